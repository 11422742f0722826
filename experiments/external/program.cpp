#include "experiments/external/program.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/external/probe.hpp"
#include "experiments/system/json.hpp"

namespace taut::external {

namespace fs = std::filesystem;

namespace {

/// A scene in a process of its own. Each call of the solver is a request to it.
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
    return "it says " + general(1e6 * word, 4) + " us a step, its CPU clock " +
           general(1e6 * clock, 4) + " us";
  }

 private:
  /// Measures what an exchange without a step costs the program: the least of three means.
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
  mutable double empty_ = 0;  ///< CPU s of an exchange without a step
  /// CPU s measured for the steps since timing began. If the first state after them costs more than
  /// a second one, the difference counts too, since the program may postpone work until then.
  mutable double clock_ = 0;
  /// Steps were requested but no state since: their work may be postponed.
  mutable bool owed_ = false;
  double said_ = 0;  ///< CPU s of the steps that the program reports
  int steps_ = 0;
};

std::string key_of(const Scene& scene, const Params& params) {
  return digest(scene) + params.canonical();
}

/// Digest of everything visible here on which the program's results depend.
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

/// Digest for a build that the user named. It does not depend on where the program lies.
std::string digest_of(const Command& command, const std::string& build) {
  return sha256("build " + build + "\n" + join(command.words, "\n", [](const fs::path& word) {
                  return word.filename().string();
                }));
}

std::atomic<bool> g_probe_required = true;

}  // namespace

void set_probe_required(bool required) { g_probe_required = required; }

std::string value_in(std::string_view params, std::string_view key) {
  for (const ParamItem& item : param_items(params))
    if (item.key == key) return item.value;
  return {};
}

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
    for (const ParamItem& item : param_items(given))  // unknown parameters stay texts, as typed
      if (std::ranges::find(specs_, item.key, &ParamSpec::name) == specs_.end())
        specs_.push_back({.name = texts_.emplace_back(item.key), .kind = ParamSpec::Kind::text});
  entry_ = {.name = name_,
            .summary = hello_
                           ? std::string_view(hello_->summary)
                           : std::string_view(texts_.emplace_back("does not answer: " + silence())),
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
  if (!hello_) return {};                     // make() reports why
  const Scene first = stages(scene).front();  // a program gets the stages one by one
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
  if (!g_probe_required) return;
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
      failure.emplace(Status::Kind::error, "not scored: it refuses every sheet of the probe");
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
    throw SolverFailure(Status::Kind::error, "changed its mind: " + loaded.answer.cannot.front());
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

}  // namespace taut::external
