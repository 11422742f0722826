// Section 7: contact of single particles, where the answer is known.
#include <cmath>
#include <numbers>

#include "core/model/angle.hpp"
#include "core/model/index.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/bodies.hpp"
#include "experiments/truths/quoted.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Two particles far apart at `height` above a plane through the origin with this normal.
Scene above_plane(double height, const Vec3& normal, double friction) {
  const Vec3 along = Vec3::UnitZ();
  Scene s =
      under_gravity(bare::scene({height * normal, height * normal + 2 * along}, {0.5, 0.5}, {}));
  s.colliders.push_back({Plane{normal, 0}, {}, friction});
  return s;
}

/// Share of particles, evenly spread over one step's displacement, that cross a solid unseen.
double missed(const std::string& solver, const Collider& collider, double travel) {
  const int count = 400;
  std::vector<Vec3> x;
  for (int i = 0; i < count; ++i) x.emplace_back(0, 0.5 + travel * (i + 0.5) / count, 0);
  Scene s = bare::scene(x, std::vector<double>(x.size(), 1.0), {});
  const Vec3 v(0, -travel / s.dt, 0);
  s.start.v.assign(x.size(), v);
  s.colliders = {collider};
  Simulation sim(s, solver, static_cast<int>(1 / travel) + 2);
  int through = 0;
  for (int i = 0; i < count; ++i)
    through += (sim.v(i) - v).norm() < 1e-9 * v.norm() && sim.x(i).y() < 0;
  return static_cast<double>(through) / count;
}

}  // namespace

TAUT_TRUTH(plane_rest, 7, 1,
           "on a plane a particle rests within two steps; it falls g dt^2 before projection",
           "Verlet with projection, no restitution") {
  findings.equal("closed form", "depth before projection at rest, 60 Hz", "m", kG / 3600, 2.725e-3,
                 5e-7);
  for (const std::string& solver :
       {jakobsen(3), jakobsen(3, "exact", "contact=before"), jakobsen(3, "exact", "contact=after"),
        jakobsen(3, "exact", "contact=discrete"), xpbd(1), mass_spring("verlet", 1), bullet(3)}) {
    Scene s = above_plane(0, Vec3::UnitY(), 0);
    s.start.v = {Vec3(0, -1, 0), Vec3(0, -1, 0)};
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, 2);
    const double speed = sim.v(0).norm();
    sim.step(254);
    const double hover = sim.x(0).y();
    if (solver_name(solver) == "bullet") {
      findings.deviates(solver, quoted::kHeightAtRest, "m", hover, 0, kG * s.dt * s.dt, 1e-5,
                        "a contact is only seen at the predicted place, so it rests at + g dt^2");
      continue;
    }
    findings.below(solver, quoted::kSpeedAfterImpact, "m/s", speed, 1e-12);
    findings.below(solver, quoted::kHeightAtRest, "m", std::abs(hover), 1e-15);
  }
}

TAUT_TRUTH(incline_friction, 7, 2,
           "slides by g (sin - mu cos) dt^2 n(n+1)/2; sticks iff mu >= tan(slope)", "Coulomb") {
  const double slope = 30 * kDegree, mu = 0.3;
  const Vec3 normal(std::sin(slope), std::cos(slope), 0);
  const Vec3 downhill(std::cos(slope), -std::sin(slope), 0);
  for (const std::string& solver :
       {jakobsen(3), jakobsen(3, "exact", "contact=before"), jakobsen(3, "exact", "contact=after"),
        xpbd(1), mass_spring("verlet", 1), with(bullet(3), "friction=refuse")}) {
    const Scene s = above_plane(0, normal, mu);
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver);
    const double worst = sim.worst(64, [&](int n) {
      const double expected =
          kG * (std::sin(slope) - mu * std::cos(slope)) * s.dt * s.dt * n * (n + 1) / 2;
      return (sim.x(0) - expected * downhill).norm();
    });
    findings.below(solver, "distance from g (sin - mu cos) dt^2 n(n+1)/2, 30 deg, mu = 0.3", "m",
                   worst, 1e-12);
    for (const double factor : {0.99, 1.01}) {
      Simulation edge(above_plane(0, normal, factor * std::tan(slope)), solver, 64);
      const bool moved = edge.x(0).norm() > 1e-9;
      findings.holds(
          solver, factor < 1 ? "slides at mu = 0.99 tan(slope)" : "sticks at mu = 1.01 tan(slope)",
          moved == (factor < 1));
    }
    // On a level plane v falls by mu g dt a step, so the distance is v0^2/(2 mu g) to first order.
    Scene level = above_plane(0, Vec3::UnitY(), mu);
    level.start.v.assign(2, Vec3(2, 0, 0));
    Simulation skid(level, solver, 128);
    const double stopping = 4 / (2 * mu * kG);
    findings.equal(solver, "stopping distance from 2 m/s, v0^2/(2 mu g)", "m", skid.x(0).x(),
                   stopping, 2 * level.dt);
  }
  // Links make a vertex stiffer along the plane than across it.
  Scene sheet = under_gravity(bare::sheet(9, 9));
  for (Vec3& x : sheet.start.x) x = x.x() * downhill + x.y() * Vec3::UnitZ();
  sheet.colliders.push_back({Plane{normal, 0}, {}, mu});
  for (const std::string& solver :
       {jakobsen(3), xpbd(1), mass_spring("verlet", 1), std::string("implicit"), std::string("pd"),
        std::string("admm"), std::string("avbd:iterations=100"),
        std::string("vbd:start=inertia")}) {
    if (!can_run(findings, solver, sheet)) continue;
    const Simulation sim(sheet, solver, 64);
    const double expected =
        kG * (std::sin(slope) - mu * std::cos(slope)) * sheet.dt * sheet.dt * 64 * 65 / 2;
    findings.equal(solver, "way of a sheet of 9 x 9 in 64 steps", "m",
                   (sim.x(40) - sheet.start.x[40]).norm(), expected, 1e-5);
  }
}

TAUT_TRUTH(tunnelling, 7, 3, "tests at step boundaries miss max(0, 1 - D/s) of the particles",
           "uniform phase of the steps") {
  const double thickness = 0.02, travel = 0.05;
  const Collider plate{Box{Vec3::Zero(), Vec3(2, thickness / 2, 2)}, {}, 0};
  const Collider ball{Ball{Vec3::Zero(), thickness / 2}, {}, 0};
  const Collider capsule{Capsule{-Vec3::UnitZ(), Vec3::UnitZ(), thickness / 2}, {}, 0};
  const Collider body{MeshBody{.mesh = body_of_a_box(Vec3(2, thickness / 2, 2))}, {}, 0};
  const Collider thick{Box{Vec3::Zero(), Vec3(2, 0.03, 2)}, {}, 0};
  Scene s = above_plane(1, Vec3::UnitY(), 0);
  s.colliders = {plate};
  for (const std::string& solver :
       {jakobsen(1, "exact", "contact=discrete"), jakobsen(1, "exact", "contact=after"),
        xpbd(1, "contact=discrete"), with(mass_spring("verlet", 1), "contact=discrete")}) {
    if (!can_run(findings, solver, s)) continue;
    findings.equal(solver, "share that misses a plate of 0.4 travels, max(0, 1 - D/s)", "1",
                   missed(solver, plate, travel), 1 - thickness / travel, 0.006);
    findings.equal(solver, "share that misses a ball of 2R = 0.4 s along its axis", "1",
                   missed(solver, ball, travel), 1 - thickness / travel, 0.006);
    findings.equal(solver, "share that misses a capsule of 2R = 0.4 s across its axis", "1",
                   missed(solver, capsule, travel), 1 - thickness / travel, 0.006);
    findings.equal(solver, "share that misses a plate of 12 triangles of 0.4 s", "1",
                   missed(solver, body, travel), 1 - thickness / travel, 0.006);
    findings.below(solver, quoted::kMissesThickPlate, "1", missed(solver, thick, travel), 0);
  }
  const std::string continuous = jakobsen(1, "exact", "contact=continuous");
  if (!can_run(findings, continuous, s)) return;
  for (const auto& [what, collider] :
       {std::pair("plate", plate), std::pair("ball", ball), std::pair("capsule", capsule),
        std::pair("body of triangles", body)})
    findings.deviates(continuous, std::string("share that misses a ") + what + " of 0.4 travels",
                      "1", missed(continuous, collider, travel), 1 - thickness / travel, 0, 0,
                      "its contact tests the path, so that nothing is missed");
}

TAUT_TRUTH(capstan, 7, 4, "T2/T1 -> exp(mu phi) around a rough cylinder, order 2 in the link angle",
           "Euler, Eytelwein; balance of every node") {
  const double mu = 0.3, wrap = std::numbers::pi;
  const PowerLaw order = fit_over(
      {wrap / 8, wrap / 16, wrap / 32, wrap / 64, wrap / 128},
      [&](double link) { return reference::capstan_ratio(mu, wrap, link) - std::exp(mu * wrap); });
  findings.slope("closed form", "order in the link angle of T2/T1 - exp(mu phi)", order, 2, 0.02);
  findings.equal("closed form", "T2/T1 for half a turn at mu = 0.3, 128 links", "1",
                 reference::capstan_ratio(mu, wrap, wrap / 128), std::exp(mu * wrap), 2e-4);
  // A light rope of 24 links over the top of a ball, and of a cylinder across the rope. It is
  // heavier at one end, and held below the ratio.
  const int n = 24;
  const double radius = 0.5, angle = wrap / n, l = 2 * radius * std::sin(angle / 2);
  const auto slip = [&](const std::string& solver, const Shape& shape, double ratio) {
    std::vector<Vec3> x;
    std::vector<Link> rods;
    std::vector<double> mass;
    for (int i = -2; i <= n + 2; ++i) {
      const double phi = std::clamp(i, 0, n) * angle;
      const double below = i < 0 ? -i * l : std::max(0, i - n) * l;
      x.push_back(radius * Vec3(-std::cos(phi), std::sin(phi), 0) - Vec3(0, below, 0));
      mass.push_back(i == -2 ? 1 : i == n + 2 ? ratio : 1e-3);
      if (i > -2) rods.push_back({i + 1, i + 2, l});
    }
    Scene s = under_gravity(bare::scene(x, mass, rods));
    s.colliders.push_back({shape, {}, mu});
    s.dt = 1.0 / 1024;
    Simulation sim(s, solver, 256);
    return (sim.x(n / 2 + 2) - s.start.x[to_index(n / 2 + 2)]).norm();
  };
  const std::string solver = jakobsen(100);
  Scene rough = above_plane(1, Vec3::UnitY(), mu);
  if (!can_run(findings, solver, rough)) return;
  const double ratio = reference::capstan_ratio(mu, wrap, angle);
  const Shape ball = Ball{Vec3::Zero(), radius},
              cylinder = Capsule{-Vec3::UnitZ(), Vec3::UnitZ(), radius};
  const double held = slip(solver, ball, 0.6 * ratio), slid = slip(solver, ball, 1.6 * ratio);
  findings.holds(solver, "the rope slides ten times further at 1.6 of the ratio than at 0.6",
                 slid > 10 * held);
  findings.equal(solver, "over a capsule it slides as far at 1.6 of the ratio", "m",
                 slip(solver, cylinder, 1.6 * ratio), slid, 1e-9 * radius);
}

}  // namespace taut
