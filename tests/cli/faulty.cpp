// Solvers that misbehave, for the tests of the harness; only the program taut-faulty contains them.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/model/solver.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::choice(
        "mode", "stable",
        "stable|crash|abort|hang|spin|memory|nan|throw|exit|print|slow|refuse|random|"
        "exit74|exit127|chdir|fork|daemon|stop|stretch|fewer|far|forge|words|restless|held",
        "what it does at that step"),
    ParamSpec::integer("at", "5", 1, 1e6, "step at which it does it"),
    ParamSpec::integer("variant", "0", 0, 1e6, "makes cases differ"),
};

/// Its free vertices go down at a constant speed until it misbehaves, at one of them.
class Faulty final : public Solver {
 public:
  Faulty(const Scene& scene, const Params& params)
      : free_(inverse_masses(scene)),
        velocity_(0.01 * scene.gravity),
        mode_(params.choice("mode")),
        at_(params.integer("at")) {}
  void load(const State& state) override { state_ = state; }
  void store(State& state) const override {
    state = state_;
    if (mode_ == "fewer" && step_ >= at_) state.x.resize(2);
  }
  std::vector<PassCost> step_cost() const override {  // a solver with sweeps would have to settle
    if (mode_ != "restless") return {};
    return {{.pass = "links", .items = 1, .repeats = 1000, .projections = true}};
  }

  void step(double, double dt) override {
    if (++step_ == at_) misbehave();
    if (mode_ == "slow") usleep(10'000);
    while (mode_ == "held" && access("go-on", F_OK) != 0) usleep(1000);
    for (std::size_t i = 0; i < state_.x.size(); ++i) {
      if (free_[i] == 0) continue;
      state_.v[i] = velocity_;
      state_.x[i] += velocity_ * dt;
    }
  }

 private:
  void misbehave() {
    if (mode_ == "crash") std::raise(SIGSEGV);
    if (mode_ == "abort") std::abort();
    if (mode_ == "nan") state_.x[2].y() = std::numeric_limits<double>::quiet_NaN();
    if (mode_ == "words")
      throw std::runtime_error("<img src=x onerror=alert(1)>\x1b]0;title\x07`touch canary` \u202e" +
                               std::string(10'000, 'w'));
    if (mode_ == "throw") throw std::runtime_error("faulty: threw as told");
    if (mode_.starts_with("exit")) std::_Exit(mode_ == "exit" ? 3 : std::stoi(mode_.substr(4)));
    if (mode_ == "far") state_.x[3].y() = 9e5;
    if (mode_ == "chdir" && chdir("/") != 0) std::abort();
    if (mode_ == "stop") std::raise(SIGSTOP);
    if (mode_ == "stretch") state_.x[3].y() = 50;
    if (mode_ == "fork" || mode_ == "daemon") leave_behind();
    if (mode_ == "forge") forge();
    if (mode_ == "random") state_.x[1].x() += 1e-9 * (1.0 + std::random_device()() % 1'000'000);
    while (mode_ == "hang") usleep(1000);
    for (volatile int spun = 0; mode_ == "spin";) spun = spun + 1;
    while (mode_ == "print") std::cerr << std::string(1 << 20, 'x');
    while (mode_ == "memory") hoard_.emplace_back(std::size_t{1} << 20, 'x');
  }

  /// Starts a process that does not end, in the process group of this one or in its own session.
  void leave_behind() const {
    const pid_t child = fork();
    if (child == 0) {
      if (mode_ == "daemon") setsid();
      for (;;) pause();
    }
    while (mode_ == "daemon" && getsid(child) != child) usleep(100);
    std::ofstream("left-by-" + mode_) << child;
  }

  /// Writes a complete record in place of the case's own, with an address that leads out of the
  /// store.
  [[noreturn]] static void forge() {
    std::ifstream in("/proc/self/cmdline", std::ios::binary);
    std::string word, before;
    while (std::getline(in, word, '\0') && before != "--into") before = word;
    Record record;
    record.key = "../../../escaped";
    record.dt = 1;
    write_file(std::filesystem::path(word) / "case.json", to_json(record));
    std::_Exit(0);
  }

  std::vector<double> free_;  ///< 0: a pin
  Vec3 velocity_;             ///< m/s
  std::string mode_;
  int at_, step_ = 0;
  State state_;
  std::vector<std::string> hoard_;
};

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return std::make_unique<Faulty>(scene, params);
}

std::vector<std::string> unsupported(const Scene&, const Params& params) {
  if (params.is("mode", "refuse")) return {"refuses, as told"};
  return {};
}

ResolvedSettings resolved_settings(const Scene&, const Params&) { return {}; }

}  // namespace
}  // namespace taut

TAUT_SOLVER(faulty) = {.name = "faulty",
                       .summary = "Misbehaves as told",
                       .source = "tests/cli",
                       .params = taut::kParams,
                       .make = taut::make,
                       .unsupported = taut::unsupported,
                       .resolved_settings = taut::resolved_settings};
