#include "experiments/external/external.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "core/io/document.hpp"
#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/external/motion_file.hpp"
#include "experiments/external/program.hpp"

namespace taut::external {

namespace fs = std::filesystem;

namespace {

/// Entry for a solver text "external" that names no program.
const SolverEntry kAny = {
    .name = "external",
    .summary = "Any program that speaks taut-solver: external:cmd='python3 mine.py'",
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

/// A solver's file in registered_folder().
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
  const Range allowed{kTimeout.min, kTimeout.max};
  const double seconds = section.number(std::string(kTimeout.name), allowed, kAnswerSeconds);
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

bool is_registered(const std::string& name) {
  std::error_code unreadable;  // another user's folder counts as empty
  return fs::is_regular_file(file_of(name), unreadable);
}

std::vector<std::string> registered_names() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(registered_folder(), none)) {
    const std::string name = file.path().stem();
    if (file.path().extension() != ".toml") continue;
    if (name == kAny.name || name == kPositions.name ||
        std::ranges::any_of(solvers(), [&](auto* e) { return e->name == name; }))
      throw InputError(file.path().string() + ": there is already a solver '" + name + "'");
    if (!is_solver_name(name))
      throw InputError(file.path().string() + ": '" + name +
                       "' is not a solver name: a letter, then letters, digits, _ and -, at most "
                       "40 characters");
    if (!file.is_regular_file(none))
      throw InputError(file.path().string() + ": is not a regular file");
    names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

struct Programs {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<Program>> all;
};

/// All programs that were started.
Programs& started() {
  static Programs all;
  return all;
}

/// Returns the entry of a program, which is started once for each name, command and build. If the
/// program does not introduce itself, each text of parameters has an entry.
const SolverEntry* program(const std::string& name, std::string_view params,
                           const Registered& solver, std::vector<ParamSpec> leading) {
  const std::lock_guard lock(started().mutex);
  auto& programs = started().all;
  const std::string command = '\n' + solver.command.text() + '\n' +
                              shortest(solver.command.seconds) + '\n' +
                              solver.command.folder.string() + '\n' + value_in(params, "build");
  auto& known = programs[name + command];
  if (!known) {
    const std::string called = name == kAny.name ? "" : name;
    known = std::make_shared<Program>(called, solver.command, leading, params, solver.files);
    // Its canonical text uses this name.
    programs[std::string(known->entry().name) + command] = known;
  }
  if (known->silence().empty()) return &known->entry();
  auto& one = programs[name + command + '\n' + std::string(params)];
  if (!one) one = std::make_shared<Program>(*known, std::move(leading), params);
  return &one->entry();
}

/// Everything that a solver text would start or open: a registered name, a command or files; may be
/// empty.
std::set<std::string> named_by(const std::string& name, std::string_view params) {
  if (!is_solver_name(name)) return {};
  if (is_registered(name)) return {"solver " + name};
  std::set<std::string> files;
  for (const ParamItem& item : param_items(params)) {
    if (item.key == "cmd") return {"cmd " + item.value + "\nin " + value_in(params, "folder")};
    if ((item.key == "file" || item.key == "rest") && !item.value.empty())
      files.insert("file " + item.value);
  }
  return files;
}

/// The programs and files that the command line and studies have named so far.
class Admitted {
 public:
  void add(const std::set<std::string>& named) {
    const std::lock_guard lock(mutex_);
    all_.insert(named.begin(), named.end());
  }
  bool has(const std::set<std::string>& named) {
    const std::lock_guard lock(mutex_);
    return std::ranges::includes(all_, named);
  }

 private:
  std::mutex mutex_;
  std::set<std::string> all_;
};

Admitted& admitted() {
  static Admitted all;
  return all;
}

void admit(std::string_view name, std::string_view params) {
  admitted().add(named_by(std::string(name), params));
}

/// Entry for a program or file that was not admitted. Its parameters are texts, as they are stored.
class Unstarted {
 public:
  Unstarted(std::string name, std::string_view given) : name_(std::move(name)) {
    for (ParamItem& item : param_items(given))
      if (!item.key.empty()) keys_.insert(std::move(item.key));
    for (const std::string& key : keys_)
      specs_.push_back({.name = key, .kind = ParamSpec::Kind::text});
    entry_ = {.name = name_,
              .summary = "not started: neither the command line nor a study names it",
              .source = "unknown",
              .params = specs_,
              .unsupported =
                  [](const Scene&, const Params&) {
                    return std::vector<std::string>{
                        "it is not started, since neither the command line nor a study names it"};
                  },
              .resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; }};
  }
  Unstarted(const Unstarted&) = delete;
  Unstarted& operator=(const Unstarted&) = delete;
  const SolverEntry& entry() const { return entry_; }

 private:
  std::string name_;
  std::set<std::string> keys_;
  std::vector<ParamSpec> specs_;
  SolverEntry entry_;
};

const SolverEntry* unstarted(const std::string& name, std::string_view params) {
  static std::mutex mutex;
  static std::map<std::string, Unstarted> entries;
  const std::lock_guard lock(mutex);
  return &entries.try_emplace(name + ':' + std::string(params), name, params).first->second.entry();
}

/// Finds an entry. "mine:cmd='...'" and "mine:file=..." also name the program or file that they
/// call.
const SolverEntry* find(std::string_view name, std::string_view params) {
  const std::string called(name);
  if (!is_solver_name(name)) return nullptr;
  const std::set<std::string> named = named_by(called, params);
  if (!admitted().has(named)) return unstarted(called, params);
  if (is_registered(called))
    return program(called, params, read_registered(file_of(called)), {kBuildName});
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

std::vector<std::string> names() {
  std::vector<std::string> all{std::string(kAny.name), std::string(kPositions.name)};
  std::ranges::move(registered_names(), std::back_inserter(all));
  return all;
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
    const bool name = text.find_first_of(" /'\"") == text.npos && is_registered(text);
    return name ? read_registered(file_of(text)).command : split_command(text, "");
  }
  std::string ours;  // parameters of taut, not of the program
  std::string cmd;
  for (const ParamItem& item : param_items(std::string_view(text).substr(9)))
    if (item.key == kTimeout.name)
      ours += item.key + '=' + item.value;
    else if (item.key == "cmd") {
      // An incomplete command is not run.
      if (!item.problem.empty()) throw InputError(item.problem);
      cmd = item.value;
    }
  Command command = split_command(cmd, value_in(std::string_view(text).substr(9), "folder"));
  try {
    command.seconds = Params(kAny.name, kLeading, ours).real(kTimeout.name);
  } catch (const InputError&) {  // reading all parameters reports this, with its column
  }
  return command;
}

std::string why_silent(const SolverEntry& entry) {
  const std::lock_guard lock(started().mutex);
  for (const auto& [text, program] : started().all)
    if (&program->entry() == &entry) return program->silence();
  return "";
}

void run_unprobed() { set_probe_required(false); }

void enable() { set_solver_source({.names = names, .find = find, .admit = admit}); }

}  // namespace taut::external
