// The value of a setting at which stability ends: the search on made-up outcomes, then springs and
// sweeps against their closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "core/reference/linear_stability.hpp"
#include "experiments/study/frontier/frontier.hpp"
#include "tests/support/cloths.hpp"

namespace taut::frontier_search_test {
namespace {

using Kind = Status::Kind;

Trial outcome(std::function<Kind(double)> of, int* count = nullptr) {
  return [of, count](const std::vector<double>& values) {
    std::vector<Outcome> outcomes;
    for (const double value : values) {
      outcomes.push_back({{of(value), "", -1, -1}});
      if (count) ++*count;
    }
    return outcomes;
  };
}

TEST(Frontier, BracketsTheEndOfStability) {
  int tried = 0;
  const Frontier found = find_frontier(
      {.from = 1e-3, .to = 1, .tolerance = 1e-4},
      outcome([](double dt) { return dt < 0.0371 ? Kind::ok : Kind::exploded; }, &tried));
  EXPECT_EQ(found.kind, Frontier::Kind::bracketed);
  EXPECT_LT(found.stable, 0.0371);
  EXPECT_GE(found.unstable, 0.0371);
  EXPECT_LE(found.unstable - found.stable, 1e-4 * found.unstable);
  EXPECT_TRUE(found.stable_above.empty());
  EXPECT_GE(found.above, 4u);
  EXPECT_LT(tried, 32);
  EXPECT_EQ(found.probes.size(), static_cast<std::size_t>(tried));
}

TEST(Frontier, SaysWhenARangeHasNone) {
  const SearchRange range{.from = 0, .to = 2};
  EXPECT_EQ(find_frontier(range, outcome([](double) { return Kind::ok; })).kind,
            Frontier::Kind::all_stable);
  const Frontier none = find_frontier(range, outcome([](double) { return Kind::unsettled; }));
  EXPECT_EQ(none.kind, Frontier::Kind::none_stable);
  EXPECT_EQ(none.unstable, 0);
  EXPECT_EQ(find_frontier(range, outcome([](double) { return Kind::unsupported; })).kind,
            Frontier::Kind::not_answered);
  EXPECT_EQ(find_frontier(range, outcome([](double) { return Kind::timeout; })).kind,
            Frontier::Kind::not_answered);
  const Frontier cut =
      find_frontier(range, [](const std::vector<double>&) { return std::vector<Outcome>{}; });
  EXPECT_EQ(cut.kind, Frontier::Kind::not_answered) << "interrupted";
}

TEST(Frontier, StabilityAboveTheBracketIsReported) {
  const Frontier found = find_frontier(
      {.from = 1, .to = 100, .tolerance = 0.01},
      outcome([](double x) { return x < 7 || (x > 50 && x < 70) ? Kind::ok : Kind::exploded; }));
  EXPECT_NEAR(found.stable, 7, 0.1);
  ASSERT_FALSE(found.stable_above.empty());
  for (const double island : found.stable_above) EXPECT_TRUE(island > 50 && island < 70) << island;
}

TEST(Frontier, WholeNumbersEndWithNeighbours) {
  const Frontier found =
      find_frontier({.from = 1, .to = 1000, .whole = true, .tolerance = 1e-6},
                    outcome([](double n) { return n <= 137 ? Kind::ok : Kind::crash; }));
  EXPECT_EQ(found.stable, 137);
  EXPECT_EQ(found.unstable, 138);
}

TEST(Frontier, WantOfTimeIsNoInstability) {
  const Frontier found =
      find_frontier({.from = 1e-4, .to = 1, .tolerance = 0.01}, outcome([](double dt) {
                      return dt < 1e-3 ? Kind::timeout : dt < 0.2 ? Kind::ok : Kind::exploded;
                    }));
  EXPECT_EQ(found.kind, Frontier::Kind::bracketed);
  EXPECT_NEAR(found.stable, 0.2, 0.004);
}

TEST(Frontier, ASymptomEndsWhatIsGoodThoughTheRunDoesNot) {
  const Frontier found =
      find_frontier({.from = 1, .to = 100}, [](const std::vector<double>& values) {
        std::vector<Outcome> outcomes;
        for (const double x : values)
          outcomes.push_back({{x < 60 ? Kind::ok : Kind::unsupported, "", -1, -1},
                              x < 20   ? ""
                              : x < 60 ? "tunnels"
                                       : "refuses"});
        return outcomes;
      });
  EXPECT_EQ(found.kind, Frontier::Kind::bracketed);
  EXPECT_NEAR(found.stable, 20, 0.2);
  EXPECT_EQ(found.at(found.unstable)->symptom, "tunnels");
}

TEST(Frontier, QuestionsBecomeCases) {
  const CaseSpec base{"chain", {}, "jakobsen:iterations=2"};
  EXPECT_EQ((FrontierQuestion{base, "dt", {}}.at(0.01).settings.back()), "time.dt=\"0.01\"");
  EXPECT_EQ((FrontierQuestion{base, "omega", {}}.at(1.5).solver),
            "jakobsen:iterations=2,omega=1.5");
  EXPECT_EQ((FrontierQuestion{base, "wind.strength", {}}.at(3).settings.back()), "wind.strength=3");
  EXPECT_EQ((FrontierQuestion{base, "cloth.size.0|cloth.size.1", {}}.at(3).settings),
            (SceneSettings{"cloth.size.0=3", "cloth.size.1=3"}));
  EXPECT_EQ((FrontierQuestion{base, "iterations", {}, Direction::down_in_whole_numbers}
                 .at(1 / 7.2)
                 .solver),
            "jakobsen:iterations=7");
  EXPECT_EQ(
      (FrontierQuestion{base, "iterations", {}, Direction::down_in_whole_numbers}.setting(1 / 6.8)),
      7)
      << "the nearest";
  EXPECT_EQ(
      (FrontierQuestion{base, "wind.strength", {}, Direction::down}.at(1 / 8.0).settings.back()),
      "wind.strength=8");
  EXPECT_EQ(range_of(base, "omega", 0.5, {}).from, 0.5);
  EXPECT_EQ(range_of(base, "omega", {}, {}).to, 2);
  EXPECT_TRUE(range_of(base, "substeps", 1, 9).whole);
  EXPECT_THROW(range_of(base, "omeega", {}, {}), InputError);
  EXPECT_THROW(range_of(base, "projection", {}, {}), InputError);
  EXPECT_THROW(range_of(base, "wind.strength", {}, {}), InputError) << "no range of its own";
  EXPECT_THROW(range_of(base, "dt", 0.5, 0.1), InputError);
}

// Nine values are tried, spread evenly with the ends included, or by equal ratios if the range
// starts above zero. Bisection then narrows the bracket to less than a hundredth of its upper end.
TEST(Frontier, IsSoughtInEvenSteps) {
  const auto tried = [](const SearchRange& range, double border) {
    std::vector<double> all;
    find_frontier(range, [&](const std::vector<double>& values) {
      std::vector<Outcome> outcomes;
      for (const double value : values) {
        all.push_back(value);
        outcomes.push_back({{value < border ? Kind::ok : Kind::exploded, "", -1, -1}});
      }
      return outcomes;
    });
    return all;
  };
  using Values = std::vector<double>;
  EXPECT_EQ(tried({.from = 1, .to = 256}, 999), (Values{1, 2, 4, 8, 16, 32, 64, 128, 256}));
  EXPECT_EQ(tried({.from = 0, .to = 2}, 9), (Values{0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2}));
  EXPECT_EQ(tried({.from = 0, .to = 3, .whole = true}, 9), (Values{0, 1, 2, 3}))
      << "none is tried twice";
  EXPECT_EQ(tried({.from = 0, .to = 8, .tolerance = 0.25, .coarse = 3}, 2.1),
            (Values{0, 4, 8, 2, 3, 2.5, 2.6, 2.7, 2.8, 2.9}))
      << "2 is a fifth below 2.5; then four values from there to the next that was tried";
}

// Values without a result are skipped, and a bracket may end at one.
TEST(Frontier, KnowsWhatIsAnAnswer) {
  const auto probed = [](Kind kind, const StatusReason& reason, const std::string& symptom = "") {
    return Probed{{{kind, reason, -1, -1}, symptom}, 1};
  };
  EXPECT_TRUE(probed(Kind::ok, "").stable());
  EXPECT_TRUE(probed(Kind::extreme, Reason::stretch).stable());
  EXPECT_FALSE(probed(Kind::extreme, Reason::stretch_and_unsettled).stable());
  EXPECT_FALSE(probed(Kind::extreme, "stretch").stable()) << "words of a solver";
  EXPECT_FALSE(probed(Kind::ok, "", "tunnels").stable());
  for (const Kind kind : {Kind::exploded, Kind::unsettled, Kind::crash}) {
    EXPECT_FALSE(probed(kind, "").stable());
    EXPECT_TRUE(probed(kind, "").known());
  }
  for (const Kind kind : {Kind::timeout, Kind::oom, Kind::protocol, Kind::error})
    EXPECT_FALSE(probed(kind, "").known());
  const Frontier gap =
      find_frontier({.from = 0, .to = 8, .tolerance = 1e-3, .coarse = 3}, outcome([](double x) {
                      return x == 6 ? Kind::timeout : x < 7 ? Kind::ok : Kind::exploded;
                    }));
  EXPECT_EQ(gap.stable, 4);
  EXPECT_EQ(gap.unstable, 8);
  EXPECT_EQ(gap.kind, Frontier::Kind::bracketed);
  std::string kinds;
  for (const auto kind : {Frontier::Kind::bracketed, Frontier::Kind::all_stable,
                          Frontier::Kind::none_stable, Frontier::Kind::not_answered})
    kinds += std::string(to_string(kind)) + ", ";
  EXPECT_EQ(kinds, "bracketed, all stable, none stable, not answered, ");
}

TEST(Frontier, ARangeIsTheParametersOwnOrHasToBeGiven) {
  const CaseSpec base{"chain", {}, "jakobsen"};
  const auto range = [&](const std::string& of, std::optional<double> from = {},
                         std::optional<double> to = {}) -> std::string {
    try {
      const SearchRange is = range_of(base, of, from, to);
      return as_typed(is.from) + " to " + as_typed(is.to) + (is.whole ? " whole" : "");
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(range("dt"), "0.002 to 0.5");
  EXPECT_EQ(range("dt", 0.1), "0.1 to 0.5");
  EXPECT_EQ(range("levels"), "1 to 20 whole");
  EXPECT_EQ(range("omega|iterations"), "0 to 2") << "of the first";
  EXPECT_EQ(range("wind.strength", 1, 2e9), "1 to 2e9");
  EXPECT_EQ(range("iterations"), "'iterations' has no range of its own: give --from and --to");
  EXPECT_EQ(range("wind.strength", 1),
            "'wind.strength' has no range of its own: give --from and "
            "--to");
  EXPECT_EQ(range("dt", 0.5, 0.5), "--from 0.5 must be below --to 0.5");
  EXPECT_EQ(range("order"), "'order' is one of mesh|coloured|reversed|random|jolt, not a number");
  EXPECT_EQ(range("fabric", 1, 2), "'fabric' is a text, not a number");
  EXPECT_EQ(range("omeg"),
            "jakobsen has no parameter 'omeg'; did you mean 'omega'? (a scene key "
            "has a dot, as \"wind.strength\")");
}

// Springs are stable below 2/w, over-relaxation on one link below 4/3 (see below).
TEST(Frontier, TheoryEndsWhereTheRangeDoes) {
  const auto predicted = [](double from, double to) {
    return *predicted_frontier({{"chain",
                                 {"cloth.grid=[1, 2]", "forces.gravity=[0, 0, 0]"},
                                 "jakobsen:order=mesh,iterations=1,substeps=1"},
                                "omega",
                                {.from = from, .to = to}});
  };
  const Prediction inside = predicted(1, 2), below = predicted(0.5, 1.3), above = predicted(1.4, 2);
  EXPECT_EQ(inside.kind, Frontier::Kind::bracketed);
  EXPECT_NEAR(inside.value, 4. / 3, 2e-6);
  EXPECT_NEAR(inside.growth, 1, 1e-4) << "just above";
  EXPECT_EQ(below.kind, Frontier::Kind::all_stable);
  EXPECT_EQ(below.value, 1.3);
  EXPECT_LT(below.growth, 1);
  EXPECT_EQ(above.kind, Frontier::Kind::none_stable);
  EXPECT_EQ(above.value, 1.4);
  EXPECT_NEAR(above.growth, 1 + std::sqrt(2), 1e-6) << "of the end of the range";
  EXPECT_EQ(above.law, inside.law);
}

// More pieces of a chain of the same mass are lighter: theory names the last stable number of
// pieces.
TEST(Frontier, TheoryOfWholeNumbersIsTheLastThatIsStable) {
  for (const char* stiffness : {"20", "23", "31", "40"}) {
    const FrontierQuestion question{{"chain",
                                     {"time.dt=0.02", "forces.gravity=[0, 0, 0]"},
                                     std::string("mass-spring:substeps=1,structural=") + stiffness},
                                    "cloth.grid.1",
                                    {.from = 2, .to = 99, .whole = true}};
    const auto stable = [&](double value) {
      const Case one = make_case(question.at(value));
      return linear_stability(*one.scene, one.choice)->stable();
    };
    const auto predicted = predicted_frontier(question);
    ASSERT_TRUE(predicted && predicted->kind == Frontier::Kind::bracketed) << stiffness;
    EXPECT_EQ(predicted->value, std::round(predicted->value)) << stiffness;
    EXPECT_TRUE(stable(predicted->value)) << stiffness;
    EXPECT_FALSE(stable(predicted->value + 1)) << stiffness;
  }
}

Scene hung_chain(int links) {
  Scene scene = hanging_sheet(1, links + 1, {true, false, false}, Lumping::equal);
  scene.gravity.setZero();
  return scene;
}

double margin(Scene scene, const std::string& solver, double dt) {
  scene.dt = dt;
  return linear_stability(scene, parse_solver(solver))->margin;
}

TEST(LinearStability, OneMassOnASpring) {
  const Scene scene = hung_chain(1);
  const double m = scene.mesh.mass[1], k = 40, w = std::sqrt(k / m), zeta = 0.5;
  const std::string spring = "mass-spring:substeps=1,structural=40";
  EXPECT_NEAR(margin(scene, spring, 2 / w), 1, 1e-9);
  EXPECT_NEAR(margin(scene, "mass-spring:substeps=4,structural=40", 8 / w), 1, 1e-9);
  // The air leaves the share q of a velocity: w^2 h^2 = 2 (1 + q), q = e^(-damping h).
  Scene in_air = scene;
  in_air.damping = 3;
  const double h = 1.9 / w, q = std::exp(-3 * h);
  EXPECT_NEAR(margin(in_air, spring, h), w * w * h * h / (2 * (1 + q)), 1e-9);
  EXPECT_NEAR(margin(in_air, "mass-spring:substeps=4,structural=40", 4 * h),
              w * w * h * h / (2 * (1 + q)), 1e-9);
  const std::string drag = ",drag=" + shortest(2 * zeta * w * m);
  EXPECT_NEAR(margin(scene, spring + drag, 2 / w * (std::sqrt(1 + zeta * zeta) - zeta)), 1, 1e-5);
  EXPECT_NEAR(margin(scene, spring + drag + ",drag-at=central", 2 / w), 1, 1e-5);
  EXPECT_GT(margin(scene, spring + ",integrator=explicit-euler", 1e-3), 1);
  // With air and drag, x' = x + (q (1 - b) (x - x_before) - w^2 h^2 x)/(1 + b), b = c h/(2m),
  // alternates its sign at w^2 h^2 = 2 (1 + q) + 2 b (1 - q).
  const double step = 0.05, c = 0.7, b = c * step / (2 * m), left = std::exp(-3 * step);
  const double stiff = m * (2 * (1 + left) + 2 * b * (1 - left)) / (step * step);
  EXPECT_NEAR(
      margin(in_air,
             "mass-spring:substeps=1,drag=0.7,drag-at=central,structural=" + shortest(stiff), step),
      1, 1e-6);
}

TEST(LinearStability, DragHoldsExplicitEulerUpToItsClosedForm) {
  Scene scene = hung_chain(1);
  const double m = scene.mesh.mass[1], k = 40, w2 = k / m, c = 0.5, y = c / m;
  const std::string spring =
      "mass-spring:substeps=1,structural=40,precision=double,integrator=explicit-euler,drag=0.5";
  ASSERT_LT(y * y, 4 * w2);
  EXPECT_NEAR(margin(scene, spring, y / w2), 1, 1e-9) << "dt < c/(m w^2)";
  scene.dt = 1.5 * y / w2;
  const auto theory = linear_stability(scene, parse_solver(spring));
  EXPECT_NEAR(theory->growth, std::sqrt(1 - y * scene.dt + w2 * scene.dt * scene.dt), 1e-12);
  // The invariant of the continuous motion, w^2 x^2 + v^2 + y x v, grows by |z|^2 in each step.
  scene.start.x[1].y() -= 1e-6;
  const auto size = [&](const State& s) {
    const double x = s.x[1].y() + 1, v = s.v[1].y();
    return std::sqrt(w2 * x * x + v * v + y * x * v);
  };
  const State before = simulate(scene, spring, 10), after = simulate(scene, spring, 60);
  EXPECT_NEAR(std::pow(size(after) / size(before), 1.0 / 50), theory->growth, 1e-5);
  const std::string stiff =
      "mass-spring:substeps=1,structural=1e-3,integrator=explicit-euler,drag=0.5";
  EXPECT_NEAR(margin(scene, stiff, 2 / y), 1, 1e-9) << "drag alone";
  EXPECT_FALSE(linear_stability(hanging_sheet(4, 4), parse_solver(spring))) << "unequal masses";
}

TEST(LinearStability, AChainOfSpringsHasItsClosedForm) {
  const int n = 16;
  const Scene scene = hung_chain(n);
  const double fastest = 2 * std::sqrt(50 / scene.mesh.mass[1]) *
                         std::sin((2 * n - 1) * std::acos(-1.0) / (2 * (2 * n + 1)));
  EXPECT_NEAR(margin(scene, "mass-spring:substeps=1", 2 / fastest), 1, 1e-9);
}

// Eigen's QR algorithm does not terminate for large unscaled numbers, nor for numbers that
// overflow.
TEST(LinearStability, WhatCannotBeComputedIsNoTheory) {
  Scene scene = hanging_sheet(9, 7, {true, false, false});
  scene.pins.clear();
  for (Vec3& x : scene.start.x) x.y() *= 0.75;
  const auto theory = [&](double dt) {
    scene.dt = dt;
    return linear_stability(scene,
                            parse_solver("mass-spring:substeps=1,structural=90,shear=0,drag=.02"));
  };
  const auto small = theory(1e-3);
  ASSERT_TRUE(small);
  for (int k = 0; k < 60; ++k) {
    const double dt = 0.02 * std::pow(1.03, k);
    ASSERT_TRUE(theory(dt)) << dt;
    EXPECT_GT(theory(dt)->margin, small->margin) << dt;
  }
  for (double& m : scene.mesh.mass) m = std::numeric_limits<double>::denorm_min();
  EXPECT_FALSE(theory(0.1)) << "beyond the largest number";
}

TEST(LinearStability, SweepsOfRelaxation) {
  EXPECT_NEAR(margin(hung_chain(1), listing("iterations=1,omega=1.33"), 0.01),
              0.33 + std::sqrt(0.33 * 0.33 + 0.33), 1e-9);
  EXPECT_TRUE(linear_stability(hung_chain(1), parse_solver(listing("iterations=1,omega=1.3333")))
                  ->stable());
  EXPECT_FALSE(linear_stability(hung_chain(1), parse_solver(listing("iterations=1,omega=1.3334")))
                   ->stable());
  // One link in air: z^2 - (1 + q) mu z + q mu = 0, mu = 1 - omega; the product of its roots is q
  // mu.
  Scene in_air = hung_chain(1);
  in_air.damping = 40;
  const double mu = -0.7, q = std::exp(-40 * 0.01), half = (1 + q) * mu / 2;
  EXPECT_NEAR(margin(in_air, listing("iterations=1,omega=1.7"), 0.01),
              std::abs(half) + std::sqrt(half * half - q * mu), 1e-9);
  const double odd = margin(hung_chain(32), listing("iterations=1,method=jacobi"), 0.01);
  EXPECT_NEAR(odd, 2.402, 0.02);
  EXPECT_LT(odd, 1 + std::sqrt(2));
  EXPECT_LE(margin(hung_chain(32), listing("iterations=2,method=jacobi"), 0.01), 1 + 1e-6);
  // |z| = rho^(k/2), rho = cos^2(pi/2N)
  EXPECT_NEAR(margin(hung_chain(16), listing("iterations=4"), 0.01),
              std::pow(std::cos(std::acos(-1.0) / 32), 4), 1e-6);
  EXPECT_FALSE(linear_stability(hanging_sheet(20, 20), parse_solver(listing()))) << "too many";
}

/// Longest stable step of the scene, found by running it.
Frontier measured(const Scene& scene, const std::string& solver, double from, double to) {
  return find_frontier(
      {.from = from, .to = to, .tolerance = 2e-3, .coarse = 5},
      [&](const std::vector<double>& values) {
        std::vector<Outcome> outcomes;
        for (const double dt : values) {
          Scene tried = scene;
          tried.dt = dt;
          tried.steps = 3000;
          outcomes.push_back(
              {run_case(tried, parse_solver(solver), {.measure = false}).record.status});
        }
        return outcomes;
      });
}

TEST(LinearStability, ASheetOfSpringsBlowsUpWhereItSays) {
  Scene sheet = crumpled(hanging_sheet(5, 6), 1e-6);
  sheet.gravity.setZero();
  for (const char* more :
       {"", ",drag=0.01", ",drag=0.01,drag-at=central", ",integrator=symplectic-euler"}) {
    const std::string solver = "mass-spring:substeps=1,precision=double" + std::string(more);
    const Frontier found = measured(sheet, solver, 2e-3, 8e-2);
    ASSERT_EQ(found.kind, Frontier::Kind::bracketed) << more;
    EXPECT_TRUE(found.stable_above.empty()) << more;
    EXPECT_LT(margin(sheet, solver, found.stable), 1.003) << more;
    EXPECT_GT(margin(sheet, solver, found.unstable), 0.999) << more;
  }
}

}  // namespace
}  // namespace taut::frontier_search_test
