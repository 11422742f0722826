#include "experiments/command_line/verb.hpp"
#include "experiments/study/cluster/cluster.hpp"

namespace taut::verb::cluster_merge {

namespace {

struct Options {
  std::vector<std::string> folders;
  std::string out;
  bool allow_missing = false;
  Format format;
};

Table sentences(const char* name, const std::vector<std::string>& lines) {
  Table table{name, name, {{"case"}}};
  for (const std::string& line : lines) table.rows.push_back({line});
  table.most = 10;
  return table;
}

int run(const Options& o) {
  const cluster::Merge merge({o.folders.begin(), o.folders.end()});
  Store store(o.out);
  const cluster::MergePlan plan = merge.look(store);
  std::vector<std::string> missing;
  for (const PlannedKey& one : plan.missing)
    missing.push_back(one.id + " (shard " + std::to_string(one.shard) + ")");
  const bool may = plan.mergeable() && (missing.empty() || o.allow_missing) && !plan.cases.empty();
  if (may) {
    store.prepare();
    merge.copy(plan, store, Countdown("merging"));
    if (!missing.empty()) store.mark_missing(plan.missing);
  }
  Answer answer{"cluster merge", o.out};
  answer.add({"cases"}, plan.cases.size());
  answer.add({"there"}, plan.cases.size() - missing.size());
  answer.add({"merged"}, may);
  if (store.reading()) answer.add({"store"}, store.digest());
  answer.add(sentences("missing", missing));
  answer.add(sentences("foreign", plan.foreign));
  answer.add(sentences("conflicts", plan.conflicts));
  print(answer, o.format);
  const auto refused = [](const char* why, const std::vector<std::string>& all, ExitCode code) {
    std::cerr << "not merged: " << all.size() << ' ' << why << ", the first: " << all.front()
              << '\n';
    return code;
  };
  if (!plan.foreign.empty()) return refused("foreign", plan.foreign, kUsage);
  if (!plan.conflicts.empty()) return refused("in conflict", plan.conflicts, kConflict);
  if (plan.cases.empty()) return kNothing;
  if (!may) return refused("missing", missing, kIncomplete);
  return missing.empty() ? kPass : kIncomplete;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("DIR", o.folders,
                  "Folders of `taut cluster submit`, or results folders of `taut run --shard`")
      .required();
  add_results(args, o.out);
  args.add_flag("--allow-missing", o.allow_missing,
                "Merge although planned cases are missing; reports say so");
  add_format(args, o.format, "All that is missing, foreign or in conflict");
}

}  // namespace
}  // namespace taut::verb::cluster_merge

TAUT_VERB(cluster_merge) = {
    .name = "cluster merge",
    .summary = "Unites results; if any are missing, foreign or in conflict, says which",
    .example =
        "taut cluster merge results/cluster/iterations\n"
        "  taut cluster merge results/shard1 results/shard2 --out results/runs",
    .answer = {{"facts", "cases there merged store"},
               {"missing", "case"},
               {"foreign", "case"},
               {"conflicts", "case"}},
    .bind =
        taut::bind_verb<taut::verb::cluster_merge::add_options, taut::verb::cluster_merge::run>};
