// Self-collision of cloth: what the hash grid keeps apart, and two failures of the octree that
// Vasilovici's report publishes.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/solver/contact/neighbour_grid.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::self_collision_test {
namespace {

/// Particles of 1 kg and 5 cm radius at the given places and velocities, without links and gravity.
Scene particles(std::vector<Vec3> x, std::vector<Vec3> v) {
  Scene scene;
  scene.mesh.mass.assign(x.size(), 1.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    scene.mesh.rest.emplace_back(10.0 * static_cast<double>(i), 0, 0);  // far apart at rest
  scene.start = {std::move(x), std::move(v)};
  scene.gravity.setZero();
  scene.self_collision = SelfCollision{.radius = 0.05};
  scene.dt = 1.0 / 64;
  return scene;
}

State run(const Scene& scene, const char* params, int steps) {
  return simulate(scene, listing(std::string("precision=double,") + params), steps);
}

TEST(SelfCollision, TwoParticlesMeetAndKeepTheirMomentum) {
  Scene scene = particles({{-0.2, 0, 0}, {0.2, 0.01, 0}}, {{1, 0, 0}, {-1, 0, 0}});
  scene.mesh.mass[1] = 3;
  const State state = run(scene, "self=grid", 64);
  EXPECT_GE((state.x[1] - state.x[0]).norm(), 0.1 - 1e-12);
  EXPECT_LT(state.x[0].x(), state.x[1].x());
  EXPECT_NEAR((state.v[0] + 3 * state.v[1] - Vec3(-2, 0, 0)).norm(), 0, 1e-12);
  EXPECT_GT(run(scene, "self=off", 64).x[0].x(), 0.5);
}

TEST(SelfCollision, AFastParticleDoesNotPassWithinAStep) {
  const Scene scene = particles({{-0.48, 0, 0}, {0, 0, 0}}, {{20, 0, 0}, {0, 0, 0}});
  const State state = run(scene, "self=grid", 3);  // moves 0.31 m a step; a diameter is 0.1 m
  EXPECT_LE(state.x[0].x(), state.x[1].x() - 0.1 + 1e-12);
  EXPECT_GT(run(scene, "self=octree", 3).x[0].x(), 0.4);
}

TEST(SelfCollision, NoneOfManyFastPairsPassesWhereverTheCellsLie) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> number(-1, 1);
  std::vector<Vec3> x, v, apart;
  for (int i = 0; i < 200; ++i) {
    const Vec3 at = Vec3(3 * (i % 6), 3 * (i / 6 % 6), 3 * (i / 36)) +
                    0.5 * Vec3(number(random), number(random), number(random));
    const Vec3 along = Vec3(number(random), number(random), number(random)).normalized();
    const double gap = 0.11 + 0.1 * std::abs(number(random));
    // distance that both approach each other: up to four diameters of 0.1 m
    const double way = 0.2 + 0.19 * std::abs(number(random));
    x.push_back(at);
    x.push_back(at + gap * along);
    v.push_back(32 * way * along);
    v.push_back(-32 * way * along);
    apart.push_back(along);
  }
  const State state = run(particles(x, v), "self=grid,iterations=1", 1);
  for (std::size_t i = 0; i < apart.size(); ++i)
    EXPECT_GE((state.x[2 * i + 1] - state.x[2 * i]).dot(apart[i]), 0.1 - 1e-12) << i;
}

TEST(SelfCollision, SlowParticlesNeverOverlap) {
  for (double gap = 0.11; gap < 0.3; gap += 0.007) {
    const Vec3 v(0.08, 0, 0);  // an 80th of the diameter per step
    const Scene scene = particles({{0, 0, 0}, {gap, 0, 0}}, {v, -v});
    const SolverChoice choice = parse_solver(listing("precision=double,self=grid"));
    const auto solver = choice.entry->make(scene, choice.params);
    solver->load(scene.start);
    State state;
    for (int n = 0; n < 80; ++n) {
      solver->step(n * scene.dt, scene.dt);
      solver->store(state);
      ASSERT_GE(state.x[1].x() - state.x[0].x(), 0.1 - 1e-12) << "gap " << gap << ", step " << n;
    }
  }
}

/// The upper half of a folded sheet sinks on to the lower half by a 32nd of a diameter per step. It
/// starts beyond the range of the first search; every layout of the particles is tested.
TEST(SelfCollision, AFoldThatClosesSlowlyIsSeenInTime) {
  for (const char* layout : {"layout=interleaved", "layout=batches", "order=mesh"}) {
    Scene scene = hanging_sheet(16, 4, {true, false, false});
    const double spacing = 1.0 / 15, diameter = spacing / 2;
    scene.pins.clear();
    scene.gravity.setZero();
    scene.self_collision = SelfCollision{.radius = diameter / 2};
    for (std::size_t v = 0; v < scene.start.x.size(); ++v)
      if (v % 16 >= 8) {
        scene.start.x[v].x() = static_cast<double>(15 - v % 16) * spacing;
        scene.start.x[v].z() = spacing;
        scene.start.v[v].z() = -spacing;
      }
    const SolverChoice choice =
        parse_solver(std::string("jakobsen:precision=double,substeps=1,") + layout);
    const auto solver = choice.entry->make(scene, choice.params);
    solver->load(scene.start);
    State state;
    double least = spacing;
    for (int n = 0; n < 64; ++n) {
      solver->step(n * scene.dt, scene.dt);
      solver->store(state);
      for (std::size_t v = 0; v < state.x.size(); ++v)
        if (v % 16 < 8) {
          const double gap = (state.x[v + 15 - 2 * (v % 16)] - state.x[v]).norm();
          least = std::min(least, gap);
          ASSERT_TRUE(v % 16 == 7 || gap > diameter * (1 - 1e-6)) << layout << " step " << n;
        }
    }
    EXPECT_LT(least, diameter * 1.01) << layout << ": they met";
  }
}

TEST(SelfCollision, TheOctreeDoesNotSeeAcrossASplitAndTheGridDoes) {
  // Two slow particles meet at the middle of the box spanned by the other particles.
  std::vector<Vec3> x{{-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}};
  for (const double sx : {-1, 1})
    for (const double sy : {-1, 1})
      for (const double sz : {-1, 1}) x.emplace_back(sx, sy, sz);
  std::vector<Vec3> v(x.size(), Vec3::Zero());
  v[0] = {0.1, 0.1, 0.1};
  v[1] = -v[0];
  const Scene scene = particles(x, v);
  const auto gap = [&](const char* params) {
    const State s = run(scene, params, 40);
    return (s.x[1] - s.x[0]).norm();
  };
  EXPECT_GE(gap("self=grid"), 0.1 - 1e-12);
  EXPECT_LT(gap("self=octree"), 0.05);
  EXPECT_EQ(gap("self=octree"), gap("self=off"));
}

/// Sheet at rest whose particles are larger than their spacing.
Scene fat_sheet() {
  Scene scene;
  scene.mesh = make_sheet({.nu = 9, .nv = 9, .width = 0.8, .height = 0.8, .mass = 0.1});
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(81, Vec3::Zero())};
  scene.gravity.setZero();
  scene.self_collision = SelfCollision{.radius = 0.15};  // spacing 0.1 m
  scene.dt = 1.0 / 64;
  return scene;
}

double moved(const Scene& scene, const State& state) {
  double most = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i)
    most = std::max(most, (state.x[i] - scene.start.x[i]).norm());
  return most;
}

TEST(SelfCollision, ALargeRadiusJamsTheOctreeAndNotTheGrid) {
  Scene scene = fat_sheet();
  // particles that overlap at rest do not push each other
  EXPECT_LT(moved(scene, run(scene, "self=grid", 20)), 1e-9);
  scene.gravity = {0, -9.81, 0};
  const double fall = 9.81 / 64 / 64 * 20 * 21 / 2;
  EXPECT_NEAR(moved(scene, run(scene, "self=grid", 20)), fall, 1e-9);
  EXPECT_LT(moved(scene, run(scene, "self=octree", 20)), 1e-3);
}

TEST(SelfCollision, PinsDoNotMove) {
  Scene scene = particles({{-0.2, 0, 0}, {0, 0, 0}}, {{1, 0, 0}, {0, 0, 0}});
  scene.pins = {1};
  for (const char* params : {"self=grid", "self=octree"})
    EXPECT_EQ(run(scene, params, 64).x[1], Vec3::Zero()) << params;
}

TEST(SelfCollision, IsNoPassUnlessTheSceneHasIt) {
  for (const bool present : {false, true}) {
    Scene scene = fat_sheet();
    if (!present) scene.self_collision.reset();
    const SolverChoice choice = parse_solver("jakobsen");
    bool found = false;
    for (const PassCost& cost : choice.entry->make(scene, choice.params)->step_cost())
      found |= cost.pass.starts_with("self-collide");
    EXPECT_EQ(found, present);
  }
}

using Pairs = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

template <class Real>
Points<Real> points(const std::vector<Vec3>& x) {
  Points<Real> p(std::make_shared<const Layout>(Layout::packed(x.size())));
  for (std::size_t i = 0; i < x.size(); ++i) p.set(i, x[i].cast<Real>());
  return p;
}

std::vector<Vec3> anywhere(std::size_t count, double far, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> number(-far, far);
  std::vector<Vec3> x(count);
  for (Vec3& p : x) p = {number(random), number(random), number(random)};
  return x;
}

template <class Real>
Pairs all_within(const Points<Real>& x, std::size_t count, Real reach) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < count; ++a) {
    const typename Points<Real>::Point at = x[a];
    for (std::uint32_t b = a + 1; b < count; ++b)
      if ((x[b] - at).squaredNorm() < reach * reach) pairs.insert({a, b});
  }
  return pairs;
}

/// Clouds of points: everywhere, on a line along each axis, in planes and thick layers, in one
/// cell.
std::vector<std::vector<Vec3>> clouds() {
  std::vector<std::vector<Vec3>> all;
  const std::vector<Vec3> cube = anywhere(400, 2, 1);
  for (const Vec3& size :
       {Vec3(1, 1, 1), Vec3(20, 0, 0), Vec3(0, 20, 0), Vec3(0, 0, 20), Vec3(5, 5, 0), Vec3(0, 5, 5),
        Vec3(0.2, 2, 2), Vec3(2, 0.2, 2), Vec3(2, 2, 0.2), Vec3(0.01, 0.01, 0.01)}) {
    all.emplace_back();
    for (const Vec3& x : cube) all.back().push_back(x.cwiseProduct(size));
  }
  for (Vec3& x : all.emplace_back(cube)) x.z() = x.x() + x.y();
  all.emplace_back(cube)[0] = {1e9, -1e9, 1e9};  // beyond the last cell
  all.emplace_back(1, Vec3::Zero());
  for (const double reach : {0.02, 0.3, 1.0})  // on both sides of the last cell of the grid
    for (const double cells : {1e6, 2e6, 4e6, 1.6e7})
      for (const double side : {-0.25, 0.25}) all.back().emplace_back((cells + side) * reach, 0, 0);
  return all;
}

TEST(NeighbourGrid, AreThoseOfAllPairs) {
  ThreadPool one_thread(1);
  for (const std::vector<Vec3>& cloud : clouds()) {
    const Points<double> x = points<double>(cloud);
    for (const double reach : {0.02, 0.3, 1.0}) {
      const Pairs brute = all_within(x, cloud.size(), reach);
      for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512}) {
        if (!available(simd)) continue;
        Pairs found;
        NeighbourGrid<double>(cloud.size(), one_thread, simd)
            .pairs(x, reach, [&](std::size_t, std::uint32_t a, std::uint32_t b) {
              found.insert(std::minmax(a, b));
            });
        EXPECT_EQ(found, brute) << reach << ' ' << to_string(simd);
      }
    }
  }
}

TEST(NeighbourGrid, MovingPairsAreThoseWithinTheirOwnWay) {
  const std::vector<Vec3> now = anywhere(400, 1, 4);
  std::vector<Vec3> before = now, rest = now;
  const std::vector<Vec3> way = anywhere(800, 0.2, 5);
  for (std::size_t i = 0; i < 400; ++i) {
    before[i] += way[i];
    rest[i] += 4 * way[400 + i];
  }
  const auto x = points<float>(now), previous = points<float>(before),
             at_rest = points<float>(rest);
  const float within = 0.1F, reach = within + 0.4F * std::sqrt(3.0F), ignored = 0.8F;
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512}) {
    if (!available(simd)) continue;
    ThreadPool one_thread(1);
    NeighbourGrid<float> neighbours(400, one_thread, simd);
    neighbours.ignore(at_rest, ignored);
    Pairs found, brute;
    neighbours.moving_pairs(
        x, previous, within, reach,
        [&](std::size_t, std::uint32_t a, std::uint32_t b) { found.insert(std::minmax(a, b)); });
    std::size_t left_out = 0;
    for (std::uint32_t a = 0; a < 400; ++a)
      for (std::uint32_t b = a + 1; b < 400; ++b) {
        const Points<float>::Point gap = x[b] - x[a];
        if (!(gap.norm() < within + (gap - (previous[b] - previous[a])).norm())) continue;
        if ((at_rest[b] - at_rest[a]).norm() >= ignored)
          brute.insert({a, b});
        else
          ++left_out;
      }
    EXPECT_EQ(found, brute) << to_string(simd);
    EXPECT_GT(found.size(), 1000u);
    EXPECT_GT(left_out, 300u);
  }
}

using Lists = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;

template <class Real>
Lists lists_of(NeighbourGrid<Real>& grid, const Points<Real>& x, Real reach) {
  Lists lists(3 * grid.parts());
  grid.pairs(x, reach, [&](std::size_t list, std::uint32_t a, std::uint32_t b) {
    lists[list].emplace_back(a, b);
  });
  return lists;
}

constexpr std::size_t kShared = ThreadPool::kWorthSharing + 1000;

TEST(NeighbourGrid, ListsAreTheSameFromEveryInstructionSet) {
  const Points<float> x = points<float>(anywhere(kShared, 2, 6));
  for (const float reach : {0.4F, 0.1F}) {  // few of the buckets are used, then most of them
    Lists first;
    for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512})
      for (const int threads : {1, 2, 3}) {
        if (!available(simd)) continue;
        ThreadPool pool(threads);
        NeighbourGrid<float> grid(kShared, pool, simd);
        const Lists found = lists_of(grid, x, reach);
        if (first.empty()) first = found;
        EXPECT_GT(found.front().size(), 100u);
        EXPECT_TRUE(found == first) << to_string(simd) << ", threads " << threads;
      }
  }
}

// Clouds: a cube, a plane, a line so long that it wraps around the grid, and a cloud with a tenth
// of its points in a few cells.
TEST(NeighbourGrid, ListsOfPartsApartShareNoParticle) {
  ThreadPool one_thread(1);
  struct Cloud {
    Vec3 size;
    /// side of the cube that holds a tenth of the points, as a share of the side of the rest
    double dense;
  };
  for (const auto& [size, dense] :
       {Cloud{{1, 1, 1}, 1}, {{1e-3, 1, 1}, 1}, {{1e-3, 1e-3, 1e5}, 1}, {{1, 1, 1}, 0.1}}) {
    std::vector<Vec3> cloud = anywhere(kShared, 1, 7);
    for (Vec3& p : cloud) p = p.cwiseProduct(size);
    for (std::size_t i = 0; i < kShared; i += 10) cloud[i] *= dense;
    NeighbourGrid<double> grid(kShared, one_thread);
    const Points<double> x = points<double>(cloud);
    const bool wraps = size.z() > 1;
    const double reach = wraps ? 20 : 0.08;
    const Lists lists = lists_of(grid, x, reach);
    const std::size_t parts = grid.parts();
    ASSERT_GT(parts, 2u);
    std::size_t all = 0;
    for (const auto& list : lists) all += list.size();
    EXPECT_EQ(all, all_within(x, kShared, reach).size());
    const auto at_once = [&](std::size_t first, std::size_t end, std::size_t step) {
      std::set<std::uint32_t> seen;
      std::size_t pairs = 0;
      for (std::size_t n = first; n < end; n += step) {
        std::set<std::uint32_t> own;
        for (const auto& [a, b] : lists[n]) {
          own.insert({a, b});
          ++pairs;
        }
        for (const std::uint32_t i : own) EXPECT_TRUE(seen.insert(i).second) << i;
      }
      return pairs;
    };
    EXPECT_GT(at_once(0, parts, 1), kShared / 2) << "inside parts";
    EXPECT_GT(at_once(parts, 2 * parts, 2), 0u) << "from the even ones to the next";
    EXPECT_GT(at_once(parts + 1, 2 * parts, 2), 0u) << "from the odd ones";
    std::size_t others = 0;
    for (std::size_t n = 2 * parts; n < lists.size(); ++n) others += lists[n].size();
    EXPECT_TRUE(!wraps || others > 0) << "from the last part to the first";
    EXPECT_TRUE(dense == 1 || others > 0) << "across a part of few particles";
    for (std::size_t n = 0; n < parts; ++n)
      EXPECT_LT(lists[n].size() + lists[parts + n].size() + lists[2 * parts + n].size(), all / 4)
          << n;
  }
}

TEST(SelfCollision, CrumpleEndsWithoutSelfIntersectionsByDefault) {
  const auto crossings = [](const char* solver, const char* duration) {
    const Scene scene = load_scene(TAUT_SOURCE_DIR "/experiments/scenes/crumple.toml", {duration});
    return run_case(scene, parse_solver(solver)).record.values.at("self.crossings.peak");
  };
  EXPECT_EQ(crossings("jakobsen", "time.duration=3"), 0);
  EXPECT_GT(crossings("jakobsen:self=off", "time.duration=1"), 100);
}

// Links that pull within a step bring together particles that were apart when the pairs were
// searched. The search has to allow for the distance that each particle has moved.
TEST(SelfCollision, ParticlesPulledTogetherFastStayApart) {
  // Pairs are searched up to 3/2 diameters plus the distance moved.
  for (const auto& [mass, far] : {std::pair(1.0, 0.2), {4.0, 0.2}, {1.0, 0.24}, {4.0, 0.24}}) {
    Scene scene = particles({{0, 0, 0}, {far, -0.05, 0}, {-0.5, 0.05, 0}},
                            // moves 0.1 m a step, to (far, 0.05)
                            {{0, 0, 0}, {0, 6.4, 0}, {0, 0, 0}});
    scene.mesh.mass[0] = mass;
    scene.pins = {2};
    scene.links = {{1, 2, 0.55}};  // pulls to x = 0.05, inside the first particle
    const State state = run(scene, "self=grid,iterations=1,projection=exact", 1);
    EXPECT_NEAR((state.x[1] - state.x[0]).norm(), 0.1, 1e-12);
    const Vec3 a = state.x[0], b = state.x[1] - Vec3(0.05, 0.05, 0);
    EXPECT_LT((mass * a + b).norm(), 1e-12) << "each by its share";
    EXPECT_LT(run(scene, "self=off,iterations=1,projection=exact", 1).x[1].norm(), 0.08);
  }
}

// Slow and fast pairs far from each other move for ten steps. No pair comes closer than a diameter,
// each pair keeps its centre of mass in uniform motion, and pairs that never meet are not touched.
TEST(SelfCollision, PairsOfEverySpeedMeetAndPart) {
  std::mt19937 random(11);
  std::uniform_real_distribution<> number(-1, 1);
  for (const double fastest : {0.1, 1.0, 8.0}) {
    std::vector<Vec3> x, v;
    for (int i = 0; i < 60; ++i) {
      const Vec3 at(7 * (i % 8), 7 * (i / 8), 0);
      const Vec3 apart = Vec3(number(random), number(random), number(random)).normalized();
      x.push_back(at);
      x.push_back(at + (0.1 + 0.2 * std::abs(number(random))) * apart);
      for (int end : {0, 1})
        v.push_back(fastest * (Vec3(number(random), number(random), number(random)) +
                               (end == 0 ? 1 : -1) * apart));
    }
    Scene scene = particles(x, v);
    for (std::size_t i = 0; i < x.size(); i += 2) scene.mesh.mass[i] = 3;
    int met = 0;
    for (int steps = 1; steps <= 10; ++steps) {
      const State state = run(scene, "self=grid", steps), free = run(scene, "self=off", steps);
      for (std::size_t i = 0; i < x.size(); i += 2) {
        ASSERT_GE((state.x[i + 1] - state.x[i]).norm(), 0.1 - 1e-12) << i << " step " << steps;
        EXPECT_LT((3 * state.x[i] + state.x[i + 1] - 3 * free.x[i] - free.x[i + 1]).norm(), 1e-11);
        met += (state.x[i] - free.x[i]).norm() > 1e-9;
      }
    }
    EXPECT_GT(met, 50) << fastest;
    EXPECT_LT(met, 550) << fastest;
  }
}

}  // namespace
}  // namespace taut::self_collision_test
