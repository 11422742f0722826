// Curves and their labels: what a chart keeps fixed, orders of convergence, fits and names.

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::curves_test {
namespace {

using Names = std::vector<std::string>;

Record at_step(double dt) { return synthetic::record("hang", "jakobsen", 16, dt); }

std::vector<Record> at_steps(const std::vector<double>& steps) {
  std::vector<Record> all;
  for (const double dt : steps) all.push_back(at_step(dt));
  return all;
}

double held(const std::vector<double>& steps, double preferred) {
  const std::vector<Record> all = at_steps(steps);
  return hold(all, "dt", preferred).value;
}

TEST(Slices, HoldTheCommonestValueAndOfEqualsTheNearest) {
  EXPECT_EQ(held({.004, .004, .02, .02, .05, .1}, 1.0 / 64), .02) << "the later of equals";
  EXPECT_EQ(held({.014, .014, .06, .06, .1, .2}, 1.0 / 64), .014) << "the earlier of equals";
  EXPECT_EQ(held({.014, .06, .06, .1, .2}, 1.0 / 64), .06) << "common before near";
  EXPECT_EQ(held({.014, .014}, 1.0 / 64), .014);
  EXPECT_EQ(held({.01, .02}, 1.0 / 64), .02);
  EXPECT_TRUE(std::isnan(held({}, 1.0 / 64)));
}

TEST(Slices, KeepWhatHasNoSuchSetting) {
  std::vector<Record> all;
  for (const int sweeps : {1, 4, 4, 16, 64})
    all.push_back(synthetic::record("hang", "jakobsen", sweeps, 0.01));
  all.push_back(synthetic::record("hang", "mass-spring", 1, 0.01));
  all.back().params.erase("iterations");
  all.back().sweeps = -1;
  const Slice slice = hold(all, "iterations", 16);
  EXPECT_EQ(slice.value, 4);
  ASSERT_EQ(slice.records.size(), 3u);
  EXPECT_EQ(slice.records[0], &all[1]);
  EXPECT_EQ(slice.records[2], &all[5]);
}

// Positions computed by another program have a time step but no sweeps; their floor is rounding.
TEST(Curves, PositionsFromAFileAreALevelOverSweeps) {
  StudyResult study{"iterations", "?", synthetic::iterations("hang"), 0, {}};
  for (const double dt : {1.0 / 64, 1.0 / 32}) {
    Record file = synthetic::record("hang", "file", 1, dt);
    file.params.erase("iterations");
    file.sweeps = -1;
    file.values = {{"stretch.rms", dt}};
    file.resolved_settings = {{kStrainFloor, "1e-7", "", 1e-7}};
    study.records.push_back(file);
  }
  Record failed =
      // drawn as a mark at its number of sweeps
      synthetic::record("hang", "jakobsen", 512, 1.0 / 64);
  failed.status = {Status::Kind::exploded, Reason::energy, 3, 0};
  failed.values.clear();
  study.records.push_back(failed);
  const auto of_file = [](const Chart& chart) {
    std::vector<std::pair<double, double>> points;
    for (const Curve& curve : chart.curves)
      if (curve.solver == "file")
        for (const Point& p : curve.points) points.emplace_back(p.x, p.y);
    return points;
  };
  using Points = std::vector<std::pair<double, double>>;
  ReportInput input;
  input.studies = {study};
  const std::vector<Chart> charts = scene_charts(input, "hang");
  ASSERT_FALSE(charts.empty());
  EXPECT_EQ(of_file(charts.front()), (Points{{1, 1.0 / 64}, {512, 1.0 / 64}}))
      << "at the time step of the others";
  EXPECT_EQ(of_file(make_chart("stability", input.studies[0].records, "dt", "stretch.rms", "dt")),
            (Points{{1.0 / 64, 1.0 / 64}, {1.0 / 32, 1.0 / 32}}));
}

TEST(Curves, PredictedStretchHasAChartWhoseLineIsEqual) {
  StudyResult study;
  for (const int sweeps : {4, 8, 16}) {
    Record r = synthetic::record("hang", "jakobsen", sweeps, 1.0 / 64);
    r.values = {{"stretch.rms", 0.1 / sweeps}, {"stretch.predicted", 0.11 / sweeps}};
    study.records.push_back(r);
  }
  ReportInput input;
  input.studies = {study};
  const auto predicted = [&] {
    std::vector<Chart> charts = scene_charts(input, "hang");
    std::erase_if(charts, [](const Chart& c) { return c.id != "hang-predicted"; });
    return charts;
  };
  ASSERT_EQ(predicted().size(), 1u);
  const Chart chart = predicted().front();
  EXPECT_EQ(theory_factor(chart), 1) << "not below the curves";
  EXPECT_EQ(chart.slope, 1);
  EXPECT_FALSE(chart.join);
  EXPECT_EQ(chart.curves.at(0).points.at(0).x, 0.11 / 16);
  for (Record& r : input.studies[0].records) r.values.erase("stretch.predicted");
  EXPECT_TRUE(predicted().empty());
}

TEST(Curves, NameASettingWhereItsValueAloneSaysNothing) {
  std::vector<Record> all;
  const auto add = [&](const char* name, const char* value, const char* setting) {
    Record r = at_step(0.01);
    r.params["omega"] = "1";
    r.params["tethers"] = "off";
    r.params["order"] = "mesh";
    r.params[name] = value;
    if (*setting) r.spec.settings = {"time.dt=0.01", setting};
    r.values["stretch.rms"] = 1;
    all.push_back(r);
  };
  add("omega", "1", "wind.strength=2");
  add("omega", "1.5", "wind.strength=2");
  add("tethers", "on", "wind.strength=2");
  add("order", "coloured", "wind.strength=2");
  add("omega", "1", "wind.strength=2.5");
  const auto curves = make_curves(all, "iterations", "stretch.rms", "iterations");
  Names labels;
  for (const Curve& c : curves) labels.push_back(c.label);
  EXPECT_EQ(labels, (Names{"Jakobsen omega=1 mesh tethers=off wind.strength=2",
                           "Jakobsen omega=1.5 mesh tethers=off wind.strength=2",
                           "Jakobsen omega=1 mesh tethers=on wind.strength=2",
                           "Jakobsen omega=1 coloured tethers=off wind.strength=2",
                           "Jakobsen omega=1 mesh tethers=off wind.strength=2.5"}));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    EXPECT_EQ(curves[i].variant, static_cast<int>(i));
    EXPECT_EQ(curves[i].points.size(), 1u);
  }
}

TEST(Curves, AreOrderedAlongTheirSettingWhatHasNoneLast) {
  std::vector<Record> all;
  for (const int sweeps : {8, -1, 2, 4}) {
    Record r = at_step(0.01);
    r.sweeps = sweeps;
    r.values["stretch.rms"] = 1;
    if (sweeps < 0) r.params.erase("iterations");
    all.push_back(r);
  }
  const auto curves = make_curves(all, "dt", "stretch.rms", "iterations");
  ASSERT_EQ(curves.size(), 1u);
  std::vector<const Record*> order;
  for (const Point& p : curves[0].points) order.push_back(p.record);
  EXPECT_EQ(order, (std::vector<const Record*>{&all[2], &all[3], &all[0], &all[1]}));
  for (Record& r : all) r.values["stretch.max"] = static_cast<double>(r.params.size());
  const auto free = make_curves(all, "stretch.max", "stretch.rms", "setting");
  ASSERT_EQ(free.size(), 1u);
  for (std::size_t i = 1; i < free[0].points.size(); ++i)
    EXPECT_GE(free[0].points[i].along, free[0].points[i - 1].along);
  EXPECT_EQ(free[0].points.back().name, "1 × 4") << "the settings that vary";
}

TEST(Quantities, ReadARecordsSettingsSizesAndValues) {
  Record r = at_step(0.01);
  r.steps = 7;
  r.vertices = 5;
  r.links = 6;
  r.projections = 9;
  r.values["stretch.rms"] = 0.5;
  r.spec.settings = {"wind.strength=2", "wind.strength=3", "wind.strengths=4", "a=1x"};
  r.resolved_settings = {{"time step", "1"}, {kStrainFloor, "of binary32", "", 1.5e-7}};
  for (const auto& [name, value] : {std::pair<std::string, double>{"dt", 0.01},
                                    {"steps", 7},
                                    {"vertices", 5},
                                    {"links", 6},
                                    {"projections", 9},
                                    {"iterations", 16},
                                    {"stretch.rms", 0.5},
                                    {"wind.strength", 3},
                                    {"strain.floor", 1.5e-7}})
    EXPECT_EQ(value_of(r, name), value) << name;
  for (const char* none : {"a", "substeps", "precision", "nothing"})
    EXPECT_TRUE(std::isnan(value_of(r, none))) << none;
  EXPECT_EQ(shown(kNumber, 3), "3");
  EXPECT_EQ(shown(kNumber, 9999999), "9999999");
  EXPECT_EQ(shown(kNumber, 1e7), "10⁷");
  EXPECT_EQ(shown(kNumber, 1.26), "1.3");
  EXPECT_EQ(shown(kErrorShare, 0.0123), "1.2\u00A0%");
  EXPECT_EQ(shown(kErrorLength, 3.26e-4, 1), "0.3\u00A0mm");
  EXPECT_EQ(shown(kErrorShare, std::nan("")), "–");
  EXPECT_EQ(quantity("dt").label(), "time step [ms]");
  EXPECT_EQ(quantity("iterations").label(), "sweeps per substep");
  EXPECT_EQ(quantity("memory.peak").text(3e6), "3.0\u00A0MB");
  EXPECT_EQ(quantity("cpu.per_step").text(0.002), "2.0\u00A0ms");
  EXPECT_EQ(quantity("penetration.box.max").title, "largest penetration box");
  EXPECT_EQ(quantity("no.such").title, "no.such");
  EXPECT_EQ(quantity("structural").label(), "structural") << "N/m of some, m/N of XPBD";
  EXPECT_EQ(quantity("structural").help, "");
  EXPECT_EQ(quantity("structural", "mass-spring").label(), "structural [N/m]");
  EXPECT_EQ(quantity("xpbd:structural").label(), "structural [m/N]");
  EXPECT_EQ(quantity("xpbd:structural").name, "xpbd:structural");
  EXPECT_EQ(quantity("omega").label(), "omega");
  EXPECT_TRUE(quantity("omega").help.starts_with("relaxation factor"));
}

TEST(Settings, ArePutIntoFewWords) {
  EXPECT_EQ(solver_title("my_own-solver"), "My own solver");
  EXPECT_EQ(solver_title("bullet-deformable"), "Bullet deformable");
  EXPECT_EQ(labelled_parameters("jakobsen"),
            (Names{"omega", "order", "tethers", "levels", "precision"}));
  EXPECT_EQ(labelled_parameters("nobody's"), Names{});
  EXPECT_EQ(searched_parameters("nobody's"), Names{});
  EXPECT_EQ(searched_parameters("mass-spring"), (Names{"precision", "structural", "shear"}));
  EXPECT_TRUE(std::ranges::count(searched_parameters("bullet"), "reorder"));
  const auto brief = [](const char* solver) { return brief_settings(parse_solver(solver)); };
  EXPECT_EQ(brief("jakobsen:substeps=2,iterations=8,order=mesh"), "2 × 8, order=mesh");
  EXPECT_EQ(brief("mass-spring:substeps=4,drag=2"), "4 substeps, drag=2");
  EXPECT_EQ(brief("avbd:iterations=4"), "1 × 4") << "k-max=1e+09 is its default, 1e9";
  Record gone;  // its solver is not here
  gone.solver = "nosuch";
  gone.spec.solver = "nosuch:a=1,sweeps=4";
  gone.params = {{"a", "1"}, {"sweeps", "4"}};
  gone.work_parameters = {"sweeps"};
  gone.sweeps = 4;
  EXPECT_EQ(brief_settings(gone), "1 × 4, a=1");
  EXPECT_EQ(titled("nosuch", brief_settings(gone)), "Nosuch 1 × 4, a=1");
  EXPECT_EQ(titled("jakobsen", ""), "Jakobsen");
  EXPECT_EQ(named_setting(kSweeps, "8"), "8 sweeps");
  EXPECT_EQ((Work{-1, -1}).text(), "defaults");
  EXPECT_EQ((Work{-1, 4}).text(), "4 sweeps");
  EXPECT_EQ((Work{0, 0}).text(), "0 × 0");
  Record r = at_step(0.01);
  EXPECT_EQ(work_of(r), (Work{1, 16})) << "whole steps are one substep";
  r.substeps = 5;
  EXPECT_EQ(work_of(r), (Work{5, 16}));
  r.sweeps = -1;
  EXPECT_EQ(work_of(r), (Work{5, -1}));
}

TEST(Settings, AcceleratorsThatTheOtherLacksAreExtras) {
  Record r = at_step(0.01);
  r.params["tethers"] = "on";
  r.params["omega"] = "1";
  r.params["levels"] = "3";
  EXPECT_EQ(extras(r, {}), (Names{"tethers", "levels"})) << "omega is at its default";
  EXPECT_EQ(extras(r, {{"tethers", "off"}}), Names{"levels"});
  r.solver = "bullet";
  EXPECT_EQ(extras(r, {}), Names{});
}

/// Records of two solvers with these substeps and sweeps.
std::vector<Record> at_work(const std::vector<std::pair<std::string, std::vector<Work>>>& all) {
  std::vector<Record> records;
  for (const auto& [solver, works] : all)
    for (const Work& work : works) {
      records.push_back(synthetic::record("hang", solver, work.sweeps, 0.01));
      records.back().substeps = work.substeps;
    }
  return records;
}

TEST(Settings, WorkIsUnequalIfNoneIsCommonToAll) {
  const auto common = at_work({{"jakobsen", {{1, 4}, {5, 16}}}, {"bullet", {{5, 16}, {1, 64}}}}),
             apart = at_work({{"jakobsen", {{5, 64}, {5, 1}}}, {"bullet", {{1, 16}}}}),
             alone = at_work({{"jakobsen", {{5, 64}, {5, 1}}}}),
             none = at_work({{"jakobsen", {{5, 0}}}, {"bullet", {{1, 16}}}});
  EXPECT_EQ(unequal_work(common), "");
  EXPECT_EQ(unequal_work(apart), "Jakobsen 5 × 1 to 5 × 64, Bullet 1 × 16 (substeps × sweeps)");
  EXPECT_EQ(unequal_work(alone), "");
  EXPECT_EQ(unequal_work(none), "") << "no sweeps, no work to compare";
}

TEST(Settings, LabelsHaveWhatVariesAndNoMore) {
  std::vector<Record> all = at_work({{"jakobsen", {{1, 4}, {1, 8}, {1, 8}}}, {"bullet", {{1, 8}}}});
  for (Record& r : all) {
    r.params["tethers"] = "off";
    r.params["order"] = "mesh";
  }
  all[1].params["tethers"] = "on";
  all[0].params["omega"] = "1.5";
  all[1].params["omega"] = all[2].params["omega"] = "1";
  all[2].params["order"] = "coloured";
  const SettingLabels labels(all);
  EXPECT_EQ(labels.of(all[0]), "1 × 4, omega=1.5, mesh") << "a number does not speak for itself";
  EXPECT_EQ(labels.of(all[1]), "1 × 8, mesh, tethers=on");
  EXPECT_EQ(labels.of(all[2]), "1 × 8") << "what is as the solver has it is not said";
  EXPECT_EQ(labels.of(all[1], {"order"}), "1 × 8, tethers=on") << "what is said beside it";
  EXPECT_EQ(labels.of(all[3]), "") << "nothing varies of Bullet's";
  EXPECT_EQ(labels.parts(all[1]).terms(), (Names{kWorkTerm, "order of Jakobsen", "tethers"}))
      << "vbd and bullet have another order";
  EXPECT_EQ(label_part(Work{4, -1}).term, "") << "it says what it is";

  std::vector<Record> by_order = at_work({{"jakobsen", {{1, 4}, {1, 4}}}});
  by_order[0].params["order"] = "coloured";
  by_order[1].params["order"] = "mesh";
  const SettingLabels of_order(by_order);
  EXPECT_EQ(of_order.of(by_order[0]), "1 × 4") << "the defaults";
  EXPECT_EQ(of_order.of(by_order[1]), "mesh");
}

TEST(Charts, ACurveThatLiesOnAnotherIsSaid) {
  std::vector<Record> records = synthetic::iterations("hang");
  std::erase_if(records, [](const Record& r) { return r.status.kind != Status::Kind::ok; });
  const auto same = [&](double factor) {
    std::vector<Record> all;
    for (Record r : records) {
      if (r.solver == "bullet") continue;
      all.push_back(r);
      r.solver = "xpbd";
      r.values["stretch.rms"] *= factor;
      all.push_back(r);
    }
    return coincident_curves(make_chart("convergence", all, kSweeps, "stretch.rms", kSweeps));
  };
  EXPECT_EQ(same(1), (std::vector<std::string>{"XPBD lies on Jakobsen: the same"}));
  EXPECT_EQ(same(1.002),
            (std::vector<std::string>{"XPBD lies on Jakobsen: the same to 0.2\u00A0%"}));
  EXPECT_TRUE(same(1.02).empty());
  for (Record& r : records) r.values["stretch.rms"] = 0;
  EXPECT_TRUE(same(1).empty()) << "zeros stand side by side on the axis";
}

TEST(Charts, ATheoryLineLiesBelowTheLowestPoint) {
  std::vector<Record> all = at_work({{"jakobsen", {{1, 1}, {1, 2}, {1, 4}}}});
  for (const auto& [i, y] : {std::pair{0, 8.0}, {1, 3.0}, {2, 2.0}})
    all[static_cast<std::size_t>(i)].values["stretch.rms"] = y;
  Chart chart = make_chart("x", all, "iterations", "stretch.rms", "iterations");
  EXPECT_TRUE(std::isnan(theory_factor(chart)));
  chart.slope = -1;  // y x: 8, 6, 8
  EXPECT_NEAR(theory_factor(chart), 0.6 * 6, 1e-12);
  EXPECT_EQ(chart.ticks, (std::vector<double>{1, 2, 4}));
  chart.curves[0].points[0].x = 0;  // its work is unknown
  EXPECT_EQ(pareto_front(chart).size(), 2u);
  EXPECT_NEAR(theory_factor(chart), 0.6 * 6, 1e-12);
  EXPECT_EQ(tick_of(quantity("dt"), 0.004), "4");
  EXPECT_EQ(tick_of(quantity("dt"), 0.0042), "4.2");
  EXPECT_EQ(tick_of(quantity("iterations"), 99999), "99999");
  EXPECT_EQ(tick_of(quantity("iterations"), 100000), "100000");
  EXPECT_EQ(tick_of(quantity("iterations"), 1e6), "10⁶");
}

TEST(Maps, HaveTheirCellsByAscendingSettings) {
  std::vector<Record> all;
  for (const double dt : {0.02, 0.01})
    for (const int sweeps : {4, 1})
      all.push_back(synthetic::record("hang", "jakobsen", sweeps, dt));
  all.push_back(all[0]);
  all[0].status.kind = Status::Kind::crash;
  all.push_back(all[1]);
  all.back().status.kind = Status::Kind::exploded;
  const auto maps = make_maps(all, "hang", "dt", "iterations");
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].columns, (std::vector<double>{0.01, 0.02}));
  EXPECT_EQ(maps[0].rows, (std::vector<double>{1, 4}));
  std::map<std::pair<std::size_t, std::size_t>, const Record*> cells;
  for (const auto& cell : maps[0].cells) cells[{cell.column, cell.row}] = cell.record;
  EXPECT_EQ((cells[{1, 1}]), &all[0]);
  EXPECT_EQ((cells[{1, 0}]), &all[5]);
  EXPECT_EQ((cells[{0, 1}]), &all[2]);
  EXPECT_EQ((cells[{0, 0}]), &all[3]);
}

TEST(Maps, OfASceneNeedThreeStepsAndThreeSweeps) {
  const auto maps = [](const std::vector<double>& steps, const std::vector<int>& sweeps) {
    ReportInput input{.studies = {{"one", "?", {}, 0, {}}}};
    for (const char* scene : {"hang", "ball"})
      for (const double dt : steps)
        for (const int k : sweeps)
          input.studies[0].records.push_back(synthetic::record(scene, "jakobsen", k, dt));
    return scene_maps(input, "hang");
  };
  EXPECT_EQ(maps({0.01, 0.02}, {1, 2, 4}).size(), 0u);
  EXPECT_EQ(maps({0.01, 0.02, 0.04}, {1, 2}).size(), 0u);
  const auto found = maps({0.01, 0.02, 0.04}, {1, 2, 4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].study + " " + found[0].scene, "one hang");
  EXPECT_EQ(found[0].x.name + " " + found[0].y.name, "dt iterations");
  EXPECT_EQ(found[0].cells.size(), 9u);
}

TEST(Maps, ThatWereAskedForNeedTwoOfEach) {
  ReportInput input{.studies = {{"one", "?", {}, 0, {}}}};
  for (const double dt : {0.01, 0.02}) {
    input.studies[0].records.push_back(synthetic::record("hang", "jakobsen", 1, dt));
    input.studies[0].records.push_back(synthetic::record("hang", "jakobsen", 4, dt));
  }
  input.maps = {{"one", "?", "dt", "iterations", {}}, {"two", "?", "iterations", "dt", {}}};
  input.maps[1].records = {input.studies[0].records.begin(), input.studies[0].records.begin() + 2};
  EXPECT_EQ(scene_maps(input, "hang").size(), 1u) << "one time step alone is no map";
  input.maps[1].records = input.studies[0].records;
  const auto both = scene_maps(input, "hang");
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].study + " " + both[1].x.name, "two iterations");
  EXPECT_TRUE(scene_maps(input, "ball").empty());
}

TEST(Keys, AreAsShortAsTellsThemApartInStepsOfFour) {
  const auto length = [](const std::string& a, const std::string& b) {
    ReportInput input{.studies = {{"one", "?", {at_step(0.01), at_step(0.02)}, 0, {}}}};
    input.studies[0].records[0].key = a;
    input.studies[0].records[1].key = b;
    CaseList refs(input);
    const std::string key = refs.key(a);
    EXPECT_EQ(key, a.substr(0, key.size()));
    EXPECT_EQ(refs.key("no such"), "");
    return key.size();
  };
  const std::string tail(40, 'x');
  EXPECT_EQ(length("0123456789ab" + tail, "0123456789ac" + tail), 12u);
  EXPECT_EQ(length("0123456789abc" + tail, "0123456789abd" + tail), 16u);
  EXPECT_EQ(length("0123456789abcdef0" + tail, "0123456789abcdef1" + tail), 20u);
}

}  // namespace
}  // namespace taut::report::curves_test
