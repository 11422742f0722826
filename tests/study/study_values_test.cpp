// Values that a study's file varies. All errors in a file are reported at once, each with its
// place.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/files.hpp"

namespace taut::study_values_test {
namespace {

using Strings = std::vector<std::string>;

class StudyFile : public testing::Test {
 protected:
  Study read(const std::string& text, const std::string& preset = "") const {
    write_file(file_, text);
    return load_study(file_, preset);
  }
  /// Line, column and message of each error.
  std::string wrong(const std::string& text) const {
    std::string all;
    try {
      cases_of(read(text));
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics()) {
        EXPECT_EQ(d.file, file_);
        all += std::to_string(d.line) + ":" + std::to_string(d.column) + ": " + d.message + "\n";
      }
    }
    return all;
  }
  const Scratch folder_;
  const std::string file_ = folder_.path() / "asked.toml";
};

// A range has the exact ends that the file states, whatever rounding does in between.
TEST_F(StudyFile, ARangeHasItsEndsToTheLastDigit) {
  for (const std::string scale : {"linear", "log"})
    for (const std::string from : {"0.1", "0.3", "0.007", "3"})
      for (const std::string to : {"0.7", "0.9", "1.1", "49", "1000"}) {
        const Study study = read(
            "question = \"?\"\nscenes = [\"hang\"]\nsolvers = "
            "[\"jakobsen\"]\n[axes]\n\"forces.damping\" = { from = " +
            from + ", to = " + to + ", steps = 4, scale = \"" + scale + "\" }\n");
        const Strings& values = study.axes.at(0).values;
        ASSERT_EQ(values.size(), 4u);
        EXPECT_EQ(values.front(), from) << to << scale;
        EXPECT_EQ(values.back(), to) << from << scale;
      }
}

TEST_F(StudyFile, GivesItsValuesAsTheyWereTyped) {
  const Study study = read(R"(question = "Why?"
scenes = ["hang"]
solvers = ["jakobsen"]
set = ["time.duration=1", "links.bend=true"]
[axes]
time.dt = ["1/64", 0.02, 100000]
"cloth.grid" = [[4, 5], [6, 7]]
"links.bend" = [true, false]
"cloth.mesh" = ['a"b\c']
fabric = ["petrak-m1"]
"forces.damping" = { from = 0, to = 1, steps = 5 }
"wind.strength" = { from = 8, to = 0.5, steps = 5, scale = "log" }
"cloth.mass" = [999999999999999, 1000000000000000]
iterations = [3, 1]
order = ["mesh", "coloured"]
[[plot]]
kind = "convergence"
y = "stretch.max"
slope = -0.5
[[plot]]
kind = "scaling"
)");
  EXPECT_EQ(study.name, "asked");
  EXPECT_EQ(study.question, "Why?");
  EXPECT_EQ(study.settings, (SceneSettings{"time.duration=1", "links.bend=true"}));
  std::string all;
  for (const StudyAxis& axis : study.axes) {
    all += axis.name + (axis.of_scene() ? "*" : "") + ":";
    for (const std::string& value : axis.values) all += " " + value;
    all += "\n";
  }
  EXPECT_EQ(all,
            "cloth.grid*: [4, 5] [6, 7]\n"
            "cloth.mass*: 999999999999999 1e+15\n"
            "cloth.mesh*: \"a\\\"b\\\\c\"\n"
            "fabric*: \"petrak-m1\"\n"
            "forces.damping*: 0 0.25 0.5 0.75 1\n"
            "iterations: 3 1\n"
            "links.bend*: true false\n"
            "order: mesh coloured\n"
            "time.dt*: \"1/64\" 0.02 100000\n"
            "wind.strength*: 8 4 2 1 0.5\n");
  const auto place = [&](const std::string& text) {
    const SourceLocation at = study.places.at(text);
    return std::pair(at.line, at.column);
  };
  EXPECT_EQ(place("links.bend=true"), std::pair(8, 17)) << "the axis, which is read after it";
  EXPECT_EQ(place("time.duration=1"), std::pair(4, 8));
  EXPECT_EQ(place("time.dt=0.02"), std::pair(6, 20));
  EXPECT_EQ(place("forces.damping=0.75"), std::pair(11, 20));
  ASSERT_EQ(study.plots.size(), 2u);
  EXPECT_EQ(study.plots[0].kind, "convergence");
  EXPECT_EQ(study.plots[0].options,
            (std::map<std::string, std::string>{{"y", "stretch.max"}, {"slope", "-0.5"}}));
  EXPECT_EQ(study.plots[0].places.at("slope").line, 19);
  EXPECT_EQ(study.plots[1].kind, "scaling");
}

TEST_F(StudyFile, AnAxisMayHoldTables) {
  const std::string head = "question = \"?\"\nscenes = [\"hang\"]\nsolvers = [\"jakobsen\"]\n";
  std::string pins, stiffness;
  for (const Case& one : cases_of(read(
           head + "set = [\"cloth.grid=[3, 3]\"]\n[axes]\n"
                  "\"cloth.pins\" = [[\"top\"], [{ edge = \"bottom\", at = 0.5 }], [0, 8]]\n"))) {
    for (const int pin : one.scene->pins) pins += std::to_string(pin) + " ";
    pins += "; ";
  }
  EXPECT_EQ(pins, "0 1 2 ; 7 ; 0 8 ; ");
  for (const Case& one : cases_of(
           read("question = \"?\"\nscenes = [\"hang\"]\nsolvers = [\"pd\"]\n"
                "exclude = [{ \"links.stiffness\" = { structural = 7, shear = 8 } }]\n[axes]\n"
                "\"links.stiffness\" = [{ structural = 50, shear = 2.5 }, { structural = 7, shear "
                "= 8 }]\n\"bending.stiffness\" = [1e-5, { warp = 1e-5, weft = 2e-5 }]\n"))) {
    for (const double k :
         {one.scene->stiffness[0], one.scene->stiffness[1], 1e5 * one.scene->bending->weft})
      stiffness += std::to_string(std::lround(2 * k)) + " ";
    stiffness += "; ";
  }
  EXPECT_EQ(stiffness, "100 5 2 ; 100 5 4 ; ");
}

TEST_F(StudyFile, WhatIsNoTextOrNumberIsNeverZero) {
  const std::string head = "question = \"?\"\nscenes = [\"hang\"]\nsolvers = [\"jakobsen\"]\n";
  const std::string said = "holds texts and numbers, no tables or dates\n";
  EXPECT_EQ(wrong(head + "axes.iterations = [{ from = 1 }]\n"), "4:20: 'iterations' " + said);
  EXPECT_EQ(wrong(head + "axes.\"time.duration\" = [1979-05-27]\n"),
            "4:25: 'time.duration' holds no dates\n");
  EXPECT_EQ(wrong(head + "axes.iterations = [1]\nexclude = [{ iterations = [{ a = 1 }] }]\n"),
            "5:28: 'iterations' " + said);
  EXPECT_EQ(wrong(head + "[[plot]]\nkind = \"convergence\"\ntitle = { a = 1 }\n"),
            "6:9: 'title' " + said);
}

TEST_F(StudyFile, APresetReplacesAnAxisAndPutsItLast) {
  const std::string text = R"(question = "?"
scenes = ["hang"]
solvers = ["jakobsen"]
axes.iterations = [1, 2]
axes.substeps = [4, 8]
exclude = [{ iterations = 1 }]
[preset.small]
axes.iterations = [16]
exclude = []
[preset.other]
solvers = ["bullet"]
)";
  const Study small = read(text, "small"), whole = read(text);
  EXPECT_EQ(small.axes[0].name + small.axes[1].name, "substepsiterations");
  EXPECT_EQ(small.axes[1].values, Strings{"16"});
  EXPECT_EQ(whole.axes[0].values, (Strings{"1", "2"}));
  EXPECT_EQ(small.presets, (Strings{"other", "small"}));
  EXPECT_TRUE(small.exclusions.empty());
  EXPECT_EQ(cases_of(small).size(), 2u);
  EXPECT_EQ(cases_of(whole).size(), 2u) << "half of the four are excluded";
  EXPECT_EQ(read(text, "other").solvers, Strings{"bullet"});
  try {
    read(text, "smal");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              file_ + ": study 'asked' has no preset 'smal'; did you mean 'small'?");
  }
}

// Parameters of the same name may mean different things in two solvers.
TEST_F(StudyFile, AnAxisMayBeOfOneSolverAndNeverMixesUnits) {
  const auto asked = [](const std::string& axes) {
    return "question = \"?\"\nscenes = [\"hang\"]\n"
           "solvers = [\"jakobsen\", \"xpbd\", \"mass-spring\"]\n" +
           axes;
  };
  std::string all;
  for (const Case& one : cases_of(read(asked("axes.substeps = [1, 2]\n"
                                             "axes.\"xpbd:substeps\" = [3]\n"))))
    all += one.choice.entry->name[0] + std::string(one.choice.params.value("substeps")) + " ";
  EXPECT_EQ(all, "j1 j2 x3 m1 m2 ");
  EXPECT_EQ(wrong(asked("axes.structural = [1, 2]\n")),
            "4:6: 'structural' is N/m in mass-spring and m/N in xpbd: an axis for each, as "
            "\"xpbd:structural\"\n");
  EXPECT_EQ(cases_of(read(asked("axes.\"xpbd:structural\" = [1e-4, 1e-3]\n"))).size(), 4u);
  EXPECT_NE(wrong(asked("axes.\"jakobsen:structural\" = [1]\n")).find("no solver of this study"),
            std::string::npos);
}

TEST_F(StudyFile, AllIsEveryShippedScene) {
  const auto scenes = [&](const std::string& list) {
    return read("question = \"?\"\nscenes = [" + list + "]\nsolvers = [\"jakobsen\"]\n").scenes;
  };
  const Strings all = scenes("\"all\"");
  EXPECT_GT(all.size(), 10u);
  EXPECT_EQ(std::ranges::count(all, "hang"), 1);
  EXPECT_EQ(scenes("\"hang\", \"all\"").size(), all.size());
  EXPECT_EQ(scenes("\"hang\", \"all\"").front(), "hang");
}

TEST_F(StudyFile, ASceneMayHaveSettingsOfItsOwn) {
  const auto asked = [](const std::string& scenes) {
    return "question = \"?\"\nscenes = [" + scenes + "]\nsolvers = [\"jakobsen\"]\n" +
           "set = [\"time.duration=1\"]\n";
  };
  std::string all;
  for (const Case& one :
       cases_of(read(asked("\"strip\", \"drape:cloth.span=0.7,cloth.grid='[8, 4]'\"")))) {
    if (one.scene->name == "strip") continue;
    const int last = one.scene->mesh.grid->nu - 1;
    const double span = one.scene->start.x[static_cast<std::size_t>(last)].x();
    all += std::to_string(last) + " " + std::to_string(std::lround(100 * span)) + " " +
           std::to_string(one.scene->steps) + "; ";
  }
  EXPECT_EQ(all, "7 70 64; ");
  EXPECT_EQ(wrong(asked("\"drape:cloth.span\"")),
            "2:11: scene 'drape': expected key=value, got 'cloth.span'\n");
  EXPECT_EQ(wrong(asked("\"hang\", \"drap:cloth.span=0.7\"")).substr(0, 5), "2:19:");
  EXPECT_EQ(wrong(asked("\"hang\", \"drape:cloth.spam=0.7\"")).substr(0, 30),
            "2:19: cloth.spam=0.7: unknown ");
  EXPECT_EQ(wrong(asked("\"drape:\"")),
            "2:11: scene 'drape': key=value is missing after the colon\n");
  EXPECT_EQ(wrong(asked("\"drape:cloth.span=0.7,cloth.span=0.8\"")),
            "2:11: scene 'drape': 'cloth.span' is given twice\n");
  EXPECT_EQ(wrong(asked("\"all:cloth.span=0.7\"")),
            "2:11: 'all' has no settings of its own: `set` holds for every scene\n");
  EXPECT_EQ(wrong(asked("\"drape\", \"drape:cloth.span=0.7\"")),
            "2:20: scene 'drape' is listed twice: vary a setting by an axis\n");
  EXPECT_EQ(wrong(asked("\"drape:cloth.span=0.7\"") + "axes.\"cloth.span\" = [0.8, 0.9]\n"),
            "2:11: 'cloth.span' of scene 'drape' is an axis of the study\n");
  // The hem of `hang` has no collider; the ball has one with the same setting.
  EXPECT_EQ(
      wrong(asked("\"ball:collider.0.radius=0.3\", \"hang:collider.0.radius=0.3\"")).substr(0, 5),
      "2:41:");
}

// A list is one value for a key of a scene, and several values for scenes, solvers and parameters.
TEST_F(StudyFile, AnExclusionNamesAnyOfSomeValues) {
  const auto left = [&](const std::string& exclusion) {
    std::string all;
    for (const Case& one : cases_of(read("question = \"?\"\nscenes = [\"hang\"]\n"
                                         "solvers = [\"jakobsen\", \"xpbd\"]\nexclude = [" +
                                         exclusion +
                                         "]\naxes.substeps = [1, 2]\n"
                                         "axes.\"cloth.grid\" = [[4, 5], [5, 4]]\n")))
      all += one.choice.entry->name[0] + std::string(one.choice.params.value("substeps")) + "@" +
             std::to_string(one.scene->mesh.grid->nu) + " ";
    return all;
  };
  EXPECT_EQ(left(""), "j1@4 j2@4 x1@4 x2@4 j1@5 j2@5 x1@5 x2@5 ");
  EXPECT_EQ(left("{ \"cloth.grid\" = [4, 5] }"), "j1@5 j2@5 x1@5 x2@5 ");
  EXPECT_EQ(left("{ \"cloth.grid\" = [4, 5], substeps = 2 }"), "j1@4 x1@4 j1@5 j2@5 x1@5 x2@5 ");
  EXPECT_EQ(left("{ substeps = [2, 1], solver = [\"xpbd\", \"bullet\"] }"), "j1@4 j2@4 j1@5 j2@5 ");
  EXPECT_EQ(left("{ scene = \"fall\" }, { scene = [\"hang\"], substeps = 1 }"),
            "j2@4 x2@4 j2@5 x2@5 ");
  EXPECT_EQ(wrong("question = \"?\"\nscenes = [\"hang\"]\nsolvers = [\"jakobsen\"]\nexclude = [\n"
                  "{ scene = \"hamg\" },\n{ solver = [\"xpbd\", \"jakobson\"] }]\n"),
            "5:11: unknown scene 'hamg'; did you mean 'hang'? (`taut list scenes` names all; a "
            "path has a '/' or ends in .toml)\n"
            "6:21: unknown solver 'jakobson'; did you mean 'jakobsen'? (`taut list solvers` names "
            "all)\n");
}

TEST_F(StudyFile, WhatIsWrongIsSaidWithItsPlaceAllAtOnce) {
  EXPECT_EQ(wrong(R"(question = ""
scenes = ["hang", 3]
solvers = ["jakobsen:iteratons=2", "jakobsen"]
set = 7
[axes]
colour = [1]
iterations = { from = 1, to = 4 }
order = []
substeps = 7
projection = ["exact", "none"]
"time.dt" = { from = 0, to = 1, steps = 3, scale = "log" }
"time.duration" = { from = 1, to = 2, steps = 1 }
"forces.damping" = { from = 1, to = 2, steps = 3, scale = "lin" }
"wind.strength" = { from = 1, too = 2, steps = 3 }
[preset.p]
exclude = [3, { scen = "hang" }]
[preset.q]
solver = ["bullet"]
[[plot]]
knd = "x"
)"),
            "1:1: missing key 'question' in the study\n"
            "2:19: 'scenes' holds texts, not a whole number\n"
            "3:22: jakobsen: unknown parameter 'iteratons'; did you mean 'iterations'?\n"
            "4:7: 'set' in the study must be a list of texts, not a whole number\n"
            "6:1: no solver of this study has a parameter 'colour' (a scene key has a dot, as "
            "\"time.dt\"; a parameter of one solver a colon, as \"xpbd:substeps\")\n"
            "7:14: missing key 'steps' in the range\n"
            "8:9: 'order' must be a list of values or a range { from, to, steps, scale }\n"
            "9:12: 'substeps' must be a list of values or a range { from, to, steps, scale }\n"
            "10:25: jakobsen: projection=none is not one of exact|sqrt-free\n"
            "11:13: a logarithmic range needs ends greater than 0\n"
            "12:47: 'steps' in the range must be at least 2 and at most 1000, not 1\n"
            "13:59: 'scale' in the range must be \"linear\" or \"log\", not \"lin\"; did you mean "
            "'log'?\n"
            "14:19: missing key 'to' in the range\n"
            "14:31: unknown key 'too' in the range; did you mean 'to'?\n"
            "16:12: an exclusion is a table such as { scene = \"ball\" }\n"
            "16:17: nothing that this study varies is called 'scen'; did you mean 'scene'? (scene, "
            "solver, or an axis's name)\n"
            "18:1: unknown key 'solver' in [preset.q]; did you mean 'solvers'?\n"
            "19:1: missing key 'kind' in [[plot]]\n"
            "20:1: unknown key 'knd' in [[plot]]; did you mean 'kind'?\n");
}

TEST_F(StudyFile, WhatNobodyCanRunIsRefused) {
  const std::string good = "question = \"?\"\nscenes = [\"hang\"]\nsolvers = [\"jakobsen\"]\n";
  EXPECT_EQ(wrong(good), "");
  EXPECT_EQ(wrong("question = \"?\"\n"),
            "1:1: missing key 'scenes' in the study\n1:1: missing key 'solvers' in the study\n");
  const std::string said =
      ": a text of a study holds no line breaks, tabs or other control "
      "characters\n";
  EXPECT_EQ(wrong("question = \"a\\tb\"\n" + good.substr(15)), "1:12" + said);
  EXPECT_EQ(wrong("question = \"a\\u007fb\"\n" + good.substr(15)), "1:12" + said);
  EXPECT_EQ(wrong(good + "set = [\"a b\", \"a\\nb\"]\n"), "4:15" + said);
  EXPECT_EQ(wrong(good + "\"a\\u001fb\" = 1\n"), "4:1" + said);
  EXPECT_EQ(wrong(good + "exclude = 3\n"),
            "4:11: 'exclude' in the study must be a list of tables\n");
  EXPECT_EQ(wrong(good + "set = [\"time.td=1\"]\n"),
            "4:8: time.td=1: unknown key 'td' in [time]; did you mean 'dt'?\n");
}

}  // namespace
}  // namespace taut::study_values_test
