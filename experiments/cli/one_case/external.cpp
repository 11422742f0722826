#include "experiments/external/external.hpp"

#include "core/io/scene_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/external/probe.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::external_program {

namespace {

using external::Check;

struct Options {
  std::string command, scene, output;
  SceneSettings settings;
  Format format;
};

int probe(const Options& options) {
  const external::Command command = external::command_of(options.command);
  const std::vector<Check> checks = external::full_probe(
      command, [](const Check& check) { progress() << "checked: " << check.name << std::endl; });
  const auto failed = std::ranges::count(checks, Check::Verdict::failed, &Check::verdict);
  Answer answer{"external probe", command.text()};
  Table table{"checks", "", {{"verdict"}, {"check"}, {"said", "what it says"}}};
  for (const Check& check : checks)
    table.rows.push_back({cell_of(check.verdict), check.name, check.said});
  answer.add(
      {"passed", "may be scored"},
      Cell(failed == 0)
          .with(failed == 0 ? ""
                            : std::to_string(failed) + " of " + std::to_string(checks.size()) +
                                  " checks failed: it is not scored"));
  answer.add(std::move(table));
  print(answer, options.format);
  return failed == 0 ? kPass : kRegression;
}

void add_options_probe(Arguments& args, Options& o) {
  args.add_option("COMMAND", o.command,
                  "The command, the name of a registered solver, or external:cmd='...'")
      .required();
  add_format(args, o.format);
}

void add_options_scene(Arguments& args, Options& o) {
  add_scene(args, o.scene).required();
  add_output(args, o.output, "File to write").required();
  add_settings(args, o.settings);
}

int write_scene(const Options& o) {
  write_file(o.output, external::scene_file(load_scene(find_scene(o.scene), o.settings)));
  return kPass;
}

}  // namespace
}  // namespace taut::verb::external_program

TAUT_VERB(external) = {
    .name = "external",
    .group = VerbGroup::one_case,
    .summary = "Probes and scores solvers from outside: programs that speak taut-solver",
    .example =
        "taut external probe 'python3 mine.py'\n  taut case hang \"external:cmd='python3 "
        "mine.py',iterations=8\""};

TAUT_VERB(external_probe) = {
    .name = "external probe",
    .summary = "Checks whether a program may be scored, and names its errors if not",
    .example = "taut external probe 'python3 mine.py'\nExit: 0 it may be scored; 1 it may not",
    .answer = {{"facts", "passed"}, {"checks", "verdict check said"}},
    .bind = taut::bind_verb<taut::verb::external_program::add_options_probe,
                            taut::verb::external_program::probe>};

TAUT_VERB(external_scene) = {
    .name = "external scene",
    .summary = "Writes a scene as programs get it: everything resolved, as JSON",
    .example = "taut external scene hang -o hang.json",
    .bind = taut::bind_verb<taut::verb::external_program::add_options_scene,
                            taut::verb::external_program::write_scene>};
