// A solver that the rest of the program does not know, whose parameters have names of their own.
#include "core/model/solver.hpp"

#include "core/model/index.hpp"

namespace taut::solver::made_up {
namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::integer("slices", "1", 1, 1e6, "Parts of a step"),
    ParamSpec::integer("passes", "8", 0, 1e6, "Sweeps over all links in a part"),
    ParamSpec::choice("boost", "off", "on|off",
                      "An accelerator that others lack: twice the sweeps"),
};

class MadeUp final : public Solver {
 public:
  MadeUp(const Scene& scene, const Params& params)
      : scene_(scene),
        w_(inverse_masses(scene)),
        slices_(params.integer("slices")),
        passes_(params.integer("passes") * (params.is("boost", "on") ? 2 : 1)) {}

  void load(const State& state) override { state_ = state; }
  void step(double, double dt) override {
    const double h = dt / slices_;
    for (int slice = 0; slice < slices_; ++slice) {
      const std::vector<Vec3> before = state_.x;
      for (std::size_t i = 0; i < w_.size(); ++i)
        if (w_[i] > 0) state_.x[i] += h * (state_.v[i] += h * scene_.gravity);
      for (int k = 0; k < passes_; ++k)
        for (const Link& link : scene_.links) project(link);
      for (std::size_t i = 0; i < w_.size(); ++i) state_.v[i] = (state_.x[i] - before[i]) / h;
    }
  }
  void store(State& state) const override { state = state_; }
  std::vector<PassCost> step_cost() const override {
    return {{.pass = "links",
             .items = scene_.links.size(),
             .repeats = static_cast<std::size_t>(slices_ * passes_),
             .bytes = scene_.links.size() * sizeof(Link),
             .projections = true}};
  }

 private:
  void project(const Link& link) {
    const std::size_t a = to_index(link.a), b = to_index(link.b);
    const Vec3 between = state_.x[b] - state_.x[a];
    const double length = between.norm(), w = w_[a] + w_[b];
    if (w == 0 || length == 0) return;
    const Vec3 move = (length - link.rest) / (length * w) * between;
    state_.x[a] += w_[a] * move;
    state_.x[b] -= w_[b] * move;
  }
  Scene scene_;
  std::vector<double> w_;  // 1/kg, 0 for pins
  int slices_, passes_;
  State state_;
};

}  // namespace
}  // namespace taut::solver::made_up

TAUT_SOLVER(made_up) = {
    .name = "made-up",
    .summary = "Projected distances under other names",
    .source = "tests/added",
    .params = taut::solver::made_up::kParams,
    .make = [](const taut::Scene& scene,
               const taut::Params& params) -> std::unique_ptr<taut::Solver> {
      return std::make_unique<taut::solver::made_up::MadeUp>(scene, params);
    },
    .unsupported = [](const taut::Scene&,
                      const taut::Params&) { return std::vector<std::string>(); },
    .resolved_settings = [](const taut::Scene&, const taut::Params&) -> taut::ResolvedSettings {
      return {{"precision", "double"}};
    },
    .accuracy = {.substeps = "slices", .sweeps = "passes", .accelerators = {"boost"}}};
