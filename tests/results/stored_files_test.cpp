// Reading a damaged file of taut gives either an InputError that names the file or a whole value.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/model/input_error.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::stored_files_test {
namespace {

namespace fs = std::filesystem;

/// Kind of file: a valid example, and code that reads and uses it.
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

std::vector<Kind> kinds(const fs::path& folder) {
  BaselineRow row = baseline_row(stored_record(), std::string(64, 'b'));
  write_baseline(folder / "baseline", {row});
  const fs::path rows = folder / "baseline" / (row.solver() + ".jsonl");
  Reference reference{"hang", std::string(64, 'c'), "by hand", 1e-9, {}};
  reference.x = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
  write_reference(reference, folder / "reference");
  const auto baseline = [](const fs::path& file) { read_baseline(file.parent_path()); };
  Answer answer{"check"};
  answer.add({"cases"}, 3);
  answer.add(Table{"findings", "", {{"study"}, {"change"}}, {{"s", Cell("x").with("note")}}});
  return {
      {"case.json", to_json(stored_record(), 1),
       [](const fs::path& file) { record_from_json(read_text(file), file.string()); }},
      {"baseline/" + rows.filename().string(), read_text(rows), baseline},
      {"reference/static.json", read_text(folder / "reference/static.json"), read_reference},
      {"answer.json", to_json(answer),
       [](const fs::path& file) { answer_from_json(read_text(file), file.string()); }},
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

TEST(StoredFiles, WrongTypesAndMissingKeysHaveTheirPlace) {
  const auto message = [](std::string from, const std::string& to) -> std::string {
    std::string text = to_json(stored_record(), 1);
    text.replace(text.find(from), from.size(), to);
    try {
      record_from_json(text, "case.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("\"scene\": \"hang\",\n \"solver\"", "\"scene\": 7,\n \"solver\""),
            "case.json: scene: expected a text");
  EXPECT_EQ(message("\"items\": 760,", ""), "case.json: step_cost[0]: has no 'items'");
  EXPECT_EQ(message("\"steps\": ", "\"steps\": 0.5").substr(0, 16), "case.json: steps");
  EXPECT_NE(message(std::string(64, 'a'), "../../escaped").find("hexadecimal"), std::string::npos);
}

}  // namespace
}  // namespace taut::stored_files_test
