#include <algorithm>

#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::fairness {

namespace {

/// The case by which a contender introduces itself: the hero scene at the quoted sweeps.
const Record* example(const Page& page, const Contender& contender) {
  const Record* best = nullptr;
  for (const Record& r : contender.records) {
    const auto rank = [&](const Record& x) {
      return (x.scene == page.hero() ? 2 : 0) +
             (value_of(x, "iterations") == page.facts().sweeps ? 1 : 0);
    };
    if (best == nullptr || rank(r) > rank(*best)) best = &r;
  }
  return best;
}

std::string passes(const Record& record) {
  std::string out;
  for (const PassCost& pass : record.step_cost)
    out += (out.empty() ? "" : ", ") + pass.pass +
           (pass.repeats > 1 ? " × " + std::to_string(pass.repeats) : "");
  return out;
}

std::string panel(const std::vector<const Record*>& examples, const Comparison& facts) {
  std::vector<std::string> names;
  for (const Record* r : examples)
    for (const auto& [name, value] : r->resolved_settings)
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  std::string out =
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Effective "
      "settings\"><table class=\"panel\"><caption class=\"sr\">What each solver makes of "
      "the same scene</caption><thead><tr><th scope=\"col\">setting</th>";
  for (const Contender& c : facts.contenders)
    out += "<th scope=\"col\">" + solver_dot(c.solver) + solver_name(c) + "</th>";
  out += "</tr></thead><tbody>";
  const auto row = [&](const std::string& name, const std::vector<std::string>& cells) {
    // A dash says that the solver has no such setting, not that it differs; what follows the same
    // beginning is a remark.
    const std::string& first = cells.front();
    const bool same = std::ranges::all_of(cells, [&](const std::string& c) {
      return c == "–" || first == "–" || c.starts_with(first) || first.starts_with(c);
    });
    out += std::string("<tr") + (same ? "" : " class=\"differs\"") + "><th scope=\"row\">" +
           escape_html(name) + (same ? "" : "<span class=\"sr\"> (differs)</span>") + "</th>";
    for (const std::string& cell : cells) out += "<td>" + escape_html(typeset(cell)) + "</td>";
    out += "</tr>\n";
  };
  for (const std::string& name : names) {
    std::vector<std::string> cells;
    for (const Record* r : examples) {
      const auto at =
          std::ranges::find(r->resolved_settings, name, [](const auto& e) { return e.first; });
      cells.push_back(at == r->resolved_settings.end() ? "–" : at->second);
    }
    row(name, cells);
  }
  std::vector<std::string> orders, work;
  for (const Record* r : examples) {
    orders.push_back(passes(*r));
    work.push_back(std::to_string(r->projections));
  }
  row("passes of a step, in order", orders);
  row("work unit: constraint projections per step", work);
  return out + "</tbody></table></div>";
}

/// What each solver refuses rather than misreads; failing to refuse would be a silent
/// approximation.
std::string refusals(const Page& page) {
  std::string out;
  for (const Contender& c : page.facts().contenders) {
    const auto& all = page.input().solvers;
    const auto solver = std::ranges::find(all, c.solver, &SolverInfo::name);
    if (solver == all.end()) continue;
    out += "<li>" + solver_name(c.solver, solver_title(c.solver)) + " ";
    if (solver->unsupported.empty()) out += "can run every shipped scene.";
    for (const auto& [reason, scenes] : solver->unsupported)
      out += (&reason == &solver->unsupported.front().first ? "cannot run " : "; ") +
             listed(scenes) + " (" + escape_html(reason) + ")";
    out += "</li>\n";
  }
  return out.empty()
             ? ""
             : "<h3 class=\"inner\">What each cannot do</h3><ul class=\"links\">" + out + "</ul>";
}

std::string render(Page& page, const std::string&) {
  std::vector<const Record*> examples;
  for (const Contender& c : page.facts().contenders) examples.push_back(example(page, c));
  return "<section id=\"fairness\"><h2>Fairness</h2><p class=\"lead\">What each solver makes of "
         "the "
         "same case (" +
         escape_html(page.hero()) + ", " + std::to_string(page.facts().sweeps) +
         " sweeps), after mapping. Marked rows differ: differences in the results may come from "
         "them. " +
         std::string(equal_substeps(page.facts())
                         ? "Equal sweeps are equal numbers of projections, not equal time."
                         : "Substeps differ: equal sweeps are not equal work here.") +
         " What none of this shows is said <a href=\"#limits\">at the end</a>.</p><div "
         "class=\"card\">" +
         panel(examples, page.facts()) + refusals(page) + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::fairness

TAUT_SECTION(fairness) = {
    .name = "fairness", .order = 30, .render = taut::report::section::fairness::render};
