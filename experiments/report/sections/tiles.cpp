#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::tiles {

namespace {

/// One number for each contender, as bars. `less_is_better` decides who is praised.
struct Tile {
  std::string heading, caption;
  Quantity quantity;
  std::vector<std::optional<double>> values;
  bool less_is_better = true;
  std::string more, less;   ///< "longer", "less"
  std::string judged = {};  ///< instead of the ratio of the values
};

std::string judgement(const Comparison& facts, const Tile& tile) {
  std::vector<std::size_t> have;
  for (std::size_t i = 0; i < tile.values.size(); ++i)
    if (tile.values[i]) have.push_back(i);
  if (have.size() < 2) return "";
  const auto less = [&](std::size_t a, std::size_t b) { return *tile.values[a] < *tile.values[b]; };
  std::ranges::stable_sort(have, less);
  if (!tile.less_is_better) std::ranges::reverse(have);
  const double best = *tile.values[have[0]], next = *tile.values[have[1]];
  const double factor = tile.less_is_better ? next / best : best / next;
  if (best == next || std::abs(factor - 1) < 0.05) return "<p class=\"even\">alike</p>";
  const std::string who = escape_html(facts.contenders[have[0]].label);
  if (!std::isfinite(factor) || factor > 1e6)
    return "<p class=\"good\">" + who + ": " + (best == 0 ? "none at all" : "far ahead") + "</p>";
  return "<p class=\"good\">" + who + ": " + ratio(factor) + "× " +
         (tile.less_is_better ? tile.less : tile.more) + "</p>";
}

std::string draw(const Comparison& facts, const Tile& tile) {
  double largest = 0;
  for (const auto& value : tile.values)
    if (value) largest = std::max(largest, *value);
  std::string bars;
  for (std::size_t i = 0; i < tile.values.size(); ++i) {
    const auto& value = tile.values[i];
    const double share = value && largest > 0 ? *value / largest * 100 : 0;
    const Contender& c = facts.contenders[i];
    bars += "<li><span class=\"sr\">" + escape_html(c.label) + ": </span><span class=\"number\">" +
            (value ? tile.quantity.text(*value) : "–") +
            "</span><i class=\"bar\"><i style=\"width:" + exact(std::round(share * 10) / 10) +
            "%;background:var(--" + std::string(solver_style(c.solver).colour.name) +
            ")\"></i></i></li>";
  }
  return "<div class=\"card tile\"><h3>" + escape_html(tile.heading) + "</h3><p>" +
         escape_html(tile.caption) + "</p><ul>" + bars + "</ul>" +
         (tile.judged.empty() ? judgement(facts, tile) : tile.judged) + "</div>";
}

/// What the priced error costs; nothing unless every solver reached it somewhere.
std::optional<Tile> cost(const Comparison& facts) {
  if (facts.contenders.size() != 2 || !facts.price[1] || !facts.price[1]->mean) return {};
  const Price& price = *facts.price[1];
  const Quantity error = quantity(kPricedMetric);
  Tile tile{"Cost of " + error.text(kPricedError, 1) + " stretch",
            "CPU time per simulated second, cheapest setting tried, geometric mean of scenes",
            {"", "", "ms", 1e3},
            {price.first_cost, price.other_cost},
            true,
            "more",
            "less"};
  const Interval& r = *price.mean;
  const bool ours = r.mid > 1;
  const Interval by = ours ? r : Interval{1 / r.high, 1 / r.mid, 1 / r.low};
  if (is_significant(r, {1, 1, 1}))
    tile.judged = "<p class=\"good\">" + escape_html(facts.contenders[ours ? 0 : 1].label) + ": " +
                  ratio(by.mid) + "× less (" + ratio(by.low) + "–" + ratio(by.high) + ")</p>";
  else
    tile.judged = "<p class=\"even\">no difference</p>";
  return tile;
}

/// Means over the scenes on which every contender has the value at the quoted sweeps.
std::vector<std::optional<double>> means(const Page& page, const std::string& value,
                                         bool geometric) {
  const Comparison& facts = page.facts();
  std::vector<std::vector<double>> all(facts.contenders.size());
  for (const std::string& scene : page.scenes()) {
    std::vector<double> here;
    for (const Contender& c : facts.contenders)
      if (const auto v = value_at(c, scene, facts.sweeps, value); v && (!geometric || *v > 0))
        here.push_back(*v);
    // A scene without stretch to speak of (free fall) would decide the mean by its rounding.
    if (value == "stretch.rms") {
      if (std::ranges::all_of(here, [](double v) { return v < kNoStretch; })) continue;
      for (double& v : here) v = std::max(v, kNoStretch);
    }
    if (here.size() == all.size())
      for (std::size_t i = 0; i < here.size(); ++i) all[i].push_back(here[i]);
  }
  std::vector<std::optional<double>> out;
  for (const auto& values : all) {
    double sum = 0, largest = 0;
    for (const double v : values)
      sum += geometric ? std::log(v) : 0, largest = std::max(largest, v);
    if (values.empty())
      out.emplace_back();
    else
      out.emplace_back(geometric ? std::exp(sum / static_cast<double>(values.size())) : largest);
  }
  return out;
}

/// Up to which time step all went well. What never failed has no limit, and so no winner.
Tile sound_step(const Page& page) {
  const SoundSteps steps = sound_steps(page.facts(), page.scenes());
  Tile tile{"Longest sound step",
            "at " + std::to_string(page.facts().sweeps) + " sweeps, ",
            quantity("dt"),
            {steps.dt.begin(), steps.dt.end()},
            false,
            "longer",
            "shorter"};
  std::string scenes;
  for (const std::string& scene : steps.scenes) scenes += (scenes.empty() ? "" : ", ") + scene;
  tile.caption += steps.scenes.size() > 1 ? "geometric mean of " + scenes : scenes;
  if (steps.no_limit) tile.judged = "<p class=\"even\">no step that was tried failed</p>";
  return tile;
}

bool any(const std::vector<std::optional<double>>& values) {
  return std::ranges::any_of(values, [](const auto& v) { return v.has_value(); });
}

std::string render(Page& page, const std::string&) {
  const Comparison& facts = page.facts();
  const std::string at = "at " + std::to_string(facts.sweeps) + " sweeps";
  std::vector<Tile> tiles{{"Residual stretch", "RMS, last second, geometric mean of scenes, " + at,
                           quantity("stretch.rms"), means(page, "stretch.rms", true), true, "more",
                           "less"}};
  auto cpu = means(page, kCpuValue, true);
  if (const auto priced = cost(facts))
    tiles.push_back(*priced);
  else if (any(cpu))
    tiles.push_back({"Cost",
                     "CPU per step, one thread, " + at,
                     {"", "", "ms", 1e3},
                     cpu,
                     true,
                     "more",
                     "less"});
  else
    tiles.push_back({"Work", "constraint projections per step, " + at, quantity("projections"),
                     means(page, "projections", true), true, "more", "less"});
  tiles.push_back(sound_step(page));
  tiles.push_back({"Penetration", "deepest vertex of any scene, last second, " + at,
                   quantity("penetration.max"), means(page, "penetration.max", false), true, "more",
                   "less"});
  std::string out;
  for (const Tile& tile : tiles)
    if (any(tile.values)) out += draw(facts, tile);
  return out.empty() ? ""
                     : "<section id=\"tiles\" class=\"tiles\" aria-label=\"In four numbers\">"
                       "<h2 class=\"sr\">In four numbers</h2>" +
                           out + "</section>\n";
}

}  // namespace
}  // namespace taut::report::section::tiles

TAUT_SECTION(tiles) = {
    .name = "tiles", .order = 20, .render = taut::report::section::tiles::render};
