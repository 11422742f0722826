#include "experiments/truths/suite.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/truths/verify.hpp"

namespace taut {

namespace {

/// Words of a verdict on an engine: what it lacks is no failure.
Cell word_of(TruthVerdict verdict) {
  if (verdict == TruthVerdict::broken) return Cell("failed").toned(Cell::Tone::bad);
  if (verdict == TruthVerdict::not_applicable) return Cell("not claimed");
  return cell_of(verdict);
}

/// The number of a phenomenon that says most: the one that fails, or is nearest to its tolerance.
const Finding* telling(const Conformance& of, std::string_view phenomenon) {
  const Finding* most = nullptr;
  const TruthVerdict verdict = of.verdict(phenomenon);
  for (const Conformance::Number& n : of.numbers) {
    const Finding& f = n.finding;
    if (n.phenomenon != phenomenon || f.verdict != verdict) continue;
    const double share = share_of_tolerance(f);
    if (!most || std::isnan(share) || share > share_of_tolerance(*most)) most = &f;
  }
  return most;
}

std::string text_of(const Finding& f) {
  if (f.verdict == TruthVerdict::not_applicable) return f.why;
  const std::string unit = f.unit == "1" ? "" : " " + f.unit;
  std::string text = f.quantity + ": " + number_text(f.measured, 4) + unit;
  if (f.expected == 0)
    text += " (at most " + number_text(f.tolerance, 3) + unit + ")";
  else
    text += " (" + number_text(f.expected, 4) + " +- " + number_text(f.tolerance, 2) + unit + ")";
  return f.why.empty() ? text : text + "; " + f.why;
}

std::size_t count(const Conformance& of, TruthVerdict verdict) {
  const std::vector<std::string> all = of.phenomena();
  return static_cast<std::size_t>(std::ranges::count(
      all, verdict, [&](const std::string& phenomenon) { return of.verdict(phenomenon); }));
}

/// A name for each engine, which tells versions of one engine apart.
std::vector<std::string> columns_of(const std::vector<Conformance>& all) {
  std::vector<std::string> names;
  for (const Conformance& one : all) {
    const bool alone = std::ranges::count(all, one.engine, &Conformance::engine) == 1;
    std::string name = alone ? one.engine : one.engine + " " + one.version;
    while (std::ranges::find(names, name) != names.end()) name += "'";
    names.push_back(name);
  }
  return names;
}

Table engines_table(const std::vector<Conformance>& all) {
  Table table{"engines",
              "",
              {{"engine"},
               {"version"},
               {"passed"},
               {"deviates", "deviates as explained"},
               {"failed"},
               {"not_claimed"},
               {"first_failed"},
               Column("solver").in_detail(),
               Column("suite").in_detail(),
               Column("machine").in_detail()}};
  for (const Conformance& one : all)
    table.rows.push_back({one.engine, one.version, count(one, TruthVerdict::passed),
                          count(one, TruthVerdict::deviates), count(one, TruthVerdict::broken),
                          count(one, TruthVerdict::not_applicable), one.first_failed(), one.solver,
                          one.suite, one.machine});
  return table;
}

/// A row for each phenomenon; engines side by side, or one with the number that says most.
Table phenomena_table(const std::vector<Conformance>& all) {
  Table table{"phenomena", "", {{"phenomenon"}, Column("needs").in_detail()}};
  const std::vector<std::string> names = columns_of(all);
  for (const std::string& name : names)
    table.columns.emplace_back(all.size() == 1 ? "verdict" : name);
  if (all.size() == 1) table.columns.emplace_back("nearest", "nearest to its tolerance");
  std::vector<std::pair<std::string, std::string>> rows;  // with what they need
  for (const Conformance& one : all)
    for (const Conformance::Number& n : one.numbers)
      if (std::ranges::find(rows, n.phenomenon, &decltype(rows)::value_type::first) == rows.end())
        rows.emplace_back(n.phenomenon, n.needs);
  for (const auto& [phenomenon, needs] : rows) {
    std::vector<Cell> row{phenomenon, needs};
    for (const Conformance& one : all) row.push_back(word_of(one.verdict(phenomenon)));
    if (all.size() == 1) {
      const Finding* const f = telling(all[0], phenomenon);
      row.push_back(f ? text_of(*f) : "");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table numbers_table(const std::vector<Conformance>& all) {
  Table table{"numbers",
              "every number",
              {{"engine"},
               {"version"},
               {"solver"},
               {"phenomenon"},
               {"test"},
               {"needs"},
               {"verdict"},
               {"quantity"},
               {"unit"},
               {"value", "", kNumber, 7},
               {"closed_form", "", kNumber, 7},
               {"ratio"},
               {"tolerance"},
               {"why"}}};
  for (const Conformance& one : all)
    for (const auto& [phenomenon, needs, test, f] : one.numbers)
      table.rows.push_back({one.engine, one.version, one.solver, phenomenon, test, needs,
                            cell_of(f.verdict), f.quantity, f.unit, f.measured, f.expected,
                            f.expected == 0 ? Cell() : Cell(f.measured / f.expected), f.tolerance,
                            f.why});
  table.detail = true;
  return table;
}

Table failed_table(const std::vector<Conformance>& all) {
  Table table{"broken", "failed", {{"engine"}, {"phenomenon"}, {"number"}}};
  for (const Conformance& one : all)
    for (const Conformance::Number& n : one.numbers)
      if (n.finding.verdict == TruthVerdict::broken)
        table.rows.push_back({one.engine, n.phenomenon, text_of(n.finding)});
  return table;
}

}  // namespace

TruthVerdict Conformance::verdict(std::string_view phenomenon) const {
  using enum TruthVerdict;
  TruthVerdict worst = not_applicable;
  for (const Number& n : numbers) {
    const TruthVerdict one = n.finding.verdict;
    if (n.phenomenon != phenomenon || one == not_applicable) continue;
    if (worst == not_applicable || one > worst) worst = one;
  }
  return worst;
}

std::string Conformance::first_failed() const {
  const auto at = std::ranges::find(numbers, TruthVerdict::broken,
                                    [](const Number& n) { return n.finding.verdict; });
  return at == numbers.end() ? "" : at->phenomenon;
}

std::vector<std::string> Conformance::phenomena() const {
  std::vector<std::string> all;
  for (const Number& n : numbers)
    if (all.empty() || all.back() != n.phenomenon) all.push_back(n.phenomenon);
  return all;
}

std::vector<const TruthEntry*> conformance_suite() {
  std::vector<const TruthEntry*> all = truths_in_order();
  std::erase_if(all, [](const TruthEntry* truth) { return truth->phenomenon.empty(); });
  return all;
}

Conformance conformance_of(const std::string& solver, const std::vector<CheckedTruth>& found,
                           const std::string& ours, const std::string& machine) {
  const SolverEntry& entry = *parse_solver(solver).entry;
  Conformance one{.engine = std::string(entry.name),
                  .version = entry.build.empty() ? ours : std::string(entry.build),
                  .solver = solver,
                  .machine = machine};
  const std::vector<const TruthEntry*> suite = conformance_suite();
  for (const CheckedTruth& truth : found)
    for (const TruthEntry* test : suite)
      if (test->name == truth.name)
        for (const Finding& f : truth.findings)
          one.numbers.push_back(
              {std::string(test->phenomenon), std::string(test->needs), truth.name, f});
  return one;
}

Answer answer_of(const std::vector<Conformance>& all) {
  Answer answer{"verify", "conformance suite " + std::to_string(kSuiteVersion)};
  answer.add(engines_table(all));
  answer.add(phenomena_table(all));
  answer.add(numbers_table(all));
  answer.add(failed_table(all));
  return answer;
}

std::vector<Conformance> conformances_in(const Answer& answer) {
  const Table& engines = answer.table("engines");
  const Table& numbers = answer.table("numbers");
  if (engines.rows.empty())
    throw InputError("it holds no result of the conformance suite: taut verify --suite --json");
  std::vector<Conformance> all;
  for (const std::vector<Cell>& row : engines.rows) {
    const auto text = [&](std::string_view column) { return engines.at(row, column).text(); };
    all.push_back({.engine = text("engine"),
                   .version = text("version"),
                   .solver = text("solver"),
                   .machine = text("machine"),
                   .suite = static_cast<int>(engines.at(row, "suite").number())});
  }
  for (const std::vector<Cell>& row : numbers.rows) {
    const auto text = [&](std::string_view column) { return numbers.at(row, column).text(); };
    const auto number = [&](std::string_view column) { return numbers.at(row, column).number(); };
    const auto of = std::ranges::find_if(all, [&](const Conformance& one) {
      return one.engine == text("engine") && one.version == text("version") &&
             one.solver == text("solver");
    });
    if (of == all.end()) throw InputError("a number belongs to no engine: " + text("engine"));
    Finding f;
    f.subject = text("solver");
    f.quantity = text("quantity");
    f.unit = text("unit");
    f.measured = number("value");
    f.expected = number("closed_form");
    f.tolerance = number("tolerance");
    f.verdict = verdict_of(text("verdict"));
    f.why = text("why");
    of->numbers.push_back({text("phenomenon"), text("needs"), text("test"), f});
  }
  return all;
}

}  // namespace taut
