#include "experiments/command_line/catalogue.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut::verb::list {

namespace {

struct Options {
  std::string what;
  Format format;
};

int run(const Options& options) {
  print(catalogue(options.what), options.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option(
      "WHAT", o.what,
      "scenes | solvers | metrics | studies | keys | fabrics | assertions | record | answers, or "
      "the name of a solver, whose parameters it lists (default: all)");
  add_format(args, o.format, "Types, ranges and examples of keys, too");
}

}  // namespace
}  // namespace taut::verb::list

TAUT_VERB(list) = {.name = "list",
                   .group = VerbGroup::one_case,
                   .summary =
                       "Lists scenes, solvers with parameters, metrics, studies, keys, fabrics, "
                       "assertions",
                   .example = "taut list solvers\n  taut list jakobsen",
                   .answer = {{"solvers", "name summary source"},
                              {"parameters", "solver name default unit allowed help"},
                              {"scenes", "name vertices links dt duration summary"},
                              {"metrics", "name summary source"},
                              {"values", "metric name unit in_series help"},
                              {"studies", "name presets question scenes solvers"},
                              {"keys", "key type unit range default example help"},
                              {"study_keys", "key help"},
                              {"fabrics", "name mass warp weft drape source licence"},
                              {"record", "key column type help"},
                              {"assertions", "source name summary verdict because truth"},
                              {"answers", "verb table columns"}},
                   .bind = taut::bind_verb<taut::verb::list::add_options, taut::verb::list::run>};
