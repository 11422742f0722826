// Studies: the exact cases that a file asks for.
#include "experiments/study/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::study_test {
namespace {

Study study_of(const std::string& text, const std::string& preset = "") {
  const std::string file = testing::TempDir() + unique_suffix() + ".toml";
  std::ofstream(file) << text;
  const Study study = load_study(file, preset);
  std::filesystem::remove(file);
  return study;
}

std::vector<std::string> ids(const Study& study) {
  std::vector<std::string> all;
  for (const Case& one : cases_of(study)) all.push_back(one.id);
  return all;
}

using Strings = std::vector<std::string>;

TEST(Study, EveryCombinationIsACaseScenesOutermost) {
  const Study study = study_of(R"(
question = "?"
scenes = ["chain", "fall"]
solvers = ["jakobsen:precision=double"]
[axes]
"time.dt" = ["1/32", 0.5]
iterations = [1, 2]
)");
  EXPECT_EQ(ids(study), (Strings{"chain dt=1/32 jakobsen:iterations=1,precision=double",
                                 "chain dt=1/32 jakobsen:iterations=2,precision=double",
                                 "chain dt=0.5 jakobsen:iterations=1,precision=double",
                                 "chain dt=0.5 jakobsen:iterations=2,precision=double",
                                 "fall dt=1/32 jakobsen:iterations=1,precision=double",
                                 "fall dt=1/32 jakobsen:iterations=2,precision=double",
                                 "fall dt=0.5 jakobsen:iterations=1,precision=double",
                                 "fall dt=0.5 jakobsen:iterations=2,precision=double"}));
}

TEST(Study, SearchedSettingsReplaceSolversSceneByScene) {
  const Scratch scratch;
  const auto file = scratch.path() / "mine.toml", searched = scratch.path() / "mine-searched.toml";
  std::ofstream(file) << R"(
question = "?"
scenes = ["chain", "fall:time.duration=1"]
solvers = ["jakobsen", "xpbd"]
searched = "mine-searched.toml"
)";
  const auto message = [&] {
    try {
      cases_of(load_study(file.string()));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(
      message().find("mine-searched.toml: no settings for scene 'chain': `taut advise --study "
                     "mine` searches them"),
      std::string::npos)
      << message();
  const double nan = std::nan("");
  const std::vector<SearchedSetting> rows{
      {"chain", "jakobsen:iterations=1,substeps=2", 0.02, 1e-4, "", false, {0.03}, {0.03, 0.1}},
      {"chain", "jakobsen:iterations=9,substeps=1", 0.02, 3e-4, "", false, {}, {}},
      {"chain", "xpbd:substeps=4", nan, nan, "exploded, \"at\" 2", false, {}, {}},
      {"fall:time.duration=1", "xpbd:substeps=3", 0.5, 1e-4, "", true, {}, {}}};
  std::ofstream(searched) << searched_toml("# as found\n", rows, {"chain, xpbd: it exploded"});
  EXPECT_EQ(ids(load_study(file.string())),
            (Strings{"chain jakobsen:iterations=1,substeps=2", "chain jakobsen", "chain xpbd",
                     "fall duration=1 xpbd:substeps=3", "fall duration=1 jakobsen",
                     "fall duration=1 xpbd"}))
      << "and each solver as it comes";
  const auto again = read_searched(searched);
  ASSERT_EQ(again.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(again[i].solver, rows[i].solver);
    EXPECT_EQ(again[i].refused, rows[i].refused);
    EXPECT_EQ(again[i].plain, rows[i].plain);
    EXPECT_EQ(again[i].best, rows[i].best);
    EXPECT_EQ(std::isnan(again[i].error), std::isnan(rows[i].error));
  }
  std::ofstream(searched) << "tried = [\n  { scene = \"chain\", solver = \"jakobson\", best = 1, "
                             "worst = 2 },\n]\n";
  const std::string wrong = message();
  for (const char* said :
       {"mine-searched.toml:2:", "did you mean 'jakobsen'?", "'best'", "unknown key 'worst'"})
    EXPECT_NE(wrong.find(said), std::string::npos) << said << " in " << wrong;
}

TEST(Study, WhatIsWrongWithItAndWithItsScenesIsSaidAtOnce) {
  const Scratch scratch;
  const auto folder = scratch.path();
  std::ofstream(folder / "bad.toml") << "[cloth]\ngrid = [3, 3]\nsize = [1, 1]\ntickness = 1\n";
  std::ofstream(folder / "study.toml")
      << "question = \"?\"\nscenes = [\"" << (folder / "bad.toml").string()
      << "\"]\nsolvers = [\"jakobsen\"]\nset = [\"forces.damping=-1\"]\nplots = 1\n"
         "[axes]\n\"time.dt\" = [0.5, \"0\"]\n";
  try {
    load_study((folder / "study.toml").string());
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* part :
         {"bad.toml:4:1: unknown key 'tickness'", "study.toml:5:1: unknown key 'plots'",
          "study.toml:4:8: forces.damping=-1: 'damping' in [forces]",
          "study.toml:7:19: time.dt=\"0\": 'dt' in [time]"})
      EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

TEST(Study, AParameterVariesWhereItIsNotFixed) {
  const Study study = study_of(R"(
question = "?"
scenes = ["fall"]
solvers = ["jakobsen", "jakobsen:iterations=9", "bullet:iterations=1"]
axes.projection = ["exact", "sqrt-free"]
axes.iterations = [4]
)");
  EXPECT_EQ(ids(study),
            (Strings{"fall jakobsen:iterations=4,projection=exact", "fall jakobsen:iterations=4",
                     "fall jakobsen:iterations=9,projection=exact", "fall jakobsen:iterations=9",
                     "fall bullet:iterations=1"}));
}

TEST(Study, RangesAreLinearLogarithmicOrWhole) {
  const Study study = study_of(R"(
question = "?"
scenes = ["fall"]
solvers = ["jakobsen"]
[axes]
iterations = { from = 1, to = 256, steps = 9, scale = "log" }
substeps = { from = 1, to = 2, steps = 5 }
"time.dt" = { from = "1/100", to = "1/10", steps = 2, scale = "log" }
)");
  EXPECT_EQ(study.axes[0].values, (Strings{"1", "2", "4", "8", "16", "32", "64", "128", "256"}));
  EXPECT_EQ(study.axes[1].values, (Strings{"1", "2"})) << "rounded, repetitions dropped";
  EXPECT_EQ(study.axes[2].values, (Strings{"0.01", "0.1"}));
}

TEST(Study, PresetsReplaceWhatTheyName) {
  const std::string text = R"(
question = "?"
scenes = ["fall", "hang"]
solvers = ["jakobsen", "bullet"]
axes.iterations = [1, 2, 4]
axes.substeps = [1, 2]
[preset.quick]
scenes = ["fall"]
axes.iterations = [8]
)";
  const Study whole = study_of(text), quick = study_of(text, "quick");
  EXPECT_EQ(whole.presets, Strings{"quick"});
  EXPECT_EQ(cases_of(whole).size(), 2u * 2 * 3 * 2);
  EXPECT_EQ(quick.scenes, Strings{"fall"});
  EXPECT_EQ(cases_of(quick).size(), 1u * 2 * 1 * 2);
  EXPECT_EQ(quick.preset, "quick");
}

TEST(Study, ExclusionsMatchAllOfTheirSettings) {
  const Study study = study_of(R"(
question = "?"
scenes = ["fall", "chain"]
solvers = ["jakobsen", "bullet"]
exclude = [{ scene = "fall", iterations = [2, 4] }, { solver = "bullet", iterations = 4 }]
axes.iterations = [1, 2, 4]
)");
  EXPECT_EQ(ids(study), (Strings{"fall jakobsen:iterations=1", "fall bullet:iterations=1",
                                 "chain jakobsen:iterations=1", "chain jakobsen:iterations=2",
                                 "chain jakobsen:iterations=4", "chain bullet:iterations=1",
                                 "chain bullet:iterations=2"}));
}

TEST(Study, TheSameSimulationIsOneCase) {
  const Study study = study_of(R"(
question = "?"
scenes = ["fall"]
solvers = ["jakobsen", "jakobsen:iterations=3"]
axes."time.dt" = ["1/64", 0.015625]
)");
  EXPECT_EQ(cases_of(study).size(), 1u);
}

TEST(Study, TooManyCasesAreRefusedBeforeTheyAreMade) {
  const Study study = study_of(R"(
question = "?"
scenes = ["fall", "chain"]
solvers = ["jakobsen"]
[axes]
"time.dt" = { from = "1/1000", to = "1/10", steps = 1000 }
"forces.damping" = { from = 0, to = 1, steps = 1000 }
)");
  try {
    cases_of(study);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("2000000 cases; at most 100000"), std::string::npos)
        << error.what();
  }
}

TEST(Study, ShippedStudiesAndTheirPresetsArePlans) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "thousands of cases; fuzz.study reads studies under sanitizers";
#endif
  ASSERT_GE(shipped("studies").size(), 10u);
  for (const std::string& name : shipped("studies")) {
    Study study = load_study(name);
    EXPECT_FALSE(cases_of(study).empty()) << name;
    for (const std::string& preset : study.presets) {
      const Study smaller = load_study(name, preset);
      EXPECT_EQ(smaller.preset, preset);
      EXPECT_FALSE(cases_of(smaller).empty()) << name << " " << preset;
    }
  }
}

TEST(Key, DiffersWithEverythingThatMatters) {
  CaseMaker maker;
  std::set<std::string> keys;
  const std::vector<CaseSpec> specs{
      {"chain", {}, "jakobsen"},
      {"fall", {}, "jakobsen"},
      {"chain", {"time.dt=\"1/128\""}, "jakobsen"},
      {"chain", {"time.duration=1"}, "jakobsen"},
      {"chain", {"forces.gravity=[0, 9.81, 0]"}, "jakobsen"},
      {"chain", {}, "jakobsen:iterations=4"},
      {"chain", {}, "bullet"},
      {"chain", {}, "bullet:precision=float"},
  };
  for (const CaseSpec& spec : specs) keys.insert(maker.make(spec).key);
  EXPECT_EQ(keys.size(), specs.size());
  EXPECT_EQ(maker.make({"chain", {}, "jakobsen:iterations=3"}).key, maker.make(specs[0]).key)
      << "a default that is spelt out is the same case";
}

TEST(Key, EverySolverHasAnImplementationDigest) {
  std::set<std::string_view> digests;
  for (const SolverEntry* entry : solvers()) {
    EXPECT_EQ(implementation(entry->name).size(), 64u) << entry->name;
    EXPECT_EQ(layer_digest(entry->name).size(), 64u) << entry->name;
    digests.insert(implementation(entry->name));
  }
  EXPECT_EQ(digests.size(), solvers().size()) << "each has its own";
  EXPECT_EQ(measurement().size(), 64u);
  EXPECT_EQ(layer_digest("jakobsen"), layer_digest("vbd"));
  EXPECT_NE(layer_digest("jakobsen"), layer_digest("bullet"));
}

}  // namespace
}  // namespace taut::study_test
