#include "experiments/external/external.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "core/io/document.hpp"
#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/external/motion_file.hpp"
#include "experiments/external/probe.hpp"
#include "experiments/system/text.hpp"

namespace taut::external {

namespace fs = std::filesystem;

namespace {

/// A scene in a program of its own. Solver calls are requests.
class ExternalSolver final : public Solver {
 public:
  ExternalSolver(std::unique_ptr<Connection> connection, int vertices, std::vector<PassCost> plan,
                 std::string unmeasurable)
      : connection_(std::move(connection)),
        vertices_(vertices),
        plan_(std::move(plan)),
        unmeasurable_(std::move(unmeasurable)) {}

  void load(const State& state) override {
    load_state(*connection_, state);
    owed_ = false;
    if (timed_ && unmeasurable_.empty() && connection_->has_helpers())
      unmeasurable_ = "it starts processes of its own, whose time its CPU clock does not hold";
  }

  void step(double t, double dt) override {
    if (!timed_) {
      take_steps(*connection_, t, dt, 1);
      return;
    }
    const double before = connection_->cpu_seconds();
    said_ += take_steps(*connection_, t, dt, 1);
    clock_ += connection_->cpu_seconds() - before - empty_;
    ++steps_;
    owed_ = true;
  }

  void store(State& state) const override {
    if (!timed_ || !owed_) return store_state(*connection_, vertices_, state);
    const double before = connection_->cpu_seconds();
    store_state(*connection_, vertices_, state);
    const double first = connection_->cpu_seconds();
    store_state(*connection_, vertices_, state);
    clock_ += std::max(0.0, 2 * first - before - connection_->cpu_seconds());
    owed_ = false;
  }
  std::vector<PassCost> step_cost() const override { return plan_; }
  std::size_t peak_bytes() const override { return connection_->peak_bytes(); }
  std::string log() const override { return connection_->log(); }

  double cpu_seconds() const override {
    if (!unmeasurable_.empty()) return std::numeric_limits<double>::quiet_NaN();
    if (!timed_) measure_empty_exchange();
    State state;
    if (owed_) store(state);
    return clock_;
  }

  std::string time_remark() const override {
    if (!unmeasurable_.empty()) return "its time is not measurable: " + unmeasurable_;
    if (steps_ == 0 || std::isnan(said_)) return {};
    const double word = said_ / steps_, clock = clock_ / steps_;
    if (agrees(word, clock, empty_)) return {};
    return formatted("it says %.4g us a step, its CPU clock %.4g us", 1e6 * word, 1e6 * clock);
  }

 private:
  /// What an exchange costs the program that asks for no step: the least of three means.
  void measure_empty_exchange() const {
    constexpr int kExchanges = 50;
    timed_ = true;
    empty_ = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 3; ++round) {
      const double before = connection_->cpu_seconds();
      for (int i = 0; i < kExchanges; ++i) take_steps(*connection_, 0, 1, 0);
      empty_ = std::min(empty_, (connection_->cpu_seconds() - before) / kExchanges);
    }
  }

  std::unique_ptr<Connection> connection_;
  int vertices_;
  std::vector<PassCost> plan_;
  std::string unmeasurable_;
  mutable bool timed_ = false;
  mutable double empty_ = 0;   ///< CPU s of an exchange without a step
  mutable double clock_ = 0;   ///< CPU s of the steps since timing began, as measured: what the
                               ///< first state after them costs beyond a second one is theirs too
  mutable bool owed_ = false;  ///< steps were asked for, and no state since: they may be undone
  double said_ = 0;            ///< CPU s of the steps, its word
  int steps_ = 0;
};

std::string key_of(const Scene& scene, const Params& params) {
  return digest(scene) + params.canonical();
}

/// What its results depend on and this program can see.
std::string digest_of(const Command& command, const std::vector<std::string>& files,
                      const std::string& version) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28;
  std::string all = command.text() + "\n" + version + "\n";
  std::vector<std::string> names = command.words;
  names.insert(names.end(), files.begin(), files.end());
  for (const std::string& name : names)
    if (const fs::path path = command.folder / name; fs::is_regular_file(path))
      all += name + " " + sha256(read_text(path, kMostBytes)) + "\n";
  return sha256(all);
}

/// A value of a solver's text; "": it has none.
std::string value_in(std::string_view params, std::string_view key) {
  for (const ParamItem& item : param_items(params))
    if (item.key == key) return item.value;
  return {};
}

/// What the results of a build that is named depend on: wherever the program lies.
std::string digest_of(const Command& command, const std::string& build) {
  return sha256("build " + build + "\n" + join(command.words, "\n", [](const fs::path& word) {
                  return word.filename().string();
                }));
}

/// One program as a solver: its entry, for as long as this program lives.
class Program {
 public:
  /// Says hello. A program that answers it badly has an entry all the same, whose cases end as the
  /// hello did: it costs its own cases, not the study. `name`: "" names it after itself
  /// (name_for). `leading` are the parameters that come before its own, `given` the text of all,
  /// `files` what it is made of beside the files that the command names. Throws InputError if it
  /// cannot be started.
  Program(std::string name, Command, std::vector<ParamSpec> leading, std::string_view given,
          const std::vector<std::string>& files);
  /// A program that did not introduce itself, called with other parameters.
  Program(const Program& silent, std::vector<ParamSpec> leading, std::string_view given);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  const SolverEntry& entry() const { return entry_; }
  bool introduced() const { return hello_ != nullptr; }

 private:
  struct Loaded {
    std::unique_ptr<Connection> connection;
    SceneAnswer answer;
  };
  void introduce(std::string_view given);
  Loaded load(const Scene&, const Params&) const;
  std::vector<std::string> unsupported(const Scene&, const Params&);
  std::unique_ptr<Solver> make(const Scene&, const Params&);
  ResolvedSettings resolved_settings(const Scene&, const Params&);
  void require_probed(const Params&);

  std::string name_, implementation_, build_;
  bool told_ = false;  ///< the build, by whoever starts it
  Command command_;
  std::unique_ptr<const Hello> hello_;
  std::optional<SolverFailure> failure_;  ///< of the hello
  std::deque<std::string> texts_;
  std::vector<ParamSpec> specs_;
  SolverEntry entry_;

  std::mutex mutex_;
  std::map<std::string, std::optional<SolverFailure>> probed_;  ///< by values of its parameters
  std::map<std::string, Loaded> waiting_;  ///< asked whether it can, until make() takes it
  std::map<std::string, ResolvedSettings> settings_;
};

Program::Program(std::string name, Command command, std::vector<ParamSpec> leading,
                 std::string_view given, const std::vector<std::string>& files)
    : name_(std::move(name)), command_(std::move(command)), specs_(std::move(leading)) {
  try {
    Connection connection(command_);
    hello_ = say_hello(connection);
    specs_.insert(specs_.end(), hello_->params.begin(), hello_->params.end());
  } catch (const SolverFailure& failure) {
    failure_ = failure;
  }
  if (name_.empty()) name_ = name_for(hello_ ? hello_->name : "external", command_.text());
  build_ = value_in(given, "build");
  told_ = !build_.empty();
  implementation_ = told_ ? digest_of(command_, build_)
                          : digest_of(command_, files, hello_ ? hello_->version : "");
  if (!told_)
    build_ = slug((hello_ ? hello_->name + "-" + hello_->version : name_) + "-" +
                  implementation_.substr(0, 8));
  introduce(given);
}

Program::Program(const Program& silent, std::vector<ParamSpec> leading, std::string_view given)
    : name_(silent.name_),
      implementation_(silent.implementation_),
      build_(silent.build_),
      told_(silent.told_),
      command_(silent.command_),
      failure_(silent.failure_),
      specs_(std::move(leading)) {
  introduce(given);
}

void Program::introduce(std::string_view given) {
  if (!hello_)
    for (const ParamItem& item : param_items(given))  // nobody knows them: as they are typed
      if (std::ranges::find(specs_, item.key, &ParamSpec::name) == specs_.end())
        specs_.push_back({.name = texts_.emplace_back(item.key), .kind = ParamSpec::Kind::text});
  entry_ = {.name = name_,
            .summary = hello_ ? std::string_view(hello_->summary)
                              : std::string_view(texts_.emplace_back(
                                    "does not answer: " + std::string(failure_->what()))),
            .source = hello_ ? std::string_view(hello_->source) : "unknown",
            .params = specs_,
            .make = [this](const Scene& s, const Params& p) { return make(s, p); },
            .unsupported = [this](const Scene& s, const Params& p) { return unsupported(s, p); },
            .resolved_settings = [this](const Scene& s,
                                        const Params& p) { return resolved_settings(s, p); },
            .declared_step = implicit_euler_of_a_frame,
            .implementation = implementation_,
            .build = build_,
            .place = told_ ? "cmd|folder|build" : ""};
  const auto has = [&](std::string_view parameter) {
    const auto at = std::ranges::find(specs_, parameter, &ParamSpec::name);
    return at != specs_.end() && at->kind == ParamSpec::Kind::integer;
  };
  if (has("substeps")) entry_.accuracy.substeps = "substeps";
  if (has("iterations")) entry_.accuracy.sweeps = "iterations";
}

Program::Loaded Program::load(const Scene& scene, const Params& params) const {
  Loaded loaded{std::make_unique<Connection>(command_), {}};
  say_hello(*loaded.connection);
  loaded.answer = give_scene(*loaded.connection, scene, own_params(*hello_, params));
  return loaded;
}

std::vector<std::string> Program::unsupported(const Scene& scene, const Params& params) {
  if (!hello_) return {};                     // make() says why
  const Scene first = stages(scene).front();  // a program gets them one by one
  if (std::vector<std::string> unknown = beyond(hello_->version_spoken, first); !unknown.empty())
    return unknown;
  const std::lock_guard lock(mutex_);
  Loaded loaded = load(first, params);
  const std::vector<std::string> cannot = loaded.answer.cannot;
  waiting_.clear();
  if (cannot.empty()) waiting_.emplace(key_of(first, params), std::move(loaded));
  return cannot;
}

void Program::require_probed(const Params& params) {
  auto at = probed_.find(params.canonical());
  if (at == probed_.end()) {
    bool any = false;
    std::optional<SolverFailure> failure;
    for (const Check& check : quick_probe(command_, own_params(*hello_, params))) {
      any = any || check.verdict == Check::Verdict::passed;
      if (check.verdict == Check::Verdict::failed && !failure)
        failure.emplace(check.status, "not scored, " + check.name + ": " + check.said);
    }
    if (!any && !failure)
      failure.emplace("error", "not scored: it refuses every sheet of the probe");
    at = probed_.emplace(params.canonical(), std::move(failure)).first;
  }
  if (at->second) throw SolverFailure(*at->second);
}

std::unique_ptr<Solver> Program::make(const Scene& scene, const Params& params) {
  if (failure_) throw SolverFailure(*failure_);
  const std::lock_guard lock(mutex_);
  require_probed(params);
  auto waiting = waiting_.extract(key_of(scene, params));
  Loaded loaded = waiting ? std::move(waiting.mapped()) : load(scene, params);
  if (!loaded.answer.cannot.empty())
    throw SolverFailure("error", "changed its mind: " + loaded.answer.cannot.front());
  ResolvedSettings settings{{"program", hello_->name + " " + hello_->version}};
  settings.insert(settings.end(), loaded.answer.settings.begin(), loaded.answer.settings.end());
  settings_[key_of(scene, params)] = settings;
  return std::make_unique<ExternalSolver>(std::move(loaded.connection), scene.mesh.size(),
                                          loaded.answer.plan, hello_->unmeasurable);
}

ResolvedSettings Program::resolved_settings(const Scene& scene, const Params& params) {
  const std::lock_guard lock(mutex_);
  return settings_[key_of(stages(scene).front(), params)];
}

constexpr ParamSpec kLeading[] = {
    {.name = "cmd", .kind = ParamSpec::Kind::text, .help = "The program that is called"},
    ParamSpec::real("timeout", "s", "30", 0.01, 86400, "Every answer has to come within this time"),
    {.name = "folder",
     .kind = ParamSpec::Kind::text,
     .help = "Where the command runs; without it: where taut does"},
    {.name = "build",
     .kind = ParamSpec::Kind::text,
     .help = "Which state of its sources it is, in place of command, files and version"}};

/// Stands for all programs where none is named.
const SolverEntry kAny = {
    .name = "external",
    .summary = "Any program that speaks taut-solver/2 or /1: external:cmd='python3 mine.py'",
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

bool is_registered(const std::string& name) {
  std::error_code unreadable;  // the folder of another user: none
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
                       "' is no name of a solver: a letter, then letters, digits, _ and -, at most "
                       "40 characters");
    if (!file.is_regular_file(none))
      throw InputError(file.path().string() + ": is no regular file");
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
  const std::string command = '\n' + solver.command.text() + '\n' +
                              std::to_string(solver.command.seconds) + '\n' +
                              solver.command.folder.string() + '\n' + value_in(params, "build");
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

/// What a solver's text would start or open: a registered name, a command, or files. Empty:
/// nothing.
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

/// What the command line and studies have named so far.
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

/// A program or file that was not admitted: its parameters are texts, as they are stored.
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
                        "it is not started, for neither the command line nor a study names it"};
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

/// "mine:cmd='...'" and "mine:file=..." give a name to what they call.
const SolverEntry* find(std::string_view name, std::string_view params) {
  const std::string called(name);
  if (!is_solver_name(name)) return nullptr;
  const std::set<std::string> named = named_by(called, params);
  if (!admitted().has(named)) return unstarted(called, params);
  if (is_registered(called))
    return program(called, params, read_registered(file_of(called)), {kLeading[3]});
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
  std::string ours;  // the parameters that are not the program's
  std::string cmd;
  for (const ParamItem& item : param_items(std::string_view(text).substr(9)))
    if (item.key == "timeout")
      ours += "timeout=" + item.value;
    else if (item.key == "cmd") {
      if (!item.problem.empty()) throw InputError(item.problem);  // half a command is not called
      cmd = item.value;
    }
  Command command = split_command(cmd, value_in(std::string_view(text).substr(9), "folder"));
  try {
    command.seconds = Params("external", kLeading, ours).real("timeout");
  } catch (const InputError&) {  // whoever reads all parameters says so, with its column
  }
  return command;
}

void enable() { set_solver_source({.names = names, .find = find, .admit = admit}); }

}  // namespace taut::external
