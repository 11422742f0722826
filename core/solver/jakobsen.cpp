#include <cmath>

#include "core/model/solver.hpp"
#include "core/solver/passes/collide.hpp"
#include "core/solver/passes/links.hpp"
#include "core/solver/passes/wind.hpp"

namespace taut {

namespace {

using Kind = ParamSpec::Kind;
constexpr ParamSpec kParams[] = {
    {.name = "iterations",
     .kind = Kind::integer,
     .default_value = "3",
     .min = 0,
     .max = 1e6,
     .help = "relaxation sweeps per substep; the report finds that 3 suffice"},
    {.name = "substeps",
     .kind = Kind::integer,
     .default_value = "1",
     .min = 1,
     .max = 1e6,
     .help = "each step is this many steps of dt / substeps"},
    {.name = "projection",
     .kind = Kind::choice,
     .default_value = "sqrt-free",
     .choices = "exact|sqrt-free",
     .help = "exact distance, or its first-order Taylor form without a square root"},
    {.name = "precision",
     .kind = Kind::choice,
     .default_value = "float",
     .choices = "float|double",
     .help = "scalar type of the simulation"},
};

/// Thomas Jakobsen, Advanced Character Physics (GDC 2001).
template <class Real>
class Jakobsen final : public Solver {
 public:
  Jakobsen(const Scene& scene, const Params& params)
      : scene_(scene),
        iterations_(params.integer("iterations")),
        substeps_(params.integer("substeps")) {
    if (scene.wind)
      forces_.push_back(std::make_unique<WindPass<Real>>(*scene.wind, scene.mesh.triangles));
    if (params.is("projection", "exact"))
      add_links<Projection::exact>();
    else
      add_links<Projection::sqrt_free>();
    for (const Collider& collider : scene.colliders)
      constraints_.push_back(
          std::make_unique<CollidePass<Real>>(collider, scene.thickness, scene.start.x.size()));
  }

  void load(const State& state) override {
    const std::vector<double> w = inverse_masses(scene_);
    const std::size_t n = w.size();
    p_.x.resize(n), p_.previous.resize(n), p_.a.resize(n);
    const double h = scene_.dt / substeps_;
    for (std::size_t i = 0; i < n; ++i) {
      p_.x[i] = vec4(state.x[i], w[i]);
      p_.previous[i] = vec4(state.x[i] - h * state.v[i], 0);
    }
  }

  void step(double t, double dt) override {
    const double h = dt / substeps_;
    for (int s = 0; s < substeps_; ++s) substep(t + s * h, h);
  }

  void store(State& state) const override {
    const double h = scene_.dt / substeps_;
    state.x.resize(p_.size()), state.v.resize(p_.size());
    for (std::size_t i = 0; i < p_.size(); ++i) {
      const auto &x = p_.x[i], &q = p_.previous[i];
      state.x[i] = {x.x, x.y, x.z};
      state.v[i] = Vec3(x.x - q.x, x.y - q.y, x.z - q.z) / h;
    }
  }

  std::vector<PassCost> plan() const override {
    const auto n = scene_.start.x.size();
    std::vector<PassCost> costs;
    const auto add = [&](PassCost cost, int repeats) {
      cost.repeats = static_cast<std::size_t>(repeats);
      costs.push_back(std::move(cost));
    };
    for (const auto& force : forces_) add(force->cost(), substeps_);
    add({.pass = "verlet", .items = n, .bytes = 3 * n * sizeof(Vec4<Real>)}, substeps_);
    for (const auto& constraint : constraints_) add(constraint->cost(), substeps_ * iterations_);
    return costs;
  }

 private:
  /// The published TimeStep().
  void substep(double t, double dt) {
    accumulate_gravity();
    for (auto& force : forces_) force->apply(p_, t, dt);
    verlet(t, dt);
    for (int k = 0; k < iterations_; ++k)
      for (auto& constraint : constraints_) constraint->apply(p_, t, dt);
  }

  void accumulate_gravity() {
    const Vec4<Real> g = vec4(scene_.gravity, 0);
    for (auto& a : p_.a) a = g;
  }

  /// x* = 2 x - x' + a dt^2, with the velocity x - x' damped; pins follow the scene.
  void verlet(double t, double dt) {
    const Real keep = static_cast<Real>(std::exp(-scene_.damping * dt)),
               dt2 = static_cast<Real>(dt * dt);
    for (std::size_t i = 0; i < p_.size(); ++i) {
      auto &x = p_.x[i], &q = p_.previous[i];
      const auto now = x;
      if (x.w != 0) {
        x.x += keep * (x.x - q.x) + p_.a[i].x * dt2;
        x.y += keep * (x.y - q.y) + p_.a[i].y * dt2;
        x.z += keep * (x.z - q.z) + p_.a[i].z * dt2;
      }
      q = now;
    }
    if (scene_.pin_motions.empty()) return;
    for (const int pin : scene_.pins) {
      auto& x = p_.x[static_cast<std::size_t>(pin)];
      x = vec4(pin_position(scene_, pin, t + dt), 0);
    }
  }

  template <Projection kind>
  void add_links() {
    for (const Family family : kFamilies) {
      std::vector<Link> links;
      const std::vector<double> w = inverse_masses(scene_);
      for (const Link& l : scene_.links)
        if (l.family == family &&
            w[static_cast<std::size_t>(l.a)] + w[static_cast<std::size_t>(l.b)] > 0)
          links.push_back(l);
      if (!links.empty())
        constraints_.push_back(std::make_unique<LinkPass<Real, kind>>(
            std::string(to_string(family)), std::move(links)));
    }
  }

  static Vec4<Real> vec4(const Vec3& v, double w) {
    return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z()),
            static_cast<Real>(w)};
  }

  Scene scene_;
  int iterations_;
  int substeps_;
  Particles<Real> p_;
  std::vector<std::unique_ptr<Pass<Real>>> forces_;
  std::vector<std::unique_ptr<Pass<Real>>> constraints_;
};

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  if (params.is("precision", "float")) return std::make_unique<Jakobsen<float>>(scene, params);
  return std::make_unique<Jakobsen<double>>(scene, params);
}

std::vector<std::string> cannot(const Scene& scene, const Params&) {
  if (scene.self_collision) return {"self-collision is not modelled"};
  return {};
}

Effective effective(const Scene&, const Params& params) {
  return {{"precision", std::string(params.choice("precision"))}, {"link order", "the scene's"}};
}

}  // namespace
}  // namespace taut

TAUT_SOLVER(jakobsen) = {
    .name = "jakobsen",
    .summary = "Verlet integration with relaxation of stiff distance constraints",
    .source = "Jakobsen, Advanced Character Physics, GDC 2001",
    .params = taut::kParams,
    .make = taut::make,
    .cannot = taut::cannot,
    .effective = taut::effective};
