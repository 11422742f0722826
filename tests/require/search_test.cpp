// The search for the smallest model, on cases that the test program itself runs
// (tests/support/main.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "experiments/case/digest.hpp"
#include "experiments/require/perturbation.hpp"
#include "experiments/require/require.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/damaged_results.hpp"

namespace taut::require_search_test {
namespace {

class Requirements : public testing::Test {
 protected:
  Requirement find(const std::string& scene, RequireOptions options) {
    write_file(scratch_.path() / "s.toml", scene);
    options.full.scene = (scratch_.path() / "s.toml").string();
    options.jobs = 2;
    store_.prepare();
    return find_requirement(options, store_, scratch_.path() / "made");
  }
  static const EffectTrial& effect(const Requirement& found, const std::string& name) {
    return *std::ranges::find(found.effects, name, &EffectTrial::name);
  }
  /// The case as stored.
  Observation seen(const CaseSpec& spec) const {
    const Case one = make_case(spec);
    return {one, *store_.find(one), store_.motion(one.key).frames};
  }
  void forget(const CaseSpec& spec) { taut::forget(store_, make_case(spec).key); }
  /// Effects that the scene file's comment lists as removed, in order: "wind: gone".
  static std::vector<std::string> said_to_go(const Requirement& found) {
    std::vector<std::string> all;
    std::istringstream lines(read_text(found.file));
    for (std::string line; std::getline(lines, line) && line.starts_with("#");)
      if (line.starts_with("#   ")) all.push_back(line.substr(4));
    return all;
  }
  const Scratch scratch_;
  Store store_{scratch_.path() / "results"};
};

// Strip pinned at two opposite corners, in a wind without effect. Its last vertex is pinned by
// number, so that no coarser grid contains it.
const std::string kStrip =
    "[cloth]\ngrid = [8, 3]\nsize = [1, 0.3]\nmass = 0.1\npins = [0, 23]\n[wind]\nvelocity = [3, "
    "0, 1]\nstrength = 0\n"
    "[links]\nshear = false\n[time]\ndt = \"1/64\"\nduration = 0.25\n";

TEST_F(Requirements, DropWhatDoesNothingAndKeepWhatMatters) {
  const Requirement found =
      find(kStrip, {.full = {"", {}, "jakobsen:substeps=4,iterations=2,precision=float"},
                    .keep = {"shape:0.01%", "stretch.max:0.01%"},
                    .patience = 60});
  EXPECT_TRUE(found.not_done.empty()) << found.not_done.front();
  ASSERT_EQ(found.answers.size(), 2u);
  EXPECT_FALSE(found.chaotic);
  EXPECT_EQ(found.values[0], 0);
  EXPECT_EQ(found.values[1], store_.find(found.full.key)->value("stretch.max"));
  ASSERT_EQ(found.noise.size(), 2u);
  for (const double noise : found.noise) EXPECT_TRUE(noise > 0 && noise < 0.1) << noise;
  const auto ran = [&](const CaseSpec& spec) {
    return store_.find(make_case(spec).key).has_value();
  };
  const Perturbations other = perturbations(found.full, scratch_.path() / "made");
  for (std::size_t i = 0; i < other.rounding.size(); ++i)
    EXPECT_EQ(ran(other.rounding[i]), i < 2) << "two are enough where chaos does not show";
  for (const CaseSpec& spec : other.order) EXPECT_TRUE(ran(spec));

  const EffectTrial& wind = effect(found, "wind");
  ASSERT_EQ(wind.trials.size(), 1u);
  EXPECT_TRUE(wind.may_go() && wind.trials[0].within && wind.trials[0].done);
  EXPECT_EQ(wind.trials[0].moved, (std::vector<double>{0, 0})) << "to the bit";
  EXPECT_EQ(wind.chosen, 0u);
  EXPECT_TRUE(wind.time);
  const EffectTrial& substeps = effect(found, "substeps");
  ASSERT_EQ(substeps.trials.size(), 1u) << "the weaker step fails, the stronger one is not tried";
  EXPECT_FALSE(substeps.may_go());
  EXPECT_TRUE(substeps.trials[0].done);
  EXPECT_GT(substeps.trials[0].moved[0], found.answers[0].tolerance);
  EXPECT_FALSE(substeps.chosen);
  EXPECT_EQ(&substeps.representative(), &substeps.trials[0]);
  const EffectTrial& resolution = effect(found, "resolution");
  ASSERT_EQ(resolution.trials.size(), 1u);
  EXPECT_TRUE(resolution.trials[0].done);
  EXPECT_NE(resolution.trials[0].why, "") << "no such vertex";
  EXPECT_EQ(resolution.trials[0].moved, (std::vector<double>{kNoAnswer, kNoAnswer}));
  EXPECT_FALSE(resolution.time);

  ASSERT_TRUE(found.smallest);
  EXPECT_TRUE(found.smallest->within);
  EXPECT_TRUE(found.verified);
  EXPECT_EQ(found.file, scratch_.path() / "made/smallest.toml");
  const std::string file = read_text(found.file);
  EXPECT_TRUE(file.starts_with("# The smallest model found of " + found.full.id +
                               ". Without, or coarser:\n#   wind: gone\n"))
      << file;
  const Case smallest = make_case(found.smallest->spec);
  EXPECT_FALSE(smallest.scene->wind);
  EXPECT_EQ(smallest.choice.params.integer("substeps"), 4);
  EXPECT_EQ(smallest.scene->steps, 16);
  EXPECT_LT(work_of(found.smallest->cost), work_of(store_.find(found.full.key)->step_cost));
  ASSERT_TRUE(found.time_ratio);
  EXPECT_TRUE(found.time_ratio->mid > 0.02 && found.time_ratio->mid < 5) << found.time_ratio->mid;
  EXPECT_GT(found.cases, 5u);
  EXPECT_LE(found.ran, found.cases);
}

double farthest(const State& a, const State& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) most = std::max(most, (a.x[i] - b.x[i]).norm());
  return most;
}

TEST_F(Requirements, AShapeThatRoundingMovesIsGivenUp) {
  constexpr double kTolerance = 2e-7;
  RequireOptions options{.full = {"", {}, "jakobsen:substeps=4,iterations=2,precision=float"},
                         .keep = {"stretch.max:50%", "shape:2e-7", "energy.mean"},
                         .patience = 60};
  const Requirement found = find(kStrip, options);
  options.full = found.full.spec;
  const Perturbations other = perturbations(found.full, scratch_.path() / "made");
  ASSERT_EQ(other.rounding.size(), 4u);
  ASSERT_EQ(other.order.size(), 2u);
  std::vector<Observation> runs{seen(found.full.spec)};
  for (const CaseSpec& spec : other.rounding) runs.push_back(seen(spec));
  double horizon = 1e9, moved = 0, low = 1e9, high = 0, least = 1e9, most = -1e9;
  for (const Observation& run : runs) {
    for (const Observation& one : runs)
      moved = std::max(moved, farthest(run.frames.back().state, one.frames.back().state));
    low = std::min(low, run.record.value("stretch.max"));
    high = std::max(high, run.record.value("stretch.max"));
    least = std::min(least, run.record.value("energy.mean"));
    most = std::max(most, run.record.value("energy.mean"));
  }
  for (std::size_t i = 1; i <= 4; ++i)
    for (std::size_t k = 0; k < runs[i].frames.size(); ++k)
      if (farthest(runs[0].frames[k].state, runs[i].frames[k].state) > kTolerance)
        horizon = std::min(horizon, runs[0].frames[k].t);
  ASSERT_LT(horizon, 0.25);
  EXPECT_TRUE(found.chaotic);
  EXPECT_EQ(found.horizon, horizon);
  ASSERT_EQ(found.answers.size(), 2u);
  EXPECT_EQ(found.answers[0].name, "stretch.max");
  EXPECT_EQ(found.answers[1].name, "energy.mean");
  EXPECT_EQ(found.values, (std::vector<double>{runs[0].record.value("stretch.max"),
                                               runs[0].record.value("energy.mean")}));
  EXPECT_EQ(found.noise, (std::vector<double>{high - low, most - least}))
      << "another order is no rounding error";
  std::vector<double> by_order(2, 0.0);
  for (const CaseSpec& spec : other.order)
    for (std::size_t i = 0; i < 2; ++i)
      by_order[i] = std::max(by_order[i], distance(found.answers[i], runs[0], seen(spec)));
  EXPECT_EQ(found.by_order, by_order);
  EXPECT_EQ(found.given_up,
            std::vector<std::string>{"shape: a rounding error at the start moves it by " +
                                     text({kShapeAnswer}, moved)});

  // With stored results and no time left, the search names what it had to skip.
  options.patience = 1e-6;
  forget(effect(found, "wind").trials[0].spec);
  const Requirement part = find(kStrip, options);
  EXPECT_EQ(part.not_done.front(), "wind");
  EXPECT_EQ(part.not_done.back(), "timing");
  EXPECT_EQ(std::ranges::count(part.not_done, "the verification"), 1);
  EXPECT_FALSE(effect(part, "wind").done());
  EXPECT_FALSE(effect(part, "wind").may_go());
  EXPECT_TRUE(effect(part, "substeps").done());
  EXPECT_FALSE(part.verified);
  EXPECT_FALSE(part.time_ratio);
  EXPECT_EQ(part.horizon, horizon);
  EXPECT_EQ(part.ran, 0u);
  forget(other.rounding[3]);
  const Requirement none = find(kStrip, options);
  EXPECT_EQ(none.not_done, std::vector<std::string>{"the noise of the full model"});
  EXPECT_EQ(none.given_up, std::vector<std::string>{"shape: a rounding error at the start moves it "
                                                    "by 0.0002 mm or more"});
  EXPECT_EQ(none.answers.size(), 2u);
  EXPECT_EQ(none.values, found.values);
  EXPECT_TRUE(none.effects.empty());
}

// In free fall, symplectic steps of h fall g t h / 2 too far and damping slows the fall; both
// errors together exceed the tolerance.
TEST_F(Requirements, OfTwoTooMuchTheSecondGoesAsFarAsItMay) {
  const Requirement found = find(
      "[cloth]\ngrid = [4, 3]\nsize = [1, 0.3]\nmass = 0.1\n[forces]\ndamping = 0.48\n"
      "[links]\nshear = false\n[time]\ndt = \"1/64\"\nduration = 0.25\n",
      {.full = {"", {}, "jakobsen:substeps=4,iterations=1,precision=float"},
       .keep = {"shape:20mm"},
       .patience = 60});
  ASSERT_TRUE(found.not_done.empty()) << found.not_done.front();
  const EffectTrial &damping = effect(found, "damping"), &substeps = effect(found, "substeps"),
                    &duration = effect(found, "duration");
  constexpr double t = 0.25, way = 9.81 * t * t / 2;
  ASSERT_EQ(substeps.trials.size(), 2u);
  EXPECT_NEAR(substeps.trials[0].moved[0], way * (1 / 32.0 - 1 / 64.0), 4e-4);
  EXPECT_NEAR(substeps.trials[1].moved[0], way * (1 / 16.0 - 1 / 64.0), 1.2e-3);
  ASSERT_EQ(damping.trials.size(), 1u);
  EXPECT_NEAR(damping.trials[0].moved[0], way * 0.48 * t / 3, 1e-3) << "to first order";
  EXPECT_EQ(std::pair(damping.allowed, substeps.allowed),
            (std::pair{std::size_t{1}, std::size_t{2}}));
  EXPECT_EQ(&substeps.representative(), &substeps.trials[1]) << "the strongest that stays within";
  EXPECT_GT(damping.trials[0].moved[0] + substeps.trials[1].moved[0], 0.02);
  ASSERT_EQ(duration.trials.size(), 1u) << "no stronger step after one that fails";
  EXPECT_FALSE(duration.may_go());
  EXPECT_EQ(duration.trials[0].steps, 8);
  ASSERT_TRUE(found.smallest);
  EXPECT_EQ(said_to_go(found), (std::vector<std::string>{"damping: gone", "substeps: 4 -> 2"}));
  EXPECT_EQ(std::pair(damping.chosen, substeps.chosen),
            (std::pair{std::optional<std::size_t>(0), std::optional<std::size_t>(0)}));
  EXPECT_FALSE(duration.chosen);
  const Case smallest = make_case(found.smallest->spec);
  EXPECT_EQ(smallest.scene->damping, 0);
  EXPECT_EQ(smallest.choice.params.integer("substeps"), 2);
  EXPECT_NEAR(found.smallest->moved[0], damping.trials[0].moved[0] + substeps.trials[0].moved[0],
              4e-4);
}

TEST_F(Requirements, OfClothAtRestEverythingGoes) {
  const Requirement found = find(
      "[cloth]\ngrid = [8, 3]\nsize = [1, 0.3]\nmass = 0.1\npins = [\"top-left\"]\n"
      "[forces]\ngravity = [0, 0, 0]\n[time]\ndt = \"1/64\"\nduration = 0.25\n",
      {.full = {"", {}, "jakobsen:substeps=3,iterations=4,precision=float"},
       .keep = {"shape:0.1%"},
       .patience = 60});
  ASSERT_TRUE(found.not_done.empty()) << found.not_done.front();
  ASSERT_TRUE(found.smallest);
  std::vector<std::tuple<bool, bool, double, std::string>> expected;
  for (const EffectTrial& one : found.effects) {
    ASSERT_EQ(one.allowed, one.trials.size()) << one.name;
    const ModelTrial& last = one.trials.back();
    EXPECT_EQ(one.chosen, one.allowed - 1);
    expected.emplace_back(last.moved[0] > found.noise[0], !last.removes,
                          static_cast<double>(work_of(last.cost)) * last.steps,
                          one.name + ": " + last.change);
  }
  std::ranges::stable_sort(expected, {}, [](const auto& one) {
    return std::tuple(std::get<0>(one), std::get<1>(one), std::get<2>(one));
  });
  std::vector<std::string> names;
  for (const auto& one : expected) names.push_back(std::get<3>(one));
  EXPECT_EQ(said_to_go(found), names);
  EXPECT_EQ(names.front(), "shear links: gone");
  const Case smallest = make_case(found.smallest->spec);
  EXPECT_EQ(smallest.scene->steps, 2);
  EXPECT_EQ(smallest.choice.canonical().find("substeps=3"), std::string::npos);
  ASSERT_TRUE(found.time_ratio);
  EXPECT_LT(found.time_ratio->mid, 0.3) << "an eighth of the steps, each cheaper";
  const std::optional<Interval>& shorter = effect(found, "duration").time;
  ASSERT_TRUE(shorter);
  EXPECT_TRUE(shorter->mid > 0.03 && shorter->mid < 0.5) << shorter->mid << ", not an eighth";
  EXPECT_LE(shorter->low, shorter->mid);
  EXPECT_LE(shorter->mid, shorter->high);
  EXPECT_LT(shorter->high, 2) << "an eighth of the time, and noise";
}

TEST_F(Requirements, WhatTheTimeDoesNotSufficeForIsSaid) {
  const Requirement none = find(kStrip, {.full = {"", {}, "jakobsen"}, .patience = 1e-6});
  EXPECT_EQ(none.not_done, std::vector<std::string>{"the full model"});
  EXPECT_TRUE(none.effects.empty());
  EXPECT_FALSE(none.smallest);
}

TEST_F(Requirements, AModelThatDoesNotRunToItsEndRequiresNothing) {
  EXPECT_THROW(
      find(kStrip, {.full = {"", {"time.dt=0.2", "time.duration=20"}, "mass-spring:substeps=1"},
                    .patience = 60}),
      InputError);
}

}  // namespace
}  // namespace taut::require_search_test
