// Files that taut reads back, damaged: an InputError that names the file or a whole value, never
// anything else.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/model/input_error.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/report/findings.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/recommendation.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::stored_files_test {
namespace {

namespace fs = std::filesystem;

/// A kind of file: a good one, and how it is read and used.
struct Kind {
  std::string file, text;
  std::function<void(const fs::path&)> use;
};

Record stored_record() {
  Record record = synthetic::iterations("hang").front();
  record.key = std::string(64, 'a');
  record.step_cost = {{"structural", 760, 8, 12160, true}};
  record.resolved_settings = {{"time step", "1/60 s"}};
  return record;
}

std::string bench_text() {
  SceneBench scene{"hang", {0.9, 1, 1.1}, {}};
  for (int i = 0; i < 2; ++i)
    scene.cases.push_back({stored_record(), {{1e-3, 2e-3, 1e-3, 3e-3}, {1, 2, 3, 4}, 4096, ""}});
  return to_json(StudyBench{"trade", "a machine", {scene}});
}

void use_bench(const fs::path& file) {
  const StudyBench bench = bench_from_json(read_text(file), file.string());
  bench.records();
  for (const SceneBench& scene : bench.scenes) {
    if (!scene.cases.empty()) recommend(scene, {.error = 0.01}, "stretch.rms");
    for (std::size_t i = 1; i < scene.cases.size(); ++i) scene.ratio(i, 0);
  }
}

std::string trajectory_bytes(const fs::path& folder) {
  TrajectoryWriter writer(folder / "good", {"hang", "jakobsen", 0.1, 3, {{0, 1, 2}}});
  State state{std::vector<Vec3>(3, Vec3::Ones()), std::vector<Vec3>(3, Vec3::Zero())};
  for (int k = 0; k < 3; ++k) writer.append(0.1 * k, state);
  return read_text(folder / "good");
}

std::vector<Kind> kinds(const fs::path& folder) {
  BaselineRow row = baseline_row(stored_record(), std::string(64, 'b'));
  write_baseline(folder / "baseline", {row});
  const fs::path rows = folder / "baseline" / (row.solver() + ".jsonl");
  Reference reference{"hang", std::string(64, 'c'), "static", 0, "by hand", 1e-9, {}};
  reference.x = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
  write_reference(reference, folder / "reference");
  const auto baseline = [](const fs::path& file) { read_baseline(file.parent_path()); };
  Answer check{"check"};
  check.add({"program"}, "p");
  check.add({"cases"}, 3);
  check.add({"values"}, 9);
  check.add(Table{"findings",
                  "",
                  {{"study"}, {"kind"}, {"case"}, {"change"}},
                  {{"s", "value moved", "c", "x"}}});
  return {
      {"case.json", to_json(stored_record(), 1),
       [](const fs::path& file) { record_from_json(read_text(file), file.string()); }},
      {"bench.json", bench_text(), use_bench},
      {"baseline/" + rows.filename().string(), read_text(rows), baseline},
      {"reference/static.json", read_text(folder / "reference/static.json"), read_reference},
      {"check.json", to_json(check),
       [](const fs::path& file) { report::stored_regressions(file.parent_path(), "p"); }},
      {"run.traj", trajectory_bytes(folder), [](const fs::path& file) { read_trajectory(file); }},
  };
}

TEST(StoredFiles, FlippedBytesAreNamedOrRead) {
  const Scratch scratch;
  for (const Kind& kind : kinds(scratch.path())) {
    SCOPED_TRACE(kind.file);
    const fs::path file = scratch.path() / kind.file;
    make_folder(file.parent_path());
    write_file(file, kind.text);
    ASSERT_NO_THROW(kind.use(file));
    std::mt19937 random(1);
    int refused = 0;
    for (int round = 0; round < 600; ++round) {
      std::string text = kind.text;
      for (auto flips = 1 + random() % 3; flips > 0; --flips)
        text[random() % text.size()] = static_cast<char>(random());
      if (random() % 8 == 0) text.resize(random() % text.size());
      write_file(file, text);
      try {
        kind.use(file);
      } catch (const InputError& error) {
        ++refused;
        ASSERT_NE(std::string(error.what()).find(file.filename()), std::string::npos)
            << error.what();
      }
    }
    EXPECT_GT(refused, 30);
    write_file(file, kind.text);
  }
}

TEST(StoredFiles, WrongTypesAndMissingKeysAreNamedWithTheirPlace) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      bench_from_json(text, "bench/trade.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto changed = [](std::string from, const std::string& to) {
    std::string text = bench_text();
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(message(changed("\"machine\": \"a machine\"", "\"machine\": 7")),
            "bench/trade.json: machine: expected a text");
  EXPECT_EQ(message(changed("\"peak_bytes\": 4096,", "")),
            "bench/trade.json: scenes[0].cases[0]: has no 'peak_bytes'");
  EXPECT_EQ(message(changed("\"steps\": ", "\"steps\": 0.5")).substr(0, 48),
            "bench/trade.json: scenes[0].cases[0].record.step");
  EXPECT_NE(message(changed(std::string(64, 'a'), "../../escaped")).find("hexadecimal"),
            std::string::npos);
}

}  // namespace
}  // namespace taut::stored_files_test
