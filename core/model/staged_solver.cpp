#include <optional>
#include <utility>

#include "core/model/move_out.hpp"
#include "core/model/solver.hpp"

namespace taut {

namespace {

/// A solver for each stage of a scene, one after another. All are made at the start, so that their
/// preparation is not timed.
class StagedSolver final : public Solver {
 public:
  using Make = std::function<std::unique_ptr<Solver>(const Scene&, const Params&)>;

  StagedSolver(const Scene& scene, const Params& params, const Make& make)
      : dt_(scene.dt), releases_(scene.releases), scenes_(stages(scene)) {
    for (const Scene& stage : scenes_) {
      Solver& solver = *solvers_.emplace_back(make(stage, params));
      solver.visit_substeps([this](double t) { substep_ended(t); });
    }
  }

  void load(const State& state) override {
    turn_to(0);
    now().load(state);
  }
  void step(double t, double dt) override {
    while (at_ < releases_.size() && t > (releases_[at_].step - 0.5) * dt_) {
      const Solver& before = now();
      turn_to(at_ + 1);
      now().go_on(before);
      let_go(releases_[at_ - 1].vertices, t);
    }
    now().step(t, dt);
  }
  void store(State& state) const override { now().store(state); }
  std::vector<PassCost> step_cost() const override { return now().step_cost(); }

  double cpu_seconds() const override {
    timed_ = true;
    return earlier_ + now().cpu_seconds();
  }
  std::size_t peak_bytes() const override { return now().peak_bytes(); }
  std::string time_remark() const override { return now().time_remark(); }
  std::string log() const override { return now().log(); }
  std::optional<int> unconverged_steps() const override { return now().unconverged_steps(); }

 private:
  /// Takes what a collider held inside out of it, before a step turns its depth into velocity.
  void let_go(const std::vector<int>& vertices, double t) {
    if (scenes_[at_].colliders.empty()) return;
    State state;
    now().store(state);
    const std::vector<Vec3> ways = ways_out(scenes_[at_], t, state.x, vertices);
    if (!ways.empty()) now().displace(ways);
  }
  Solver& now() const { return *solvers_[at_]; }
  /// Turns to another stage. A solver in a process of its own has its own clock.
  void turn_to(std::size_t stage) {
    const double spent = timed_ ? cpu_seconds() : 0;
    at_ = stage;
    if (timed_) earlier_ = spent - now().cpu_seconds();
  }

  double dt_;  ///< s, length of a step
  std::vector<Release> releases_;
  std::vector<Scene> scenes_;  ///< solvers may refer to these
  std::vector<std::unique_ptr<Solver>> solvers_;
  std::size_t at_ = 0;
  mutable bool timed_ = false;  ///< cpu_seconds() was called
  double earlier_ = 0;          ///< s, of earlier stages
};

/// Eigen divides large products by the sizes of the machine's caches, and the division decides the
/// order of their sums. These sizes everywhere give the same bits on every machine.
void fix_blocks_of_products() {
  static const bool fixed = [] {
    Eigen::setCpuCacheSizes(48 << 10, 1280 << 10, 48 << 20);
    return true;
  }();
  (void)fixed;
}

}  // namespace

std::unique_ptr<Solver> MakeSolver::operator()(const Scene& scene, const Params& params) const {
  fix_blocks_of_products();
  if (whole_ || scene.releases.empty()) return bare_(scene, params);
  return std::make_unique<StagedSolver>(scene, params, bare_);
}

}  // namespace taut
