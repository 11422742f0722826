// The tables of costs, cell by cell, from the samples of made-up benches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include "experiments/case/record_io.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "experiments/system/json.hpp"
#include "tests/report/made_up.hpp"

namespace taut::report::cost_tables_test {
namespace {

struct Made {
  ReportInput input;
  std::map<std::string, Json> tables;  ///< by id
  Json cost;
};

/// Three made-up reports with a bench, a hundred times as fast, so that budgets buy something.
const std::vector<Made>& benches() {
  static const std::vector<Made> all = [] {
    std::vector<Made> made;
    for (unsigned seed = 0; made.size() < 3; ++seed) {
      Made one{made_up::Maker(seed).input(), {}, {}};
      if (!one.input.bench) continue;
      for (SceneBench& scene : one.input.bench->scenes)
        for (BenchedCase& c : scene.cases)
          for (double& t : c.timing.samples) t /= 100;
      const Json model = parse_json(make_model(one.input));
      for (const Json& table : model["tables"]) one.tables[table["id"]] = table;
      one.cost = model["cost"];
      made.push_back(std::move(one));
    }
    return made;
  }();
  return all;
}

/// What a case costs [s/s], how far it is off, and whether either counts.
struct Priced {
  std::string solver;
  double cost, error;
};

double middle(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

/// Those that completed, without tethers unless the scene has one solver alone.
std::vector<Priced> priced(const SceneBench& bench) {
  const bool alone = solvers_of(bench).size() == 1;
  std::vector<Priced> all;
  for (const BenchedCase& c : bench.cases) {
    const auto tethers = c.record.params.find("tethers");
    const bool extra = !alone && tethers != c.record.params.end() && tethers->second == "on";
    if (extra || !c.timing.failure.empty() || !completed(c.record.status)) continue;
    all.push_back({c.record.solver, middle(c.timing.samples) / c.record.dt,
                   c.record.values.at("stretch.rms")});
  }
  return all;
}

/// The least of `what` over the solver's cases that pass `good`.
std::optional<double> least(const std::vector<Priced>& cases, const std::string& solver,
                            double Priced::*what, const std::function<bool(const Priced&)>& good) {
  std::optional<double> best;
  for (const Priced& one : cases)
    if (one.solver == solver && good(one)) best = std::min(best.value_or(1e300), one.*what);
  return best;
}

double first_number(const std::string& text) {
  std::size_t at = text.find_first_of("0123456789");
  return std::stod(text.substr(at));
}

TEST(CostTables, HaveTheCheapestForEachErrorAndTheBestForEachBudget) {
  int reached = 0, missed = 0, bought = 0;
  for (const Made& made : benches())
    for (const SceneBench& bench : made.input.bench->scenes) {
      const auto cases = priced(bench);
      const auto solvers = solvers_of(bench);
      const Json &levels = made.tables.at("cost-levels-" + bench.scene),
                 &budgets = made.tables.at("cost-budgets-" + bench.scene);
      ASSERT_EQ(levels["rows"].size(), 4u);
      ASSERT_EQ(budgets["rows"].size(), 5u);
      const double errors[] = {0.1, 0.01, 0.001, 0.0001},
                   frames[] = {0.1e-3, 0.5e-3, 1e-3, 4e-3, 16e-3};
      const double shown_errors[] = {10, 1, 0.1, 0.01}, shown_frames[] = {0.1, 0.5, 1, 4, 16};
      for (std::size_t r = 0; r < 4; ++r) {
        const Json& row = levels["rows"][r];
        ASSERT_EQ(row.size(), solvers.size() + 1);
        EXPECT_EQ(row[0]["value"], errors[r]);
        EXPECT_NEAR(first_number(row[0]["text"]), shown_errors[r], 1e-12);
        std::optional<double> cheapest_of_all;
        for (const std::string& solver : solvers)
          if (const auto cost = least(cases, solver, &Priced::cost,
                                      [&](const Priced& p) { return p.error <= errors[r]; }))
            cheapest_of_all = std::min(cheapest_of_all.value_or(1e300), *cost);
        for (std::size_t s = 0; s < solvers.size(); ++s) {
          const Json& cell = row[s + 1];
          const auto cost = least(cases, solvers[s], &Priced::cost,
                                  [&](const Priced& p) { return p.error <= errors[r]; });
          ASSERT_EQ(cell.is_object(), cost.has_value()) << cell;
          if (!cost) {
            const auto nearest =
                least(cases, solvers[s], &Priced::error, [](const Priced&) { return true; });
            const std::string text = cell;
            EXPECT_EQ(text.find("no case completed") != text.npos, !nearest) << text;
            if (nearest) {
              const double told = first_number(text.substr(text.find("at best")));
              EXPECT_NEAR(told, 100 * *nearest, 0.05 * 100 * *nearest) << text;
            }
            ++missed;
            continue;
          }
          EXPECT_NEAR(cell["value"].get<double>(), *cost, 1e-12 * *cost);
          EXPECT_NEAR(first_number(cell["text"]), 1e3 * *cost, 0.06 * 1e3 * *cost) << cell["text"];
          EXPECT_LE(cell["low"].get<double>(), *cost);
          EXPECT_GE(cell["high"].get<double>(), *cost);
          EXPECT_LE(cell.contains("note"), *cost > *cheapest_of_all)
              << "the cheapest is not compared with itself";
          ++reached;
        }
      }
      for (std::size_t r = 0; r < 5; ++r) {
        const Json& row = budgets["rows"][r];
        EXPECT_EQ(row[0]["value"], frames[r]);
        EXPECT_NEAR(first_number(row[0]["text"]), shown_frames[r], 1e-12);
        for (std::size_t s = 0; s < solvers.size(); ++s) {
          const auto error = least(cases, solvers[s], &Priced::error,
                                   [&](const Priced& p) { return p.cost <= 60 * frames[r]; });
          ASSERT_EQ(row[s + 1].is_object(), error.has_value()) << row[s + 1];
          if (!error) continue;
          EXPECT_EQ(row[s + 1]["value"], *error);
          const std::string text = row[s + 1]["text"];
          EXPECT_NEAR(first_number(text), 100 * *error, 0.05 * 100 * *error) << text;
          const double spent = first_number(text.substr(text.find(" for ")));  // ms of a frame
          EXPECT_LE(spent, 1e3 * frames[r] * 1.06) << text;
          EXPECT_TRUE(std::ranges::any_of(cases, [&](const Priced& p) {
            return p.error == *error && std::abs(1e3 * p.cost / 60 - spent) <= 0.06 * spent;
          })) << text;
          ++bought;
        }
      }
    }
  EXPECT_GT(reached, 10);
  EXPECT_GT(missed, 5);
  EXPECT_GT(bought, 10);
}

TEST(CostTables, TheAnswerIsTheCheapestForOnePerCent) {
  int answered = 0;
  for (const Made& made : benches()) {
    const Json& rows = made.tables.at("cost-cheapest")["rows"];
    const auto& scenes = made.input.bench->scenes;
    ASSERT_EQ(rows.size(), scenes.size());
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      EXPECT_EQ(rows[k][0], scenes[k].scene);
      const auto cases = priced(scenes[k]);
      std::optional<double> cheapest;
      std::string solver;
      for (const Priced& p : cases)
        if (p.error <= 0.01 && p.cost < cheapest.value_or(1e300))
          cheapest = p.cost, solver = p.solver;
      ASSERT_EQ(rows[k][2].is_object(), cheapest.has_value());
      if (!cheapest) continue;
      EXPECT_NEAR(rows[k][2]["value"].get<double>(), *cheapest, 1e-12 * *cheapest);
      const std::string first = rows[k][1], again = rows[k][4];
      EXPECT_TRUE(first.starts_with(std::string(find_solver(solver).title.empty()
                                                    ? solver == "bullet" ? "Bullet" : "Jakobsen"
                                                    : find_solver(solver).title)))
          << first;
      EXPECT_TRUE(again.starts_with("taut advise " + scenes[k].scene + " --error 1%")) << again;
      ++answered;
    }
  }
  EXPECT_GT(answered, 2);
}

TEST(CostTables, NoiseIsThatOfTheControlAndSharesOnlyGrowWithTheFactor) {
  int rows = 0;
  for (const Made& made : benches()) {
    const auto& scenes = made.input.bench->scenes;
    ASSERT_EQ(made.cost["scenes"].size(), scenes.size());
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      const Interval& control = scenes[k].control;
      const double noise = 100 * (std::max(control.high, 1 / control.low) - 1);
      const std::string said = made.cost["scenes"][k]["noise"];
      EXPECT_NEAR(first_number(said.substr(said.find("up to"))), noise, 0.06 * noise) << said;
      EXPECT_EQ(made.cost["scenes"][k]["scene"], scenes[k].scene);
    }
    if (!made.tables.contains("cost-profiles")) continue;
    double cheapest = 0;  // of some solver in every problem
    for (const Json& row : made.tables.at("cost-profiles")["rows"]) {
      ASSERT_EQ(row.size(), 7u);
      for (std::size_t k = 2; k < 7; ++k)
        EXPECT_GE(first_number(row[k]), first_number(row[k - 1])) << row;
      EXPECT_LE(first_number(row[6]), 100);
      cheapest += first_number(row[1]);
      ++rows;
    }
    EXPECT_GE(cheapest, 99) << "ties count twice";
  }
  EXPECT_GT(rows, 1);
}

}  // namespace
}  // namespace taut::report::cost_tables_test
