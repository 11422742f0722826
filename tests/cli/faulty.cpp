// Solvers that misbehave, for the tests of the harness: in the program taut-faulty alone.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <stdexcept>

#include "core/model/solver.hpp"

namespace taut {

namespace {

constexpr ParamSpec kParams[] = {
    {.name = "mode",
     .kind = ParamSpec::Kind::choice,
     .default_value = "sound",
     .choices = "sound|crash|abort|hang|spin|memory|nan|throw|exit|print|slow|refuse|random",
     .help = "what it does at that step"},
    {.name = "at",
     .kind = ParamSpec::Kind::integer,
     .default_value = "5",
     .min = 1,
     .max = 1e6,
     .help = "step at which it does it"},
    {.name = "variant",
     .kind = ParamSpec::Kind::integer,
     .default_value = "0",
     .min = 0,
     .max = 1e6,
     .help = "makes cases differ"},
};

/// Free fall, until it misbehaves.
class Faulty final : public Solver {
 public:
  Faulty(const Scene& scene, const Params& params)
      : gravity_(scene.gravity), mode_(params.choice("mode")), at_(params.integer("at")) {}
  void load(const State& state) override { state_ = state; }
  void store(State& state) const override { state = state_; }
  std::vector<PassCost> step_cost() const override { return {}; }

  void step(double, double dt) override {
    if (++step_ == at_) misbehave();
    if (mode_ == "slow") usleep(10'000);
    for (std::size_t i = 0; i < state_.x.size(); ++i) {
      state_.v[i] += gravity_ * dt;
      state_.x[i] += state_.v[i] * dt;
    }
  }

 private:
  void misbehave() {
    if (mode_ == "crash") std::raise(SIGSEGV);
    if (mode_ == "abort") std::abort();
    if (mode_ == "nan") state_.x[2].y() = std::numeric_limits<double>::quiet_NaN();
    if (mode_ == "throw") throw std::runtime_error("faulty: threw as told");
    if (mode_ == "exit") std::_Exit(3);
    if (mode_ == "random") state_.x[0].x() += 1e-3 * static_cast<double>(getpid() % 1000);
    while (mode_ == "hang") usleep(1000);
    for (volatile int spun = 0; mode_ == "spin";) spun = spun + 1;
    while (mode_ == "print") std::cerr << std::string(1 << 20, 'x');
    while (mode_ == "memory") hoard_.emplace_back(std::size_t{1} << 20, 'x');
  }

  Vec3 gravity_;
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
