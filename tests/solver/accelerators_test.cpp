// Tethers, the hierarchy of levels, and the limits of float.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/model/index.hpp"
#include "core/solver/constraints/hierarchy.hpp"
#include "core/solver/constraints/tethers.hpp"
#include "tests/support/cloths.hpp"

namespace taut::accelerators_test {
namespace {

/// Root mean square strain of the structural links.
double strain(const Scene& scene, const State& state) {
  double sum = 0, count = 0;
  for (const Link& link : scene.links) {
    if (link.family != Family::structural) continue;
    const double length =
        (state.x[static_cast<std::size_t>(link.a)] - state.x[static_cast<std::size_t>(link.b)])
            .norm();
    sum += (length / link.rest - 1) * (length / link.rest - 1);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(Tethers, GoFromEveryFreeVertexToEachGroupOfPins) {
  Scene scene = hanging_sheet(5, 4);
  EXPECT_EQ(make_tethers(scene).size(), 2u * (20 - 2));  // two corners
  for (const Tether& t : make_tethers(scene))
    EXPECT_NEAR(t.length,
                (scene.mesh.rest[static_cast<std::size_t>(t.vertex)] -
                 scene.mesh.rest[static_cast<std::size_t>(t.pin)])
                    .norm(),
                1e-15);
  scene.pins = {0, 1, 2, 3, 4};
  EXPECT_EQ(make_tethers(scene).size(), 15u);  // one edge
  scene.pins.clear();
  EXPECT_TRUE(make_tethers(scene).empty());
}

/// Strain left by four sweeps once the cloth has come to rest.
double settled(const Scene& scene, const char* more) {
  return strain(scene, simulate(scene, listing("precision=double,iterations=4") + more, 600));
}

TEST(Tethers, FollowTheClothWhereTheMeshIsNoGrid) {
  Scene chain = hanging_sheet(1, 5, {true, false, false});
  chain.mesh.grid.reset();
  // folded back; the path along the links keeps its length
  chain.mesh.rest[4] = chain.mesh.rest[2];
  const auto tethers = make_tethers(chain);
  ASSERT_EQ(tethers.size(), 4u);
  EXPECT_NEAR(tethers.back().length, 1, 1e-12);
}

TEST(Tethers, HoldAHangingSheetAndLeaveASlackOneAlone) {
  Scene scene = hanging_sheet(12, 12);
  scene.damping = 2;
  EXPECT_LT(10 * settled(scene, ",tethers=on"), settled(scene, ""));
  scene.gravity.setZero();
  for (Vec3& x : scene.start.x) x *= 0.9;
  EXPECT_EQ(simulate(scene, listing("tethers=on"), 1).x, simulate(scene, listing(), 1).x);
}

TEST(Tethers, FollowPinsThatMove) {
  for (const int nu : {5, 20}) {
    Scene scene = hanging_sheet(nu, 9);
    scene.pin_motions = {{.vertices = scene.pins, .motion = {.velocity = {0, 2, 1}}}};
    const State state = simulate(scene, listing("iterations=20,order=coloured,tethers=on"), 64);
    for (const Tether& t : make_tethers(scene)) {
      const Vec3 line = state.x[to_index(t.vertex)] - state.x[to_index(t.pin)];
      EXPECT_LT(line.norm(), 1.01 * t.length);
    }
    EXPECT_GT(state.x.back().y(), scene.start.x.back().y() + 1);
  }
}

/// A net held by corners that are closer together than its width shears. Vertices are then farther
/// from the pins than in the flat sheet although every link has its rest length.
TEST(Accelerators, LeaveANetAloneThatShears) {
  Scene net = hanging_sheet(17, 17, {true, false, false});
  net.gravity.setZero();
  for (int j = 0; j < 17; ++j)
    for (int i = 0; i < 17; ++i) {  // a V whose columns hang straight down
      const double u = i / 16.0, fall = 0.5 * std::min(u, 1 - u);
      net.start.x[static_cast<std::size_t>(17 * j + i)] +=
          Vec3((std::sqrt(0.75) - 1) * u, -fall, 0);
    }
  for (const Link& link : net.links)
    ASSERT_NEAR((net.start.x[static_cast<std::size_t>(link.a)] -
                 net.start.x[static_cast<std::size_t>(link.b)])
                    .norm(),
                link.rest, 1e-12);
  for (const char* more : {",tethers=on", ",levels=4"}) {
    const State moved = simulate(net, listing("precision=double") + more, 1);
    EXPECT_LT(largest_distance(moved.x, net.start.x), 1e-9) << more;
  }
}

TEST(Hierarchy, HalvesTheVerticesAndEveryChildHasParents) {
  const Scene scene = hanging_sheet(16, 16);
  const auto levels = make_hierarchy(scene, inverse_masses(scene), 4);
  ASSERT_EQ(levels.size(), 4u);
  std::size_t finer = 256;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    EXPECT_LT(level->vertices.size(), 0.6 * static_cast<double>(finer));
    EXPECT_EQ(level->children.size() + level->vertices.size(), finer);
    for (const Level::Child& child : level->children) {
      double sum = 0;
      for (int p = child.first; p < child.end; ++p)
        sum += level->parents[static_cast<std::size_t>(p)].weight;
      EXPECT_NEAR(sum, 1, 1e-12);
    }
    finer = level->vertices.size();
  }
}

// The chain 0-1-2-3-4-5-6-7-8 hangs on vertex 0 by links of 1, 2, ... 7 m and one of length 0. The
// next level keeps every other vertex after the pin's neighbour, and the level above keeps every
// other vertex of those.
TEST(Hierarchy, OfAChainIsThis) {
  Scene scene;
  scene.mesh.rest.assign(9, Vec3::Zero());
  scene.mesh.mass.assign(9, 1);
  scene.pins = {0};
  for (int i = 0; i < 8; ++i)
    scene.links.push_back({i, i + 1, i < 7 ? i + 1.0 : 0, Family::structural});
  scene.links.push_back({2, 6, 1, Family::bend});  // the hierarchy ignores bend links
  std::string text;
  for (const Level& level : make_hierarchy(scene, inverse_masses(scene), 9)) {
    for (const int v : level.vertices) text += std::to_string(v) + ' ';
    text += "by";
    for (const auto& c : level.links)
      text += ' ' + std::to_string(c.a) + '-' + std::to_string(c.b) + ':' +
              std::to_string(std::lround(c.rest));
    for (const Level::Child& child : level.children) {
      text += "; " + std::to_string(child.vertex) + " with";
      for (int p = child.first; p < child.end; ++p) {
        const Level::Parent& parent = level.parents[static_cast<std::size_t>(p)];
        text += ' ' + std::to_string(parent.vertex) + '*' +
                std::to_string(std::lround(1000 * parent.weight));
      }
    }
    text += '\n';
  }
  EXPECT_EQ(text,
            "0 1 by 0-1:1; 5 with 1*1000\n"
            "0 1 5 by 0-1:1 1-5:14; 3 with 1*643 5*357; 7 with 5*1000\n"
            "0 1 3 5 7 by 0-1:1 1-3:5 3-5:9 5-7:13; 2 with 1*600 3*400; 4 with 3*556 5*444; "
            "6 with 5*538 7*462\n");
  EXPECT_EQ(make_hierarchy(scene, inverse_masses(scene), 2).size(), 2u);
  const SolverChoice choice = parse_solver("jakobsen:order=mesh,levels=9,iterations=4,substeps=3");
  const std::vector<PassCost> costs = choice.entry->make(scene, choice.params)->step_cost();
  const auto cost = std::ranges::find(costs, "hierarchy", &PassCost::pass);
  ASSERT_NE(cost, costs.end());
  EXPECT_EQ(cost->items, 1u + 2 + 4);
  EXPECT_EQ(cost->repeats, 12u);
  EXPECT_TRUE(cost->projections);
}

TEST(Hierarchy, StiffensAHangingSheetAtFewSweeps) {
  Scene scene = hanging_sheet(17, 17);
  scene.damping = 2;
  EXPECT_LT(2 * settled(scene, ",levels=6"), settled(scene, ""));
}

TEST(Accelerators, WorkInterleavedAsWellAsPacked) {
  const Scene scene = crumpled(hanging_sheet(20, 20), 0.01);
  for (const char* more : {",tethers=on", ",levels=3", ",levels=3,tethers=on"}) {
    const std::string method = listing("precision=double,order=coloured,iterations=2") + more;
    const State interleaved = simulate(scene, method + ",layout=interleaved", 30);
    const State batches = simulate(scene, method + ",layout=batches", 30);
    const State without = simulate(scene, method.substr(0, method.size() - std::strlen(more)), 30);
    // the same cloth in another order
    const double apart = largest_distance(interleaved.x, batches.x);
    EXPECT_LT(3 * apart, largest_distance(interleaved.x, without.x)) << more;
    EXPECT_LT(3 * apart, largest_distance(batches.x, without.x)) << more;
  }
}

TEST(Memory, OfASheetIsAtMostAHundredBytesAVertex) {
  const auto per_vertex = [](const Scene& scene, const char* solver) {
    const SolverChoice choice = parse_solver(solver);
    double bytes = 0;
    for (const PassCost& line : choice.entry->make(scene, choice.params)->step_cost())
      bytes += static_cast<double>(line.bytes);
    EXPECT_GE(bytes, 24 * scene.mesh.size()) << "two positions of three floats";
    return bytes / scene.mesh.size();
  };
  for (const int n : {32, 64, 128}) {
    const Scene scene = hanging_sheet(n, n);
    EXPECT_LE(per_vertex(scene, "jakobsen:layout=interleaved"), 100) << n;
    EXPECT_LE(per_vertex(scene, "jakobsen:layout=batches"), 200) << n;
    EXPECT_LE(per_vertex(scene, "jakobsen:order=mesh"), 200) << n;
  }
}

// No two of the six pins are linked, so each vertex below hangs from the nearest four.
TEST(Tethers, GoToTheFourNearestGroupsAtMost) {
  Scene scene = hanging_sheet(11, 2);
  scene.pins = {0, 2, 4, 6, 8, 10};
  std::vector<int> pins, of_the_middle;
  for (const Tether& t : make_tethers(scene)) {
    if (t.vertex == 11) pins.push_back(t.pin);
    if (t.vertex == 16) of_the_middle.push_back(t.pin);
  }
  EXPECT_EQ(pins, (std::vector{0, 2, 4, 6}));
  EXPECT_EQ(of_the_middle, (std::vector{4, 6, 2, 8}));
  EXPECT_EQ(make_tethers(scene).size(), 4u * 16);
  scene.pins = {0, 1, 4};
  for (const Tether& t : make_tethers(scene))
    EXPECT_TRUE(t.pin == 4 || t.pin == (t.vertex % 11 == 0 ? 0 : 1)) << "the nearer of two linked";
}

}  // namespace
}  // namespace taut::accelerators_test
