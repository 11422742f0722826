// Springs and dampers before any constraint, F = -k x - c v, integrated explicitly: Vasilovici,
// Cloth Simulation Report, section 3.
//
//     explicit-euler     x' = x + v dt;   v' = v + a(x, v) dt              as printed there
//     symplectic-euler   v' = v + a dt;   x' = x + v' dt
//     verlet             x* = 2x - x' + a dt^2                             v = (x - x')/dt
//
// Stable without drag while dt < 2/w, w^2 the largest eigenvalue of K/M (symplectic Euler and
// Verlet; explicit Euler never is). Drag taken at the lagged velocity shrinks that limit to
// (2/w)(sqrt(1 + zeta^2) - zeta); Verlet's `drag-at=central` restores it.
#include <cmath>
#include <string>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/solver/wind.hpp"

namespace taut::solver::mass_spring {

namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::choice("integrator", "verlet", "explicit-euler|symplectic-euler|verlet",
                      "how the particles move"),
    ParamSpec::real("structural", "N/m", "50", 0, 1e12,
                    "spring constant of structural links; 0: no spring"),
    ParamSpec::real("shear", "N/m", "50", 0, 1e12, "spring constant of shear links; 0: no spring"),
    ParamSpec::real("bend", "N/m", "5", 0, 1e12, "spring constant of bend links; 0: no spring"),
    ParamSpec::real("drag", "N s/m", "0", 0, 1e9,
                    "c of F = -c v on every particle, beside the scene's own damping"),
    ParamSpec::choice(
        "drag-at", "lagged", "lagged|central",
        "velocity that drag sees: (x_n - x_n-1)/dt, or, verlet only, (x_n+1 - x_n-1)/2dt"),
    ParamSpec::integer("substeps", "32", 1, 1e6, "each step is this many steps of dt / substeps"),
    ParamSpec::choice("precision", "float", "float|double", "scalar type of the simulation"),
};

struct Springs {
  Family family;
  double stiffness;  ///< N/m
  std::vector<Link> links;
};

double stiffness(const Params& params, Family family) { return params.real(to_string(family)); }

template <class Real>
class MassSpring final : public Solver {
 public:
  using V = Vec3Of<Real>;

  MassSpring(const Scene& scene, const Params& params)
      : scene_(scene),
        substeps_(params.integer("substeps")),
        drag_(params.real("drag")),
        central_(params.is("drag-at", "central")),
        integrate_(params.is("integrator", "explicit-euler")     ? &MassSpring::explicit_euler
                   : params.is("integrator", "symplectic-euler") ? &MassSpring::symplectic_euler
                                                                 : &MassSpring::verlet) {
    const std::vector<double> w = inverse_masses(scene);
    for (const double wi : w) w_.push_back(static_cast<Real>(wi));
    for (const Family family : kFamilies) {
      Springs springs{family, stiffness(params, family), {}};
      if (springs.stiffness == 0) continue;
      for (const Link& l : scene.links)
        if (l.family == family && (w_[to_index(l.a)] > 0 || w_[to_index(l.b)] > 0))
          springs.links.push_back(l);
      if (!springs.links.empty()) springs_.push_back(std::move(springs));
    }
  }

  void load(const State& state) override {
    const std::size_t n = state.x.size();
    x_.resize(n), v_.resize(n), a_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      x_[i] = state.x[i].template cast<Real>();
      v_[i] = state.v[i].template cast<Real>();
    }
  }

  void step(double t, double dt) override {
    const double h = dt / substeps_;
    for (int s = 0; s < substeps_; ++s) {
      accumulate_forces();
      const Real keep = static_cast<Real>(std::exp(-scene_.damping * h));
      for (std::size_t i = 0; i < x_.size(); ++i)
        if (w_[i] != 0)
          (this->*integrate_)(i, static_cast<Real>(h), keep);
        else
          v_[i].setZero();
      move_pins(t + (s + 1) * h, h);
      if (s + 1 < substeps_) substep_ended(t + (s + 1) * h);
    }
  }

  void store(State& state) const override {
    state.x.resize(x_.size()), state.v.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      state.x[i] = x_[i].template cast<double>();
      state.v[i] = v_[i].template cast<double>();
    }
  }

  std::vector<PassCost> step_cost() const override {
    const auto repeats = static_cast<std::size_t>(substeps_);
    std::vector<PassCost> costs;
    if (scene_.wind)
      costs.push_back({.pass = "wind", .items = scene_.mesh.triangles.size(), .repeats = repeats});
    for (const Springs& s : springs_)
      costs.push_back({.pass = std::string(to_string(s.family)) + " springs",
                       .items = s.links.size(),
                       .repeats = repeats,
                       .bytes = s.links.size() * sizeof(Link)});
    costs.push_back({.pass = "integrate",
                     .items = x_.size(),
                     .repeats = repeats,
                     .bytes = x_.size() * (3 * sizeof(V) + sizeof(Real))});
    return costs;
  }

 private:
  /// G = m g, the wind, F = -k x of every spring, F = -c v of every particle; a = F/m.
  void accumulate_forces() {
    const V g = scene_.gravity.template cast<Real>();
    const Real c = static_cast<Real>(central_ ? 0 : drag_);
    for (std::size_t i = 0; i < x_.size(); ++i) a_[i] = g - w_[i] * c * v_[i];
    add_wind<Real>(scene_, x_, v_, w_, a_);
    for (const Springs& springs : springs_) {
      const Real k = static_cast<Real>(springs.stiffness);
      for (const Link& l : springs.links) {
        const V delta = x_[to_index(l.b)] - x_[to_index(l.a)];
        const Real length = delta.norm();
        if (length == 0) continue;  // no direction to pull in
        const V pull = k * (length - static_cast<Real>(l.rest)) / length * delta;
        a_[to_index(l.a)] += w_[to_index(l.a)] * pull;
        a_[to_index(l.b)] -= w_[to_index(l.b)] * pull;
      }
    }
  }

  void explicit_euler(std::size_t i, Real dt, Real keep) {
    x_[i] += v_[i] * dt;
    v_[i] = keep * v_[i] + a_[i] * dt;
  }
  void symplectic_euler(std::size_t i, Real dt, Real keep) {
    v_[i] = keep * v_[i] + a_[i] * dt;
    x_[i] += v_[i] * dt;
  }
  /// x* = 2x - x' + a dt^2 with v = (x - x')/dt kept instead of x', so that no digits are lost.
  void verlet(std::size_t i, Real dt, Real keep) {
    const Real half = central_ ? static_cast<Real>(drag_) * w_[i] * dt / 2 : Real(0);
    v_[i] = ((1 - half) * keep * v_[i] + a_[i] * dt) / (1 + half);
    x_[i] += v_[i] * dt;
  }

  void move_pins(double t, double dt) {
    if (scene_.pin_motions.empty()) return;
    for (const int pin : scene_.pins) {
      const V place = pin_position(scene_, pin, t).template cast<Real>();
      v_[to_index(pin)] = (place - x_[to_index(pin)]) / static_cast<Real>(dt);
      x_[to_index(pin)] = place;
    }
  }

  Scene scene_;
  int substeps_;
  double drag_;
  bool central_;
  void (MassSpring::*integrate_)(std::size_t, Real, Real);
  std::vector<Springs> springs_;
  std::vector<Real> w_;
  std::vector<V> x_, v_, a_;
};

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  if (params.is("precision", "float")) return std::make_unique<MassSpring<float>>(scene, params);
  return std::make_unique<MassSpring<double>>(scene, params);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons;
  if (!scene.colliders.empty()) reasons.emplace_back("springs alone do not model contact");
  if (scene.self_collision) reasons.emplace_back("self-collision is not modelled");
  if (params.is("drag-at", "central") && !params.is("integrator", "verlet"))
    reasons.emplace_back("drag-at=central needs integrator=verlet");
  return reasons;
}

ResolvedSettings resolved_settings(const Scene&, const Params& params) {
  const std::string springs = join(kFamilies, ", ", [&](Family family) {
    const std::string name(to_string(family));
    return name + " " + std::string(params.value(name)) + " N/m";
  });
  return {{"precision", std::string(params.choice("precision"))},
          {"links", "Hooke springs: " + springs},
          {"work unit", "spring evaluations, not projections"}};
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"precision", "float|double"}};

LinearModel linear_model(const Scene&, const Params& params) {
  return LinearSprings{
      .stiffness = {params.real("structural"), params.real("shear"), params.real("bend")},
      .drag = params.real("drag"),
      .central_drag = params.is("drag-at", "central"),
      .explicit_euler = params.is("integrator", "explicit-euler"),
      .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::mass_spring

TAUT_SOLVER(mass_spring) = {
    .name = "mass-spring",
    .summary = "Hooke springs with drag, integrated explicitly",
    .source = "Vasilovici, Cloth Simulation Report, section 3; Provot 1995; Lander 1999",
    .params = taut::solver::mass_spring::kParams,
    .make = taut::solver::mass_spring::make,
    .unsupported = taut::solver::mass_spring::unsupported,
    .resolved_settings = taut::solver::mass_spring::resolved_settings,
    .accuracy = {.substeps = "substeps",
                 .stiffness = {"structural|shear", "50|200|800|3200|12800|51200"},
                 .alternatives = taut::solver::mass_spring::kAlternatives,
                 .labelled = "substeps|precision"},
    .linear_model = taut::solver::mass_spring::linear_model};
