#include <string>

#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// What the solver says of its own iterations: the only number here that positions do not tell.
class Convergence final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {"steps.unconverged", kErrorCount,
       "steps that ended before the solver's own criterion of convergence held. No value for a "
       "solver whose number of iterations is fixed",
       false, Window::run, "steps that did not converge"},
  };
  explicit Convergence(const Scene&) {}
  void observe(const Snapshot&) override {}
  void unconverged(int steps) override { steps_ = steps; }
  std::vector<double> finish() override { return {steps_}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  double steps_ = Summary::kNone;
};

}  // namespace

TAUT_METRIC(convergence, Convergence, "Steps whose iterations did not converge",
            "number of steps in which the solver's criterion did not hold");

}  // namespace taut
