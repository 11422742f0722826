// Section 7: a cloth that lies on a turning disc is turned by friction alone.
#include <cmath>
#include <numbers>
#include <numeric>

#include "experiments/truths/bodies.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Angular acceleration of an annulus that slips everywhere [rad/s^2].
double turning(double mu, double r1, double r2) {
  return 4.0 / 3 * mu * kG * (std::pow(r2, 3) - std::pow(r1, 3)) /
         ((r2 * r2 - r1 * r1) * (r2 * r2 + r1 * r1));
}

/// Rings of vertices in the middle of `rings` strips of a disc of this radius [m], linked to their
/// neighbours, with masses by area.
Scene disc_of_rings(int rings, int around, double radius) {
  std::vector<Vec3> x;
  std::vector<double> mass;
  std::vector<Link> links;
  const auto at = [&](int ring, int k) { return ring * around + (k + around) % around; };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const double r = (ring + 0.5) * radius / rings, a = 2 * std::numbers::pi * k / around;
      x.push_back({r * std::cos(a), 0, r * std::sin(a)});
      mass.push_back(1e-3 * r);
    }
  const auto add = [&](int a, int b) {
    links.push_back({a, b, (x[to_index(b)] - x[to_index(a)]).norm()});
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      add(at(ring, k), at(ring, k + 1));
      if (ring + 1 == rings) continue;
      add(at(ring, k), at(ring + 1, k));
      add(at(ring, k), at(ring + 1, k + 1));
      add(at(ring, k), at(ring + 1, k - 1));
    }
  return under_gravity(bare::scene(x, mass, links));
}

/// Angular velocity about y: angular momentum over moment of inertia [rad/s].
double angular_velocity(const Scene& s, const State& state) {
  double momentum = 0, inertia = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    momentum += s.mesh.mass[i] * state.x[i].cross(state.v[i]).y();
    inertia += s.mesh.mass[i] * Vec3(state.x[i].x(), 0, state.x[i].z()).squaredNorm();
  }
  return momentum / inertia;
}

}  // namespace

TAUT_TRUTH(turning_disc, 7, 10,
           "an annulus that slips on a turning disc: alpha = (4/3) mu g (R2^3 - R1^3)/((R2^2 - "
           "R1^2)(R2^2 + R1^2)); a disc is in step after 3 omega R/(4 mu g)",
           "Coulomb; torque over moment of inertia") {
  const double radius = 0.5, mu = 0.3, omega = 2;
  const double alpha = turning(mu, 0, radius), in_step = 3 * omega * radius / (4 * mu * kG);
  findings.equal("closed form", "alpha of a disc of 0.5 m, mu = 0.3", "rad/s^2", alpha, 7.848,
                 1e-12);
  findings.equal("closed form", "time until it is in step, omega/alpha", "s", in_step,
                 omega / alpha, 1e-12);
  findings.equal("closed form", "alpha of a thin ring, mu g/R", "rad/s^2",
                 turning(mu, radius - 1e-6, radius), mu * kG / radius, 1e-4);
  Scene s = disc_of_rings(6, 16, radius);
  Motion turn;
  turn.spin = Vec3(0, omega, 0);
  s.dt = 1.0 / 256;
  const int slipping = static_cast<int>(0.5 * in_step / s.dt),
            stuck = static_cast<int>(1.5 * in_step / s.dt) - slipping;
  // on a disc that is a plane, and on top of a box of 12 triangles
  const MeshBody box{.mesh = body_of_a_box({1, 0.1, 1}), .center = {0, -0.1, 0}};
  const auto on = [&](const Shape& shape, const std::string& solver, const std::string& where) {
    s.colliders = {{shape, turn, mu}};
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver, slipping);
    findings.equal(solver, "angular velocity while it slips" + where + ", over time", "rad/s^2",
                   angular_velocity(s, sim.state()) / (slipping * s.dt), alpha, 0.02 * alpha);
    sim.step(stuck);
    findings.equal(solver, "angular velocity after 1.5 times that time" + where, "rad/s",
                   angular_velocity(s, sim.state()), omega, 1e-3 * omega);
  };
  for (const std::string& solver :
       {jakobsen(8), std::string("xpbd:substeps=1,order=mesh,iterations=8,precision=double"),
        std::string("implicit:substeps=1"),
        std::string("vbd:substeps=1,iterations=200,precision=double,start=inertia"),
        std::string("pd:substeps=1,precision=double,iterations=100"),
        std::string("admm:substeps=1,precision=double")}) {
    const std::string name = solver_name(solver);
    if (name == "pd" || name == "vbd" || name == "implicit")
      s.stiffness = {1000, 1000, 1000};
    else
      s.stiffness = kRigid;
    on(Plane{}, solver, "");
    on(box, solver, " on triangles");
  }
}

}  // namespace taut
