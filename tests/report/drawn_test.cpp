// The model's drawings, counts and names, compared with the raw records of made-up reports.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "experiments/system/json.hpp"
#include "tests/report/made_up.hpp"
#include "tests/support/numbers.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::drawn_test {
namespace {

bool fails(const std::string& status) {
  return status != "ok" && status != "unsettled" && status != "unsupported";
}

/// Made-up report, its model, and its cases by their short keys.
struct Made {
  explicit Made(unsigned seed) : input(made_up::Maker(seed).input()) {
    model = parse_json(make_model(input));
    for (const Json& one : model["cases"]) cases[one["key"]] = one;
  }
  ReportInput input;
  Json model;
  std::map<std::string, Json> cases;
};

/// Made-up reports, created once.
const std::vector<Made>& sets() {
  static const std::vector<Made> all = [] {
    std::vector<Made> made;
    for (unsigned seed = 0; seed < 20; ++seed) made.emplace_back(seed);
    return made;
  }();
  return all;
}

/// Value of a quantity in a listed case: a setting, a measured value or its cost; null if absent.
Json value_in(const Json& one, const std::string& metric) {
  for (const char* field : {"dt", "steps", "projections"})
    if (metric == field) return one[field];
  if (one["parameters"].contains(metric))
    return number_at(one["parameters"][metric].get<std::string>());
  if (one.contains("cost") && one["cost"].contains(metric)) return one["cost"][metric]["mid"];
  return one["values"].value(metric, Json());
}

/// Whether two values agree; a case lists its values to seven digits.
bool same(const Json& a, const Json& b) {
  if (!a.is_number() || !b.is_number()) return a == b;
  const double x = a, y = b;
  return std::abs(x - y) <= 1e-6 * std::abs(y);
}

TEST(Drawn, APointIsMarkedAsItEndedWithinItsInterval) {
  std::size_t points = 0, intervals = 0;
  for (const Made& made : sets()) {
    for (const Json& chart : made.model.value("charts", Json::array())) {
      for (const char* axis : {"x", "y"}) {
        const Quantity q = quantity(chart[axis]["metric"].get<std::string>());
        EXPECT_EQ(chart[axis]["scale"], q.unit.scale) << q.name;
        EXPECT_EQ(chart[axis]["unit"], q.unit.shown) << q.name;
      }
      for (const Json& series : chart["series"]) {
        const std::string solver = series["solver"];
        double before = 0;
        EXPECT_TRUE(series["label"].get<std::string>().starts_with(solver_title(solver)));
        for (const Json& p : series.value("points", Json::array())) {
          const Json& one = made.cases.at(p["case"]);
          EXPECT_EQ(one["solver"], solver);
          EXPECT_EQ(one["scene"], chart["scene"]);
          const Json x = value_in(one, chart["x"]["metric"]);
          EXPECT_TRUE(p["x"] == x || (p["failed"] && x.is_null()))
              << chart["id"];  // failed runs have a time
          if (!p["failed"]) {
            EXPECT_TRUE(same(p["y"], value_in(one, chart["y"]["metric"]))) << chart["id"];
          }
          if (chart.contains("held")) {
            const std::string held = chart["held"];
            const bool step = held.starts_with("time step ");
            const Quantity q = quantity(step ? "dt" : "iterations");
            const double its = value_in(one, q.name);
            EXPECT_EQ(held, step ? "time step " + q.text(its, 3) : q.text(its, 3) + " " + q.title);
          }
          if (p["x"].is_null()) continue;
          EXPECT_LE(before, p["x"]) << "not in the order of " << chart["x"]["metric"];
          before = p["x"];
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
  }
  EXPECT_GT(points, 300U);
  EXPECT_GT(intervals, 10U);
}

TEST(Drawn, CountsOfStatusesAreOfAllCases) {
  for (const Made& made : sets()) {
    std::map<std::string, std::map<std::string, std::map<std::string, int>>> ended;
    std::set<std::string> keys;
    const auto count = [&](const Record& r) {
      if (keys.insert(r.key).second)
        ++ended[r.scene][r.solver][std::string(to_string(r.status.kind))];
    };
    for (const StudyResult& study : made.input.studies) std::ranges::for_each(study.records, count);
    if (made.input.bench)
      for (const SceneBench& scene : made.input.bench->scenes)
        for (const BenchedCase& c : scene.cases) count(c.record);
    for (const Json& scene : made.model["scenes"]) {
      EXPECT_EQ((scene["statuses"].get<std::map<std::string, std::map<std::string, int>>>()),
                ended.at(scene["id"]));
      int cases = 0;
      for (const auto& [solver, statuses] : ended.at(scene["id"]))
        for (const auto& [status, n] : statuses) cases += n;
      const Json& facts = scene["facts"];
      EXPECT_EQ(facts.back(), (Json{{"name", "cases"}, {"value", std::to_string(cases)}}));
    }
    for (const Json& status : made.model["statuses"])
      EXPECT_EQ(status["failed"], fails(status["id"]));
  }
}

TEST(Drawn, ACaseHasItsSettingsItsCommandAndItsCost) {
  std::size_t timed = 0;
  for (const Made& made : sets()) {
    std::set<Json> colours;
    for (const Json& solver : made.model["solvers"]) colours.insert(solver["colour"]);
    EXPECT_EQ(colours.size(), made.model["solvers"].size()) << "two solvers look alike";
    std::map<std::string, const Record*> raw;
    for (const StudyResult& study : made.input.studies)
      for (const Record& r : study.records) raw[r.id] = &r;
    for (const auto& [key, one] : made.cases) {
      if (const auto at = raw.find(one["id"]); at != raw.end()) {
        for (const auto& [name, value] : at->second->values)
          if (std::isfinite(value)) {
            EXPECT_TRUE(same(one["values"][name], value)) << name;
          }
        EXPECT_EQ(one.value("step", -1), at->second->status.step);
        EXPECT_EQ(one.value("vertex", -1), at->second->status.vertex);
      }
      const std::string command = one["command"], settings = one["settings"];
      EXPECT_NE(command.find(settings), std::string::npos);
      for (const Json& text : one.value("scene_settings", Json::array()))
        EXPECT_NE(command.find(text.get<std::string>().substr(0, 7)), std::string::npos) << command;
      if (!one.contains("cost")) continue;
      for (const char* end : {"low", "mid", "high"}) {
        const double second = one["cost"]["cpu.per_second"][end];
        EXPECT_NEAR(one["cost"]["cpu.per_step"][end].get<double>(),
                    second * one["dt"].get<double>(), 1e-9 * second);
      }
      ++timed;
    }
  }
  EXPECT_GT(timed, 10U);
}

TEST(Drawn, ACellOfAMapIsTheCaseOfItsRowAndColumn) {
  std::size_t seen = 0;
  for (const Made& made : sets())
    for (const Json& map : made.model.value("maps", Json::array()))
      for (const Json& cell : map["cells"]) {
        const Json& one = made.cases.at(cell["case"]);
        EXPECT_EQ(one["solver"], map["solver"]);
        EXPECT_EQ(one["scene"], map["scene"]);
        EXPECT_EQ(one["status"], cell["status"]);
        EXPECT_EQ(cell.value("reason", ""), one.value("reason", ""));
        for (const auto& [axis, place] : {std::pair{"x", "column"}, {"y", "row"}}) {
          const Json& values = map[axis]["values"];
          EXPECT_TRUE(std::ranges::is_sorted(values.get<std::vector<double>>()));
          EXPECT_EQ(values.at(cell[place].get<std::size_t>()), value_in(one, map[axis]["metric"]));
        }
        ++seen;
      }
  EXPECT_GT(seen, 300U);
}

// A map over a scene's setting: its cells differ in that setting alone.
TEST(Drawn, AMapNamesItsAxesAndItsSharedSettings) {
  const Record other = synthetic::record("hang", "jakobsen", 8, 1.0 / 64);
  ReportInput input{.studies = {{"one", "?", {other}, 1, {}}},
                    .maps = {{"spans", "?", "dt", "cloth.span", {}}}};
  for (const char* dt : {"0.01", "0.02"})
    for (const char* span : {"0.7", "0.8", "0.9"}) {
      Record r = synthetic::record("hang", "jakobsen", 8, number_at(dt));
      r.spec.settings = {std::string("time.dt=") + dt, "cloth.mass=2",
                         std::string("cloth.span=") + span, "forces.damping=1"};
      r.key = std::string(dt) + span + std::string(20, 'x');
      input.maps[0].records.push_back(r);
    }
  const Json model = parse_json(make_model(input));
  ASSERT_EQ(model["maps"].size(), 1u);
  const Json& map = model["maps"][0];
  EXPECT_EQ(map["scene_settings"], "cloth.mass=2, forces.damping=1");
  EXPECT_EQ(map["title"], "How cases end over time step and cloth.span");
  EXPECT_EQ(map["x"]["values"], (Json{0.01, 0.02}));
  EXPECT_EQ(map["y"]["values"], (Json{0.7, 0.8, 0.9}));
  EXPECT_EQ(map["cells"].size(), 6u);
}

TEST(Drawn, AChartNamesTheWindowOfItsValue) {
  int contact = 0;
  for (const Made& made : sets())
    for (const Json& chart : made.model.value("charts", Json::array())) {
      const Window window = quantity(chart["y"]["metric"].get<std::string>()).window;
      const std::string caption = chart["caption"];
      EXPECT_TRUE(!caption.starts_with("Last second.") || window == Window::last_second)
          << chart["id"];
      EXPECT_TRUE(!caption.ends_with("whole run.") || window == Window::run) << chart["id"];
      if (chart["kind"] != "contact") continue;
      EXPECT_FALSE(window == Window::last_second)
          << chart["title"] << ": what has left by then is not seen";
      ++contact;
    }
  EXPECT_GT(contact, 50);
}

TEST(Drawn, OfTwoCasesInOneCellTheWorseIsShown) {
  std::vector<Record> two(2);
  for (Record& r : two) {
    r.scene = "hang";
    r.solver = "jakobsen";
    r.dt = 0.01;
    r.sweeps = 4;
    for (const Status::Kind kind : {Status::Kind::ok, Status::Kind::crash}) {
      r.status.kind = kind;
      const auto maps = make_maps(two, "hang", "dt", "iterations");
      const bool any = &r == &two[1] || kind != Status::Kind::ok;
      EXPECT_EQ(maps.at(0).cells.at(0).record->status.kind,
                any ? Status::Kind::crash : Status::Kind::ok);
    }
  }
}

// Maps leave out solvers without sweeps, and other scenes.
TEST(Drawn, AMapIsOfTheCasesThatHaveBothOfItsSettings) {
  std::vector<Record> records;
  for (const int sweeps : {1, 2})
    records.push_back(synthetic::record("hang", "jakobsen", sweeps, 0.01));
  records.push_back(synthetic::record("ball", "jakobsen", 4, 0.01));
  Record without = synthetic::record("hang", "jakobsen", 4, 0.01);
  without.params.erase("iterations");
  without.sweeps = -1;
  without.status.kind = Status::Kind::crash;
  records.push_back(without);
  for (const auto& [x, y] : {std::pair{"dt", "iterations"}, {"iterations", "dt"}}) {
    const auto maps = make_maps(records, "hang", x, y);
    ASSERT_EQ(maps.size(), 1u);
    EXPECT_EQ(maps[0].cells.size(), 2u) << x;
    EXPECT_EQ(maps[0].rows.size() * maps[0].columns.size(), 2u) << x;
    for (const StatusMap::Cell& cell : maps[0].cells)
      EXPECT_EQ(cell.record->status.kind, Status::Kind::ok) << x;
  }
  EXPECT_THROW(make_maps(records, "box", "dt", "iterations"), InputError);
}

TEST(Drawn, NoPointBeatsTheFront) {
  std::size_t seen = 0;
  for (const Made& made : sets())
    for (const Json& chart : made.model.value("charts", Json::array())) {
      if (!chart.contains("front")) continue;
      const Json& front = chart["front"];
      for (std::size_t i = 1; i < front.size(); ++i, ++seen)
        EXPECT_TRUE(front[i - 1]["x"] <= front[i]["x"] && front[i - 1]["y"] > front[i]["y"]);
      for (const Json& series : chart["series"])
        for (const Json& p : series["points"])
          EXPECT_TRUE(p["failed"] || p.contains("not_counted") || p["y"].is_null() || p["x"] <= 0 ||
                      std::ranges::any_of(front, [&](const Json& f) {
                        return f["x"] <= p["x"] && f["y"] <= p["y"];
                      }));
    }
  EXPECT_GT(seen, 8U);
}

TEST(Drawn, TheReferencesOwnErrorIsTheFloorOfItsChart) {
  ReportInput input = made_up::Maker(0).input();
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) {
      r.values["reference.rms"] = 0.01;
      r.values["reference.floor"] = 1e-3;
    }
  int seen = 0;
  const Json model = parse_json(make_model(input));
  for (const Json& chart : model["charts"])
    if (chart["y"]["metric"] == "reference.rms") {
      EXPECT_EQ(chart.value("floor", Json{{"y", 0}})["y"], 1e-3);
      ++seen;
    }
  EXPECT_GT(seen, 0);
}

}  // namespace
}  // namespace taut::report::drawn_test
