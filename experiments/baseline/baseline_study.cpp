#include "experiments/baseline/baseline_study.hpp"

#include <fstream>
#include <map>
#include <set>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/results/store.hpp"

namespace taut {

namespace {

void run_all(const std::vector<Case>& cases, Store& store, const BaselineOptions& options,
             BaselineStudy& result) {
  store.prepare();
  const CampaignProgress campaign = options.run(
      {{result.name, cases}}, store, "taut check " + result.name, {.jobs = options.jobs});
  result.conflict = campaign.conflicts > 0;
  result.interrupted = campaign.interrupted;
}

/// Runs all cases again, into a separate store, and marks those whose results differ in any bit.
void mark_flaky(const std::vector<Case>& cases, Store& store, const BaselineOptions& options,
                BaselineStudy& result) {
  const std::filesystem::path folder = std::filesystem::path(options.out) / "again";
  std::filesystem::remove_all(folder);
  Store second(folder.string());
  run_all(cases, second, options, result);
  for (const Case& one : cases) {
    const auto a = store.find(one), b = second.find(one);
    if (!a || !b || (a->digest == b->digest && a->status.step == b->status.step)) continue;
    for (BaselineRow& row : result.now) row.flaky = row.flaky || row.id == one.id;
    options.say(result.name + ": " + one.id + ": does not repeat bit for bit: flaky");
  }
  std::filesystem::remove_all(folder);
}

void add_frontiers(Store& store, const BaselineOptions& options, BaselineStudy& result) {
  const std::vector<FrontierQuestion> questions = read_frontiers(result.folder);
  if (questions.empty()) return;
  store.begin_session("taut check " + result.name);
  for (const FrontierQuestion& question : questions) {
    const CaseFrontier found = find_frontier(question, store, {.jobs = options.jobs});
    result.interrupted = result.interrupted || found.interrupted;
    if (found.frontier.kind == Frontier::Kind::not_answered)
      result.not_run.push_back(frontier_id(question));
    else
      result.now.push_back(frontier_row(question, found));
  }
}

}  // namespace

Comparison BaselineStudy::compare() const {
  const std::set<std::string> left_out(not_run.begin(), not_run.end());
  Baseline known = before;
  std::erase_if(known, [&](const BaselineRow& row) { return left_out.count(row.id) > 0; });
  return taut::compare(known, now, tolerances);
}

BaselineStudy baseline_study(const std::string& name, const BaselineOptions& options,
                             bool needs_baseline) {
  const Study study = load_study(name);
  BaselineStudy result;
  result.name = study.name;
  result.folder = std::filesystem::path(options.baselines) / study.name;
  result.tolerances = read_tolerances(result.folder);
  result.before = read_baseline(result.folder);
  if (const auto file = result.folder / kToolchainFile; std::filesystem::exists(file)) {
    std::ifstream made_with = open_file(file);
    std::getline(made_with, result.toolchain);
  }
  result.toolchain = printable(result.toolchain);
  if (result.before.empty() && needs_baseline) return result;

  Store store(options.out);
  const std::vector<Case> cases = cases_of(study);
  run_all(cases, store, options, result);
  std::map<const Scene*, std::string> digests;
  for (const Case& one : cases) {
    const auto record = store.find(one);
    if (!record) {
      result.not_run.push_back(one.id);
      continue;
    }
    std::string& scene = digests[one.scene.get()];
    if (scene.empty()) scene = digest(*one.scene);
    result.now.push_back(baseline_row(*record, scene));
  }
  if (options.repeat) mark_flaky(cases, store, options, result);
  add_frontiers(store, options, result);
  return result;
}

}  // namespace taut
