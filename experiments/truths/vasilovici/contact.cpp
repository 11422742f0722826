// Section 8, what Vasilovici's report says of boxes and of self-collision, on the shipped scenes.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/truths/simulation.hpp"

namespace taut {

namespace {

/// Three sweeps in the scene's order, as the report has it, with this response to the box.
std::string answering(const std::string& contact) {
  return "jakobsen:iterations=3,substeps=1,order=mesh,contact=" + contact;
}

/// Values of a shipped scene under a solver; nothing if it was not asked for or cannot.
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
  findings.equal(solver, "largest acceleration at rest, 1/256 s: it pops", "m/s^2",
                 fine["popping.max"], 320, 200);
}

TAUT_TRUTH(octree_split, 8, 9, "an octree of boxes misses what collides across a split",
           "Vasilovici, Cloth Simulation Report, section 4.2.4") {
  // Two slow particles meet at the middle of a box whose corners hold the others.
  std::vector<Vec3> x{{-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}};
  for (const double sx : {-1, 1})
    for (const double sy : {-1, 1})
      for (const double sz : {-1, 1}) x.emplace_back(sx, sy, sz);
  Scene s = bare::scene(x, std::vector<double>(x.size(), 1.0), {});
  s.start.v[0] = {0.1, 0.1, 0.1}, s.start.v[1] = -s.start.v[0];
  s.self_collision = SelfCollision{.radius = 0.05};
  const auto gap = [&](const std::string& method) {
    Simulation sim(s, "jakobsen:precision=double,substeps=1,self=" + method);
    sim.step(40);
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

}  // namespace taut
