// The generic path against the published listing, and the quantities that every method conserves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/reference/textbook.hpp"
#include "core/solver/layout/order.hpp"
#include "tests/support/cloths.hpp"

namespace taut::relaxation_test {
namespace {

TEST(Relaxation, InMeshOrderAndDoubleItIsTheListing) {
  for (const auto& [nu, nv] : {std::pair{2, 2}, {3, 5}, {20, 20}, {33, 17}, {1, 16}})
    for (const Lumping lumping : {Lumping::area, Lumping::equal})
      for (const bool exact : {false, true}) {
        Scene scene = crumpled(hanging_sheet(nu, nv, {true, true, true}, lumping), 0.2 / nu);
        scene.damping = 0.5;
        Textbook<double> oracle(scene, 4, exact);
        for (int n = 0; n < 30; ++n) oracle.step();
        const State state = simulate(
            scene,
            listing("precision=double,iterations=4,projection=") + (exact ? "exact" : "sqrt-free"),
            30);
        EXPECT_LT(largest_distance(state.x, oracle.x()), 1e-11) << nu << " x " << nv;
      }
}

TEST(Relaxation, WithoutPinsTheCentreOfMassFollowsTheParabola) {
  for (const char* method :
       {"method=gauss-seidel", "method=jacobi,omega=0.15", "method=jacobi-underrelaxed",
        "order=coloured", "order=random", "order=reversed"}) {
    Scene scene = crumpled(hanging_sheet(9, 7), 0.02);
    scene.pins.clear();
    const auto centre = [&](const std::vector<Vec3>& x) {
      Vec3 sum = Vec3::Zero();
      double mass = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        sum += scene.mesh.mass[i] * x[i];
        mass += scene.mesh.mass[i];
      }
      return Vec3(sum / mass);
    };
    const State state =
        simulate(scene, listing(std::string("precision=double,iterations=5,") + method), 32);
    const double t = 0.5;
    const Vec3 fall = scene.gravity * (t * t / 2 + t * scene.dt / 2);
    EXPECT_LT((centre(state.x) - centre(scene.start.x) - fall).norm(), 1e-13) << method;
  }
}

/// Shares follow the masses for every position of a heavy vertex, in every lane of an interleaved
/// sheet.
TEST(Relaxation, KeepsTheCentreOfMassWhereverAHeavyVertexLies) {
  for (const int columns : {9, 20, 33})
    for (int heavy = 0; heavy < 3 * columns; ++heavy) {
      Scene scene = crumpled(hanging_sheet(columns, 3), 0.01);
      scene.pins.clear();
      scene.gravity.setZero();
      scene.mesh.mass[to_index(heavy)] *= 50;
      Vec3 moved = Vec3::Zero();
      const State state = simulate(scene, "jakobsen:precision=double,substeps=1", 1);
      for (std::size_t i = 0; i < state.x.size(); ++i)
        moved += scene.mesh.mass[i] * (state.x[i] - scene.start.x[i]);
      EXPECT_LT(moved.norm(), 1e-13) << columns << " columns, vertex " << heavy;
    }
}

TEST(Relaxation, AveragedJacobiDoesNotConserveMomentum) {
  Scene scene = crumpled(hanging_sheet(9, 7, {true, true, true}, Lumping::equal), 0.02);
  scene.pins.clear();
  scene.gravity.setZero();
  const State state =
      simulate(scene, listing("precision=double,method=jacobi-averaged,iterations=5"), 1);
  Vec3 drift = Vec3::Zero();
  for (std::size_t i = 0; i < state.x.size(); ++i) drift += state.x[i] - scene.start.x[i];
  EXPECT_GT(drift.norm() / static_cast<double>(state.x.size()), 1e-6);
}

/// Largest distance between the left half of a sheet and the mirror image of the right one.
double asymmetry(const State& state, int nu, int nv) {
  double most = 0;
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      Vec3 mirrored = state.x[static_cast<std::size_t>(j * nu + nu - 1 - i)];
      mirrored.x() = 1 - mirrored.x();
      most = std::max(most, (mirrored - state.x[static_cast<std::size_t>(j * nu + i)]).norm());
    }
  return most;
}

TEST(Relaxation, JacobiKeepsMirrorSymmetryGaussSeidelDoesNot) {
  const Scene scene = hanging_sheet(9, 9);
  const State jacobi =
      simulate(scene, listing("precision=double,method=jacobi-underrelaxed,iterations=8"), 64);
  EXPECT_LT(asymmetry(jacobi, 9, 9), 1e-12);
  const State sequential = simulate(scene, listing("precision=double,iterations=8"), 64);
  EXPECT_GT(asymmetry(sequential, 9, 9), 1e-6);
}

TEST(Relaxation, EveryOrderVisitsEveryLinkOnce) {
  const Scene scene = hanging_sheet(40, 37);
  for (const Order order :
       {Order::mesh, Order::coloured, Order::reversed, Order::random, Order::jolt}) {
    std::vector<Link> links = ordered(scene, order, 7);
    const auto key = [](const Link& l) { return std::tuple(l.a, l.b, l.rest); };
    std::vector<std::tuple<int, int, double>> got, want;
    for (const Link& l : links) got.push_back(key(l));
    for (const Link& l : scene.links) want.push_back(key(l));
    std::sort(got.begin(), got.end());
    std::sort(want.begin(), want.end());
    EXPECT_EQ(got, want);
  }
}

TEST(Relaxation, LinksOfAColourShareNoVertex) {
  const Scene scene = hanging_sheet(70, 35);
  std::size_t links = 0;
  for (const Phase& phase : colour(scene.links, scene.mesh)) {
    std::vector<int> tile_of(scene.start.x.size(), -1);
    for (std::size_t t = 0; t < phase.size(); ++t)
      for (const Colour& colour : phase[t]) {
        std::vector<bool> seen(tile_of.size());
        for (const Link& link : colour) {
          ++links;
          for (const int v : {link.a, link.b}) {
            EXPECT_FALSE(seen[static_cast<std::size_t>(v)]);
            seen[static_cast<std::size_t>(v)] = true;
            int& tile = tile_of[static_cast<std::size_t>(v)];
            EXPECT_TRUE(tile == -1 || tile == static_cast<int>(t));
            tile = static_cast<int>(t);
          }
        }
      }
  }
  EXPECT_EQ(links, scene.links.size());
}

TEST(Relaxation, SeedsChooseTheRandomOrderAndNothingElse) {
  const Scene scene = crumpled(hanging_sheet(8, 8), 0.02);
  const auto run = [&](const std::string& solver) { return simulate(scene, solver, 20).x; };
  EXPECT_EQ(run(listing("order=random,seed=3")), run(listing("order=random,seed=3")));
  EXPECT_NE(run(listing("order=random,seed=3")), run(listing("order=random,seed=4")));
  EXPECT_EQ(run(listing("seed=3")), run(listing("seed=4")));
}

TEST(Relaxation, ZeroIterationsIsFreeFallAndNegativeIsAnError) {
  const Scene scene = hanging_sheet(3, 3);
  const State state = simulate(scene, listing("iterations=0,precision=double"), 64);
  EXPECT_NEAR(state.x[4].y() - scene.start.x[4].y(), -9.81 * (0.5 + 0.5 / 64), 1e-12);
  EXPECT_EQ(state.x[0], scene.start.x[0]);
  EXPECT_THROW(parse_solver("jakobsen:iterations=-1"), InputError);
}

TEST(Relaxation, AVertexWithoutLinksFalls) {
  Scene scene = hanging_sheet(5, 5);
  std::erase_if(scene.links, [](const Link& l) { return l.a == 12 || l.b == 12; });
  Scene loose = scene;
  loose.links.clear();
  for (const char* more : {"order=mesh", "order=coloured", "method=jacobi-averaged", "tethers=on",
                           "levels=3", "order=random"}) {
    const std::string solver = listing(std::string("precision=double,") + more);
    const double fall = -9.81 * (0.5 + 0.5 / 64);
    for (const Scene* one : {&scene, &loose}) {
      const State state = simulate(*one, solver, 64);
      EXPECT_NEAR(state.x[12].y() - one->start.x[12].y(), fall, 1e-12) << more;
      for (const Vec3& x : state.x) EXPECT_TRUE(x.allFinite()) << more;
    }
  }
}

TEST(Relaxation, LinksThatCannotMoveOrHaveNoLengthDoNoHarm) {
  Scene scene = hanging_sheet(3, 3);
  scene.pins = {0, 1, 2};                                // links 0-1 and 1-2 cannot move
  scene.links.push_back({3, 4, 0, Family::structural});  // welds 3 and 4
  scene.start.x[7] = scene.start.x[4];                   // coincident
  for (const char* projection : {"exact", "sqrt-free"})
    for (const char* precision : {"float", "double"})
      for (const char* method : {"gauss-seidel", "jacobi-averaged"}) {
        const State state = simulate(
            scene,
            listing("projection=") + projection + ",precision=" + precision + ",method=" + method,
            20);
        for (const Vec3& x : state.x) EXPECT_TRUE(x.allFinite());
        EXPECT_EQ(state.x[1], scene.start.x[1]);
      }
}

TEST(Order, ListsPhasesThenTilesThenColours) {
  const auto link = [](int a) { return Link{a, a + 1, 1}; };
  const std::vector<Phase> phases{{{{link(0), link(1)}, {link(2)}}, {{link(3)}}},
                                  {{{link(4)}, {link(5), link(6)}}}};
  int next = 0;
  for (const Link& l : flatten(phases)) EXPECT_EQ(l.a, next++);
  EXPECT_EQ(next, 7);
  Scene scene = hanging_sheet(3, 2);
  const std::vector<Link> backwards = ordered(scene, Order::reversed, 1);
  for (std::size_t k = 0; k < backwards.size(); ++k)
    EXPECT_EQ(backwards[k].a, scene.links[backwards.size() - 1 - k].a);
}

/// Vertices of each tile by their places in memory: places 0 to 1023, the next 1024, and so on.
TEST(Order, TilesAreSquaresOfAGridOrNeighbourhoods) {
  const Scene grid = hanging_sheet(70, 35);
  const std::vector<std::uint32_t> rank = tile_ranks(grid.mesh);
  // squares of 32, row after row, and row by row inside a square
  std::vector<std::uint32_t> expected;
  std::uint32_t next = 0;
  expected.resize(rank.size());
  for (const auto& [v0, v1] : {std::pair{0, 32}, {32, 35}})
    for (const auto& [u0, u1] : {std::pair{0, 32}, {32, 64}, {64, 70}})
      for (int j = v0; j < v1; ++j)
        for (int i = u0; i < u1; ++i) expected[static_cast<std::size_t>(70 * j + i)] = next++;
  EXPECT_EQ(rank, expected);
  Mesh loose = make_sheet({.nu = 90, .nv = 30, .width = 9, .height = 3, .mass = 1});
  loose.grid.reset();  // 2700 vertices: three tiles of 900, side by side along the longer side
  const std::vector<std::uint32_t> places = tile_ranks(loose);
  for (std::size_t v = 0; v < places.size(); ++v) EXPECT_EQ(places[v] / 900, v % 90 / 30) << v;
}

}  // namespace
}  // namespace taut::relaxation_test
