#include "experiments/command_line/verb.hpp"
#include "experiments/steps/error_probes.hpp"

namespace taut::verb::step_error {

namespace {

struct Options {
  std::vector<std::string> parts, scenes;
  Format format;
};

int run(const Options& o) {
  const std::vector<std::string> known = probe_parts();
  std::vector<ProbePart> parts;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (o.parts.empty() || std::ranges::find(o.parts, known[i]) != o.parts.end())
      parts.push_back(static_cast<ProbePart>(i));
  print(error_probes(parts, o.scenes), o.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("PART", o.parts, "free (elastic links), contact, rigid (default: all)")
      .check(known("part", probe_parts()));
  args.add_option("--scene", o.scenes, "One of its scenes alone; repeat it for each").one_each();
  add_format(args, o.format, "Print all rows");
}

}  // namespace
}  // namespace taut::verb::step_error

TAUT_VERB(verify_steps) = {
    .name = "verify steps",
    .group = VerbGroup::trust,
    .summary = "Compares step.error with the true distance from the exact step",
    .example = "taut verify steps free\n  taut verify steps contact --scene ball",
    .answer = {{"facts", "free_share contact_share rigid_share"},
               {"free", "scene solver probes within refused without_exact least most"},
               {"contact", "scene solver probes within refused without_exact least most"},
               {"rigid", "scene solver probes within refused without_exact least most"}},
    .bind = taut::bind_verb<taut::verb::step_error::add_options, taut::verb::step_error::run>};
