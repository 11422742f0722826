// Ten planted regressions in a study of time steps and sweeps: each is caught, and no change raises
// no alarm.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "experiments/baseline/baseline.hpp"

namespace taut::planted_regressions_test {
namespace {

/// hang under two solvers over dt x iterations; cases with dt/k above 1/60 explode.
Baseline study() {
  Baseline rows;
  for (const std::string solver : {"bullet", "jakobsen"})
    for (const int rate : {240, 120, 60, 30})
      for (const int k : {1, 2, 4}) {
        const std::string dt = "dt=1/" + std::to_string(rate);
        const bool stable = rate * k >= 60;
        const double dt2 = 1.0 / (rate * rate), none = std::nan("");
        BaselineRow row;
        row.spec = {"hang", {"time." + dt}, solver + ":iterations=" + std::to_string(k)};
        row.id = "hang " + dt + " " + row.spec.solver;
        row.scene = "content of hang at " + dt;
        row.status = stable ? RowStatus{"ok"} : RowStatus{"exploded", "energy"};
        row.projections = static_cast<std::size_t>(100 * k);
        row.values = {{"stretch.max", stable ? 300 * dt2 / k : none},
                      {"penetration.max", stable ? 9.81 * dt2 : none}};
        rows.push_back(row);
      }
  return rows;
}

struct Plant {
  const char* name;
  std::function<void(Baseline&)> change;
  bool mismatch = false;  ///< the question differs, not the answer
};

TEST(PlantedRegressions, EachOfTenIsCaughtAndANoOpIsNot) {
  const auto each = [](auto change) {
    return [change](Baseline& rows) {
      for (BaselineRow& row : rows) change(row);
    };
  };
  const std::vector<Plant> plants{
      {"a sweep converges 0.1 % slower",
       each([](BaselineRow& r) { r.values["stretch.max"] *= 1.001; })},
      {"the frontier moves by one cell",
       [](Baseline& rows) {
         for (BaselineRow& r : rows)
           if (r.id == "hang dt=1/60 jakobsen:iterations=1") {
             r.status = {"exploded", "energy"};
             for (auto& [name, value] : r.values) value = std::nan("");
           }
       }},
      {"NaN in one value of one cell",
       [](Baseline& rows) { rows[0].values["stretch.max"] = std::nan(""); }},
      {"penetration widens by a micrometre",
       [](Baseline& rows) { rows[3].values["penetration.max"] += 1e-6; }},
      {"more work for the same result", [](Baseline& rows) { ++rows[5].projections; }},
      {"a case is missing", [](Baseline& rows) { rows.erase(rows.begin() + 4); }, true},
      {"a solver is missing", [](Baseline& rows) { rows.resize(12); }, true},
      {"the scene changed", each([](BaselineRow& r) { r.scene += "'"; }), true},
      {"a case is renamed", [](Baseline& rows) { rows[2].id += " (new)"; }, true},
      {"a setting changed",
       [](Baseline& rows) {
         rows[2].id += ",omega=1.1";
         rows[2].spec.solver += ",omega=1.1";
       },
       true},
  };
  ASSERT_EQ(plants.size(), 10u);
  for (const Plant& plant : plants) {
    Baseline now = study();
    plant.change(now);
    const Comparison found = compare(study(), now, {});
    EXPECT_EQ(found.regressed(), !plant.mismatch) << plant.name;
    EXPECT_EQ(found.mismatched(), plant.mismatch) << plant.name;
    for (const Change& finding : found.findings) EXPECT_FALSE(finding.text.empty()) << plant.name;
  }
  const Comparison same = compare(study(), study(), {});
  EXPECT_TRUE(same.findings.empty());
  EXPECT_EQ(same.cases, 24u);
  EXPECT_EQ(same.values, 48u);
}

}  // namespace
}  // namespace taut::planted_regressions_test
