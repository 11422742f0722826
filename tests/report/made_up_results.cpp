// Writes a study and made-up results into a folder, as a run and a bench would leave them, and the
// timings again as rows of a CSV file. answer_test.py uses them.
//     taut_made_up FOLDER SEED
#include <fstream>
#include <iostream>
#include <map>

#include "core/model/input_error.hpp"
#include "experiments/case/case.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/study_bench.hpp"
#include "tests/report/made_up.hpp"

namespace taut::report::made_up_results {

using made_up::Maker;

namespace {

/// One solver, or several with unequal work; scenes with colliders, without, and in free fall.
std::string study_text(Maker& make) {
  std::string solvers =
      "\"jakobsen:substeps=" + std::string(make.chance(0.2) ? "5" : "1") + ",order=mesh\"";
  for (const char* solver : {"bullet", "xpbd", "admm"})
    if (make.chance(0.6)) solvers += ", \"" + std::string(solver) + "\"";
  std::string scenes = "\"hang\"";
  for (const char* scene : {"ball", "box", "swing", "fall", "plane"})
    if (make.chance(0.6)) scenes += ", \"" + std::string(scene) + "\"";
  return "question = \"Made up?\"\nscenes = [" + scenes + "]\nsolvers = [" + solvers +
         "]\nset = [\"time.duration=1\"]\n[axes]\n\"time.dt\" = [\"1/240\", \"1/60\", \"1/20\"]\n"
         "iterations = [1, 16, 64]\n";
}

void write_bench(Maker& make, const std::vector<Case>& cases,
                 const std::map<std::string, Record>& stored, const std::filesystem::path& folder) {
  std::ofstream csv(folder / "bench.csv");
  csv << "scene,noise,key,scene_id,solver,setting,dt,status,stable,error,samples\n";
  StudyBench bench = StudyBench::here("made-up");
  // range of costs: with 1.2 some are nearly equal
  const double range = make.chance(0.5) ? 100 : 1.2;
  for (const Case& one : cases) {
    if (one.scene->dt < 0.02 || make.chance(0.2)) continue;  // one time step only
    const auto known = stored.find(one.key);
    if (known == stored.end()) continue;  // only stored cases are timed
    SceneBench* scene = nullptr;
    for (SceneBench& other : bench.scenes)
      if (other.scene == one.scene->name) scene = &other;
    if (!scene) {
      const double noise = make.chance(0.3) ? 0.4 : 0.02;
      bench.scenes.push_back({one.scene->name, {1 / (1 + noise), 1, 1 + noise}, {}});
      scene = &bench.scenes.back();
    }
    BenchedCase c{known->second, {}};
    const double cost = 1e-4 * make.between(1, range), spread = make.between(0.01, 0.5);
    for (int i = 0; i < 8; ++i) c.timing.samples.push_back(cost * (1 + spread * make.uniform()));
    c.timing.wall = c.timing.samples;
    if (make.chance(0.05)) c.timing.failure = "made up";
    csv.precision(17);
    const auto error = c.record.values.find("stretch.rms");
    csv << scene->scene << ',' << scene->control.high - 1 << ',' << c.record.key << ','
        << c.record.scene << ',' << c.record.solver << ",\"" << c.record.spec.solver << "\","
        << c.record.dt << ',' << to_string(c.record.status.kind) << ',' << (c.stable() ? 1 : 0)
        << ',';
    if (error != c.record.values.end() && !std::isnan(error->second)) csv << error->second;
    csv << ',';
    for (const double sample : c.timing.samples) csv << sample << ' ';
    csv << '\n';
    scene->cases.push_back(std::move(c));
  }
  if (bench.scenes.empty()) return;
  Store store(folder / "results");
  keep(store, bench);
}

void write(const std::filesystem::path& folder, unsigned seed) {
  Maker make(seed);
  make_folder(folder);
  write_file((folder / "made-up.toml").string(), study_text(make));
  Store store(folder / "results");
  store.prepare();
  const std::vector<Case> cases = cases_of(load_study((folder / "made-up.toml").string(), ""));
  std::map<std::string, Record> stored;
  store.together([&] {
    for (const Case& one : cases) {
      if (make.chance(0.08)) continue;  // not run
      Record r = unfinished(one, {});
      make.fill(r);
      store.commit(r);
      stored[r.key] = r;
    }
  });
  if (seed % 4 != 0) write_bench(make, cases, stored, folder);
}

}  // namespace
}  // namespace taut::report::made_up_results

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  taut::report::made_up_results::write(argv[1], static_cast<unsigned>(std::stoul(argv[2])));
} catch (const taut::InputError& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
