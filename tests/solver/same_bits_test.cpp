// The result does not depend on the instruction set, the number of threads, or the layout.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "core/model/body_frames.hpp"
#include "core/solver/layout/colour_batches.hpp"
#include "core/solver/layout/interleaved_sheet.hpp"
#include "core/solver/simd/kernels_impl.hpp"
#include "core/solver/thread_pool.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"

namespace taut::same_bits_test {
namespace {

#ifdef TAUT_SANITIZED
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

struct Case {
  int nu, nv;
  Lumping lumping;
  bool sanitized = true;  ///< also run with sanitizers, which take ten times as long
};

/// Sheets of awkward sizes, and one mesh that is not a grid.
std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const auto& [nu, nv, lumping, sanitized] : {Case{2, 2, Lumping::area},
                                                   {3, 5, Lumping::equal},
                                                   {31, 33, Lumping::area, false},
                                                   {65, 7, Lumping::area},
                                                   {68, 5, Lumping::equal, false},
                                                   {17, 40, Lumping::equal, false},
                                                   {24, 9, Lumping::area},
                                                   {7, 66, Lumping::area, false},
                                                   {16, 21, Lumping::equal},
                                                   {12, 10, Lumping::area}}) {
    if (kSanitized && !sanitized) continue;
    Scene scene = crumpled(hanging_sheet(nu, nv, {true, true, true}, lumping), 0.3 / nu);
    scene.damping = 0.3;
    all.push_back(std::move(scene));
  }
  Scene& irregular = all.emplace_back(crumpled(hanging_sheet(30, 30), 0.01));
  irregular.mesh.grid.reset();
  std::erase_if(irregular.links, [](const Link& l) { return (l.a * 7 + l.b) % 5 == 0; });
  for (Link& link : irregular.links) link.rest *= 1 + 0.01 * (link.a % 7);
  return all;
}

bool same_bits(const State& a, const State& b) {
  const auto same = [](const std::vector<Vec3>& p, const std::vector<Vec3>& q) {
    return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) == 0;
  };
  return same(a.x, b.x) && same(a.v, b.v);
}

/// Expects that `method` with each of these parameters computes the bits of `reference`.
void expect_same(const Scene& scene, const std::string& method, const std::string& reference,
                 int steps, const std::vector<std::string>& parameters) {
  const State want = simulate(scene, reference, steps);
  for (const std::string& more : parameters)
    EXPECT_TRUE(same_bits(simulate(scene, method + more, steps), want)) << method << more;
}

std::vector<std::string> in_threads(const std::vector<int>& numbers) {
  std::vector<std::string> all;
  for (const int n : numbers) all.push_back(",threads=" + std::to_string(n));
  return all;
}

void expect_same_in_threads(const Scene& scene, const std::string& method, int steps,
                            const std::vector<int>& threads) {
  expect_same(scene, method, method, steps, in_threads(threads));
}

/// Expects that every instruction set of this machine, with each of these numbers of threads,
/// computes the bits of the scalar path in one thread.
void expect_same_everywhere(const Scene& scene, const std::string& method, int steps,
                            const std::vector<int>& threads = {}) {
  std::vector<std::string> parameters = in_threads(threads);
  for (const Simd simd : {Simd::sse2, Simd::avx2, Simd::avx512})
    if (available(simd)) parameters.push_back(",simd=" + std::string(to_string(simd)));
  expect_same(scene, method, method + ",simd=scalar", steps, parameters);
}

TEST(SameBits, ForEveryInstructionSetAndNumberOfThreads) {
  for (const Scene& scene : scenes())
    for (const char* precision : {"float", "double"})
      for (const char* projection : {"exact", "sqrt-free"})
        for (const char* layout : {"auto", "batches"}) {
          const std::string method =
              std::string("jakobsen:order=coloured,substeps=2,iterations=3,precision=") +
              precision + ",projection=" + projection + ",layout=" + layout;
          expect_same_everywhere(scene, method, 5, {2, 5});
        }
}

TEST(SameBits, OfWindEverywhere) {
  for (Scene& scene : scenes()) {
    scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2};
    for (const char* precision : {"float", "double"})
      for (const char* layout : {"auto", "batches"}) {
        const std::string method =
            std::string("jakobsen:iterations=2,precision=") + precision + ",layout=" + layout;
        expect_same_everywhere(scene, method, 5, {2});
      }
  }
}

TEST(SameBits, OfTethersForEveryInstructionSet) {
  for (const Scene& scene : scenes())
    for (const char* projection : {"exact", "sqrt-free"})
      for (const char* layout : {"auto", "batches"}) {
        const std::string method = std::string("jakobsen:iterations=2,tethers=on,layout=") +
                                   layout + ",projection=" + projection;
        expect_same_everywhere(scene, method, 20);
      }
}

/// Growing torus of triangles.
Collider growing(const Vec3& center) {
  const Triangles body = torus(0.15, 0.06, 12, 8);
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 20;
  for (int k = 0; k < 9; ++k) {
    auto& x = frames->places.emplace_back(body.vertices);
    for (Vec3& p : x) p = (1 + 0.1 * k) * p + 0.02 * k * Vec3(p.y(), 1, p.x());
  }
  return {.shape = MeshBody{body.mesh(), center}, .friction = 0.3, .frames = frames};
}

/// Plane, balls, a capsule, and a turned box and tori of triangles that rise, spin and grow, in the
/// path of the falling sheet.
std::vector<Collider> obstacles(const Scene& scene) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : scene.start.x) middle += x / static_cast<double>(scene.start.x.size());
  Box box{middle + Vec3(0.3, -0.1, 0), {0.2, 0.1, 0.15}};
  box.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized());
  Motion motion;
  motion.velocity = {0, 2, 0};
  motion.spin = {0, 3, 1};
  motion.pivot = box.center;
  return {Collider{Plane{Vec3(1, 2, 2) / 3, Vec3(1, 2, 2).dot(middle) / 3 - 0.3}, {}, 0.5},
          Collider{Ball{middle + Vec3(-0.2, 0.1, 0), 0.2}, {}, 0.3},
          Collider{box, motion, 0.8},
          Collider{Ball{middle + Vec3(0, -0.3, 0), 0.15}, motion, 0},
          Collider{Capsule{middle + Vec3(-0.3, -0.2, 0.1), middle + Vec3(0.1, -0.1, -0.1), 0.1},
                   motion, 0.2},
          Collider{MeshBody{torus(0.2, 0.08, 12, 8).mesh(), middle + Vec3(0.1, -0.2, -0.2)}, motion,
                   0.2},
          growing(middle + Vec3(-0.1, -0.1, -0.2))};
}

TEST(SameBits, OfContactForEveryInstructionSetAndLayout) {
  for (Scene& scene : scenes()) {
    scene.colliders = obstacles(scene);
    scene.thickness = 0.002;
    scene.self_collision = SelfCollision{.radius = 0.02};
    for (const char* precision : {"float", "double"})
      for (const char* contact : {"continuous", "discrete", "after", "freeze", "halt"}) {
        const std::string method = std::string("jakobsen:substeps=1,iterations=3,contact=") +
                                   contact + ",precision=" + precision;
        for (const char* order : {",order=mesh", ",order=coloured"}) {
          expect_same_everywhere(scene, method + order, 8);
        }
      }
  }
}

TEST(SameBits, OfWindAndContactThatThreadsShare) {
  Scene scene = crumpled(hanging_sheet(92, 90), 0.005);
  for (int row = 0; row < 80; ++row) scene.pins.push_back(92 * row + 40);
  PinMotion& moved = scene.pin_motions.emplace_back();
  moved.motion.velocity = {0.5, 1, 0};
  for (int row = 40; row < 80; ++row) moved.vertices.push_back(92 * row + 40);
  ASSERT_GE(scene.start.x.size(), ThreadPool::kWorthSharing);
  scene.colliders = obstacles(scene);
  scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2};
  for (const char* layout : {"auto", "batches"}) {
    const std::string method = std::string("jakobsen:iterations=2,layout=") + layout;
    const State want = simulate(scene, method, 4);
    for (const char* threads : {",threads=2", ",threads=3"})
      EXPECT_TRUE(same_bits(simulate(scene, method + threads, 4), want)) << method << threads;
  }
}

/// Adds every effect that a sweep over vertices supports: bending, contact, wind and moving pins.
Scene with_everything(Scene scene) {
  scene.colliders = obstacles(scene);
  scene.thickness = 0.002;
  scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2};
  scene.bending = Bending{.warp = 1e-4, .weft = 3e-4};
  PinMotion& moved = scene.pin_motions.emplace_back();
  moved.motion.velocity = {0.5, 1, 0};
  moved.vertices = {scene.pins.back()};
  return scene;
}

TEST(SameBits, OfVertexSweepsForEveryInstructionSet) {
  for (const Scene& plain : scenes())
    for (const bool everything : {false, true})
      for (const char* solver :
           {"vbd:iterations=3,damping=1e-3,chebyshev=0.5", "vbd:iterations=3,order=mesh",
            "avbd:iterations=3,beta=1000,substeps=2", "avbd:iterations=2,order=mesh"})
        for (const char* precision : {",precision=float", ",precision=double"}) {
          const Scene scene = everything ? with_everything(plain) : plain;
          const std::string method = std::string(solver) + precision;
          expect_same_everywhere(scene, method, 3);
        }
}

TEST(SameBits, OfForcesAndGlobalSystemsEverywhere) {
  for (const Scene& plain : scenes())
    for (const bool everything : {false, true})
      for (const char* solver :
           {"pd:iterations=3,chebyshev=0.5", "pd:iterations=3,anderson=2",
            "admm:iterations=3,multipliers=keep", "admm:iterations=2,links=elastic,substeps=2",
            "mass-spring:substeps=3,drag=0.01", "mass-spring:substeps=3,drag=0.01,drag-at=central",
            "implicit:iterations=3"})
        for (const char* precision : {",precision=float", ",precision=double"}) {
          const bool no_choice = std::string_view(solver).starts_with("implicit");
          if (no_choice && std::string_view(precision).ends_with("float")) continue;
          const Scene scene = everything ? with_everything(plain) : plain;
          const std::string method = solver + std::string(no_choice ? "" : precision);
          expect_same_everywhere(scene, method, 3);
        }
}

TEST(SameBits, OfForcesThatThreadsShare) {
  const Scene plain = crumpled(hanging_sheet(60, 50), 0.002);
  for (const bool everything : {false, true}) {
    if (kSanitized && !everything) continue;
    for (const char* solver : {"pd:iterations=2", "admm:iterations=2", "mass-spring:substeps=4"})
      for (const char* precision : {",precision=float", ",precision=double"}) {
        const Scene scene = everything ? with_everything(plain) : plain;
        const std::string method = std::string(solver) + precision;
        expect_same_in_threads(scene, method, 2, {2, 3});
      }
  }
}

TEST(SameBits, OfVertexSweepsThatThreadsShare) {
  const Scene plain = crumpled(hanging_sheet(160, 150), 0.002);  // large colours, also with bending
  for (const bool everything : {false, true}) {
    if (kSanitized && !everything) continue;
    for (const char* solver : {"vbd:iterations=2", "avbd:iterations=2"})
      for (const char* precision : {",precision=float", ",precision=double"}) {
        const Scene scene = everything ? with_everything(plain) : plain;
        const std::string method = std::string(solver) + precision;
        expect_same_in_threads(scene, method, 2, {2, 3});
      }
  }
}

TEST(SameBits, OfSelfCollisionThatThreadsShare) {
  // Without shear links diagonal neighbours are close at rest, so that lists of two searches are
  // swept.
  Scene scene = crumpled(hanging_sheet(92, 90, {true, false, true}), 0.005);
  const double middle = (scene.start.x.front().y() + scene.start.x.back().y()) / 2;
  for (Vec3& x : scene.start.x)  // folded
    if (x.y() < middle) x = {x.x(), 2 * middle - x.y(), x.z() + 0.01};
  scene.self_collision = SelfCollision{.radius = 0.008};
  for (const char* layout : {"auto", "batches"})
    // searched once per step, and once for several substeps
    for (const char* substeps : {"1", "15"}) {
      const std::string method =
          std::string("jakobsen:iterations=2,layout=") + layout + ",substeps=" + substeps;
      const State want = simulate(scene, method, 4);
      EXPECT_FALSE(same_bits(simulate(scene, method + ",self=off", 4), want)) << method;
      for (const char* threads : {",threads=2", ",threads=3"})
        EXPECT_TRUE(same_bits(simulate(scene, method + threads, 4), want)) << method << threads;
    }
}

/// Runs the scene with its links in the given order through the generic path, one link at a time.
State one_by_one(Scene scene, std::vector<Link> order, const std::string& more) {
  scene.links = std::move(order);
  return simulate(scene, listing("iterations=4,simd=scalar," + more), 20);
}

/// The links in the order in which the sweep visits them.
template <class Real>
std::vector<Link> order_of(const RegularLinks& regular, const InterleavedSheet<Real>& sheet) {
  const SheetSides& grid = regular.grid;
  const SheetSweep<Real>& sweep = sheet.sweep();
  std::vector<Link> links;
  for (const int parity : {0, 1})
    for (int begin = parity * kBlockRows; begin < grid.rows; begin += 2 * kBlockRows)
      visit_directions(sweep, [&](auto columns, auto rows, const SheetDirection<Real>& d) {
        const Family family =
            regular.directions[static_cast<std::size_t>(&d - sweep.direction)].family;
        visit_direction<columns, rows>(
            sweep.vectors, begin, std::min(begin + kBlockRows, d.rows),
            [&](int j, auto, const auto& vectors) {
              vectors([&](int k) {
                for (int lane = 0; lane < sweep.lanes; ++lane)
                  if (const int i = lane * sweep.vectors + k; i + d.columns < grid.columns)
                    links.push_back({grid.index(i, j + d.left),
                                     grid.index(i + d.columns, j + d.right),
                                     static_cast<double>(d.rest), family});
              });
            });
      });
  return links;
}

TEST(SameBits, InterleavedSheetsAreTheGenericPath) {
  for (const auto& [nu, nv] : {std::pair{31, 33},
                               {65, 7},
                               {17, 40},
                               {24, 9},
                               {64, 9},
                               {130, 21},
                               {9, 24},
                               {16, 65},
                               {2, 17},
                               {16, 16},
                               {11, 9},
                               {8, 20},
                               {5, 12}})
    for (const LinkChoice& families : {LinkChoice{true, true, true}, LinkChoice{true, false, true},
                                       LinkChoice{true, true, false}}) {
      Scene scene = crumpled(hanging_sheet(nu, nv, families), 0.3 / nu);
      const std::vector<double> w = inverse_masses(scene);
      const auto links = regular_links(scene.mesh, scene.links);
      ASSERT_TRUE(links);
      const auto compare = [&]<class Real>(const InterleavedSheet<Real>& sheet,
                                           const std::string& more) {
        const std::vector<Link> order = order_of(*links, sheet);
        EXPECT_EQ(order.size(), scene.links.size());
        const State interleaved =
            simulate(scene, listing("order=coloured,layout=interleaved,iterations=4,") + more, 20);
        EXPECT_TRUE(same_bits(one_by_one(scene, order, more), interleaved))
            << scene.mesh.grid->nu << more;
      };
      compare(InterleavedSheet<float>(*links, w, 1), "precision=float");
      compare(InterleavedSheet<double>(*links, w, 1), "precision=double,projection=exact");
    }
}

/// Mesh of 90 000 vertices that is not a grid, with scrambled numbers: it has many tiles, and 16
/// bits cannot tell the ends of all links apart.
Scene shuffled_mesh() {
  const int side = 300, n = side * side;
  Scene scene = hanging_sheet(side, side, {true, false, false});
  scene.mesh.grid.reset();
  const auto renamed = [&](int v) { return (v * 7919 + 13) % n; };  // 7919 and n share no factor
  const Scene plain = scene;
  for (int v = 0; v < n; ++v) {
    const auto from = static_cast<std::size_t>(v), to = static_cast<std::size_t>(renamed(v));
    scene.mesh.rest[to] = plain.mesh.rest[from];
    scene.mesh.mass[to] = plain.mesh.mass[from];
  }
  scene.start.x = scene.mesh.rest;
  for (Link& link : scene.links) {
    link.a = renamed(link.a);
    link.b = renamed(link.b);
  }
  for (Triangle& face : scene.mesh.triangles)
    for (int& v : face) v = renamed(v);
  scene.pins = {renamed(0), renamed(side - 1)};
  std::sort(scene.pins.begin(), scene.pins.end());
  // A seam from the first tile to the last, between the lower left and the upper right corner.
  for (int i = 0; i < 50; ++i)
    scene.links.push_back({renamed(n - side + i), renamed(side - 1 - i), 1.4});
  return crumpled(scene, 0.001);
}

TEST(SameBits, AnyMeshWithFarLinksIsTheGenericPath) {
  const Scene scene = shuffled_mesh();
  const std::vector<double> w = inverse_masses(scene);
  const Layout layout = Layout::packed(scene.start.x.size(), tile_ranks(scene.mesh));
  const ColourBatches<float> batches(colour(scene.links, scene.mesh), w, 1, layout);
  std::vector<Link> order;
  for (const DistanceConstraint<float>& c : batches.order(layout))
    order.push_back({c.a, c.b, static_cast<double>(c.rest), Family::structural});
  const auto ends = [](const std::vector<Link>& links) {
    std::vector<std::pair<int, int>> all;
    for (const Link& link : links) all.emplace_back(link.a, link.b);
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(ends(order), ends(scene.links));
  std::size_t near = 0, far = 0;
  for (std::size_t phase = 0; phase < batches.phases(); ++phase)
    for (std::size_t tile = 0; tile < batches.parts(phase); ++tile)
      for (const BatchRun<float>& run : batches.runs(phase, tile))
        (run.near ? near : far) += run.count;
  EXPECT_GT(near, 10 * far) << "neighbours lie beside each other, whatever they are called";
  EXPECT_GT(far, 5u);
  const std::string method = listing("order=coloured,iterations=2");
  const State want = simulate(scene, method, 2);
  Scene in_order = scene;
  in_order.links = order;
  EXPECT_TRUE(same_bits(simulate(in_order, listing("iterations=2"), 2), want));
  EXPECT_TRUE(same_bits(simulate(scene, method + ",simd=scalar", 2), want));
  EXPECT_TRUE(same_bits(simulate(scene, method + ",threads=2", 2), want));
}

TEST(SameBits, BatchesAreTheGenericPathInTheirOrder) {
  for (const Scene& scene : scenes()) {
    const std::vector<double> w = inverse_masses(scene);
    const Layout layout = Layout::packed(scene.start.x.size(), tile_ranks(scene.mesh));
    const ColourBatches<double> batches(colour(scene.links, scene.mesh), w, 1, layout);
    std::vector<Link> order;
    for (const DistanceConstraint<double>& c : batches.order(layout))
      order.push_back({c.a, c.b, c.rest, Family::structural});
    const State result =
        simulate(scene, listing("order=coloured,layout=batches,iterations=4,precision=double"), 20);
    EXPECT_TRUE(same_bits(one_by_one(scene, order, "precision=double"), result));
  }
}

TEST(SameBits, NarrowAndIncompleteSheetsAreNotInterleaved) {
  for (const auto& [nu, nv] : {std::pair{7, 7}, {1, 40}}) {
    const Scene narrow = hanging_sheet(nu, nv);
    EXPECT_FALSE(regular_links(narrow.mesh, narrow.links));
  }
  Scene cut = hanging_sheet(20, 20);
  EXPECT_TRUE(regular_links(cut.mesh, cut.links));
  cut.links.pop_back();
  EXPECT_FALSE(regular_links(cut.mesh, cut.links));
  cut = hanging_sheet(20, 20);
  cut.links.back() = cut.links[cut.links.size() - 2];
  EXPECT_FALSE(regular_links(cut.mesh, cut.links)) << "a duplicate";
  cut = hanging_sheet(20, 20);
  cut.links.back().rest *= 1.001;
  EXPECT_FALSE(regular_links(cut.mesh, cut.links));
}

// With a tiny compliance, multipliers are below the rounding error of the lengths that they are
// added to. Kernels with multipliers then compute the bits of those without. With a compliance that
// matters, all instruction sets, layouts and numbers of threads agree.
TEST(SameBits, XpbdIsTheExactProjectionWithoutCompliance) {
  for (const Scene& scene : scenes())
    for (const char* precision : {",precision=float", ",precision=double"})
      for (const char* order : {",order=mesh", ",order=jolt", ",order=coloured",
                                ",order=coloured,layout=batches", ",order=coloured,threads=2"}) {
        const std::string common = std::string("substeps=2,iterations=3") + precision + order;
        const State want = simulate(scene, "jakobsen:projection=exact," + common, 8);
        EXPECT_TRUE(same_bits(simulate(scene, "xpbd:" + common, 8), want)) << common;
        EXPECT_TRUE(same_bits(
            simulate(scene, "xpbd:structural=1e-25,shear=1e-25,bend=1e-25," + common, 8), want))
            << common;
      }
}

TEST(SameBits, OfCompliantLinksEverywhere) {
  std::vector<Scene> all = scenes();
  all.push_back(crumpled(hanging_sheet(92, 90), 0.005));
  for (const Scene& scene : all)
    for (const char* precision : {"float", "double"})
      for (const char* more : {"", ",layout=batches", ",multipliers=reset"}) {
        std::string method = "xpbd:structural=1e-4,bend=0.01,substeps=2,iterations=3,precision=";
        method += precision;
        method += more;
        expect_same_everywhere(scene, method, 4, {3});
      }
}

/// Compliant links of a sheet, taken one by one in the order of its sweep, give the same as in mesh
/// order.
TEST(SameBits, CompliantSheetsAreTheGenericPathInTheirOrder) {
  for (const auto& [nu, nv] : {std::pair{31, 33}, {65, 7}, {24, 9}, {9, 24}, {16, 11}, {5, 8}}) {
    const Scene scene = crumpled(hanging_sheet(nu, nv, {true, true, true}), 0.3 / nu);
    const auto links = regular_links(scene.mesh, scene.links);
    ASSERT_TRUE(links);
    Scene in_order = scene;
    in_order.links = order_of(*links, InterleavedSheet<double>(*links, inverse_masses(scene), 1));
    for (const char* sweeps : {"1", "4"}) {
      const std::string method =
          std::string("xpbd:structural=1e-4,shear=1e-3,bend=0.01,iterations=") + sweeps +
          ",precision=double,order=";
      EXPECT_TRUE(same_bits(simulate(in_order, method + "mesh", 20),
                            simulate(scene, method + "coloured", 20)))
          << nu;
    }
  }
}

/// FNV-1a hash of the positions' bits.
std::uint64_t hash(const State& state) {
  std::uint64_t value = 14695981039346656037u;
  const auto* bytes = reinterpret_cast<const unsigned char*>(state.x.data());
  for (std::size_t i = 0; i < state.x.size() * sizeof state.x[0]; ++i)
    value = (value ^ bytes[i]) * 1099511628211u;
  return value;
}

// Recorded once: g++, clang++ and every instruction set have to compute these numbers, now and
// later.
TEST(SameBits, AsRecorded) {
  const Scene scene = crumpled(hanging_sheet(31, 33), 0.01);
  const auto run = [&](const std::string& solver) { return hash(simulate(scene, solver, 32)); };
  EXPECT_EQ(run(listing()), 17873402768262654844u);
  EXPECT_EQ(run(listing("order=coloured")), 3464990680418230354u);
  EXPECT_EQ(run(listing("order=coloured,projection=exact,precision=double")), 4745603385666999776u);
  EXPECT_EQ(run(listing("order=coloured,layout=batches")), 9924528306655619327u);
  EXPECT_EQ(run(listing("order=coloured,layout=batches,projection=exact,precision=double")),
            7898678465999565491u);
  EXPECT_EQ(run(listing("method=jacobi-averaged")), 1211506826981364154u);
  // Three vectors per row and five; eight lanes and sixteen. The end of a strip shares a particle
  // with the strip before it.
  for (const auto& [nu, nv, want] : {std::tuple{17, 41, std::uint64_t{72121683038813057u}},
                                     {33, 40, std::uint64_t{7369157318980948830u}},
                                     {65, 9, std::uint64_t{1729169306995266907u}}})
    EXPECT_EQ(hash(simulate(crumpled(hanging_sheet(nu, nv), 0.1 / nu),
                            listing("order=coloured,layout=interleaved"), 32)),
              want)
        << nu;
}

/// Each end of a link counts as loaded, changed and stored once, the measure of traffic of the
/// benchmark.
template <class Real>
void expect_both_ends_stored(Simd simd) {
  NearBatch<Real> batch{};
  std::vector<Real> x(4 * 2 * kLanes);
  for (std::size_t l = 0; l < kLanes; ++l) {
    batch.a[l] = static_cast<std::uint16_t>((5 * l) % kLanes);
    batch.b[l] = static_cast<std::uint16_t>(kLanes + (3 * l) % kLanes);
  }
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<Real>(i);
  BatchRun<Real> run{};
  run.near = &batch;
  run.count = 1;
  kernels<Real>(simd).load_and_store(run, x.data());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (i % 4 != 3) {
      EXPECT_NEAR(x[i] - static_cast<Real>(i), i < x.size() / 2 ? 0.001 : -0.001, 1e-5) << i;
    }
}

TEST(SameBits, LoadingAndStoringMovesBothEndsOfEachLink) {
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512})
    if (available(simd)) {
      SCOPED_TRACE(to_string(simd));
      expect_both_ends_stored<float>(simd);
      expect_both_ends_stored<double>(simd);
    }
}

}  // namespace
}  // namespace taut::same_bits_test
