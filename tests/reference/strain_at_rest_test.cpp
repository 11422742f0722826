// Strain that sweeps leave at rest: the sheet of springs against closed forms, the law against the
// chain's recurrence, and what it refuses. Truth `sweeps-are-springs` has it against runs.
#include "core/reference/strain_at_rest.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/resting_springs.hpp"
#include "tests/support/cloths.hpp"

namespace taut::reference::strain_at_rest_test {
namespace {

constexpr double kG = 9.81;

Scene sheet(int nu, int nv, const LinkChoice& links) {
  Scene s = hanging_sheet(nu, nv, links);
  s.pins = {0, nu - 1};
  s.gravity = {0, -kG, 0};
  s.dt = 1.0 / 256;
  s.steps = 2560;
  return s;
}
Scene chain(int n) {
  Scene s;
  s.mesh = make_sheet(
      {.nu = 1, .nv = n + 1, .height = 1, .mass = 0.1 * (n + 1), .lumping = Lumping::equal});
  s.start = {s.mesh.rest, std::vector<Vec3>(s.mesh.rest.size(), Vec3::Zero())};
  s.pins = {0};
  s.links = grid_links(s.mesh, {});
  s.dt = 1.0 / 256;
  s.steps = 2560;
  return s;
}

TEST(RestingSprings, AChainCarriesTheWeightBelow) {
  const int n = 16;
  const Scene s = chain(n);
  for (const double stiffness : {30.0, 1e6}) {
    const auto rest = RestingSprings(s).rest(std::vector<double>(s.links.size(), stiffness));
    ASSERT_TRUE(rest.found);
    for (int j = 0; j < n; ++j)
      EXPECT_NEAR(rest.tension[to_index(j)], (n - j) * 0.1 * kG, 2e-3 * 0.1 * kG);
  }
}

TEST(RestingSprings, AHeavierLoadOnStifferSpringsStretchesThemAsMuch) {
  const Scene s = sheet(21, 21, {.structural = true, .shear = true});
  RestingSprings springs(s);
  const std::vector<double> k(s.links.size(), 500), stiffer(s.links.size(), 1500);
  const auto one = springs.rest(k),
             loaded =
                 springs.rest(stiffer, nullptr, std::vector<double>(to_index(s.mesh.size()), 3.0));
  ASSERT_TRUE(one.found && loaded.found);
  for (std::size_t j = 0; j < k.size(); ++j)
    EXPECT_NEAR(loaded.tension[j], 3 * one.tension[j], 0.05) << j;
  EXPECT_EQ(springs.rest(k).tension, one.tension) << "a load is not kept";
}

/// From a start that is neither stretched nor in the shape at rest.
TEST(RestingSprings, ARopeHangsInTheElasticCatenary) {
  const int n = 16;
  Scene s = chain(n);
  s.pins = {0, n};
  for (int i = 0; i <= n; ++i)
    s.start.x[to_index(i)] = Vec3(0.8 * i / n, i % 2 ? -0.6 / n : 0.0, 0);
  for (const double stiffness : {200.0, 1e5}) {
    const auto rest = RestingSprings(s).rest(std::vector<double>(s.links.size(), stiffness));
    ASSERT_TRUE(rest.found);
    const Catenary exact = discrete_catenary(n, 0.8, 1.0 / n, 0.1 * kG, stiffness);
    for (int j = 0; j < n; ++j)
      EXPECT_NEAR(rest.tension[to_index(j)] / exact.tension[to_index(j)], 1, 2e-3);
  }
}

/// A large sheet starts from smaller ones. It ends where it also ends without them.
TEST(RestingSprings, ASheetRestsWhereItRestsWithoutACoarserOne) {
  const Scene s = sheet(24, 20, {.structural = true, .shear = true});
  const std::vector<double> k(s.links.size(), 300);
  RestingSprings springs(s);
  const RestingSprings::Rest start{s.start.x, {}, 0, 0, false};
  const auto nested = springs.rest(k), direct = springs.rest(k, &start);
  ASSERT_TRUE(nested.found && direct.found);
  double square = 0, off = 0;
  for (std::size_t j = 0; j < k.size(); ++j) {
    square += direct.tension[j] * direct.tension[j];
    off += std::pow(nested.tension[j] - direct.tension[j], 2);
  }
  EXPECT_LT(std::sqrt(off / square), 5e-3);
}

TEST(CoarseSheet, KeepsPinsMassesAndTheLayoutOfSolvers) {
  Scene s = sheet(33, 17, {.structural = true, .shear = true});
  s.pins.push_back(16 * 33 + 16);  // the middle of the lower edge
  const Scene c = coarse_sheet(s, 9, 5);
  EXPECT_EQ(c.pins, (std::vector<int>{0, 8, 4 * 9 + 4}));
  double fine = 0, coarse = 0;
  for (const double m : s.mesh.mass) fine += m;
  for (const double m : c.mesh.mass) coarse += m;
  EXPECT_NEAR(coarse, fine, 1e-12 * fine);
  EXPECT_NEAR(c.mesh.mass[10] / c.mesh.mass[0], s.mesh.mass[34] / s.mesh.mass[0], 1e-12);
  EXPECT_EQ(c.mesh.triangles, make_sheet({.nu = 9, .nv = 5}).triangles);
  EXPECT_EQ(c.links.size(), grid_links(c.mesh, {.structural = true, .shear = true}).size());
  EXPECT_NEAR((c.mesh.rest.back() - s.mesh.rest.back()).norm(), 0, 1e-12);
}

/// c = 2 within 3 %, and the strain of the recurrence, from few sweeps to so many that a substep
/// corrects a third of the slow modes.
TEST(StrainAtRest, IsTheRecurrencesOnAChain) {
  const int n = 32;
  const Scene s = chain(n);
  const SolverChoice solver =
      parse_solver("jakobsen:substeps=1,order=mesh,projection=exact,precision=double");
  ASSERT_TRUE(StrainAtRest::refuse(s, solver).empty());
  StrainAtRest law(s, solver);
  EXPECT_NEAR(law.correction(), 2, 0.06);
  for (const int k : {4, 16, 64, 128}) {
    const StrainAtRest::Strain strain = law.at(k, 1);
    const Eigen::VectorXd exact =
        n * steady_strain(chain_sweep(n, Sweep::gauss_seidel), k, kG * s.dt * s.dt);
    EXPECT_NEAR(strain.rms / std::sqrt(exact.squaredNorm() / n), 1, 0.03) << k;
    EXPECT_NEAR(strain.largest / exact.maxCoeff(), 1, 0.06) << k;
    EXPECT_TRUE(law.outside(strain, 1).empty());
  }
}

/// Springs of one K have the strain that of_springs() says, and stiffness_of() finds their K again.
TEST(StrainAtRest, KnowsTheStiffnessThatSweepsAre) {
  const Scene s = sheet(12, 12, {.structural = true, .shear = true});
  const SolverChoice solver = parse_solver("jakobsen:projection=exact,precision=double");
  StrainAtRest law(s, solver);
  EXPECT_NEAR(law.stiffness_of(law.of_springs(700)) / 700, 1, 2e-3);
  const StrainAtRest::Strain few = law.at(4, 1), many = law.at(8, 1);
  EXPECT_NEAR(law.stiffness_of(many) / law.stiffness_of(few), 2, 0.1);
}

TEST(StrainAtRest, RefusesWithTheReason) {
  const LinkChoice both{.structural = true, .shear = true};
  const auto reasons = [](const Scene& s, const char* solver) {
    return StrainAtRest::refuse(s, parse_solver(solver));
  };
  const Scene good = sheet(12, 12, both);
  EXPECT_TRUE(reasons(good, "jakobsen").empty());
  for (const auto& [solver, reason] :
       {std::pair("mass-spring", "no law is known for the sweeps of 'mass-spring'"),
        {"jakobsen:levels=3", "levels=3: coarse levels"},
        {"jakobsen:tethers=on", "tethers=on: "},
        {"jakobsen:chebyshev=0.9", "chebyshev=0.9: "},
        {"jakobsen:method=lines,substeps=40", "method=lines: "},
        {"jakobsen:iterations=0", "no sweeps"},
        {"xpbd:method=global", "method=global: "},
        {"xpbd:multipliers=reset", "multipliers=reset: "},
        {"vbd", "start=adaptive: it never rests"},
        {"vbd:start=inertia,shear=5", "its links have several stiffnesses"}}) {
    const auto all = reasons(good, solver);
    ASSERT_FALSE(all.empty()) << solver;
    EXPECT_TRUE(all.front().starts_with(reason)) << solver << ": " << all.front();
  }
  Scene contact = good;
  contact.colliders = {{.shape = Plane{}}};
  EXPECT_TRUE(reasons(contact, "jakobsen").front().starts_with("contact"));
  Scene moving = good;
  moving.pin_motions = {{{0}, {.spin = {0, 0, 1}}}};
  EXPECT_EQ(reasons(moving, "jakobsen"), std::vector<std::string>{"the pins move"});
  Scene held = good;
  held.pins.clear();
  for (int i = 0; i < held.mesh.size(); ++i) held.pins.push_back(i);
  EXPECT_EQ(reasons(held, "jakobsen"),
            std::vector<std::string>{"no structural or shear link of it can stretch"});
  constexpr const char* kVertices = "vbd:start=inertia";
  EXPECT_TRUE(reasons(good, kVertices).empty());
  EXPECT_TRUE(reasons(sheet(12, 12, {.structural = true}), kVertices)
                  .front()
                  .starts_with("no shear links"));
  EXPECT_TRUE(reasons(sheet(1, 12, {.structural = true}), kVertices).empty()) << "a chain";
  Scene heavy = good;
  heavy.mesh.mass.back() *= 40;
  EXPECT_TRUE(reasons(heavy, kVertices).front().starts_with("a vertex weighs more than 2.5 times"));
  EXPECT_TRUE(reasons(heavy, "jakobsen").empty());
  Scene bending = good;
  bending.bending = Bending{1, 1};
  EXPECT_TRUE(reasons(bending, "jakobsen").front().starts_with("bending"));
}

TEST(StrainAtRest, SaysWhereItEnds) {
  const LinkChoice both{.structural = true, .shear = true};
  const auto outside = [](const Scene& s, const char* text) {
    const SolverChoice solver = parse_solver(text);
    StrainAtRest law(s, solver);
    return join(law.outside(law.at(solver.sweeps(), solver.substeps()), solver.substeps()), "; ");
  };
  const auto says = [&](const Scene& s, const char* text, const char* reason) {
    const std::string all = outside(s, text);
    EXPECT_NE(all.find(reason), std::string::npos) << text << ": " << all;
  };
  Scene s = sheet(12, 12, both);
  EXPECT_EQ(outside(s, "jakobsen:precision=double,projection=exact"), "");
  says(s, "jakobsen:precision=double,iterations=2000", "its sweeps leave hardly any strain");
  says(s, "jakobsen:iterations=50,substeps=60", "float rounds");
  s.dt = 1.0 / 64;
  says(s, "jakobsen:iterations=1,substeps=1", "its RMS strain");
  s.dt = 1.0 / 32;
  says(s, "jakobsen:iterations=1,substeps=1,projection=exact", "its largest strain");
  s.dt = 1.0 / 256;
  for (Vec3& x : s.start.x) x = Vec3(x.x(), 0.7 * x.y(), -0.7 * x.y());
  says(s, "jakobsen:precision=double", "motion: ");
  s.damping = 4;
  EXPECT_EQ(outside(s, "jakobsen:precision=double"), "");
}

}  // namespace
}  // namespace taut::reference::strain_at_rest_test
