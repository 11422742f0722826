#pragma once

#include <array>
#include <functional>

#include "experiments/report/claims/claim.hpp"
#include "tests/report/raw_records.hpp"

namespace taut::report::reading {

/// Reads a sentence about costs: evaluated from the bench's samples, of cases that completed,
/// without what only one solver has.
class CostReader {
 public:
  CostReader(const ReportInput& input, const Claim& claim)
      : input_(input), text_(claim.sentence), sure_(claim.sure) {}

  void cost(const std::string& other) const {
    const std::string first = first_beside(other);
    std::map<std::string, Ratio> ratios;
    std::map<std::string, double> logs;
    Scenes expected;
    for (const SceneBench& scene : input_.bench->scenes) {
      if (!has(scene, first)) continue;
      expected.insert(scene.scene);
      const BenchedCase *ours = cheapest(scene, first, false),
                        *theirs = cheapest(scene, other, false);
      if (!ours || !theirs) continue;
      ratios[scene.scene] = ratio_of(*ours, *theirs);
      logs[first] += std::log(cost_of(*ours)), logs[other] += std::log(cost_of(*theirs));
    }
    Scenes named = directions(first, other, ratios);
    const auto check = [&](const std::string& words, bool ours, bool theirs, bool timed) {
      for (const std::string& name : names_in(said(words))) {
        named.insert(name);
        EXPECT_EQ(cheapest(bench(name), other, false) != nullptr, theirs) << words << name;
        EXPECT_EQ(has(bench(name), other), timed) << words << name;
        EXPECT_TRUE(!timed || (cheapest(bench(name), first, false) != nullptr) == ours) << name;
      }
    };
    for (const auto& [missing, having] : {std::pair(other, first), {first, other}})
      for (const bool to_the_end : {false, true}) {
        const std::string words =
            (to_the_end ? " Never reached by " : " Reached by no setting tried of ") +
            label_of(missing) +
            (to_the_end ? ", tried to the end of its accuracy parameters" : "") + ", but by " +
            label_of(having) + " on ";
        check(words, having == first, having == other, true);
        for (const std::string& name : names_in(said(words)))
          EXPECT_EQ(searched(bench(name), missing), to_the_end) << words << name;
      }
    const std::string b = label_of(other);
    check(" Reached by no setting tried on ", false, false, true);
    check(" Not timed with " + b + " on ", false, false, false);
    EXPECT_EQ(named, expected);
    for (const Names& m :
         matches(said(" CPU time per simulated second: "), pattern("([A-Z][A-Za-z]+) #\u00A0ms")))
      EXPECT_PRED2(near, number_in(m[2]) / 1e3,
                   std::exp(logs[solver_of(m[1])] / static_cast<double>(ratios.size())));
  }

  void same_work(const std::string& other) const {
    const std::string first = first_beside(other);
    std::map<std::string, Ratio> ratios;
    std::set<std::string> works, named;
    for (const SceneBench& scene : input_.bench->scenes) {
      std::vector<Ratio> here;
      for (const auto& [substeps, sweeps] :
           {std::pair{1, 4}, {1, 16}, {4, 1}, {8, 2}, {1024, 1}, {1, 128}}) {
        const BenchedCase *ours = nullptr, *theirs = nullptr;
        for (const BenchedCase& c : scene.cases) {
          if (!counts(c) || tethered(c) || Raw::number(c.record, "substeps") != substeps ||
              Raw::number(c.record, "iterations") != sweeps)
            continue;
          if (c.record.solver == first) ours = &c;
          if (c.record.solver == other) theirs = &c;
        }
        if (!ours || !theirs || ours->record.dt != theirs->record.dt) continue;
        here.push_back(ratio_of(*ours, *theirs));
        works.insert(std::to_string(substeps) + " × " + std::to_string(sweeps));
      }
      if (!here.empty()) ratios[scene.scene] = mean_of(here);
    }
    EXPECT_EQ(directions(first, other, ratios).size(), ratios.size());
    for (const Names& m : matches(text_.substr(0, text_.find("): ")), "\\d+ × \\d+"))
      named.insert(m[0]);
    EXPECT_EQ(named, works);
  }

  /// "on hang 2.1 ms, 1/10 of without; on ball 3 ms, not to be told apart
  /// from without (1.02, 95 % interval 0.97 to 1.08)".
  void only(const std::string& other) const {
    EXPECT_EQ(text_.find("With tethers, which " + label_of(other) + " does not have, Jakobsen "),
              0U);
    const auto clauses = matches(
        text_, pattern("on ([a-z]+) #\u00A0ms, (#(\u00A0%)? of|more than|not to be told apart from|"
                       "too noisy to be told from|without not)( without \\(#, 95\u00A0% interval # "
                       "to #\\))?"));
    Scenes named, expected, missed;
    double noise = 0;
    for (const SceneBench& scene : input_.bench->scenes) {
      if (!has(scene, other) ||
          !std::ranges::any_of(scene.cases, [](const BenchedCase& c) { return tethered(c); }))
        continue;
      const bool reached = cheapest(scene, "jakobsen", true) != nullptr;
      (reached ? expected : missed).insert(scene.scene);
      if (reached) noise = std::max(noise, noise_of(scene));
    }
    for (const Names& m : clauses) named.insert(m[1]);
    EXPECT_EQ(named, expected);
    const Names others = names_in(said("; not reached by the settings tried on "));
    EXPECT_EQ(Scenes(others.begin(), others.end()), missed);
    const auto stray = matches(text_, pattern("identical code differed by up to #\u00A0%"));
    ASSERT_EQ(stray.size(), 1U);
    EXPECT_PRED2(near, number_in(stray[0][1]) / 100, noise);
    for (const Names& m : clauses) {
      const BenchedCase *with = cheapest(bench(m[1]), "jakobsen", true),
                        *without = cheapest(bench(m[1]), "jakobsen", false);
      ASSERT_TRUE(with);
      EXPECT_PRED2(near, number_in(m[2]) / 1e3, cost_of(*with));
      EXPECT_EQ(m[3] == "without not", without == nullptr);
      if (!without) continue;
      const Ratio ratio = ratio_of(*with, *without);
      const Certainty sure = told(ratio, noise_of(bench(m[1])));
      EXPECT_EQ(m[3] == "not to be told apart from", sure == Certainty::none);
      EXPECT_EQ(m[3] == "too noisy to be told from", sure == Certainty::too_noisy);
      EXPECT_EQ(m[6].empty(), sure == Certainty::clear || sure == Certainty::likely);
      constexpr std::size_t kEnds[] = {1, 0, 2};  // the sentence has the middle first
      for (std::size_t k = 0; k < 3 && !m[6].empty(); ++k)
        EXPECT_PRED2(near, number_in(m[7 + k]), ratio[kEnds[k]]);
      EXPECT_EQ(m[3] == "more than",
                (sure == Certainty::clear || sure == Certainty::likely) && ratio[1] > 1);
      if (m[4].empty()) continue;
      EXPECT_PRED2(near, number_in(m[4]) / (m[5].empty() ? 1 : 100), ratio[1]);
    }
  }
  void difference_of_cost(const std::string& solver) const {
    double sum = 0;
    int n = 0;
    for (const auto& [a, b] : input_.differences->timed)
      if (a.record.solver == solver && counts(a) && counts(b))
        sum += std::log(cost_of(b) / cost_of(a)), ++n;
    const auto cases = matches(text_, ", (\\d+) cases? in sessions");
    ASSERT_EQ(cases.size(), 1U);
    EXPECT_EQ(std::stoi(cases[0][1]), n);
    if (n == 0) return;
    const double change = sum / n, stray = std::log1p(input_.differences->noise);
    const auto uses = matches(text_, pattern("(A|B) uses #(\u00A0%)? of the CPU time of"));
    EXPECT_EQ(uses.size(), std::abs(change) > std::max(std::log(1.05), stray) ? 1U : 0U);
    for (const Names& m : uses) {
      const double share = number_in(m[2]) / (m[3].empty() ? 1 : 100);
      EXPECT_PRED2(near, share, std::exp(m[1] == "B" ? change : -change));
    }
  }

 private:
  std::string said(const std::string& opening) const { return said_after(text_, opening); }

  static bool tethered(const BenchedCase& c) {
    return c.record.params.contains("tethers") && c.record.params.at("tethers") == "on";
  }
  static bool counts(const BenchedCase& c) {
    return Raw::good(c.record) && c.timing.failure.empty();
  }
  static double cost_of(const BenchedCase& c) { return median(c.timing.samples) / c.record.dt; }
  static bool cheaper(const BenchedCase& a, const BenchedCase* b) {
    return !b || cost_of(a) < cost_of(*b);
  }
  static bool has(const SceneBench& scene, const std::string& solver) {
    return std::ranges::any_of(scene.cases,
                               [&](const auto& c) { return c.record.solver == solver; });
  }
  static double noise_of(const SceneBench& scene) {
    return std::max(1 / scene.control.low, scene.control.high) - 1;
  }
  /// Low end, middle and high end.
  using Ratio = std::array<double, 3>;
  /// Cost of a over b per simulated second: the least, the median and the largest of five blocks
  /// A B B A. The outer ones are the ends of the bootstrap's interval: in 5.8 % of the resamples of
  /// five the least is the median, which is more than 2.5 %.
  static Ratio ratio_of(const BenchedCase& a, const BenchedCase& b) {
    const std::vector<double>&x = a.timing.samples, &y = b.timing.samples;
    EXPECT_EQ(x.size(), 10U);
    std::vector<double> blocks;
    for (std::size_t i = 0; i + 1 < x.size(); i += 2)
      blocks.push_back((x[i] + x[i + 1]) / a.record.dt / ((y[i] + y[i + 1]) / b.record.dt));
    std::ranges::sort(blocks);
    return {blocks.front(), blocks[2], blocks.back()};
  }
  /// Their geometric mean; the errors of independent ratios add as squares.
  static Ratio mean_of(const std::vector<Ratio>& ratios) {
    double below = 0, middle = 0, above = 0;
    for (const auto& [low, mid, high] : ratios) {
      middle += std::log(mid);
      below += std::log(mid / low) * std::log(mid / low);
      above += std::log(high / mid) * std::log(high / mid);
    }
    const auto n = static_cast<double>(ratios.size());
    return {std::exp((middle - std::sqrt(below)) / n), std::exp(middle / n),
            std::exp((middle + std::sqrt(above)) / n)};
  }
  /// How sure a difference is, as meaning() says it.
  static Certainty told(const Ratio& ratio, double noise) {
    const auto& [low, mid, high] = ratio;
    const double change = std::max(mid, 1 / mid) - 1;
    if (change > 0.05 && change <= noise) return Certainty::too_noisy;
    if (change <= 0.05 || (low <= 1 && 1 <= high)) return Certainty::none;
    const double least = (mid < 1 ? 1 / high : low) - 1;
    return noise <= 0.05 && least > std::max(noise, 0.05) ? Certainty::clear : Certainty::likely;
  }
  const SceneBench& bench(const std::string& scene) const {
    return *std::ranges::find(input_.bench->scenes, scene, &SceneBench::scene);
  }
  const BenchedCase* cheapest(const SceneBench& scene, const std::string& solver, bool with) const {
    const BenchedCase* best = nullptr;
    for (const BenchedCase& c : scene.cases)
      if (c.record.solver == solver && counts(c) && tethered(c) == with &&
          c.record.values.at("stretch.rms") <= 0.01 && cheaper(c, best))
        best = &c;
    return best;
  }
  /// Who is compared with `other`: the first that the bench has.
  std::string first_beside(const std::string& other) const {
    const std::string& first = input_.bench->scenes.front().cases.front().record.solver;
    EXPECT_NE(first, other);
    return first;
  }
  /// Tried at the last value of both parameters that a search would try.
  static bool searched(const SceneBench& scene, const std::string& solver) {
    int substeps = 0, sweeps = 0;
    for (const BenchedCase& c : scene.cases)
      if (c.record.solver == solver)
        substeps = std::max(substeps, Raw::number(c.record, "substeps")),
        sweeps = std::max(sweeps, Raw::number(c.record, "iterations"));
    return substeps >= 1024 && sweeps >= 128;
  }

  /// Who is said to need less where, by how much and how sure; gives the scenes judged.
  Scenes directions(const std::string& first, const std::string& other,
                    const std::map<std::string, Ratio>& ratios) const {
    Scenes judged;
    double noise = 0;
    std::vector<Ratio> all;
    std::set<Certainty> sure;
    for (const auto& [scene, ratio] : ratios) {
      noise = std::max(noise, noise_of(bench(scene))), all.push_back(ratio);
      sure.insert(told(ratio, noise_of(bench(scene))));
    }
    const auto each = [&](const std::string& words, const auto& check) {
      for (const std::string& scene : names_in(said(words))) {
        judged.insert(scene);
        ASSERT_TRUE(ratios.contains(scene)) << scene;
        check(std::log(ratios.at(scene)[1]), std::log(1 + noise_of(bench(scene))));
      }
    };
    const double tolerance = std::log(1.05) - 1e-9;
    each(" Less with " + label_of(first) + " on ", [&](double change, double stray) {
      EXPECT_LT(change, -std::max(tolerance, stray - 1e-9));
    });
    each(" Less with " + label_of(other) + " on ", [&](double change, double stray) {
      EXPECT_GT(change, std::max(tolerance, stray - 1e-9));
    });
    each(" Too noisy to judge on ",
         [&](double change, double stray) { EXPECT_LE(std::abs(change), stray + 1e-9); });
    each(" No difference that can be told on ", [](double, double) {});
    if (ratios.empty()) {
      EXPECT_EQ(sure_, Certainty::single_run);
      EXPECT_EQ(text_.find("of the CPU time"), std::string::npos);
      return judged;
    }
    const Ratio mean = mean_of(all);
    sure.insert(told(mean, noise));
    sure.erase(Certainty::none);
    EXPECT_EQ(sure_, sure.empty() ? Certainty::none : *sure.rbegin());
    const auto ends = matches(text_, pattern("95\u00A0% interval #(\u00A0%)? to #(\u00A0%)?;"));
    EXPECT_EQ(ends.size(), 1U);
    const auto number = [](const Names& m, std::size_t at) {
      return number_in(m[at]) / (m[at + 1].empty() ? 1 : 100);
    };
    const auto factor = matches(
        text_,
        pattern("([A-Z][A-Za-z]+) uses #(\u00A0%)? of the CPU time of ([A-Z][A-Za-z]+) \\([^;]*; "
                "geometric mean over ([^)]*)\\)"));
    if (!factor.empty()) {
      const Names& m = factor[0];
      const bool ours = solver_of(m[1]) == first;
      EXPECT_LT(number(m, 2), 1);
      EXPECT_PRED2(near, number(m, 2), ours ? mean[1] : 1 / mean[1]);
      EXPECT_PRED2(near, number(ends[0], 1), ours ? mean[0] : 1 / mean[2]);
      EXPECT_PRED2(near, number(ends[0], 3), ours ? mean[2] : 1 / mean[0]);
      EXPECT_EQ(solver_of(solver_of(m[1]) == first ? m[4] : m[1]), other);
      EXPECT_EQ(names_in(m[5]).size(), ratios.size());
    } else {
      const auto even = matches(text_, pattern(" over [A-Za-z]+ #,"));
      EXPECT_EQ(even.size(), 1U);
      for (const Names& m : even) EXPECT_PRED2(near, number_in(m[1]), mean[1]);
      EXPECT_PRED2(near, number(ends[0], 1), mean[0]);
      EXPECT_PRED2(near, number(ends[0], 3), mean[2]);
    }
    const auto stray = matches(text_, pattern("identical code differed by up to #\u00A0%"));
    EXPECT_EQ(stray.size(), 1U);
    for (const Names& m : stray) EXPECT_PRED2(near, number_in(m[1]) / 100, noise);
    return judged;
  }

  const ReportInput& input_;
  const std::string& text_;
  Certainty sure_;
};

}  // namespace taut::report::reading
