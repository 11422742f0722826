#include "experiments/report/questions/winners.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/questions/costs.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/report/questions/questions.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/cheapest.hpp"

namespace taut::report {

namespace {

/// The solver with which most readers compare.
constexpr const char* kBullet = "bullet";
/// The solver of this project, whose losses are listed.
constexpr const char* kOwn = "jakobsen";

/// "1000 N/m", of links that are not rigid.
std::string links_text(const Record& r) {
  const ResolvedSetting* links = find_setting(r.resolved_settings, kLinksSetting);
  return links && std::isfinite(links->number) ? shortest(links->number) + " N/m" : "";
}

/// The winners of one scene.
class SceneWinners {
 public:
  SceneWinners(const SceneBench& bench, const std::string& metric, const ReportInput& input,
               CaseList& list)
      : scene_(bench, metric), input_(input), list_(list) {}

  WinnerRow row() {
    const SceneBench& bench = scene_.bench;
    WinnerRow row{bench.cases.empty() ? bench.scene : bench.cases.front().record.scene,
                  bench.scene};
    for (const BenchedCase& c : bench.cases) row.by = std::max(row.by, judged_by(c.record));
    for (const double level : levels_of(scene_.metric)) row.cells.push_back(cell(level));
    for (const BenchedCase& c : bench.cases) {
      if (c.record.solver != kBullet) continue;
      row.has_bullet = true;
      if (c.record.status.kind == Status::Kind::unsupported)
        row.bullet_refused = describe(c.record.status);
    }
    return row;
  }

 private:
  /// The contender of a case. Its setting leaves out precision and stiffness, which have fields of
  /// their own.
  Contender contender(std::size_t at) {
    const Record& r = scene_.bench.cases[at].record;
    const std::string links = links_text(r);
    std::vector<std::string> beside{parameter_of(r.solver, ParamSpec::Role::precision)};
    if (!links.empty())
      for (const std::string& name : stiffness_parameters(r.solver)) beside.push_back(name);
    return {r.solver,
            setting_label(scene_.bench, at, beside),
            arithmetic_of(r, input_.vectors),
            links,
            scene_.candidates[at].cost,
            scene_.candidates[at].error,
            error_of(r, kVerdict),
            r.value(std::string(kStretch)),
            r.value("stretch.max"),
            list_.key(r),
            {r.spec.scene, r.spec.settings, parse_solver(r.spec.solver).brief()},
            scene_.is_upper_bound(at)};
  }

  WinnerCell cell(double level) {
    WinnerCell cell;
    const std::vector<std::size_t> best = scene_.best_of_each({.error = level});
    if (best.empty()) {
      cell.why = scene_.why_not({.error = level}).note;
      return cell;
    }
    const Cheapest found = scene_.cheapest(best);
    pass_over(cell, level, scene_.candidates[found.at].cost.mid);
    cell.cheapest.push_back(contender(found.at));
    for (const Rival& rival : found.rivals)
      if (!rival.is_dearer()) {
        cell.cheapest.push_back(contender(rival.at));
      } else if (!cell.next) {
        cell.next = contender(rival.at);
        cell.times = *rival.times;
      }
    const auto beside = [&](const char* solver) -> std::optional<WinnerCell::Beside> {
      const auto at = scene_.best({.error = level}, solver);
      if (!at) return {};
      return {{contender(*at),
               found.at == *at ? Interval{1, 1, 1} : scene_.bench.ratio(*at, found.at)}};
    };
    cell.bullet = beside(kBullet);
    cell.own = beside(kOwn);
    return cell;
  }

  /// Adds the solvers that reach the error at less cost with a setting that does not count, and
  /// with none that does.
  void pass_over(WinnerCell& cell, double level, double cost) const {
    for (const std::string& solver : solvers_of(scene_.bench)) {
      if (scene_.best({.error = level}, solver)) continue;
      for (const Candidate& one : scene_.candidates)
        if (one.solver == solver && one.is_uncounted() && one.error <= level &&
            one.cost.mid < cost) {
          cell.excluded.emplace_back(solver, one.failure);
          break;
        }
    }
  }

  JudgedScene scene_;
  const ReportInput& input_;
  CaseList& list_;
};

/// The cells that a solver wins.
struct Wins {
  std::string solver;
  std::vector<const WinnerCell*> cells;

  /// The cells with the least and the largest lead over the next solver.
  std::vector<const WinnerCell*> ends() const {
    std::vector<const WinnerCell*> opposed = cells;
    std::erase_if(opposed, [](const WinnerCell* cell) { return !cell->next; });
    std::ranges::sort(opposed, {}, [](const WinnerCell* cell) { return cell->times.mid; });
    if (opposed.size() > 1) opposed = {opposed.front(), opposed.back()};
    return opposed;
  }
};

/// "is cheapest in 3 of 20 cells, by 1.2 to 4 times"
void add_wins(std::vector<Said>& sentence, const Wins& wins, const std::string& of) {
  sentence.push_back({solver_title(wins.solver) + " is cheapest in "});
  sentence.push_back({std::to_string(wins.cells.size()), wins.cells.front()->cheapest[0].key});
  if (!of.empty()) {
    sentence.push_back({" of "});
    sentence.push_back({of, "", true});
    sentence.push_back({of == "1" ? " cell" : " cells"});
  }
  const auto ends = wins.ends();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    sentence.push_back({i == 0 ? ", by " : " to "});
    sentence.push_back({significant(ends[i]->times.mid), ends[i]->cheapest[0].key});
  }
  if (!ends.empty()) sentence.push_back({" times"});
}

/// "btSoftBody costs 12 times as much as the cheapest solver for 5 % on push; it reaches no error
/// of the map with the settings timed on rail; it cannot run drape-swing." Empty if it was timed
/// nowhere.
std::vector<Said> bullet_sentence(const WinnerMap& map) {
  std::vector<Said> sentence;
  std::vector<std::string> missed, refused;
  for (const WinnerRow& row : map.rows) {
    if (!row.has_bullet) continue;
    std::size_t at = row.cells.size();  // the least error that it reaches
    while (at > 0 && !row.cells[at - 1].bullet) --at;
    if (at == 0) {
      if (row.by == JudgedBy::nothing && row.bullet_refused.empty()) continue;
      (row.bullet_refused.empty() ? missed : refused).push_back(row.title);
      continue;
    }
    const WinnerCell& cell = row.cells[at - 1];
    sentence.push_back({sentence.empty() ? "btSoftBody costs " : ", "});
    const std::string times =
        cell.bullet->times ? significant(cell.bullet->times->mid) + " times" : "more than";
    sentence.push_back({times + " the cheapest for " +
                            quantity(kVerdict).text(kErrorLevels[at - 1], 1) + " on " + row.title,
                        cell.bullet->one.key});
  }
  const auto add = [&](const std::vector<std::string>& scenes, const std::string& what) {
    if (scenes.empty()) return;
    sentence.push_back(
        {(sentence.empty() ? "btSoftBody " : "; it ") + what + join(scenes, ", "), "", true});
  };
  add(missed, "reaches no error of the map with the settings timed on ");
  add(refused, "cannot run ");
  if (!sentence.empty()) sentence.push_back({"."});
  return sentence;
}

}  // namespace

WinnerMap winners_of(const ReportInput& input, CaseList& list, const std::string& metric) {
  WinnerMap map{metric, {}, {}};
  if (!input.bench) return map;
  list.use(metric);
  for (const SceneBench& scene : input.bench->scenes) {
    map.rows.push_back(SceneWinners(scene, metric, input, list).row());
    for (const std::string& solver : solvers_of(scene)) push_unique(map.solvers, solver);
    map.noise = std::max(map.noise, spread(scene.control));
  }
  return map;
}

std::vector<std::vector<Said>> sentences_of(const WinnerMap& map) {
  std::vector<Wins> wins;
  std::vector<const WinnerCell*> alike, empty;
  std::size_t all = 0;
  for (const WinnerRow& row : map.rows)
    for (const WinnerCell& cell : row.cells) {
      ++all;
      if (cell.cheapest.empty())
        empty.push_back(&cell);
      else if (cell.cheapest.size() > 1)
        alike.push_back(&cell);
      else if (const auto at = std::ranges::find(wins, cell.cheapest[0].solver, &Wins::solver);
               at != wins.end())
        at->cells.push_back(&cell);
      else
        wins.push_back({cell.cheapest[0].solver, {&cell}});
    }
  if (all == 0) return {};
  std::ranges::stable_sort(wins, std::greater{}, [](const Wins& one) { return one.cells.size(); });
  std::vector<Said> first, second;
  if (wins.empty()) {
    first = {{"No solver can be told to be cheapest in any of "}, {std::to_string(all), "", true}};
    first.push_back({all == 1 ? " cell." : " cells."});
  } else {
    add_wins(first, wins[0], std::to_string(all));
    first.push_back({"."});
  }
  const auto separate = [&] {
    if (!second.empty()) second.push_back({"; "});
  };
  for (std::size_t i = 1; i < wins.size(); ++i) {
    separate();
    add_wins(second, wins[i], "");
  }
  if (!alike.empty()) {
    separate();
    second.push_back({std::to_string(alike.size()), alike[0]->cheapest[0].key});
    second.push_back({alike.size() == 1 ? " cell has several that noise cannot tell apart"
                                        : " cells have several that noise cannot tell apart"});
  }
  if (!empty.empty()) {
    separate();
    second.push_back({std::to_string(empty.size()), "", true});
    second.push_back(
        {empty.size() == 1 ? " cell is reached by nobody" : " cells are reached by nobody"});
  }
  std::vector<std::vector<Said>> sentences;
  if (const std::vector<Said> bullet = bullet_sentence(map); !bullet.empty())
    sentences.push_back(bullet);
  sentences.push_back(first);
  if (second.empty()) return sentences;
  second.push_back({"."});
  sentences.push_back(second);
  return sentences;
}

std::string text_of(const std::vector<Said>& sentence) {
  return join(sentence, "", [](const Said& one) { return one.text; });
}

std::string line_of(const WinnerRow& row, std::size_t level) {
  const WinnerCell& cell = row.cells.at(level);
  const std::string head =
      row.title + " at " + quantity(kVerdict).text(kErrorLevels[level], 1) + ": ";
  if (cell.cheapest.empty()) return head + "nobody, " + cell.why;
  const auto said = [](const Contender& one) {
    return solver_title(one.solver) + " " + one.setting.text() + ", " + one.arithmetic.text() +
           (one.links.empty() ? "" : ", springs of " + one.links) + ": " +
           (one.bound ? "at most " : "") + shown(kFrameCost, one.cost.mid);
  };
  std::string text = head + join(cell.cheapest, "; not to be told from it: ", said);
  if (cell.next)
    text += "; " + significant(cell.times.mid) + " (" + significant(cell.times.low) + " to " +
            significant(cell.times.high) + ") times cheaper than " +
            solver_title(cell.next->solver);
  return text;
}

std::string authors_text(const WinnerMap& map) {
  std::vector<std::string> own, theirs;
  for (const std::string& solver : map.solvers) {
    const SolverEntry& entry = *parse_solver(solver).entry;
    // what needs a program of its own is a library with two builds
    (entry.foreign() || entry.program ? theirs : own).push_back(solver_title(solver));
  }
  if (own.empty() || theirs.empty()) return "";
  return "taut\u2019s authors wrote " + joined(own) + "; " + joined(theirs) +
         (theirs.size() == 1 ? " is" : " are") + " the code of others.";
}

Table losses_of(const WinnerMap& map, const Answer& answer) {
  Table table{"losses",
              "Where " + solver_title(kOwn) + ", the solver of this project, loses",
              {Column("what", "question"), Column("where"), Column("own", solver_title(kOwn)),
               Column("other", "better")},
              {},
              "every cell of the map that another solver wins, and every question below with a "
              "better number of another solver over the scenes that all have"};
  for (const WinnerRow& row : map.rows)
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const WinnerCell& cell = row.cells[k];
      if (cell.cheapest.empty() ||
          std::ranges::find(cell.cheapest, kOwn, &Contender::solver) != cell.cheapest.end())
        continue;
      Cell own = cell.own && cell.own->times
                     ? Cell(significant(cell.own->times->mid) + " times as dear")
                     : Cell("does not reach it");
      if (cell.own) own.key = cell.own->one.key;
      Cell best(solver_title(cell.cheapest[0].solver) + " " + cell.cheapest[0].setting.text());
      best.key = cell.cheapest[0].key;
      table.rows.push_back({"CPU time of " + quantity(kVerdict).text(kErrorLevels[k], 1),
                            Cell(row.title).of_scene(row.scene), std::move(own), std::move(best)});
    }
  for (const Table& asked : answer.tables) {
    const auto at = std::ranges::find(asked.columns, kOwn, &Column::name);
    const ValueSpec* value = find_value(asked.name).second;
    if (asked.rows.empty() || at == asked.columns.end() || asked.name == kPrice ||
        (value && value->role == Role::motion))
      continue;
    const std::vector<Cell>& last = asked.rows.back();
    const auto own = static_cast<std::size_t>(at - asked.columns.begin());
    if (std::isnan(last[own].number())) continue;
    const bool more_is_better = asked.name == kLargestStep;
    std::size_t best = own;
    for (std::size_t c = 1; c < last.size(); ++c)
      if (more_is_better ? last[c].number() > last[best].number()
                         : last[c].number() < last[best].number())
        best = c;
    if (std::abs(last[own].number() - last[best].number()) <=
        kTolerance * std::abs(last[own].number()))
      continue;
    const auto text = [&](std::size_t c) { return taut::text(last[c], asked.columns[c]); };
    table.rows.push_back({asked.title, last[0], text(own),
                          solver_title(asked.columns[best].name) + " " + text(best)});
  }
  return table;
}

std::vector<std::string> rules_of(const WinnerMap& map) {
  const auto titles = [&](JudgedBy by) {
    std::vector<std::string> all;
    for (const WinnerRow& row : map.rows)
      if (row.by == by) all.push_back(row.title);
    return join(all, ", ");
  };
  std::vector<std::string> all{
      "The error is how far the cloth is from where it should be: its distance from the converged "
      "motion at 32 moments, RMS, relative to that of a cloth that stands still, which is "
      "100\u00A0% whatever the scene. The RMS stretch beyond the reference\u2019s must be within "
      "the error, too.",
      "Each cell names the cheapest solver, how many times cheaper it is than the next one, the "
      "CPU time of a frame of 1/" +
          number_text(1 / kFrame) +
          "\u00A0s, the setting, the arithmetic, and the stiffness of links that are not rigid.",
      "A setting does not count if it fails, passes through a body or sinks into it by more than " +
          shown(kShare, kMostDepth, 1) +
          " of the cloth\u2019s diagonal, or where no reference is known. An error counts as at "
          "least three times the reference\u2019s own."};
  if (const std::string by = titles(JudgedBy::observables); !by.empty())
    all.push_back(
        "On " + by +
        " motion is too chaotic for a reference: the error is that of the centre of mass and the "
        "second moment over the fall, or of the share in contact, whichever is largest, beside the "
        "mean of perturbed references.");
  if (const std::string unjudged = titles(JudgedBy::nothing); !unjudged.empty())
    all.push_back("On " + unjudged + " motion is not judged, so nobody wins there.");
  all.emplace_back(
      "All settings that were timed compete, accelerators included; a solver is absent if no timed "
      "setting reaches the error.");
  return all;
}

std::string certainty_text(double noise) {
  return "Cheaper means, in every table: the 95\u00A0% interval of the ratio of two costs, sampled "
         "in turns, leaves out 1, and the ratio is beyond " +
         shown(kShare, kTolerance, 1) +
         " and beyond what two runs of identical code differed by on the same scene, at most " +
         shown(kShare, noise) + ".";
}

std::vector<std::pair<std::string, std::string>> terms_of(const std::vector<const Record*>& records,
                                                          const std::string& vectors) {
  std::map<std::string, std::string> orders, arithmetics, parameters;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> seen;
  bool works = false;
  for (const Record* r : records) {
    const Work work = work_of(*r);
    works = works || (work.substeps > 0 && work.sweeps > 0);
    const Arithmetic own = arithmetic_of(*r, vectors);
    arithmetics[own.brief()] = own.meaning();
    if (const ResolvedSetting* order = find_setting(r->resolved_settings, kLinkOrder))
      orders[order->compared()] = order->text;
    // labels name the order itself, a term of its own
    const std::string beside = link_order(*r).empty() ? "" : link_order_parameter(r->solver);
    for (const std::string& name : labelled_parameters(r->solver))
      if (const auto at = r->params.find(name); at != r->params.end() && name != beside)
        seen[{r->solver, name}].insert(at->second);
  }
  for (const auto& [parameter, values] : seen) {
    const auto& [solver, name] = parameter;
    if (values.size() > 1)
      parameters[parameter_term(solver, name)] = parameter_meaning(solver, name);
  }
  std::vector<std::pair<std::string, std::string>> terms;
  if (works)
    terms.emplace_back(kWorkTerm,
                       "each time step is cut into 2 substeps of 8 sweeps; of a solver that solves "
                       "all links at once, of 8 iterations");
  terms.insert(terms.end(), arithmetics.begin(), arithmetics.end());
  for (const auto& [order, text] : orders)
    if (!order.empty()) terms.emplace_back(order, "order in which links are visited: " + text);
  terms.insert(terms.end(), parameters.begin(), parameters.end());
  return terms;
}

}  // namespace taut::report
