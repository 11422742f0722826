#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include "core/io/mesh_io.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

/// All readers of external input, as functions of bytes, for libFuzzer (fuzz.cpp) and for inputs
/// that once broke a reader (corpus_test.cpp). A reader throws InputError for input that it
/// refuses; any other exception, a signal or a failed expectation is a finding.
namespace taut::fuzz {

/// Checks a property that every accepted input must have.
inline void expect(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << '\n';
  std::abort();
}

/// File with these bytes; every call reuses the same file.
inline std::filesystem::path file_of(const std::string& bytes, const std::string& name) {
  static const Scratch scratch;
  const std::filesystem::path file = scratch.path() / name;
  make_folder(file.parent_path());
  write_file(file, bytes);
  return file;
}

inline void read_scene(const std::string& bytes) {
  // The grid is small, as the bytes may ask for 2^24 vertices. A mesh would be another file.
  const Scene scene = parse_scene("fuzzed.toml", bytes, {"cloth.grid=[4, 3]"});
  expect(digest(scene).size() == 64, "a scene has a digest");
  for (const Vec3& x : scene.start.x) expect(x.allFinite(), "a scene starts at finite positions");
  for (const double m : scene.mesh.mass) expect(m > 0, "masses are above 0");
  for (const Link& link : scene.links) expect(link.rest > 0, "links have a length");
  expect(scene.dt > 0 && scene.steps > 0, "a scene takes time");
}

inline void read_study(const std::string& bytes) {
  const Study study = load_study(file_of(bytes, "study.toml").string());
  expect(!study.question.empty() && !study.scenes.empty() && !study.solvers.empty(),
         "a study asks something");
  for (const StudyAxis& axis : study.axes) expect(!axis.values.empty(), "an axis has values");
}

inline void read_mesh(const std::string& bytes) {
  const Polygons polygons = parse_obj("fuzzed.obj", bytes);
  for (const double m : make_mesh(polygons, 1, Lumping::area).mass)
    expect(m > 0, "masses are above 0");
  for (const Link& link : mesh_links(polygons, {true, true, true}))
    expect(link.rest > 0, "links have a length");
}

inline void read_solver(const std::string& bytes) {
  const SolverChoice choice = parse_solver(bytes);
  const std::string canonical = choice.canonical();
  expect(parse_solver(canonical).canonical() == canonical, "a canonical text stands for itself");
  expect(parse_solver(choice.brief()).canonical() == canonical, "the brief text says the same");
}

inline void read_frames(const std::string& bytes) {
  for (const Frame& frame : frames_in(bytes, 3))
    expect(std::isfinite(frame.t), "frames have a time");
}

inline void judge(const Record& record) {
  expect(is_key(record.key) && record.dt > 0, "a record has an address and a time step");
  for (const auto& [name, value] : record.values)
    expect(!std::isinf(value), "a value is a number or has no meaning");
}

inline void read_record(const std::string& bytes) {
  const Record record = record_from_json(bytes, "case.json");
  judge(record);
  expect(to_json(record_from_json(to_json(record), "again")) == to_json(record),
         "a record is what was written of it");
}

inline void read_baseline_rows(const std::string& bytes) {
  const Baseline rows = read_baseline(file_of(bytes, "baseline/jakobsen.jsonl").parent_path());
  expect(compare(rows, rows, {}).findings.empty(), "a baseline is equal to itself");
  for (const BaselineRow& row : rows) reproduce(row);
}

/// Reads the lines with which a program answers "hello", "scene" (of four vertices), "step" and
/// "store".
inline void read_answers(const std::string& bytes) {
  std::istringstream lines(bytes);
  const auto next = [&] {
    std::string line;
    if (!std::getline(lines, line)) throw InputError("an answer is missing");
    return external::parse_answer(line);
  };
  const auto hello = external::read_hello(next());
  const Params params(hello->name, hello->params, "");
  expect(Params(hello->name, hello->params, params.canonical()).canonical() == params.canonical(),
         "defaults are values of their parameters");
  external::own_params(*hello, params);
  for (const PassCost& pass : external::read_scene_answer(next(), 4).plan)
    expect(pass.items < SIZE_MAX / 2, "a pass visits a number of items");
  external::read_step(next());
  expect(external::read_store(next(), 4) == 4 * sizeof(double) * 6, "a state has its size");
}

struct Reader {
  std::string_view name;  ///< also the name of its folder in corpus/
  void (*read)(const std::string& bytes);
};

inline constexpr Reader kReaders[] = {
    {"scene", read_scene},
    {"study", read_study},
    {"mesh", read_mesh},
    {"solver", read_solver},
    {"record", read_record},
    {"frames", read_frames},
    {"baseline", read_baseline_rows},
    {"answers", read_answers},
};

}  // namespace taut::fuzz
