// Macklin, Mueller, Chentanez, XPBD: Position-Based Simulation of Compliant Constrained Dynamics
// (MIG 2016), with the substeps of Macklin et al., Small Steps in Physics Simulation (SCA 2019).
//
// Algorithm 1 with C = |x2 - x1| - rest and n = delta/|delta| (equations 17 and 18):
//
//     dlambda = (-C - alpha/h^2 lambda) / (w1 + w2 + alpha/h^2),   lambda = 0 at every substep
//     x1 -= w1 dlambda n;   x2 += w2 dlambda n;   lambda += dlambda
//
// alpha [m/N] is the inverse of a spring constant. With alpha = 0 this is Jakobsen's exact
// projection, and the prediction x + v h + a h^2, v = (x - x')/h is his Verlet step.
#include <cmath>
#include <string>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/solver/wind.hpp"

namespace taut::solver::xpbd {

namespace {

constexpr ParamSpec kParams[] = {
    ParamSpec::integer("substeps", "8", 1, 1e6, "each step is this many steps of dt / substeps"),
    ParamSpec::integer("iterations", "1", 0, 1e6,
                       "sweeps per substep; Small Steps finds that one is best"),
    ParamSpec::real("structural", "m/N", "0", 0, 1e12, "compliance of structural links"),
    ParamSpec::real("shear", "m/N", "0", 0, 1e12, "compliance of shear links"),
    ParamSpec::real("bend", "m/N", "0", 0, 1e12, "compliance of bend links"),
    ParamSpec::choice("precision", "float", "float|double", "scalar type of the simulation"),
};

template <class Real>
class Xpbd final : public Solver {
 public:
  using V = Vec3Of<Real>;

  Xpbd(const Scene& scene, const Params& params)
      : scene_(scene),
        substeps_(params.integer("substeps")),
        iterations_(params.integer("iterations")) {
    for (const double wi : inverse_masses(scene)) w_.push_back(static_cast<Real>(wi));
    for (const Family family : kFamilies)
      for (const Link& l : scene.links)
        if (l.family == family && (w_[to_index(l.a)] > 0 || w_[to_index(l.b)] > 0))
          constraints_.push_back({to_index(l.a), to_index(l.b), static_cast<Real>(l.rest),
                                  params.real(to_string(family)), Real(0)});
  }

  void load(const State& state) override {
    const std::size_t n = state.x.size();
    x_.resize(n), previous_.resize(n), v_.resize(n), a_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      x_[i] = state.x[i].template cast<Real>();
      const double h = scene_.dt / substeps_;
      previous_[i] = (state.x[i] - h * state.v[i]).template cast<Real>();
    }
  }

  void step(double t, double dt) override {
    const double h = dt / substeps_;
    for (int s = 0; s < substeps_; ++s) {
      predict(t + (s + 1) * h, h);
      for (DistanceConstraint& c : constraints_) c.lambda = 0;
      for (int k = 0; k < iterations_; ++k) {
        for (DistanceConstraint& c : constraints_) solve(c, h);
        for (const Collider& collider : scene_.colliders) collide(collider, t + (s + 1) * h);
      }
      if (s + 1 < substeps_) substep_ended(t + (s + 1) * h);
    }
  }

  void store(State& state) const override {
    const double h = scene_.dt / substeps_;
    state.x.resize(x_.size()), state.v.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      state.x[i] = x_[i].template cast<double>();
      state.v[i] = (x_[i] - previous_[i]).template cast<double>() / h;
    }
  }

  std::vector<PassCost> step_cost() const override {
    const auto substeps = static_cast<std::size_t>(substeps_);
    const std::size_t sweeps = substeps * static_cast<std::size_t>(iterations_);
    std::vector<PassCost> costs;
    if (scene_.wind)
      costs.push_back({.pass = "wind", .items = scene_.mesh.triangles.size(), .repeats = substeps});
    costs.push_back({.pass = "predict",
                     .items = w_.size(),
                     .repeats = substeps,
                     .bytes = w_.size() * (4 * sizeof(V) + sizeof(Real))});
    if (!constraints_.empty())
      costs.push_back({.pass = "links",
                       .items = constraints_.size(),
                       .repeats = sweeps,
                       .bytes = constraints_.size() * sizeof(DistanceConstraint),
                       .projections = true});
    for (const Collider& collider : scene_.colliders)
      costs.push_back({.pass = "collide " + std::string(type_name(collider.shape)),
                       .items = w_.size(),
                       .repeats = sweeps});
    return costs;
  }

 private:
  struct DistanceConstraint {
    std::size_t a, b;
    Real rest;
    double compliance;  ///< m/N
    Real lambda;        ///< N s^2, of this substep
  };
  void predict(double end, double h) {
    const V g = scene_.gravity.template cast<Real>();
    a_.assign(x_.size(), g);
    if (scene_.wind) {
      for (std::size_t i = 0; i < x_.size(); ++i)
        v_[i] = (x_[i] - previous_[i]) / static_cast<Real>(h);
      add_wind<Real>(scene_, x_, v_, w_, a_);
    }
    const Real keep = static_cast<Real>(std::exp(-scene_.damping * h)),
               h2 = static_cast<Real>(h * h);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const V now = x_[i];
      if (w_[i] != 0) x_[i] += keep * (now - previous_[i]) + h2 * a_[i];
      previous_[i] = now;
    }
    if (scene_.pin_motions.empty()) return;
    for (const int pin : scene_.pins)
      x_[to_index(pin)] = pin_position(scene_, pin, end).template cast<Real>();
  }

  void solve(DistanceConstraint& c, double h) {
    const V delta = x_[c.b] - x_[c.a];
    const Real length = delta.norm();
    if (length == 0) return;  // no direction to push in
    const Real soft = static_cast<Real>(c.compliance / (h * h));
    const Real w1 = w_[c.a], w2 = w_[c.b];
    const Real change = (c.rest - length - soft * c.lambda) / (w1 + w2 + soft);
    c.lambda += change;
    const V push = change / length * delta;
    x_[c.a] -= w1 * push;
    x_[c.b] += w2 * push;
  }

  void collide(const Collider& collider, double end) {
    const Shape shape = shape_at(collider, end);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (w_[i] == 0) continue;
      const Surface s = surface(shape, x_[i].template cast<double>());
      if (s.distance < scene_.thickness)
        x_[i] += ((scene_.thickness - s.distance) * s.normal).template cast<Real>();
    }
  }

  Scene scene_;
  int substeps_, iterations_;
  std::vector<Real> w_;
  std::vector<DistanceConstraint> constraints_;
  std::vector<V> x_, previous_, v_, a_;
};

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  if (params.is("precision", "float")) return std::make_unique<Xpbd<float>>(scene, params);
  return std::make_unique<Xpbd<double>>(scene, params);
}

std::vector<std::string> unsupported(const Scene& scene, const Params&) {
  std::vector<std::string> reasons;
  if (scene.self_collision) reasons.emplace_back("self-collision is not modelled");
  for (const Collider& collider : scene.colliders)
    if (collider.friction > 0) {
      reasons.emplace_back("friction is not modelled");
      break;
    }
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  ResolvedSettings lines{{"precision", std::string(params.choice("precision"))},
                         {"link order", "the scene's, mesh order"}};
  if (!scene.colliders.empty()) lines.emplace_back("order of passes", "links, then contacts");
  return lines;
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"precision", "float|double"}};

LinearModel linear_model(const Scene&, const Params& params) {
  for (const Family family : kFamilies)
    if (params.value(to_string(family)) != "0") return {};
  return LinearSweeps{.sweeps = params.integer("iterations"),
                      .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::xpbd

TAUT_SOLVER(xpbd) = {.name = "xpbd",
                     .title = "XPBD",
                     .summary = "Compliant position-based dynamics with substeps",
                     .source = "Macklin, Mueller, Chentanez 2016; Macklin et al. 2019",
                     .params = taut::solver::xpbd::kParams,
                     .make = taut::solver::xpbd::make,
                     .unsupported = taut::solver::xpbd::unsupported,
                     .resolved_settings = taut::solver::xpbd::resolved_settings,
                     .accuracy = {.substeps = "substeps",
                                  .sweeps = "iterations",
                                  .alternatives = taut::solver::xpbd::kAlternatives,
                                  .labelled = "substeps|iterations|precision"},
                     .linear_model = taut::solver::xpbd::linear_model};
