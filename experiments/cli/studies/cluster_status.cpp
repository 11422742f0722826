#include "experiments/command_line/verb.hpp"
#include "experiments/study/cluster/cluster.hpp"

namespace taut::verb::cluster_status {

namespace {

struct Options {
  std::string folder;
  Format format;
};

int run(const Options& o) {
  const Answer answer = cluster::status_of(o.folder);
  print(answer, o.format);
  return answer.fact("done") == answer.fact("cases") ? kPass : kIncomplete;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("DIR", o.folder, "The folder of `taut cluster submit`").required();
  add_format(args, o.format, "Every shard and every failed case");
}

}  // namespace
}  // namespace taut::verb::cluster_status

TAUT_VERB(cluster_status) = {
    .name = "cluster status",
    .summary = "Shows done and failed cases of every shard, and the command that starts the rest",
    .example = "taut cluster status results/cluster/iterations",
    .answer = {{"facts", "cases done start again"},
               {"shards", "shard state cases done host started"},
               {"failed", "shard case status"}},
    .bind =
        taut::bind_verb<taut::verb::cluster_status::add_options, taut::verb::cluster_status::run>};
