#include "experiments/external/external.hpp"

#include "core/io/scene_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/external/probe.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::external_program {

namespace {

using external::Check;

struct Options {
  std::string command, scene, output;
  std::vector<std::string> settings;
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
    table.rows.push_back({external::to_string(check.verdict), check.name, check.said});
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

void add_options_probe(CLI::App& app, Options& o) {
  app.add_option("COMMAND", o.command,
                 "The command, the name of a registered solver, or external:cmd='...'")
      ->required();
  add_format(app, o.format);
}

void add_options_scene(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "Name or path of a scene")->required();
  add_output(app, o.output, "File to write")->required();
  add_settings(app, o.settings);
}

int write_scene(const Options& o) {
  write_file(o.output, external::scene_file(load_scene(find_scene(o.scene), o.settings)));
  return kPass;
}

/// Downloads Jolt and registers it; if that fails, nothing is registered. Nothing of it is part of
/// taut or of its set-up.
int install(const Options& o) {
  namespace fs = std::filesystem;
  constexpr const char* kPackage = "jolt-physics@1.1.0";
  if (o.command != "jolt") throw InputError("unknown program '" + o.command + "': there is jolt");
  for (const char* needed : {"node", "npm"})
    if (!on_path(needed))
      throw InputError(std::string(needed) + " is not here (apt install nodejs npm): no jolt");
  const fs::path registered = external::registered_folder(), folder = registered / "jolt";
  progress() << "npm downloads " << kPackage << " (MIT, 13 MB), of which 3 MB stay in "
             << folder.string() << "; to be rid of it, delete that folder and "
             << (registered / "jolt.toml").string() << '\n';
  const Scratch scratch;
  Process npm({"npm", "install", "--prefix", scratch.path(), "--no-save", "--no-audit", "--no-fund",
               "--ignore-scripts", kPackage},
              {.output = ProcessOptions::Stream::piped, .errors = ProcessOptions::Stream::piped});
  const std::string said = npm.read_all(600);
  if (const auto end = npm.wait(10); !end || !end->good())
    throw InputError("npm could not install " + std::string(kPackage) + ":\n" + said);
  const fs::path package = fs::path("node_modules") / "jolt-physics",
                 ours = data_folder() / "external";
  const auto put = [&](const fs::path& from, const fs::path& to) {
    make_folder((folder / to).parent_path());
    write_file(folder / to, read_text(from));
  };
  for (const char* file : {"package.json", "LICENSE", "dist/jolt-physics.wasm-compat.js"})
    put(scratch.path() / package / file, package / file);
  put(ours / "jolt" / "jolt.js", "jolt.js");
  put(ours / "sdk" / "taut_solver.js", "taut_solver.js");
  write_file(registered / "jolt.toml",
             "cmd = \"node jolt/jolt.js\"\nfiles = [\"jolt/taut_solver.js\", "
             "\"jolt/node_modules/jolt-physics/dist/jolt-physics.wasm-compat.js\"]\n");
  return probe(o);
}

void add_options_install(CLI::App& app, Options& o) {
  app.add_option("PROGRAM", o.command, "jolt")->required();
  add_format(app, o.format);
}

}  // namespace
}  // namespace taut::verb::external_program

TAUT_VERB(external) = {
    .name = "external",
    .group = VerbGroup::one_case,
    .summary = "Solvers from outside: programs that speak taut-solver/1",
    .example =
        "taut external probe 'python3 mine.py'\n  taut case hang \"external:cmd='python3 "
        "mine.py',iterations=8\""};

TAUT_VERB(external_probe) = {
    .name = "external probe",
    .summary = "Says in sentences whether a program may be scored, and what is wrong with it",
    .example = "taut external probe 'python3 mine.py'\nExit: 0 it may be scored; 1 it may not",
    .bind = taut::bind_verb<taut::verb::external_program::add_options_probe,
                            taut::verb::external_program::probe>};

TAUT_VERB(external_install) = {
    .name = "external install",
    .summary = "Downloads another engine, says what, registers it as a solver and probes it: jolt",
    .example = "taut external install jolt\n  taut case hang jolt:substeps=15",
    .bind = taut::bind_verb<taut::verb::external_program::add_options_install,
                            taut::verb::external_program::install>};

TAUT_VERB(external_scene) = {
    .name = "external scene",
    .summary = "Writes a scene as programs get it: everything resolved, as JSON",
    .example = "taut external scene hang -o hang.json",
    .bind = taut::bind_verb<taut::verb::external_program::add_options_scene,
                            taut::verb::external_program::write_scene>};
