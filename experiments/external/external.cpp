#include "experiments/external/external.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>

#include "core/io/section.hpp"
#include "core/model/input_error.hpp"
#include "experiments/external/command.hpp"
#include "experiments/external/program.hpp"
#include "experiments/external/recorded.hpp"

namespace taut::external {

namespace fs = std::filesystem;

namespace {

constexpr ParamSpec kLeading[] = {
    {.name = "cmd", .kind = ParamSpec::Kind::text, .help = "The program that is called"},
    ParamSpec::real("timeout", "s", "30", 0.01, 86400,
                    "Every answer has to come within this time")};

/// Stands for all programs where none is named.
const SolverEntry kAny = {
    .name = "external",
    .summary = "Any program that speaks taut-solver/1: external:cmd='python3 mine.py'",
    .source = "experiments/external/README.md",
    .params = kLeading,
    .make = [](const Scene&, const Params&) -> std::unique_ptr<Solver> {
      throw InputError("external: which program? external:cmd='python3 mine.py'");
    },
    .unsupported =
        [](const Scene&, const Params&) {
          return std::vector<std::string>{"no program is named: external:cmd='python3 mine.py'"};
        },
    .resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; }};

/// A solver's file in the registered folder.
struct Registered {
  Command command;
  std::vector<std::string> files;
};

Registered read_registered(const fs::path& file) {
  const Document document = read_document(file, {});
  Diagnostics diagnostics(document);
  Section section(diagnostics, document.root, "a solver");
  Registered solver;
  const std::string cmd = section.string("cmd").value_or("");
  section.need({"cmd"});
  const double seconds = section.number("timeout", Range::positive(86400), 30);
  if (const Value* files = section.find("files")) {
    if (!files->is_array()) section.report("files", "'files' must be a list of texts");
    for (const Value& item : files->items) {
      if (!item.is_string() || !fs::is_regular_file(file.parent_path() / item.string))
        diagnostics.report(item.place,
                           "'files' holds names of files, relative to this one's folder");
      solver.files.push_back(item.string);
    }
  }
  section.finish();
  diagnostics.throw_if_any();
  try {
    solver.command = split_command(cmd, fs::absolute(file).parent_path());
  } catch (const InputError& error) {
    section.report("cmd", error.diagnostics().front().message);
  }
  diagnostics.throw_if_any();
  solver.command.seconds = seconds;
  return solver;
}

fs::path file_of(const std::string& name) { return registered_folder() / (name + ".toml"); }

std::vector<std::string> registered_names() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(registered_folder(), none)) {
    const std::string name = file.path().stem();
    if (file.path().extension() != ".toml") continue;
    if (name == kAny.name || name == kPositions.name ||
        std::ranges::any_of(solvers(), [&](auto* e) { return e->name == name; }))
      throw InputError(file.path().string() + ": there is already a solver '" + name + "'");
    names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

/// Programs by name, command and, if they did not introduce themselves, all that was typed.
const SolverEntry* program(const std::string& name, std::string_view params,
                           const Registered& solver, std::vector<ParamSpec> leading) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<Program>> programs;
  const std::lock_guard lock(mutex);
  const std::string command =
      '\n' + solver.command.text() + '\n' + std::to_string(solver.command.seconds);
  auto& known = programs[name + command];
  if (!known) {
    const std::string called = name == kAny.name ? "" : name;
    known = std::make_shared<Program>(called, solver.command, leading, params, solver.files);
    programs[std::string(known->entry().name) + command] = known;  // its canonical text names it so
  }
  if (known->introduced()) return &known->entry();
  auto& one = programs[name + command + '\n' + std::string(params)];
  if (!one) one = std::make_shared<Program>(*known, std::move(leading), params);
  return &one->entry();
}

/// "mine:cmd='...'" and "mine:file=..." give a name to what they call.
const SolverEntry* find(std::string_view name, std::string_view params) {
  const std::string called(name);
  if (!is_solver_name(name)) return nullptr;
  if (fs::is_regular_file(file_of(called)))
    return program(called, params, read_registered(file_of(called)), {});
  const std::vector<ParamItem> items = param_items(params);
  const auto has = [&](std::string_view key) {
    return std::ranges::find(items, key, &ParamItem::key) != items.end();
  };
  if (has("cmd")) {
    const Registered solver{command_of("external:" + std::string(params)), {}};
    return program(called, params, solver, {std::begin(kLeading), std::end(kLeading)});
  }
  if (has("file")) return recorded(called, params);
  return name == kAny.name ? &kAny : name == kPositions.name ? &kPositions : nullptr;
}

std::vector<const SolverEntry*> all() {
  std::vector<const SolverEntry*> entries{&kAny, &kPositions};
  for (const std::string& name : registered_names()) entries.push_back(find(name, ""));
  return entries;
}

}  // namespace

fs::path registered_folder() {
  const auto variable = [](const char* name) -> fs::path {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (const fs::path given = variable("TAUT_SOLVERS"); !given.empty()) return given;
  const fs::path config = variable("XDG_CONFIG_HOME");
  return (config.empty() ? variable("HOME") / ".config" : config) / "taut" / "solvers";
}

Command command_of(const std::string& text) {
  if (!text.starts_with("external:")) {
    const bool name =
        text.find_first_of(" /'\"") == text.npos && fs::is_regular_file(file_of(text));
    return name ? read_registered(file_of(text)).command : split_command(text, "");
  }
  std::string ours;  // the parameters that are not the program's
  std::string cmd;
  for (const ParamItem& item : param_items(std::string_view(text).substr(9)))
    if (item.key == "timeout")
      ours += "timeout=" + item.value;
    else if (item.key == "cmd") {
      if (!item.problem.empty()) throw InputError(item.problem);  // half a command is not called
      cmd = item.value;
    }
  Command command = split_command(cmd, "");
  try {
    command.seconds = Params("external", kLeading, ours).real("timeout");
  } catch (const InputError&) {  // whoever reads all parameters says so, with its column
  }
  return command;
}

void enable() { set_solver_source({.all = all, .find = find}); }

}  // namespace taut::external
