// Truths applied to external solvers with one error each; the building blocks of truths; and
// verdicts on findings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/reference/fit.hpp"
#include "experiments/truths/truth.hpp"

namespace taut::judging_test {
namespace {

constexpr ParamSpec kFlaws[] = {ParamSpec::choice(
    "flaw", "none", "none|pushes|heavy|restless|loose|left|fails|refuses", "how it is wrong")};

/// Verlet integration without links, which is correct for unconnected particles.
struct FromOutside final : Solver {
  FromOutside(const Scene& s, const Params& params)
      : scene(s), flaw(params.choice("flaw")), w(inverse_masses(s)) {}
  void load(const State& s) override {
    x = before = s.x;
    for (std::size_t i = 0; i < x.size(); ++i) before[i] -= scene.dt * s.v[i];
  }
  void step(double t, double dt) override {
    if (flaw == "fails") throw SolverFailure(Status::Kind::crash, "SIGSEGV");
    const bool rests = scene.gravity.isZero(0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 now = x[i];
      if (w[i] > 0)
        x[i] += now - before[i] + dt * dt * (flaw == "heavy" ? 1.02 : 1) * scene.gravity;
      if (flaw == "pushes" && !rests && w[i] > 0) x[i].z() += 1e-4 * dt;
      if (flaw == "restless" && rests) x[i].x() += 2e-5 * dt;
      if (w[i] == 0 && flaw != "left") x[i] = pin_position(scene, static_cast<int>(i), t + dt);
      if (flaw == "loose" && w[i] == 0 && i > 0) x[i].y() += 2e-6 * (t + dt);
      before[i] = now;
    }
  }
  void store(State& s) const override { s = {x, x}; }
  std::vector<PassCost> step_cost() const override { return {}; }
  Scene scene;
  std::string flaw;
  std::vector<double> w;
  std::vector<Vec3> x, before;
};

const SolverEntry kOutside{
    .name = "outside",
    .params = kFlaws,
    .make = [](const Scene& s, const Params& p) -> std::unique_ptr<Solver> {
      return std::make_unique<FromOutside>(s, p);
    },
    .unsupported =
        [](const Scene&, const Params& p) {
          return p.is("flaw", "refuses") ? std::vector<std::string>{"sheets"}
                                         : std::vector<std::string>{};
        },
    .resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; },
    .implementation = "made for this test"};

const TruthEntry& truth(std::string_view name) {
  return **std::ranges::find(truths(), name, &TruthEntry::name);
}

class AnySolver : public testing::Test {
 protected:
  void SetUp() override {
    set_solver_source({[] { return std::vector<std::string>{"outside"}; },
                       [](std::string_view name, std::string_view) {
                         return name == "outside" ? &kOutside : nullptr;
                       }});
  }
  void TearDown() override { set_solver_source({}); }
  /// Findings of the truth about this solver, broken or not.
  static std::vector<Finding> findings(const std::string& solver) {
    Findings found({solver});
    for (const char* name : {"any-momentum", "any-rest", "any-pins", "any-moving-pins"})
      truth(name).check(found);
    return found.all();
  }
  static std::vector<std::string> broken(const std::string& flaw) {
    std::vector<std::string> quantities;
    const auto all = findings("outside:flaw=" + flaw);
    EXPECT_EQ(all.size(), 6u);
    for (const Finding& f : all)
      if (f.verdict == TruthVerdict::broken) quantities.push_back(f.quantity.substr(0, 8));
    return quantities;
  }
};

TEST_F(AnySolver, ThatIsWrongInOneWayBreaksOneTruth) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(broken("none"), Names{});
  EXPECT_EQ(broken("heavy"), Names{"fall of "});
  EXPECT_EQ(broken("pushes"), Names{"its way "});
  EXPECT_EQ(broken("restless"), (Names{"way of t", "way of a"}));
  EXPECT_EQ(broken("loose"), (Names{"way of t", "distance"}));
  EXPECT_EQ(broken("left"), Names{"distance"});
}

TEST_F(AnySolver, ThatFailsOrRefusesIsSaidSoForEachTruth) {
  for (const Finding& f : findings("outside:flaw=fails")) {
    EXPECT_EQ(f.quantity, "crash: SIGSEGV");
    EXPECT_EQ(f.verdict, TruthVerdict::broken);
  }
  EXPECT_EQ(findings("outside:flaw=fails").size(), 4u);
  for (const Finding& f : findings("outside:flaw=refuses")) {
    EXPECT_EQ(f.why, "sheets");
    EXPECT_EQ(f.verdict, TruthVerdict::not_applicable);
  }
  EXPECT_EQ(findings("outside:flaw=refuses").size(), 4u);
  EXPECT_EQ(findings("jakobsen").size(), 6u) << "one of the tree";
  EXPECT_TRUE(findings("reference").empty());
}

TEST(Judging, KeepsWhatItJudgedByAndSaysWhy) {
  Findings findings({"jakobsen", "xpbd:bend=1"});
  EXPECT_TRUE(findings.wants("jakobsen:iterations=1"));
  EXPECT_TRUE(findings.wants("xpbd:bend=1"));
  EXPECT_FALSE(findings.wants("xpbd:bend=2"));
  EXPECT_TRUE(Findings().wants("anything"));
  findings.equal("jakobsen", "a", "m", 1.25, 1, 0.25);
  findings.equal("jakobsen", "a", "m", 1.2500001, 1, 0.25);
  findings.below("jakobsen", "b", "N", 0.5, 0.5);
  findings.below("jakobsen", "b", "N", -0.51, 0.5);
  findings.holds("jakobsen", "c", true);
  findings.holds("jakobsen", "c", false);
  findings.slope("jakobsen", "d", {3, -1.5, 0.125}, -1.5, 0);
  findings.deviates("jakobsen", "e", "s", 7, 1, 7.5, 0.5, "because");
  findings.not_applicable("jakobsen", "rigid");
  const auto& all = findings.all();
  ASSERT_EQ(all.size(), 9u);
  std::string verdicts;
  for (const Finding& f : all) verdicts += std::string(to_string(f.verdict)) + ";";
  EXPECT_EQ(verdicts, "passed;broken;passed;broken;passed;broken;passed;deviates;not applicable;");
  EXPECT_EQ(all[2].expected, 0);
  EXPECT_EQ(all[2].tolerance, 0.5);
  EXPECT_EQ(all[2].unit, "N");
  EXPECT_EQ(all[5].measured, 0);
  EXPECT_EQ(all[5].expected, 1);
  EXPECT_EQ(all[6].measured, -1.5);
  EXPECT_EQ(all[6].uncertainty, 0.125);
  EXPECT_EQ(all[7].why, "because");
  EXPECT_EQ(all[7].expected, 1);
  EXPECT_EQ(all[8].why, "rigid");
  EXPECT_TRUE(std::isnan(all[8].measured));
  EXPECT_EQ(to_string(TruthVerdict::broken), "broken");
  EXPECT_EQ(section_title(1), "One constraint");
  EXPECT_EQ(section_title(10), "Metrics");
}

// A deviation that has vanished is as wrong as one that has grown: its explanation no longer holds.
TEST(Judging, ADeviationIsHeldToWhatExplainsIt) {
  for (const auto& [measured, verdict] : {std::pair(1.0, TruthVerdict::broken),
                                          {1.4, TruthVerdict::broken},
                                          {1.5, TruthVerdict::passed},
                                          {1.6, TruthVerdict::deviates},
                                          {2.0, TruthVerdict::deviates},
                                          {2.6, TruthVerdict::broken},
                                          {std::nan(""), TruthVerdict::broken}}) {
    Findings findings;
    findings.deviates("jakobsen", "a", "1", measured, 1, 2, 0.5, "because");
    EXPECT_EQ(findings.all().front().verdict, verdict) << measured;
  }
}

TEST(Judging, WhatCannotRunIsNotClaimed) {
  Findings findings({"jakobsen", "bullet", "nonesuch"});
  const Scene scene = bare::pair(1, 1);
  EXPECT_TRUE(can_run(findings, "jakobsen:iterations=1", scene));
  EXPECT_FALSE(can_run(findings, "xpbd", scene)) << "nobody asked";
  EXPECT_TRUE(findings.all().empty());
  EXPECT_FALSE(can_run(findings, "nonesuch", scene));
  EXPECT_FALSE(can_run(findings, "bullet:precision=float", scene));
  Scene rubs = scene;
  rubs.colliders = {{.shape = Plane{}, .friction = 1.5}};
  EXPECT_FALSE(can_run(findings, "bullet", rubs));
  ASSERT_EQ(findings.all().size(), 3u);
  EXPECT_EQ(findings.all()[1].why, "bullet: precision=float needs the program taut-f32");
  for (const Finding& f : findings.all()) EXPECT_EQ(f.verdict, TruthVerdict::not_applicable);
}

TEST(TruthScenes, AreAsBareAsTheySay) {
  const Scene pair = bare::pair(3, 2, 5, 7);
  EXPECT_EQ(pair.start.x[1], Vec3(2, 1, -2));
  EXPECT_EQ(pair.mesh.mass, (std::vector<double>{5, 7}));
  EXPECT_EQ(pair.links[0].rest, 2);
  EXPECT_TRUE(pair.pins.empty() && pair.gravity.isZero(0));
  EXPECT_EQ(pair.dt, 1.0 / 64);
  const Scene chain = under_gravity(bare::chain(4, 2, 0.5));
  EXPECT_EQ(chain.start.x[4], Vec3(0, -2, 0));
  EXPECT_EQ(chain.pins, std::vector{0});
  EXPECT_EQ(chain.links.size(), 4u);
  EXPECT_EQ(chain.links[3].rest, 0.5);
  EXPECT_EQ(chain.mesh.mass, std::vector<double>(5, 0.5));
  EXPECT_EQ(chain.gravity, Vec3(0, -9.81, 0));
  const Scene sheet = bare::sheet(3, 2, {.shear = true}, Lumping::equal, 4, 5, 12);
  EXPECT_EQ(sheet.mesh.rest[5], Vec3(4, -5, 0));
  EXPECT_EQ(sheet.mesh.mass, std::vector<double>(6, 2));
  EXPECT_EQ(sheet.links.size(), 7u + 4u);
  EXPECT_EQ(sheet.mesh.triangles.size(), 4u);
  State state = pair.start;
  state.x[1] *= 2;
  EXPECT_DOUBLE_EQ(strains(pair, state)[0], 4);
  EXPECT_DOUBLE_EQ(max_strain(pair, state), 2);
  Scene two =
      bare::scene({Vec3::Zero(), Vec3(2, 0, 0), Vec3(2, 3, 0)}, {1, 1, 1}, {{0, 1, 1}, {1, 2, 4}});
  EXPECT_DOUBLE_EQ(rms_strain(two, two.start), std::sqrt((1 + 0.0625) / 2));
  EXPECT_DOUBLE_EQ(max_strain(two, two.start), 1);
  two.start.x[2].x() = std::nan("");
  EXPECT_TRUE(std::isnan(max_strain(two, two.start)));
  EXPECT_TRUE(std::isnan(max_distance(two.start.x, two.mesh.rest)));
  EXPECT_EQ(max_distance({Vec3(1, 2, 3), Vec3(0, 0, 0)}, {Vec3(1, 2, 3), Vec3(3, 0, 4)}), 5);
}

TEST(TruthSolvers, AreThePublishedOnesUnlessSaid) {
  EXPECT_EQ(jakobsen(4),
            "jakobsen:iterations=4,substeps=1,order=mesh,projection=exact,precision=double");
  EXPECT_EQ(jakobsen(1, "sqrt-free", "substeps=2,order=jolt"),
            "jakobsen:iterations=1,projection=sqrt-free,precision=double,substeps=2,order=jolt");
  EXPECT_EQ(bullet(3), "bullet:iterations=3,precision=double");
  EXPECT_EQ(xpbd(2, "bend=1"), "xpbd:iterations=1,order=mesh,substeps=2,precision=double,bend=1");
  EXPECT_EQ(
      mass_spring("verlet", 0.1, 2),
      "mass-spring:integrator=verlet,structural=0.10000000000000001,shear=0.10000000000000001,"
      "bend=0.10000000000000001,drag=2,substeps=1,precision=double");
}

TEST(Settle, TakesTenCalmLooksInARow) {
  Scene scene = bare::scene({Vec3::Zero()}, {1}, {});
  Simulation rests(scene, jakobsen(1));
  EXPECT_TRUE(settle(rests, 1e-9, 3, 30));
  EXPECT_FALSE(settle(rests, 1e-9, 3, 27)) << "nine looks";
  scene.start.v[0] = {1, 0, 0};
  scene.damping = 64 * std::log(2.0);  // halves the speed in every step
  Simulation slows(scene, jakobsen(1));
  EXPECT_FALSE(settle(slows, std::ldexp(1, -10), 1, 19));
  Simulation again(scene, jakobsen(1));
  EXPECT_TRUE(settle(again, std::ldexp(1, -10), 1, 20)) << "below 2^-10 from the 11th step on";
  EXPECT_EQ(again.x(0).x() > 0, true);
}

TEST(Fit, TheErrorIsThatOfTheLinesSlope) {
  const auto error = [](const std::vector<double>& log_y) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < log_y.size(); ++i) {
      x.push_back(std::exp(static_cast<double>(i)));
      y.push_back(std::exp(log_y[i]));
    }
    return fit_power_law(x, y);
  };
  const PowerLaw four = error({0, 1, 0, 1});  // slope 1/5, residual 0.8 with two degrees of freedom
  EXPECT_NEAR(four.exponent, 0.2, 1e-12);
  EXPECT_NEAR(four.factor, std::exp(0.2), 1e-12);
  EXPECT_NEAR(four.error, std::sqrt(0.8 / 2 / 5), 1e-12);
  EXPECT_NEAR(error({0, 1, 0}).error, std::sqrt(2.0 / 3 / 2), 1e-12);
  EXPECT_EQ(error({0, 1}).error, 0) << "a line through two points";
  EXPECT_NEAR(error({0, 1}).exponent, 1, 1e-12);
}

TEST(Fit, ASignChangesWhereItDoes) {
  for (const double sign : {1.0, -1.0}) {
    const auto f = [&](double x) { return sign * (x * x - 2); };
    EXPECT_NEAR(sign_change(0.5, 4, 1e-9, f), std::sqrt(2), 1e-9);
    EXPECT_GT(std::abs(sign_change(0.5, 4, 0.1, f) - std::sqrt(2)), 1e-6) << "no finer than asked";
    EXPECT_NEAR(sign_change(0.5, 4, 0.1, f), std::sqrt(2), 0.05);
  }
}

}  // namespace
}  // namespace taut::judging_test
