// Study of many cheap cases: planned, stored by shards, merged, read back, reported. Prints the
// cost of each part; TAUT_SCALE_CASES=100000 makes the table of results/benchmarks/cluster.md.
#include <gtest/gtest.h>
#include <malloc.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "experiments/case/record_io.hpp"
#include "experiments/report/report.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/files.hpp"

namespace taut::cluster::scale_test {
namespace {

namespace fs = std::filesystem;

/// Memory that the process holds now (VmRSS), or the most since forget_peak() (VmHWM) [kB].
long held(const std::string& what) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(what + ":")) return std::stol(line.substr(what.size() + 1));
  return 0;
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

class Stopwatch {
 public:
  void lap(const char* what) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - last_;
    malloc_trim(0);
    std::cout << "| " << what << " | " << spent.count() << " | " << held("VmRSS") / 1024 << " |\n";
    last_ = std::chrono::steady_clock::now();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The study, also written to a file, so that `taut report ROOT/many.toml --out ROOT/merged` can
/// read what this test leaves behind.
Study many(int cases, const fs::path& root) {
  const std::string seeds = std::to_string(cases / 100);
  make_folder(root);
  write_file(root / "many.toml",
             "question = \"What do many cases cost?\"\nscenes = [\"hang\"]\nsolvers = "
             "[\"jakobsen\"]\nset = [\"cloth.grid=[4, 4]\", \"time.duration=0.1\"]\n[axes]\n"
             "iterations = { from = 1, to = 100, steps = 100 }\nseed = { from = 1, to = " +
                 seeds + ", steps = " + seeds + " }\n");
  return load_study((root / "many.toml").string());
}

/// One small result, stored for every case of a study under the case's own name and settings.
class Copies {
 public:
  explicit Copies(const Study& study)
      : run_(run_case(make_case({"hang", study.settings, "jakobsen"}), {.series_rows = 120})),
        files_{.series = to_json(run_.series)} {}
  void put(Store& into, const std::string& key, const std::string& id, const CaseSpec& spec) {
    Record& record = run_.record;
    record.key = key;
    record.id = id;
    record.spec = spec;
    const SolverChoice choice = parse_solver(spec.solver);
    for (const std::string name : {"iterations", "seed"})
      record.params[name] = choice.params.value(name);
    into.commit(record, files_);
  }

 private:
  CaseRun run_;
  CaseFiles files_;
};

/// Peak memory of a report beyond what was held before [bytes].
double peak_of_report(const Study& study, const Store& store) {
  forget_peak();
  const long before = held("VmRSS");
  EXPECT_FALSE(report::make_report(report::stored_results({study}, store)).empty());
  return 1024.0 * static_cast<double>(held("VmHWM") - before);
}

TEST(StoreScale, AReportHoldsFewBytesOfACase) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "a sanitizer's memory is not the program's";
#endif
  const Scratch root;
  const Study few = many(4200, root.path() / "few"), all = many(8400, root.path() / "all");
  Store store(root.path() / "results");
  Copies copies(all);
  store.together(
      [&] { each_case(all, [&](Case&& one) { copies.put(store, one.key, one.id, one.spec); }); });
  // A page shows details of the first 4000 cases only: beyond them only records grow.
  const double first = peak_of_report(few, store), both = peak_of_report(all, store);
  ASSERT_GT(first, 1e6) << "the peak was not measured";
  const double of_a_case = (both - first) / 4200;
  std::cout << "bytes of a case: " << of_a_case << ", of the first 4200 in all: " << first << '\n';
  // Values with a role take 2.2 kB; all 118 values would take 11.6 kB.
  EXPECT_LT(of_a_case, 4000) << "of some hundred values each, those with a role";
}

TEST(StoreScale, ManyCheapCases) {
  const char* given = std::getenv("TAUT_SCALE_CASES");
  const char* keep = std::getenv("TAUT_SCALE_FOLDER");
  const int count = given ? std::atoi(given) : 300;
  const fs::path root =
      keep ? fs::path(keep) : fs::path(testing::TempDir()) / ("scale." + unique_suffix());
  const fs::path folder = root / "folder";
  std::cout << "| " << count << " cases | s | MB held then |\n|---|---|---|\n";
  Stopwatch watch;
  const Study study = many(count, root);
  constexpr int kShards = 8;
  {
    make_folder(folder / "shards");
    const std::vector<Case> cases = cases_of(study);
    plan(study, cases, {}, kShards, 1);
    Store(folder).begin_session("", {{study.name, cases}}, {1, kShards});
  }
  watch.lap("plan: keys, shards");
  Copies copies(study);
  {
    std::vector<Store> stores;
    for (int shard = 1; shard <= kShards; ++shard) stores.emplace_back(shard_folder(folder, shard));
    std::size_t planned = 0;
    for (int shard = 1; shard <= kShards; ++shard)
      stores[static_cast<std::size_t>(shard) - 1].together([&] {
        each_case(study, [&](Case&& one) {
          if (Shard::of(one.key, kShards) != shard) return;
          copies.put(stores[static_cast<std::size_t>(shard) - 1], one.key, one.id, one.spec);
          ++planned;
        });
      });
    ASSERT_EQ(planned, static_cast<std::size_t>(count));
  }
  watch.lap("write eight files");
  Store merged(root / "merged");
  {
    const Merge merge({folder});
    const MergePlan found = merge.look(merged);
    ASSERT_TRUE(found.mergeable() && found.missing.empty());
    watch.lap("compare for the merge");
    merge.copy(found, merged, [](std::size_t, std::size_t) {});
  }
  watch.lap("merge");
  EXPECT_EQ(Store(root / "merged").digest(), merged.digest());
  watch.lap("digest, twice");
  {
    const StudyRecords all = collect(study, merged);
    EXPECT_EQ(all.records.size(), static_cast<std::size_t>(count));
    watch.lap("collect all records");
  }
  std::map<fs::path, int> entries;
  for (const auto& one : fs::recursive_directory_iterator(root))
    ++entries[one.path().parent_path()];
  int most = 0;
  for (const auto& [where, number] : entries) most = std::max(most, number);
  std::cout << "most entries in a folder: " << most << '\n';
  EXPECT_LE(most, 20) << "many cases, few files";
  if (!keep) fs::remove_all(root);
}

}  // namespace
}  // namespace taut::cluster::scale_test
