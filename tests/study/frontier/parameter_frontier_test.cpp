// Symptoms of a run, the cases that a setting generates, and frontiers compared with stored ones.
#include "experiments/study/frontier/parameter_frontier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut::parameter_frontier_test {
namespace {

using Names = std::vector<std::string>;

JudgedRun swing(const std::map<std::string, double>& values, Status status = {}) {
  JudgedRun seen{make_case({"swing", {"cloth.grid=[9, 9]"}, "jakobsen"}), {}, {}};
  seen.record.status = status;
  seen.record.values = values;
  seen.end = seen.one.scene->start.x;
  return seen;
}

TEST(Symptoms, EachIsSeenInItsOwnMetricAndNowhereElse) {
  const JudgedRun start = swing({{"drift.max", 1}, {"popping.max", 30}});
  const auto of = [&](const std::map<std::string, double>& values, Status status = {}) {
    std::map<std::string, double> all{{"drift.max", 1}, {"popping.max", 30}};
    for (const auto& [name, value] : values) all[name] = value;
    return symptoms(swing(all, status), &start);
  };
  EXPECT_EQ(of({}), Names{});
  EXPECT_EQ(of({{"tunnelling.count", 1}}), Names{"tunnels"});
  EXPECT_EQ(of({{"stretch.max", 1.01}}), Names{"overstretches"});
  EXPECT_EQ(of({{"stretch.max", 0.99}}), Names{});
  EXPECT_EQ(of({{"drift.max", 0.09}}), Names{"freezes"});
  EXPECT_EQ(of({{"drift.max", 0.11}}), Names{});
  EXPECT_EQ(of({{"popping.max", 1000}}), Names{"jitters"});
  EXPECT_EQ(of({{"popping.max", 970}}), Names{}) << "below 100 g";
  // The swing releases 10.4 % of m g L.
  EXPECT_EQ(of({{"energy.peak", 0.006}}), Names{"gains energy"});
  EXPECT_EQ(of({{"energy.peak", 0.004}}), Names{});
  EXPECT_EQ(of({{"energy.mean", -0.056}}), Names{"loses energy"});
  EXPECT_EQ(of({{"energy.mean", -0.048}}), Names{});
  EXPECT_EQ(of({{"stretch.max", 2}, {"energy.mean", -1}}),
            (Names{"overstretches", "loses energy"}));
  EXPECT_EQ(of({}, {Status::Kind::exploded, Reason::nonfinite}), Names{"NaN"});
  EXPECT_EQ(of({}, {Status::Kind::exploded, Reason::energy}), Names{"explodes"});
  EXPECT_EQ(of({}, {Status::Kind::exploded, "nonfinite"}), Names{"explodes"}) << "a solver's words";
  EXPECT_EQ(of({}, {Status::Kind::crash, "SIGSEGV"}), Names{"crashes"});
  EXPECT_EQ(of({}, {Status::Kind::unsupported, "no"}), Names{"refuses"});
  EXPECT_EQ(of({}, {Status::Kind::extreme, Reason::stretch}), Names{"overstretches"});
  EXPECT_EQ(of({}, {Status::Kind::unsettled, ""}), Names{"jitters"});
}

TEST(Symptoms, ASmallClothIsNotFrozenForMovingLess) {
  const JudgedRun start = swing({{"drift.max", 1}});
  JudgedRun small = swing({{"drift.max", 0.02}});
  small.one = make_case({"swing", {"cloth.size=[0.1, 0.1]"}, "jakobsen"});
  EXPECT_EQ(symptoms(small, &start), Names{});
  small.record.values["drift.max"] = 0.009;
  EXPECT_EQ(symptoms(small, &start), Names{"freezes"});
}

TEST(Symptoms, AsymmetryIsTheDistanceFromTheMirrorImage) {
  JudgedRun seen = swing({});
  const double size = extent(*seen.one.scene);
  EXPECT_NEAR(asymmetry(*seen.one.scene, seen.end), 0, 1e-12);
  seen.end[9 * 8].z() += 0.05 * size;
  EXPECT_NEAR(asymmetry(*seen.one.scene, seen.end), 0.05 * size, 1e-12);
  EXPECT_EQ(symptoms(seen, nullptr), Names{});
  seen.end[9 * 8].z() += 0.06 * size;
  EXPECT_EQ(symptoms(seen, nullptr), Names{"asymmetric"});
  const Case blown = make_case({"swing", {"wind={ velocity = [1, 0, 0] }"}, "jakobsen"});
  EXPECT_EQ(asymmetry(*blown.scene, blown.scene->start.x), 0) << "wind from the side";
}

// The mirror plane passes through the middle of the first side, wherever that is.
TEST(Symptoms, AsymmetryAsksForASceneThatIsSymmetric) {
  const auto of = [](const SceneSettings& changes) {
    const Case one = make_case({"swing", changes, "jakobsen"});
    std::vector<Vec3> end = one.scene->start.x;
    end.back().z() += 0.25;
    return asymmetry(*one.scene, end);
  };
  const std::string grid = "cloth.grid=[5, 4]";
  EXPECT_NEAR(of({grid}), 0.25, 1e-12);
  EXPECT_NEAR(of({grid, "cloth.origin=[7, -2, 3]"}), 0.25, 1e-12);
  EXPECT_NEAR(of({grid, "wind={ velocity = [0, 2, 1] }"}), 0.25, 1e-12) << "along the mirror";
  for (const char* sideways : {"wind={ velocity = [0.1, 0, 0] }", "forces.gravity=[1, -9, 0]",
                               "cloth.u=[0, 0, 1]", "collider=[{ type = \"plane\", offset = -9 }]"})
    EXPECT_EQ(of({grid, sideways}), 0) << sideways;
  const Case one = make_case({"swing", {grid}, "jakobsen"});
  EXPECT_EQ(asymmetry(*one.scene, {}), 0) << "it did not come to its end";
}

TEST(Symptoms, WhatASwingSetsFreeIsItsFallToThePlumbLine) {
  const JudgedRun seen = swing({});
  const Scene& scene = *seen.one.scene;
  // Rows at distance r from the top fall by r (1 - cos 45 degrees).
  double expected = 0;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i)
      expected += scene.mesh.mass[static_cast<std::size_t>(9 * j + i)] * 9.81 * j / 8 *
                  (1 - std::numbers::sqrt2 / 2);
  EXPECT_NEAR(swing_energy(scene), expected, 1e-6 * expected);
  for (const char* active : {"wind={ velocity = [0, 0, 1] }", "cloth.pins=[]"})
    EXPECT_EQ(swing_energy(*make_case({"swing", {active}, "jakobsen"}).scene), 0) << active;
}

TEST(FrontierSettings, StartWhereTheyAreEasyAndMakeCases) {
  for (const char* solver : {"jakobsen", "bullet:iterations=4", "mass-spring", "xpbd"}) {
    std::size_t answered = 0;
    for (const FrontierSetting& setting : frontier_settings(solver)) {
      if (!setting.lacks.empty()) continue;
      ++answered;
      for (const double at : {setting.question.range.from, setting.question.range.to})
        EXPECT_NO_THROW(make_case(setting.question.at(at))) << solver << ": " << setting.name;
    }
    EXPECT_GE(answered, 8u) << solver;
  }
  EXPECT_THROW(frontier_settings("nobody"), InputError);
}

// A search starts from the unchanged question: the standard scene and the solver asked about.
TEST(FrontierSettings, BeginAtWhatTheStandardSceneHas) {
  for (const std::string solver : {"jakobsen", "bullet:iterations=4", "mass-spring", "xpbd"})
    for (const FrontierSetting& setting : frontier_settings(solver)) {
      // these ranges start at large numbers
      if (!setting.lacks.empty() || setting.name == "sweeps") continue;
      const FrontierQuestion& question = setting.question;
      const Case base = make_case(question.base),
                 start = make_case(question.at(question.range.from));
      EXPECT_EQ(content(*start.scene), content(*base.scene)) << solver << ": " << setting.name;
      EXPECT_EQ(start.choice.canonical(), base.choice.canonical())
          << solver << ": " << setting.name;
      const Case end = make_case(question.at(question.range.to));
      EXPECT_TRUE(content(*end.scene) != content(*base.scene) ||
                  end.choice.canonical() != base.choice.canonical())
          << solver << ": " << setting.name;
    }
}

// Ranges go from easy to absurd. A search downwards ascends in 1/setting.
TEST(FrontierSettings, GoThisFar) {
  const auto all = [](const std::string& solver) {
    std::string text;
    for (const FrontierSetting& one : frontier_settings(solver)) {
      const FrontierQuestion& q = one.question;
      text += one.name + " [" + one.unit + "]: ";
      if (one.lacks.empty())
        text += number_text(q.setting(q.range.from)) + " to " + number_text(q.setting(q.range.to)) +
                (q.range.whole || q.direction == Direction::down_in_whole_numbers ? ", whole" : "");
      else
        text += one.lacks;
      text += "\n";
      if (!one.lacks.empty()) continue;
      EXPECT_EQ(q.base.scene, "swing");
      EXPECT_EQ(q.range.tolerance, 0.02);
      EXPECT_NEAR(make_case(q.base).scene->dt, one.name == "sweeps" ? 1. / 30 : 1. / 240, 1e-8);
      EXPECT_EQ(make_case(q.base).scene->mesh.size(), one.name == "sweeps" ? 17 * 17 : 81);
    }
    return text;
  };
  const std::string scene =
      "mass ratio []: 1 to 1e9\n"
      "resolution [vertices a side]: 9 to 97, whole\n"
      "speed of a collider [m/s]: 0.1 to 1000\n"
      "size, up [m]: 1 to 100000\n"
      "size, down [m]: 1 to 1e-5\n"
      "distance from the origin [m]: 1 to 100000\n"
      "bending [N m]: 1e-6 to 10000\n"
      "wind [N s/m^3]: 0.01 to 100000\n";
  EXPECT_EQ(all("jakobsen"),
            "time step [s]: 0.00417 to 1\nsweeps []: 64 to 1, whole\n"
            "stiffness [omega]: 1 to 2\n" +
                scene);
  EXPECT_EQ(all("bullet"),
            "time step [s]: 0.00417 to 1\nsweeps []: 64 to 1, whole\n"
            "stiffness [stiffness]: 1 to 2\n" +
                scene);
  EXPECT_EQ(all("xpbd"),
            "time step [s]: 0.00417 to 1\nsweeps []: 64 to 1, whole\n"
            "stiffness []: its links are rigid\n" +
                scene);
  EXPECT_EQ(all("mass-spring"),
            "time step [s]: 0.00417 to 1\nsweeps []: it has none\n"
            "stiffness [N/m]: 50 to 1e8\n" +
                scene);
}

TEST(FrontierSettings, TheoriesAreClosedForms) {
  for (const FrontierSetting& setting : frontier_settings("jakobsen:substeps=1,contact=discrete")) {
    if (setting.name == "wind") {
      EXPECT_NEAR(setting.theory->value, 2 * 0.2 * 240, 1e-9);
    }
    if (setting.name == "speed of a collider") {
      EXPECT_NEAR(setting.theory->value, 0.02 * 240, 1e-9);
    }
    if (setting.name == "distance from the origin") {
      const float far = static_cast<float>(setting.theory->value);
      const float fall = 9.81F / (240 * 240);
      EXPECT_GT(4 * (std::nextafter(far, 2 * far) - far), fall) << "an eighth is lost there";
      EXPECT_LT(4 * (far - std::nextafter(far, 0.0F)), fall) << "and less nearer";
    }
  }
  EXPECT_FALSE(frontier_settings("jakobsen")[5].theory) << "continuous detection knows no limit";
  for (const FrontierSetting& setting : frontier_settings("mass-spring"))
    if (setting.name == "time step") {
      // Below 2/w: without its borders a 20 x 20 grid with both diagonals is stable up to 0.71
      // sqrt(m/k).
      EXPECT_NEAR(setting.theory->value / 32 / std::sqrt(0.2 / 64 / 50), 0.7, 0.2);
    }
}

ParameterFrontier kept(double good, double bad, bool downwards = false) {
  ParameterFrontier one;
  one.solver = "jakobsen";
  one.parameter = "time step";
  one.unit = "s";
  one.downwards = downwards;
  one.from = downwards ? 1 : 0.01;
  one.to = downwards ? 0.01 : 1;
  one.good = good;
  one.bad = bad;
  one.symptom = std::isnan(bad) ? "" : "explodes";
  one.beyond = {"swing", {"time.dt=\"0.2\""}, "jakobsen"};
  return one;
}

const double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Frontiers, AreReadBackFromTheirAnswer) {
  std::vector<ParameterFrontier> all{kept(0.1, 0.102), kept(0.1, kNone, true)};
  all[1].parameter = "size, down";
  const Answer answer = answer_of(all);
  const std::vector<ParameterFrontier> read = frontiers_of(answer);
  EXPECT_EQ(answer_of(read), answer);
  EXPECT_EQ(read[0].beyond.settings, all[0].beyond.settings);
  EXPECT_DOUBLE_EQ(read[0].headroom(), 10);
  EXPECT_DOUBLE_EQ(read[1].headroom(), 10) << "downwards from 1 to 0.1";
  Answer earlier = answer;
  earlier.tables[1].columns[2].name = "override";
  EXPECT_EQ(answer_of(frontiers_of(earlier)), answer) << "an earlier taut had another word";
  Answer damaged = answer;
  damaged.tables[0].columns[0].name = "who";
  EXPECT_THROW(frontiers_of(damaged), InputError);
}

}  // namespace
}  // namespace taut::parameter_frontier_test
