#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"

namespace taut {

namespace {

constexpr int kStepsPerSecond = 240;             ///< of the standard scene
constexpr double kStep = 1.0 / kStepsPerSecond;  ///< s
constexpr double kDensity = 0.2;  ///< kg/m^2, mass over area in experiments/scenes/swing.toml
constexpr double kPlate = 0.02;   ///< m, thickness of the rising plate

SceneSettings standard(const SceneSettings& more) {
  const std::string dt = "time.dt=\"1/" + std::to_string(kStepsPerSecond) + "\"";
  return replaced({"cloth.grid=[9, 9]", dt, "time.duration=2"}, more);
}

/// Builds the settings for one solver.
class FrontierSettings {
 public:
  explicit FrontierSettings(const std::string& solver) : choice_(parse_solver(solver)) {}

  std::vector<FrontierSetting> all() {
    linear(add("time step", "s", "dt", kStep, 1));
    add_sweeps();
    add_stiffness();
    linear(add("mass ratio", "", "cloth.weights.0.factor", 1, 1e9, Direction::up,
               {"cloth.weights=[{ vertices = [\"bottom\"], factor = 1 }]"}));
    add("resolution", "vertices a side", "cloth.grid.0|cloth.grid.1", 9, 97, Direction::up,
        {"time.duration=1"})
        .question.range.whole = true;
    add_speed();
    add("size, up", "m", "cloth.size.0|cloth.size.1", 1, 1e5);
    add("size, down", "m", "cloth.size.0|cloth.size.1", 1, 1e5, Direction::down);
    add_distance();
    linear(add("bending", "N m", "bending.stiffness", 1e-6, 1e4, Direction::up,
               {"bending={ stiffness = 1e-6 }"}));
    FrontierSetting& wind = add("wind", "N s/m^3", "wind.strength", 0.01, 1e5, Direction::up,
                                {"wind={ velocity = [0, 0, 5], strength = 0.01 }"});
    wind.theory = {Frontier::Kind::bracketed, 2 * kDensity / substep(), 0,
                   "explicit drag of a face: c h/sigma < 2"};
    return std::move(all_);
  }

 private:
  const ParamSpec* parameter(std::string_view name) const {
    const auto& specs = choice_.entry->params;
    const auto found = std::ranges::find(specs, name, &ParamSpec::name);
    return found == specs.end() ? nullptr : &*found;
  }

  /// Length of a substep [s].
  double substep() const { return kStep / choice_.substeps(); }

  FrontierSetting& add(const std::string& name, const std::string& unit, const std::string& of,
                       double from, double to, Direction direction = Direction::up,
                       const SceneSettings& more = {}) {
    FrontierSetting one{name, unit, {{"swing", standard(more), choice_.brief()}, of, {}}, "", {}};
    one.question.direction = direction;
    one.question.range = {.from = from, .to = to, .tolerance = kBracketWidth};
    all_.push_back(std::move(one));
    return all_.back();
  }

  void lacking(const std::string& name, const std::string& why) {
    all_.push_back({name, "", {}, why, {}});
  }

  static void linear(FrontierSetting& one) { one.theory = predicted_frontier(one.question); }

  /// Adds the number of sweeps. It matters on a finer sheet in long steps without substeps.
  void add_sweeps() {
    const std::string sweeps(choice_.entry->accuracy.sweeps);
    if (sweeps.empty()) return lacking("sweeps", "it has none");
    FrontierSetting& one = add("sweeps", "", sweeps, 1.0 / 64, 1, Direction::down_in_whole_numbers,
                               {"cloth.grid=[17, 17]", "time.dt=\"1/30\""});
    const std::string substeps(choice_.entry->accuracy.substeps);
    if (!substeps.empty()) one.question.base.solver = choice_.with(substeps, "1").brief();
  }

  void add_stiffness() {
    const std::string springs = join(choice_.entry->accuracy.stiffness.parameters, "|");
    if (!springs.empty()) return linear(add("stiffness", "N/m", springs, 50, 1e8));
    for (const char* share : {"stiffness", "omega"})
      if (const ParamSpec* spec = parameter(share)) {
        add("stiffness", share, share, 1, spec->max);
        return;
      }
    lacking("stiffness", "its links are rigid");
  }

  /// Adds the speed of a plate that rises towards a free, falling sheet.
  void add_speed() {
    FrontierSetting& one =
        add("speed of a collider", "m/s", "collider.0.velocity.1", 0.1, 1000, Direction::up,
            {"cloth.pins=[]", "cloth.tilt=0", "cloth.v=[0, 0, 1]", "cloth.origin=[-0.5, 0.2, -0.5]",
             "cloth.thickness=0.01",
             "collider=[{ type = \"box\", center = [0, 0, 0], half_extents = [0.8, " +
                 shortest(kPlate / 2) + ", 0.8], velocity = [0, 0.1, 0] }]"});
    if (parameter("contact") && choice_.params.is("contact", "discrete"))
      one.theory = {Frontier::Kind::bracketed, kPlate / substep(), 0,
                    "tests at step boundaries jump a plate beyond D/h"};
  }

  void add_distance() {
    FrontierSetting& one =
        add("distance from the origin", "m", "cloth.origin.0|cloth.origin.1|cloth.origin.2", 1, 1e5,
            Direction::up, {"cloth.origin=[1, 1, 1]"});
    const auto precision = parameter_with(ParamSpec::Role::precision, choice_.entry->params);
    if (precision.empty() || !choice_.params.is(precision, "float")) return;
    // The unit in the last place of a binary32 number x is 2^(floor(log2 x) - 23).
    const double g = -Scene().gravity.y();  // m/s^2, which the standard scene keeps
    const double unit = g * substep() * substep() / 4;
    one.theory = {Frontier::Kind::bracketed, std::exp2(std::floor(std::log2(unit)) + 1 + 23), 0,
                  "float: rounding changes g h^2 by more than an eighth"};
  }

  SolverChoice choice_;
  std::vector<FrontierSetting> all_;
};

}  // namespace

std::vector<FrontierSetting> frontier_settings(const std::string& solver) {
  return FrontierSettings(solver).all();
}

}  // namespace taut
