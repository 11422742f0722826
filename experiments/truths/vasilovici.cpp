// Section 8: statements of Vasilovici's report on springs, steps, sweeps, boxes and self-collision.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/truths/quoted.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Three sweeps in the scene's order, as in the report, with this response to the box.
std::string answering(const std::string& contact) {
  return "jakobsen:iterations=3,substeps=1,order=mesh,contact=" + contact;
}

/// Values of a shipped scene under a solver; empty if it was not asked for or cannot run.
std::map<std::string, double> values_of(Findings& findings, const CaseSpec& spec) {
  if (!findings.wants(spec.solver)) return {};
  const Case one = make_case(spec);
  if (!can_run(findings, spec.solver, *one.scene)) return {};
  return run_case(one).record.values;
}

std::map<std::string, double> values(Findings& findings, const std::string& scene,
                                     const std::string& solver, const std::string& dt = "1/64") {
  return values_of(findings, {scene, {"time.dt=\"" + dt + "\""}, solver});
}

Scene particle_at_box(const Vec3& x, const Vec3& velocity) {
  Scene s = bare::scene({x, x + Vec3(0, 0, 50)}, {1, 1}, {});
  s.start.v = {velocity, Vec3::Zero()};
  s.colliders.push_back(
      {Box{Vec3::Zero(), {0.5, 0.5, 0.5}, Eigen::Quaterniond::Identity()}, {}, 0});
  return s;
}

}  // namespace

TAUT_TRUTH(box_before_relaxation, 8, 6,
           "out of the box first and relaxed afterwards, cloth sinks in but not through",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string solver = answering("before");
  auto v = values(findings, "box", solver);
  if (v.empty()) return;
  findings.equal(solver, "depth at rest in a box of 0.4 m", "m", v["penetration.max"], 0.04, 0.02);
  findings.below(solver, "vertices that end on the other side of it", "1", v["tunnelling.count"],
                 0);
}

TAUT_TRUTH(box_freeze, 8, 7,
           "frozen where it touches the box, cloth stays out, and stretches instead",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string solver = answering("freeze");
  auto v = values(findings, "box", solver);
  if (v.empty()) return;
  findings.below(solver, "depth at rest in a box", "m", v["penetration.max"], 1e-6);
  findings.below(solver, "largest acceleration at rest, without gravity's", "m/s^2",
                 v["popping.max"], 0.01);
  findings.equal(solver, "largest stretch at rest: what is frozen cannot slide", "1",
                 v["stretch.max"], 2, 0.7);
}

TAUT_TRUTH(box_halt, 8, 8,
           "halted for a step where it touches the box, cloth pops and sinks in with the step",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string solver = answering("halt");
  auto coarse = values(findings, "box", solver), fine = values(findings, "box", solver, "1/256");
  if (coarse.empty()) return;
  findings.equal(solver, "depth in a box at 1/64 s over that at 1/256 s", "1",
                 coarse["penetration.max"] / std::max(fine["penetration.max"], 1e-9), 5.6, 2.8);
  findings.equal(solver, quoted::kPopOfHaltedCloth, "m/s^2", fine["popping.max"], 320, 200);
}

TAUT_TRUTH(octree_split, 8, 9, "an octree of boxes misses what collides across a split",
           "Vasilovici, Cloth Simulation Report, section 4.2.4") {
  // Two slow particles meet at the middle of a box whose corners hold the others.
  std::vector<Vec3> x{{-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}};
  for (const double sx : {-1, 1})
    for (const double sy : {-1, 1})
      for (const double sz : {-1, 1}) x.emplace_back(sx, sy, sz);
  Scene s = bare::scene(x, std::vector<double>(x.size(), 1.0), {});
  s.start.v[0] = {0.1, 0.1, 0.1};
  s.start.v[1] = -s.start.v[0];
  s.self_collision = SelfCollision{.radius = 0.05};
  const auto gap = [&](const std::string& method) {
    Simulation sim(s, "jakobsen:precision=double,substeps=1,self=" + method, 40);
    return (sim.x(1) - sim.x(0)).norm();
  };
  const std::string octree = "jakobsen:self=octree", grid = "jakobsen:self=grid";
  if (!can_run(findings, octree, s)) return;
  findings.equal(octree, "distance of two that met across the octree's split: as without a test",
                 "m", gap("octree"), gap("off"), 0);
  findings.below(grid, "their overlap", "m", std::max(0.0, 0.1 - gap("grid")), 1e-12);
}

TAUT_TRUTH(octree_jam, 8, 10, "particles larger than the spacing jam the cloth under the octree",
           "Vasilovici, Cloth Simulation Report, section 4.2.4") {
  const std::string octree = "jakobsen:self=octree", grid = "jakobsen:self=grid";
  if (auto v = values(findings, "jam", octree, "1/256"); !v.empty())
    findings.below(octree, "way of a falling sheet whose particles overlap", "m", v["drift.max"],
                   1e-3);
  if (auto v = values(findings, "jam", grid, "1/256"); !v.empty())
    findings.equal(grid, "its way with overlaps at rest left alone", "m", v["drift.max"], 0.26,
                   0.06);
}

TAUT_TRUTH(octree_crossings, 8, 16,
           "an octree keeps a folding sheet from crossing itself, though particles overlap",
           "Vasilovici, Cloth Simulation Report, section 4.2.4") {
  const auto seen = [&](const std::string& method) {
    return values_of(findings, {"crumple", {"time.duration=1.5"}, "jakobsen:self=" + method});
  };
  auto octree = seen("octree"), grid = seen("grid"), off = seen("off");
  if (octree.empty()) return;
  const std::string solver = "jakobsen:self=octree";
  findings.below(solver, "crossing faces of a sheet that folds on itself", "1",
                 octree["self.crossings.peak"], 0);
  findings.equal("jakobsen:self=off", "the same without a test", "1", off["self.crossings.peak"],
                 120, 80);
  findings.equal(solver, "deepest overlap of its particles", "m", -octree["self.gap"], 0.013,
                 0.008);
  findings.below("jakobsen:self=grid", "the same on a grid of neighbours", "m", -grid["self.gap"],
                 1e-3);
}

/// x* = 2x - x' + a dt^2 in steps of h and h/2 by turns.
TAUT_TRUTH(verlet_fixed_step, 8, 11,
           "2x - x' is a velocity only while the step is fixed: by turns h and h/2 it is 4/3",
           "Vasilovici, Cloth Simulation Report, section 3") {
  constexpr int kSteps = 100;
  constexpr double kStep = 0.01;  // s
  double x = 0, before = -kStep, t = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double now = x;
    x = 2 * x - before;
    before = now;
    t += n % 2 == 0 ? kStep : kStep / 2;
  }
  findings.equal("closed form", "way of a free particle over speed times time, steps of h and h/2",
                 "1", x / t, 4.0 / 3, 1e-12);
}

/// A square hung by two corners, on its structural links alone and with the others.
TAUT_TRUTH(spring_families, 8, 12,
           "without shear links a square hung by two corners sags; bend links do little",
           "Vasilovici, Cloth Simulation Report, section 3") {
  const std::string solver = jakobsen(16);
  const auto loss = [&](bool shear, bool bend) {
    Scene s = bare::sheet(9, 9, {true, shear, bend});
    s.gravity = {0, -kG, 0};
    s.damping = 1;
    s.pins = {0, 8};
    Simulation sim(s, solver, 640);
    return s.start.x[8 * 9 + 4].y() - sim.x(8 * 9 + 4).y();
  };
  if (!can_run(findings, solver, bare::sheet(2, 2))) return;
  const double all = loss(true, true), no_bend = loss(true, false), no_shear = loss(false, false);
  findings.equal(solver, "sag of the lower edge without shear links, over that with all", "1",
                 no_shear / all, 60, 30);
  findings.equal(solver, "the same without bend links, which a flat sheet hardly needs", "1",
                 no_bend / all, 2, 1);
}

/// Number of divisions in a frame, one in each projection.
TAUT_TRUTH(divisions, 8, 13, "without the root a sweep takes N divisions, k sweeps k N",
           "Vasilovici, Cloth Simulation Report, section 4") {
  for (const int sweeps : {1, 3}) {
    const std::string solver = jakobsen(sweeps, "sqrt-free");
    const Scene s = bare::sheet(9, 9);
    if (!can_run(findings, solver, s)) return;
    const SolverChoice choice = parse_solver(solver);
    findings.equal(
        solver, "divisions in a frame over the number of links", "1",
        static_cast<double>(projections_per_step(*choice.entry->make(s, choice.params))) /
            static_cast<double>(s.links.size()),
        sweeps, 0);
  }
}

TAUT_TRUTH(box_sides, 8, 14, "a box has six sides, not four",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string solver = jakobsen(3, "exact", "contact=discrete");
  int kept_out = 0;
  for (int side = 0; side < 6; ++side) {
    const Vec3 normal = (side % 2 == 0 ? 1 : -1) * Vec3::Unit(side / 2);
    const Scene s = particle_at_box(0.6 * normal, -2 * normal);
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver, 32);
    kept_out += sim.x(0).dot(normal) > 0.5 - 1e-9;
  }
  findings.equal(solver, "sides of a box that keep a particle out", "1", kept_out, 6, 0);
}

TAUT_TRUTH(box_nearest_side, 8, 15,
           "a test of where a particle is finds the nearest side, not the one it came in by",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string discrete = jakobsen(3, "exact", "contact=discrete"),
                    continuous = jakobsen(3, "exact", "contact=continuous");
  // Falls 0.1 m deep through the top, 0.02 m beside the edge.
  const Scene s = particle_at_box({0.48, 0.55, 0}, {0, -0.15 * 64, 0});
  if (!can_run(findings, discrete, s)) return;
  Simulation wrong(s, discrete), right(s, continuous);
  wrong.step();
  right.step();
  findings.equal(discrete, "distance from the side, for it is put out there, not where it came in",
                 "m", 0.5 - wrong.x(0).x(), 0, 1e-9);
  findings.equal(discrete, "its depth below the top", "m", 0.5 - wrong.x(0).y(), 0.1, 1e-6);
  findings.below(continuous, "the same where its way is tested", "m",
                 std::max(0.0, 0.5 - right.x(0).y()), 1e-9);
}

}  // namespace taut
