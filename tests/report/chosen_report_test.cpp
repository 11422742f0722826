// A small report with chosen numbers: the contents of its cases, charts, panels, films and tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "experiments/system/json.hpp"
#include "experiments/truths/assertions/assertions.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::chosen_report_test {
namespace {

Json model_of(const ReportInput& input) { return parse_json(make_model(input)); }

/// "hj04kkkkkkkk": twelve digits of a key, as in the model.
std::string short_key(const std::string& scene, const std::string& solver, int sweeps) {
  return std::string{scene[0], solver[0], sweeps < 10 ? '0' : '1'} + std::to_string(sweeps % 10) +
         "kkkkkkkk";
}

/// Small report with chosen numbers: two solvers on two scenes, one refusal.
ReportInput chosen() {
  ReportInput input;
  input.studies = {{"sweeps", "How many?", {}, 9, {{"hang", -1}}}, {"other", "?", {}, 0, {}}};
  const auto add = [&](std::size_t study, const std::string& scene, const std::string& solver,
                       int sweeps, double stretch) -> Record& {
    Record r = synthetic::record(scene, solver, sweeps, 0.01);
    r.id = scene + solver + std::to_string(sweeps);
    r.key = short_key(scene, solver, sweeps) + std::string(30, 'k');
    r.substeps = 1;
    r.values = {{"stretch.rms", stretch}};
    return input.studies[study].records.emplace_back(r);
  };
  for (const auto& [sweeps, a, b] :
       {std::tuple{4, 0.08, 0.09}, {8, 0.04, 0.05}, {16, 0.02, 0.03}}) {
    add(0, "hang", "jakobsen", sweeps, a);
    add(0, "hang", "bullet", sweeps, b);
  }
  add(1, "ball", "jakobsen", 16, 0.005);
  add(1, "ball", "bullet", 16, 0.02).status = {Status::Kind::unsettled, "speed", -1, -1};
  Record& refused = add(1, "ball", "xpbd", 16, 0);
  refused.status = {Status::Kind::unsupported, "no balls", -1, -1};
  refused.values.clear();
  return input;
}

const Json& by_id(const Json& list, const std::string& id) {
  static const Json none;
  for (const Json& one : list)
    if (one["id"] == id) return one;
  ADD_FAILURE() << "no " << id;
  return none;
}

TEST(Chosen, ASceneHasItsFactsItsStatusesAndWhoRefusesIt) {
  const Json model = model_of(chosen());
  const Json &hang = by_id(model["scenes"], "hang"), &ball = by_id(model["scenes"], "ball");
  const auto fact = [](const Json& scene, const std::string& name) -> std::string {
    for (const Json& one : scene["facts"])
      if (one["name"] == name) return one["value"];
    return "";
  };
  EXPECT_EQ(fact(hang, "cases"), "6");
  EXPECT_EQ(fact(hang, "sweeps per substep"), "4, 8, 16");
  EXPECT_EQ(fact(hang, "time step"), "10\u00A0ms");
  EXPECT_EQ(fact(hang, "simulated time"), "4\u00A0s");
  EXPECT_EQ(fact(hang, "vertices"), "400");
  EXPECT_EQ(fact(ball, "cases"), "3");
  ReportInput more = chosen();
  for (const int sweeps : {2, 1024}) {
    Record& one = more.studies[0].records.emplace_back(more.studies[0].records[0]);
    one.sweeps = sweeps;
    one.key = std::to_string(sweeps);
  }
  EXPECT_EQ(fact(by_id(model_of(more)["scenes"], "hang"), "sweeps per substep"),
            "2 to 1024 (5 values)");
  EXPECT_EQ(hang["statuses"], (Json{{"jakobsen", {{"ok", 3}}}, {"bullet", {{"ok", 3}}}}));
  EXPECT_EQ(ball["statuses"], (Json{{"jakobsen", {{"ok", 1}}},
                                    {"bullet", {{"unsettled", 1}}},
                                    {"xpbd", {{"unsupported", 1}}}}));
  EXPECT_EQ(ball["refusals"], (Json{{{"solver", "xpbd"}, {"reason", "no balls"}}}));
  EXPECT_FALSE(hang.contains("refusals"));
  for (const Json& status : model["statuses"]) EXPECT_FALSE(status["failed"]) << status;
  EXPECT_EQ(model["meta"]["cases"], 9);
  EXPECT_EQ(model["meta"]["planned"], 12) << "six of nine of the first study were run";
  EXPECT_EQ(model["method"]["studies"][0],
            (Json{{"name", "sweeps"}, {"question", "How many?"}, {"cases", 6}, {"planned", 9}}));
  EXPECT_EQ(by_id(model["solvers"], "jakobsen")["settings"], "precision=double");
}

TEST(Chosen, AChartHasItsPointsItsTicksItsFitAndItsTheory) {
  ReportInput input = chosen();
  Record& failed = input.studies[0].records[3];  // Bullet, 8 sweeps
  failed.status = {Status::Kind::exploded, Reason::energy, 3, 2};
  const Json model = model_of(input);
  const Json& chart = by_id(model["charts"], "hang-convergence");
  EXPECT_EQ(chart["kind"], "convergence");
  EXPECT_EQ(chart["title"], "RMS stretch over sweeps per substep");
  EXPECT_EQ(chart["caption"], "Last second.");
  EXPECT_EQ(chart["x"]["values"], (Json{4, 8, 16}));
  EXPECT_EQ(chart["x"]["texts"], (Json{"4", "8", "16"}));
  EXPECT_EQ(chart["x"]["axis"], "log");
  EXPECT_EQ(chart["y"]["unit"], "%");
  EXPECT_FALSE(chart["y"].contains("values"));
  EXPECT_EQ(chart["theory"]["slope"], -1);
  EXPECT_NEAR(chart["theory"]["factor"].get<double>(), 0.6 * 0.32, 1e-12) << "the least y x";
  EXPECT_EQ(chart["theory"]["text"], "theory of relaxation: 1/sweeps");
  ASSERT_EQ(chart["series"].size(), 2u);
  const Json& series = chart["series"][1];
  EXPECT_EQ(series["label"], "Bullet");
  EXPECT_EQ(series["points"], (Json{{{"x", 4},
                                     {"y", 0.09},
                                     {"status", "ok"},
                                     {"case", short_key("hang", "bullet", 4)},
                                     {"failed", false},
                                     {"zero", false},
                                     {"name", "1 × 4"}},
                                    {{"x", 8},
                                     {"y", nullptr},
                                     {"status", "exploded"},
                                     {"case", short_key("hang", "bullet", 8)},
                                     {"failed", true},
                                     {"zero", false},
                                     {"name", "1 × 8"}},
                                    {{"x", 16},
                                     {"y", 0.03},
                                     {"status", "ok"},
                                     {"case", short_key("hang", "bullet", 16)},
                                     {"failed", false},
                                     {"zero", false},
                                     {"name", "1 × 16"}}}));
}

TEST(Chosen, AFilmHasItsPanelsItsBarAndItsEvents) {
  ReportInput input = chosen();
  input.media = {{.scene = "hang"}};
  input.media[0].panels = {{"jakobsen", "1 × 16", input.studies[0].records[4].key},
                           {"bullet", "elsewhere", ""}};
  input.media[0].footage = {.type = "video/mp4",
                            .bytes = "film",
                            .poster = "still",
                            .poster_type = "image/jpeg",
                            .alt = "to be seen",
                            .columns = 2,
                            .duration = 1,
                            .speed = 0.5,
                            .frame = 0.125,
                            .poster_t = 0.75,
                            .bar = {"strain", {"#000000", "#FFFFFF"}, {{0.5, "0 %"}}}};
  input.series = {
      {"hang", "jakobsen", "J", "stretch.rms", {0, 0.5, 1, 1.5}, {0, 0.1, std::nan(""), 9}},
      {"hang", "bullet", "B", "stretch.rms", {1, 2}, {1, 1}}};
  const Json model = model_of(input);
  const Json& film = by_id(model["films"], "film-hang");
  EXPECT_EQ(film["src"], "data:video/mp4;base64,ZmlsbQ==");
  EXPECT_EQ(film["poster"], "data:image/jpeg;base64,c3RpbGw=");
  EXPECT_EQ(
      (std::tuple{film["duration"], film["speed"], film["frame"], film["poster_t"], film["alt"]}),
      (std::tuple{Json(1), Json(0.5), Json(0.125), Json(0.75), Json("to be seen")}));
  EXPECT_EQ(film["panels"], (Json{{{"solver", "jakobsen"},
                                   {"settings", "1 × 16"},
                                   {"case", short_key("hang", "jakobsen", 16)}},
                                  {{"solver", "bullet"}, {"settings", "elsewhere"}}}));
  EXPECT_EQ(film["columns"], 2);
  EXPECT_EQ(film["bar"], (Json{{"title", "strain"},
                               {"stops", {"#000000", "#FFFFFF"}},
                               {"ticks", {{{"at", 0.5}, {"text", "0 %"}}}}}));
  const Json range{{"axis", "linear"}, {"low", 0}, {"high", 10 + 0.06 * 10}};  // intervals of 0.1
  const Json line{{"solver", "jakobsen"},
                  {"label", "J"},
                  {"dash", ""},
                  {"t", {0, 0.5, 1}},
                  {"y", {0, 0.1, nullptr}}};
  const Json track{{"metric", "stretch.rms"},
                   {"title", "RMS stretch"},
                   {"range", range},
                   {"series", Json::array({line})}};
  EXPECT_EQ(film["tracks"], Json::array({track})) << "one moment of Bullet's is no track";
  EXPECT_EQ(by_id(model["scenes"], "hang")["film"], "film-hang");
}

TEST(Chosen, TablesHaveWhatWasFoundRowByRow) {
  ReportInput input = chosen();
  input.required = {{"hang", "Jakobsen", "no", "shape", "wind", "pins", "34 %"},
                    {"ball", "Bullet", "after 0.4 s", "depth", "none", "all", "–"}};
  ParameterFrontier f;
  f.solver = "bullet";
  f.parameter = "time step";
  f.unit = "s";
  f.from = 0.01;
  f.to = 1;
  f.good = 0.0612;
  f.bad = 0.0623;
  f.symptom = "explodes";
  f.theory = 0.07;
  input.frontiers = {f, f, f, f};
  input.frontiers[1].solver = "jakobsen";
  input.frontiers[1].bad = std::nan("");
  input.frontiers[2].parameter = "drag";
  input.frontiers[2].lacks = "it has none";
  input.frontiers[3].parameter = "mass";
  input.frontiers[3].unit = "";
  input.frontiers[3].solver = "jakobsen";
  input.frontiers[3].good = input.frontiers[3].theory = std::nan("");
  const Record& a = input.studies[0].records[0];
  Record worse = a, better = input.studies[0].records[2], other = a, same = a;
  worse.values = {{"stretch.rms", 0.1}, {"kinetic", 3}};
  better.values["stretch.rms"] = 0.03;
  other.status.kind = Status::Kind::crash;
  Record before = a;
  before.values["kinetic"] = 2;
  input.differences = Differences{
      "x", "y", {{a, same}, {before, worse}, {input.studies[0].records[2], better}, {a, other}},
      {},  0,   0,
      0};
  const Json model = model_of(input);
  const Json& tables = model["tables"];
  EXPECT_EQ(tables["required"]["rows"],
            (Json{{"hang", "Jakobsen", "no", "shape", "wind", "pins", "34 %"},
                  {"ball", "Bullet", "after 0.4 s", "depth", "none", "all", "–"}}));
  EXPECT_EQ(tables["frontiers"]["rows"],
            (Json{{"time step", "0.0612\u00A0s, then explodes (theory: 0.0700\u00A0s)",
                   "1.00\u00A0s, the end of the range"},
                  {"drag", "–: it has none", nullptr},
                  {"mass", nullptr, "none, then explodes"}}));
  const Json& values = tables["differences-values"];
  EXPECT_EQ(values["caption"],
            "The 4 largest relative changes of 4; better and worse where a value is an error.");
  const auto cells = [](const Json& row) { return Json{row[1], row[2], row[3], row[5]}; };
  EXPECT_EQ(cells(values["rows"][0]), (Json{"status", "ok", "crash", nullptr}));
  EXPECT_EQ(cells(values["rows"][1]), (Json{"kinetic", "2", "3", nullptr}));
  EXPECT_EQ(cells(values["rows"][2]),
            (Json{"RMS stretch", "4.000\u00A0%", "3.000\u00A0%", "better"}));
  EXPECT_EQ(cells(values["rows"][3]),
            (Json{"RMS stretch", "8.000\u00A0%", "10.00\u00A0%", "worse"}));
  EXPECT_EQ(values["rows"][2][4], -0.25);
  EXPECT_EQ(values["notes"][2]["key"], short_key("hang", "jakobsen", 8));
  EXPECT_EQ(tables["differences-ends"]["rows"], (Json{{"ok", "crash", 1}, {"ok", "ok", 3}}));
  const Json& stretch = tables["differences"]["rows"][0];
  EXPECT_EQ((Json{stretch[0], stretch[1], stretch[2], stretch[3]}),
            (Json{"RMS stretch", 3.0, 1.0, 1.0}));
  EXPECT_NEAR(stretch[4].get<double>(), -0.25, 1e-12);
  EXPECT_EQ(
      model["differences"]["a"].get<std::string>() + model["differences"]["b"].get<std::string>(),
      "xy");
  EXPECT_NE(model["differences"]["matched"].get<std::string>().find("not by the content"),
            std::string::npos);
  EXPECT_TRUE(model["answer"]["subject"].get<std::string>().starts_with("B alone, y."));
}

// Two builds of a solver in sessions of their own: the result is a geometric mean, and at most
// "likely".
TEST(Chosen, CostsOfTwoFoldersAreComparedSolverBySolver) {
  ReportInput input = chosen();
  // alternating between Jakobsen's and Bullet's
  const std::vector<Record>& records = input.studies[0].records;
  const auto timed = [](const Record& r, double cost) {
    const std::vector<double> samples(12, cost * r.dt);
    return BenchedCase{r, {samples, samples, 0, "", ""}};
  };
  Differences two{"x", "y", {{records[0], records[0]}}, {}, 3, 5, 0.02};
  two.timed = {{timed(records[0], 2), timed(records[0], 1)},
               {timed(records[2], 3), timed(records[2], 3)},
               {timed(records[1], 4), timed(records[1], 4.02)}};
  BenchedCase failed = timed(records[4], 1);
  failed.timing.failure = "made up";
  two.timed.emplace_back(failed, timed(records[4], 100));
  two.timed.emplace_back(timed(records[4], 1), failed);
  input.differences = two;
  const Json model = model_of(input);
  const Json& costs = model["tables"]["differences-cost"]["rows"];
  ASSERT_EQ(costs.size(), 2u);
  EXPECT_EQ((Json{costs[0][0], costs[0][1]}), (Json{"Bullet", 1.0}));
  EXPECT_NEAR(costs[0][2].get<double>(), 1.005, 1e-9);
  EXPECT_EQ((Json{costs[1][0], costs[1][1]}), (Json{"Jakobsen", 2.0}));
  EXPECT_NEAR(costs[1][2].get<double>(), std::sqrt(0.5), 1e-9);
  EXPECT_EQ(costs[1][3], to_string(Certainty::likely)) << "beyond the noise";
  EXPECT_EQ(costs[0][3], to_string(Certainty::none)) << "within the noise";
  EXPECT_EQ(model["tables"]["differences-ends"]["caption"],
            "1 cases in both; in A alone 3, in B alone 5");
  const Json& values = model["tables"]["differences"];
  const Json cpu = values["rows"].back();
  EXPECT_EQ((Json{cpu[0], cpu[1], cpu[2], cpu[3]}), (Json{"CPU time of a step", 3.0, 1.0, 1.0}));
  EXPECT_NEAR(cpu[4].get<double>(), -0.5, 1e-12);
  EXPECT_TRUE(std::ranges::any_of(values["notes"], [](const Json& note) {
    return note.value("note", "").find("not timed together") != std::string::npos;
  }));
}

// Three builds, the last of them with a step in its results; the middle build has no result for the
// case.
TEST(Chosen, AHistoryHasALineForEachCase) {
  ReportInput input = chosen();
  EXPECT_FALSE(model_of(input).contains("history"));
  const Record& now = input.studies[0].records[0];
  const auto point = [](const std::string& key, double stretch) {
    return std::make_shared<const HistoryPoint>(HistoryPoint{key, {}, {{"stretch.rms", stretch}}});
  };
  History history{"s",
                  {{"one", "2026-01-01"}, {"two", "2026-02-01"}, {"three", "2026-03-01"}},
                  {{"hang a",
                    "hang",
                    "jakobsen",
                    {point("k", 0.02), nullptr, point(now.key, 0.03)},
                    {"k", "", now.key}}},
                  {},
                  {},
                  1};
  history.builds[1].gap = "does not build";
  history.steps = {{0, 0, 2, {.metric = "stretch.rms"}, 0.02, 0.03, 0.5}};
  input.histories = {history};
  const Json found = model_of(input)["history"][0];
  EXPECT_EQ(found["rows"][0]["values"], (Json{0.02, nullptr, 0.03}));
  EXPECT_EQ(found["builds"][1]["gap"], "does not build");
  const Json& step = found["rows"][0]["steps"][0];
  EXPECT_EQ((Json{step["at"], step["before"], step["now"]}), (Json{2, "one", "three"}));
  EXPECT_EQ(step["cases"][1]["case"], short_key("hang", "jakobsen", 4));
  EXPECT_FALSE(step["cases"][0].contains("case")) << "no case of this page";
  EXPECT_EQ(step["values"][0]["text"], "2 % -> 3 %");
  EXPECT_EQ(found["sentences"][0],
            "stretch.rms of hang a rose from 2 to 3 % at three (2026-03-01), or at one of 1 builds "
            "before it without a result");
}

TEST(Chosen, ACostIsThatOfTheCheapestWithinTheError) {
  ReportInput input = chosen();
  std::vector<Record>& records = input.studies[0].records;
  SceneBench scene{"hang", {1 / 1.02, 1, 1.02}, {}, true, std::vector<Limit>{}};
  for (const auto& [at, error, cost] : {std::tuple{0u, 0.4, 1.0},
                                        {2u, 0.08, 4.0},
                                        {4u, 0.07, 6.0},
                                        {1u, 0.45, 2.0},
                                        {3u, 0.3, 5.0},
                                        {5u, 0.009, 8.0}}) {
    records[at].values = {
        {"motion.error", error}, {"stretch.rms", 0}, {"motion.share", 0.6}, {"energy.peak", 7}};
    const std::vector<double> samples(12, cost * records[at].dt);
    scene.cases.push_back({records[at], {samples, samples, 0, "", ""}});
  }
  input.bench = StudyBench{"sweeps", "a machine", {scene}};
  const Json model = model_of(input);
  const Json& levels = model["tables"]["cost-levels-hang"];
  const auto cost = [&](std::size_t row, std::size_t column) {
    const Json& cell = levels["rows"][row][column];
    return cell.is_array() ? cell[1] : cell;
  };
  ASSERT_EQ(levels["rows"].size(), 6u);
  EXPECT_EQ((Json{cost(0, 0), cost(1, 0), cost(2, 0), cost(3, 0), cost(4, 0), cost(5, 0)}),
            (Json{0.5, 0.2, 0.1, 0.05, 0.02, 0.01}));
  const double jakobsen[] = {1, 4, 4}, bullet[] = {2, 8, 8, 8, 8, 8};
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(cost(k, 1).get<double>(), jakobsen[k], 1e-12) << k;
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(cost(k, 2).get<double>(), bullet[k], 1e-12) << k;
  for (std::size_t k = 3; k < 6; ++k) EXPECT_EQ(cost(k, 1), "not reached");
  const std::string solvers[] = {"jakobsen", "bullet"};
  std::size_t seen = 0;
  for (const Json& note : levels["notes"]) {
    const std::size_t row = note["row"];
    const std::string solver = note["column"];
    if (note.contains("state")) {
      EXPECT_EQ(note["state"], "none");
      EXPECT_EQ(cost(row, solver == "bullet" ? 2 : 1), "not reached");
      continue;
    }
    const std::string text = note["note"];
    EXPECT_EQ(note["key"], short_key("hang", solver, row == 0 ? 4 : solver == "bullet" ? 16 : 8));
    EXPECT_TRUE(text.ends_with(", " + quantity("motion.share").title + " 60\u00A0%")) << text;
    EXPECT_EQ(text.find(quantity("motion.error").title), text.npos) << "the row has it: " << text;
    // 50 % is reached by the cheapest settings tried, so that costs are upper bounds
    EXPECT_EQ(note.contains("best"), solver == "jakobsen" && row >= 1) << row;
    ++seen;
  }
  EXPECT_EQ(seen, 9u);
  const Json& profiles = model["tables"]["cost-profiles"];
  EXPECT_EQ(profiles["rows"], (Json{{"Jakobsen", 0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
                                    {"Bullet", 0.5, 0.5, 1.0, 1.0, 1.0, 1.0}}))
      << "of six errors that somebody reaches";
  EXPECT_TRUE(profiles["caption"].get<std::string>().starts_with("6 problems: "));
}

// The largest changes come first; the number of rows is limited.
TEST(Chosen, OfManyChangesTheLargestAreListed) {
  ReportInput input = chosen();
  Differences two{"x", "y", {}, {}, 0, 0, 0};
  for (int i = 1; i <= 250; ++i) {
    Record a = input.studies[0].records[0], b = a;
    a.values = {{"stretch.rms", 1}};
    b.values = {{"stretch.rms", 1 + i * 1e-3}};
    two.pairs.emplace_back(a, b);
  }
  input.differences = two;
  const Json model = model_of(input);
  const Json& table = model["tables"]["differences-values"];
  ASSERT_EQ(table["rows"].size(), 200u);
  EXPECT_TRUE(
      table["caption"].get<std::string>().starts_with("The 200 largest relative changes of 250;"));
  for (std::size_t i = 0; i < 200; ++i)
    EXPECT_NEAR(table["rows"][i][4].get<double>(), (250 - static_cast<double>(i)) * 1e-3, 1e-12);
}

// Verdicts of this program's own truths replace stored verdicts on an assertion.
TEST(Chosen, AssertionsHaveTheVerdictOfThisProgram) {
  ReportInput input = chosen();
  const Json earlier = model_of(input), &before = earlier["tables"]["assertions"];
  ASSERT_EQ(before["rows"].size(), assertions().size());
  const Assertion& judged = assertions()[1];
  input.truths = Truths{};
  input.truths->assertions[std::string(judged.assertion)] = {"made up", "x^2"};
  const Json later = model_of(input), &now = later["tables"]["assertions"];
  for (std::size_t i = 0; i < assertions().size(); ++i) {
    EXPECT_EQ(before["rows"][i][0],
              std::string(assertions()[i].source) + ", " + std::string(assertions()[i].place));
    EXPECT_EQ(before["rows"][i][2], to_string(assertions()[i].verdict));
    EXPECT_EQ(now["rows"][i][2], i == 1 ? Json("made up") : before["rows"][i][2]);
    EXPECT_EQ(now["rows"][i][4], i == 1 ? Json("x²") : Json(nullptr));
  }
}

}  // namespace
}  // namespace taut::report::chosen_report_test
