// The search for the smallest model, on cases that the test program itself runs
// (tests/support/main.cpp).
#include <gtest/gtest.h>

#include "experiments/case/digest.hpp"
#include "experiments/require/require.hpp"
#include "experiments/system/files.hpp"

namespace taut::require_search_test {
namespace {

class Requirements : public testing::Test {
 protected:
  Requirement find(const std::string& scene, RequireOptions options) {
    write_file(scratch_.path() / "s.toml", scene);
    options.full.scene = (scratch_.path() / "s.toml").string(), options.jobs = 2;
    store_.prepare();
    return find_requirement(options, store_, Session(store_, "a test", {}, {}),
                            scratch_.path() / "made");
  }
  static const EffectTrial& effect(const Requirement& found, const std::string& name) {
    return *std::ranges::find(found.effects, name, &EffectTrial::name);
  }
  const Scratch scratch_;
  const Store store_{scratch_.path() / "results"};
};

// A strip on one pin in a wind that does nothing. Its last vertex is pinned by number: there is no
// coarser grid with it.
const std::string kStrip =
    "[cloth]\ngrid = [8, 3]\nsize = [1, 0.3]\nmass = 0.1\npins = [0, 23]\n[wind]\nvelocity = [3, "
    "0, 1]\nstrength = 0\n"
    "[links]\nshear = false\n[time]\ndt = \"1/64\"\nduration = 0.25\n";

TEST_F(Requirements, DropWhatDoesNothingKeepWhatMattersAndNameWhatCannotBe) {
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
