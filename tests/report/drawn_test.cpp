// What the model draws, counts and names, held against the raw records of made-up reports.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/quantity.hpp"
#include "experiments/report/chart/settings.hpp"
#include "experiments/report/model/model.hpp"
#include "experiments/system/json.hpp"
#include "tests/report/made_up.hpp"

namespace taut::report {
namespace {

bool fails(const std::string& status) { return status != "ok" && status != "unsettled"; }

/// One made-up report, its model and its cases by their short keys.
struct Made {
  explicit Made(unsigned seed) : input(made_up::Maker(seed).input()) {
    model = parse_json(make_model(input));
    for (const Json& one : model["cases"]) cases[one["key"]] = one;
  }
  ReportInput input;
  Json model;
  std::map<std::string, Json> cases;
};

constexpr unsigned kSets = 10;

TEST(Drawn, APointIsOfItsSolverMarkedAsItEndedAndInsideItsInterval) {
  std::size_t points = 0, intervals = 0;
  for (unsigned seed = 0; seed < kSets; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Made made(seed);
    for (const Json& chart : made.model.value("charts", Json::array()))
      for (const Json& series : chart["series"]) {
        const std::string solver = series["solver"];
        EXPECT_TRUE(series["label"].get<std::string>().starts_with(solver_title(solver)));
        for (const Json& p : series.value("points", Json::array())) {
          EXPECT_EQ(made.cases.at(p["case"])["solver"], solver);
          EXPECT_EQ(p["zero"], !p["y"].is_null() && p["y"] == 0);
          EXPECT_EQ(p["failed"], fails(p["status"]));
          ++points;
          if (!p.contains("x_low")) continue;
          EXPECT_LE(p["x_low"], p["x"]);
          EXPECT_LE(p["x"], p["x_high"]);
          ++intervals;
        }
      }
  }
  EXPECT_GT(points, 300U);
  EXPECT_GT(intervals, 10U);
}

TEST(Drawn, CountsOfStatusesAreOfAllCases) {
  for (unsigned seed = 0; seed < kSets; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Made made(seed);
    for (const Json& map : made.model.value("maps", Json::array())) {
      std::map<std::string, int> counts;
      for (const Json& cell : map["cells"]) ++counts[cell["status"]];
      EXPECT_EQ((map["counts"].get<std::map<std::string, int>>()), counts);
    }
    std::map<std::string, std::map<std::string, std::map<std::string, int>>> ended;
    std::set<std::string> keys;
    for (const StudyResult& study : made.input.studies)
      for (const Record& r : study.records)
        if (keys.insert(r.key).second)
          ++ended[r.scene][r.solver][std::string(to_string(r.status.kind))];
    for (const Json& scene : made.model["scenes"])
      if (scene["studied"]) {
        EXPECT_EQ((scene["statuses"].get<std::map<std::string, std::map<std::string, int>>>()),
                  ended.at(scene["id"]));
      }
    for (const Json& status : made.model["statuses"])
      EXPECT_EQ(status["failed"], fails(status["id"]));
    for (const Json& claim : made.model["claims"])
      for (const Json& basis : claim["basis"]) {
        std::map<std::string, std::map<std::string, int>> seen;
        for (const Json& value : basis["values"]) ++seen[value["label"]][value["status"]];
        if (!basis.contains("unlisted")) {
          EXPECT_EQ((basis["statuses"].get<std::map<std::string, std::map<std::string, int>>>()),
                    seen)
              << claim["id"];
        }
      }
  }
}

TEST(Drawn, ABasisNamesTheWindowOfItsMetricAndOrderedIntervals) {
  std::size_t intervals = 0;
  for (unsigned seed = 0; seed < kSets; ++seed) {
    const Made made(seed);
    for (const auto& [name, metric] : made.model["metrics"].items())
      EXPECT_EQ(metric["scale"], quantity(name).scale) << name;
    for (const Json& claim : made.model["claims"])
      for (const Json& basis : claim["basis"]) {
        const std::string window = quantity(basis["metric"].get<std::string>()).window;
        EXPECT_EQ(basis["window"], window.empty() ? "whole run" : window) << basis["metric"];
        for (const Json& value : basis["values"]) {
          if (!value.contains("low")) continue;
          EXPECT_LE(value["low"], value["value"]);
          EXPECT_LE(value["value"], value["high"]);
          ++intervals;
        }
      }
  }
  EXPECT_GT(intervals, 10U);
}

TEST(Drawn, ACaseHasItsSettingsItsCommandAndItsCost) {
  std::size_t timed = 0;
  for (unsigned seed = 0; seed < kSets; ++seed) {
    const Made made(seed);
    std::set<Json> colours;
    for (const Json& solver : made.model["solvers"]) colours.insert(solver["colour"]);
    EXPECT_EQ(colours.size(), made.model["solvers"].size()) << "two solvers look alike";
    for (const auto& [key, one] : made.cases) {
      const std::string command = one["command"], settings = one["settings"];
      EXPECT_NE(command.find(settings), std::string::npos);
      for (const Json& text : one.value("overrides", Json::array()))
        EXPECT_NE(command.find(text.get<std::string>().substr(0, 7)), std::string::npos) << command;
      if (!one.contains("cost")) continue;
      const double second = one["cost"]["cpu.per_second"]["mid"];
      EXPECT_NEAR(one["cost"]["cpu.per_step"]["mid"].get<double>(),
                  second * one["dt"].get<double>(), 1e-9 * second);
      ++timed;
    }
  }
  EXPECT_GT(timed, 10U);
}

}  // namespace
}  // namespace taut::report
