// own_solver SCENE.toml [gravity=FACTOR]: runs a custom solver (particles without links) in the
// harness, with every metric, the verdict on the run, values over time and the record, as for the
// solvers of taut.
#include <cstdio>
#include <taut/case/record_io.hpp>
#include <taut/case/run_case.hpp>
#include <taut/io/scene_io.hpp>
#include <taut/model/input_error.hpp>

namespace {

constexpr taut::ParamSpec kParams[] = {
    taut::ParamSpec::real("gravity", "", "1", 0, 10, "Factor of the scene's gravity")};

class Fall final : public taut::Solver {
 public:
  Fall(const taut::Scene& scene, const taut::Params& params)
      : w_(taut::inverse_masses(scene)), g_(params.real("gravity") * scene.gravity) {}
  void load(const taut::State& state) override { state_ = state; }
  void step(double, double dt) override {
    for (std::size_t i = 0; i < w_.size(); ++i) {
      if (w_[i] == 0) continue;  // a pin
      state_.v[i] += dt * g_;
      state_.x[i] += dt * state_.v[i];
    }
  }
  void store(taut::State& state) const override { state = state_; }
  std::vector<taut::PassCost> step_cost() const override {
    return {{.pass = "fall", .items = w_.size(), .bytes = 7 * w_.size() * sizeof(double)}};
  }

 private:
  std::vector<double> w_;  // 1/kg
  taut::Vec3 g_;           // m/s^2
  taut::State state_;
};

const taut::SolverEntry kFall = {
    .name = "fall",
    .summary = "Particles that fall, each alone",
    .source = "Galilei 1638",
    .params = kParams,
    .make = [](const taut::Scene& scene, const taut::Params& params)
        -> std::unique_ptr<taut::Solver> { return std::make_unique<Fall>(scene, params); },
    .unsupported = [](const taut::Scene& scene, const taut::Params&) -> std::vector<std::string> {
      if (!scene.colliders.empty()) return {"it falls through everything"};
      return {};
    },
    .resolved_settings = [](const taut::Scene&, const taut::Params&) -> taut::ResolvedSettings {
      return {{"precision", "double"}};
    }};

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) throw taut::InputError("usage: own_solver SCENE.toml [gravity=FACTOR]");
  const taut::Scene scene = taut::load_scene(argv[1]);
  const taut::Params params(kFall.name, kFall.params, argc > 2 ? argv[2] : "");
  const taut::CaseRun run = taut::run_case(scene, {&kFall, params}, {.series_rows = 10});
  std::printf("%s\n", taut::to_json(run.record, 1).c_str());
} catch (const taut::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
