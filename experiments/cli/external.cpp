#include "experiments/command_line/verb.hpp"

namespace taut::verb::external_group {

namespace {

std::function<int()> bind(CLI::App& app) {
  app.require_subcommand(1);
  return [] { return kUsage; };
}

}  // namespace
}  // namespace taut::verb::external_group

TAUT_VERB(external) = {.name = "external",
                       .group = VerbGroup::one_case,
                       .summary = "Results from outside: positions that another program computed",
                       .example = "taut external score hang blender.pc2 --fps 24",
                       .bind = taut::verb::external_group::bind};
