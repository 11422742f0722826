// The plan that a solver reports for its steps: which passes, over which items, how often, with how
// much memory, and the end of each substep.
#include <gtest/gtest.h>
#include <malloc.h>

#include <map>

#include "core/model/index.hpp"
#include "tests/support/cloths.hpp"

namespace taut::plan_test {
namespace {

std::unique_ptr<Solver> make(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  return choice.entry->make(scene, choice.params);
}

TEST(Plan, SubstepsEndAtEvenTimesWhereShorterStepsEnd) {
  Scene scene = hanging_sheet(6, 5);
  scene.pin_motions = {{{5}, {.velocity = {-0.5, 0.2, 0.1}}}};
  Scene fine = scene;
  fine.dt = scene.dt / 4;
  for (const std::string solver : {"jakobsen:precision=double", "xpbd:precision=double",
                                   "mass-spring:precision=double", "bullet", "bullet-deformable"}) {
    const auto coarse =
                   make(scene, solver + (solver.ends_with("double") ? "," : ":") + "substeps=4"),
               steps = make(fine, solver + (solver.ends_with("double") ? "," : ":") + "substeps=1");
    std::vector<double> times;
    std::vector<State> states;
    coarse->visit_substeps([&](double t) {
      times.push_back(t);
      coarse->store(states.emplace_back());
    });
    coarse->load(scene.start);
    steps->load(fine.start);
    State state;
    for (int n = 0; n < 3; ++n) {
      times.clear();
      states.clear();
      coarse->step(n * scene.dt, scene.dt);
      coarse->store(states.emplace_back());
      ASSERT_EQ(times.size(), 3u) << solver << ": of each substep but the last";
      for (std::size_t k = 0; k < 4; ++k) {
        if (k < 3) {
          EXPECT_NEAR(times[k], (n + (static_cast<double>(k) + 1) / 4) * scene.dt, 1e-15) << solver;
        }
        steps->step(n * scene.dt + static_cast<double>(k) * fine.dt, fine.dt);
        steps->store(state);
        EXPECT_LT(largest_distance(states[k].x, state.x), 1e-12) << solver << ' ' << n << ' ' << k;
      }
    }
  }
}

/// Cost of each pass by its name; passes such as "collide ball" are listed by their first word.
std::map<std::string, PassCost> plan(const Scene& scene, const std::string& solver) {
  const auto made = make(scene, solver);
  made->load(scene.start);
  made->step(0, scene.dt);
  std::map<std::string, PassCost> lines;
  for (const PassCost& line : made->step_cost()) lines[line.pass] = line;
  return lines;
}

TEST(Plan, EveryPassVisitsItemsAsOftenAsAsked) {
  Scene scene = hanging_sheet(20, 7);
  scene.pins = {0, 1, 19};
  scene.wind = Wind{.velocity = {1, 0, 0}, .strength = 0.1};
  scene.colliders = {{.shape = Ball{{0.5, -9, 0}, 0.1}}};
  std::map<Family, std::size_t> links;
  for (const Link& l : scene.links)
    links[l.family] += !(is_pinned(scene, l.a) && is_pinned(scene, l.b));
  const auto expect = [&](const std::map<std::string, PassCost>& lines, const std::string& pass,
                          std::size_t items, std::size_t repeats, bool projections = false) {
    ASSERT_TRUE(lines.contains(pass)) << pass;
    EXPECT_EQ(lines.at(pass).items, items) << pass;
    EXPECT_EQ(lines.at(pass).repeats, repeats) << pass;
    EXPECT_EQ(lines.at(pass).projections, projections) << pass;
  };
  const std::size_t faces = scene.mesh.triangles.size(),
                    all = links[Family::structural] + links[Family::shear] + links[Family::bend];
  for (const std::string order : {"mesh", "coloured,layout=interleaved", "coloured,layout=batches",
                                  "mesh,method=jacobi-averaged"}) {
    const std::string solver = "jakobsen:iterations=4,substeps=3,order=" + order;
    for (const auto& [contact, repeats] :
         {std::pair{"continuous", 12u}, {"discrete", 12u}, {"before", 3u}, {"after", 3u}}) {
      const auto lines = plan(scene, solver + ",tethers=on,contact=" + contact);
      expect(lines, "wind", faces, 3);
      expect(lines, "verlet", 140, 3);
      expect(lines, "pins", 3, 3);
      expect(lines, "structural", links[Family::structural], 12, true);
      expect(lines, "shear", links[Family::shear], 12, true);
      expect(lines, "bend", links[Family::bend], 12, true);
      expect(lines, "tethers", 2 * 137, 12, true);
      expect(lines, "collide ball", 140, repeats);
    }
    EXPECT_EQ(projections_per_step(*make(scene, solver)), all * 12);
  }
  auto lines = plan(scene, "xpbd:iterations=4,substeps=3");
  expect(lines, "wind", faces, 3);
  expect(lines, "verlet", 140, 3);
  expect(lines, "structural", links[Family::structural], 12, true);
  expect(lines, "shear", links[Family::shear], 12, true);
  expect(lines, "bend", links[Family::bend], 12, true);
  expect(lines, "collide ball", 140, 12);
  lines = plan(scene, "bullet:iterations=4,substeps=3");
  expect(lines, "wind", faces, 3);
  expect(lines, "predict and update tree", 140, 3);
  expect(lines, "detect contacts", 140, 3);
  expect(lines, "links", all, 12, true);
  expect(lines, "normals", faces, 3);
  lines = plan(scene, "mass-spring:substeps=3,shear=0");
  expect(lines, "wind", faces, 3);
  expect(lines, "verlet", 140, 3);
  expect(lines, "collide ball", 140, 3);
  expect(lines, "structural springs", links[Family::structural], 3);
  expect(lines, "bend springs", links[Family::bend], 3);
  EXPECT_FALSE(lines.contains("shear springs"));
  scene.links.clear();
  scene.wind.reset();
  scene.pins.clear();
  scene.colliders.clear();
  for (const char* solver : {"jakobsen", "xpbd", "mass-spring", "bullet:faces=off"})
    EXPECT_EQ(plan(scene, solver).size(), 1u) << solver << ": there is nothing but motion";
}

TEST(Plan, ContactOfFacesAndOfSolidsHasItsLines) {
  Scene scene = hanging_sheet(20, 7);
  scene.colliders = {{.shape = Ball{{0.5, -9, 0}, 0.1}}, {.shape = Box{{0, -9, 0}, {1, 2, 3}}}};
  scene.self_collision = SelfCollision{.radius = 0.001};
  const std::size_t faces = scene.mesh.triangles.size(), links = scene.links.size();
  const auto visits = [&](const std::string& solver, const std::string& pass) {
    const auto lines = plan(scene, solver);
    const auto line = lines.find(pass);
    if (line == lines.end()) return std::pair<std::size_t, std::size_t>();
    EXPECT_EQ(line->second.projections, pass.starts_with("links")) << pass;
    return std::pair(line->second.items, line->second.repeats);
  };
  const std::string sweeps = "iterations=4,substeps=3";
  const auto times = [](std::size_t items, std::size_t repeats) {
    return std::pair(items, repeats);
  };
  EXPECT_EQ(visits("jakobsen:self=octree," + sweeps, "self-collide octree"), times(140, 12));
  EXPECT_EQ(visits("jakobsen:self=grid," + sweeps, "self-collide").second, 12u);
  EXPECT_EQ(visits("jakobsen:faces=on," + sweeps, "faces on ball"), times(faces, 12));
  EXPECT_EQ(visits("jakobsen:faces=on," + sweeps, "faces on box"), times(faces, 12));
  EXPECT_EQ(visits("jakobsen:contact=freeze," + sweeps, "freeze ball"), times(140, 12));
  EXPECT_EQ(visits("jakobsen:contact=halt," + sweeps, "halt box"), times(140, 3));
  EXPECT_EQ(visits("bullet:" + sweeps, "detect contacts"), times(280, 3));
  EXPECT_EQ(visits("bullet:" + sweeps, "contacts"), times(0, 12)) << "none is near";
  EXPECT_EQ(visits("bullet:reorder=on," + sweeps, "links, reordered").second, 12u);
  EXPECT_EQ(visits("bullet-deformable:newton=2,substeps=3", "springs (Newton steps)"),
            times(links, 6));
  const auto bytes = [&](std::size_t balls) {
    scene.colliders.assign(balls, {.shape = Ball{{0.5, -9, 0}, 0.1}});
    return plan(scene, "bullet")["detect contacts"].bytes;
  };
  EXPECT_EQ(bytes(3) - bytes(2), bytes(2) - bytes(1)) << "a body and a shape each";
  EXPECT_GT(bytes(2) - bytes(1), 500u);
  EXPECT_LT(bytes(2) - bytes(1), 2000u);
}

struct Memory {
  double held = 0, reported = 0;  ///< bytes
};

/// Memory of a solver that has made a step.
Memory memory(const Scene& scene, const std::string& solver) {
  const auto heap = [] {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const double before = heap();
  const auto made = make(scene, solver);
  made->load(scene.start);
  made->step(0, scene.dt);
  Memory memory{heap() - before, 0};
  for (const PassCost& line : made->step_cost()) memory.reported += static_cast<double>(line.bytes);
  return memory;
}

/// Additional memory of a sheet of 2n x 2n over one of n x n, as a share of the addition that its
/// passes report.
double held_by_reported(const std::string& solver, int n, bool contact, bool wind) {
  const auto sheet = [&](int vertices) {
    Scene scene = hanging_sheet(vertices, vertices);
    if (wind) scene.wind = Wind{};
    if (contact) scene.colliders = {{.shape = Ball{{0.5, -9, 0}, 0.1}}};
    return scene;
  };
  const Scene small = sheet(n), large = sheet(2 * n);
  memory(small, solver);  // allocates what is made only once per process
  const Memory a = memory(small, solver), b = memory(large, solver);
  return (b.held - a.held) / (b.reported - a.reported);
}

// The memory of contact and accelerators grows with the sheet as their passes report.
TEST(Plan, MemoryOfOtherPassesIsWhatTheyReport) {
  if (mallinfo2().uordblks == 0)
    GTEST_SKIP() << "this allocator does not say what it holds (sanitizers)";
  const auto check = [&](const std::string& solver, bool contact, bool wind = false) {
    EXPECT_NEAR(held_by_reported(solver, 48, contact, wind), 1, 0.04) << solver;
  };
  for (const std::string order : {"coloured", "mesh", "mesh,precision=double"}) {
    const std::string solver = "jakobsen:order=" + order;
    check(solver + ",tethers=on", false);
    for (const char* contact : {"continuous", "freeze", "halt"})
      check(solver + ",contact=" + contact, true);
  }
  check("jakobsen:order=mesh,method=jacobi-averaged", false);
  check("jakobsen:order=mesh,levels=3", false);
  check("jakobsen:order=mesh", false, true);
}

// Bullet allocates more than the data that its passes visit.
TEST(Plan, MemoryOfBulletIsMostlyWhatItsPassesReport) {
  if (mallinfo2().uordblks == 0)
    GTEST_SKIP() << "this allocator does not say what it holds (sanitizers)";
  for (const char* solver : {"bullet", "bullet-deformable"})
    for (const bool windy : {false, true})
      EXPECT_NEAR(held_by_reported(solver, 24, windy, windy), 1.13, 0.1) << solver;
}

// Each link of a compliant family adds a multiplier and a share of it, unless the multiplier is
// zero in every sweep, as with one sweep per substep.
TEST(Plan, MultipliersAreThereForLinksThatComply) {
  const Scene scene = hanging_sheet(64, 64);
  for (const auto& [precision, real] : {std::pair{"float", 4.0}, {"double", 8.0}})
    for (const char* layout : {",order=coloured", ",order=coloured,layout=batches"}) {
      const std::string solver = std::string("xpbd:precision=") + precision + layout;
      const auto bytes = [&](const std::string& more) {
        double all = 0;
        for (const auto& [pass, line] : plan(scene, solver + more))
          all += static_cast<double>(line.bytes);
        return all;
      };
      std::size_t compliant = 0;
      for (const Link& l : scene.links) compliant += l.family == Family::shear;
      const double more = bytes(",iterations=2,shear=0.01") - bytes(",iterations=2");
      EXPECT_NEAR(more / (static_cast<double>(compliant) * real), 1, 0.2) << solver;
      for (const char* none : {",iterations=1", ",iterations=2,multipliers=reset"})
        EXPECT_NEAR(bytes(none + std::string(",shear=0.01")) / bytes(none), 1, 0.01) << solver;
    }
}

}  // namespace
}  // namespace taut::plan_test
