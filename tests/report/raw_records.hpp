#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"

// What readers of claims share: numbers and names out of sentences, and the raw records, asked
// without anything that claims are made with.
namespace taut::report::reading {

using Names = std::vector<std::string>;
using Scenes = std::multiset<std::string>;

inline std::string solver_of(std::string label) {
  for (char& c : label) c = static_cast<char>(std::tolower(c));
  return label;
}

inline std::string label_of(std::string solver) {
  if (solver == "xpbd") return "XPBD";
  solver[0] = static_cast<char>(std::toupper(solver[0]));
  return solver;
}

/// Every match of a pattern, as the texts of its groups ("" where a group took no part).
inline std::vector<Names> matches(const std::string& text, const std::string& pattern) {
  static std::map<std::string, std::regex> known;
  const std::regex& regex = known.try_emplace(pattern, pattern).first->second;
  std::vector<Names> all;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at)
    all.emplace_back(at->begin(), at->end());
  return all;
}

/// "ball, box and hang"
inline Names names_in(const std::string& list) {
  Names names;
  for (const Names& m : matches(list, "([a-z]+)(, | and |$)")) names.push_back(m[1]);
  return names;
}

constexpr const char* kNumber = "(10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|[0-9./]+(?:×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)";
inline std::string pattern(std::string text) {  // "#": a number
  for (std::size_t at; (at = text.find('#')) != std::string::npos;) text.replace(at, 1, kNumber);
  return text;
}

/// A number as the page writes it: "0.31", "1.2×10⁻⁵", "1/11".
inline double number_in(const std::string& text) {
  if (text.starts_with("1/")) return 1 / std::stod(text.substr(2));
  const auto ten = text.find("10⁻");
  if (ten == std::string::npos) return std::stod(text);
  const std::vector<std::string> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  int power = 0;
  for (std::string rest = text.substr(ten + std::string("10⁻").size());;) {
    const auto digit =
        std::ranges::find_if(raised, [&](const std::string& d) { return rest.starts_with(d); });
    if (digit == raised.end()) break;
    power = 10 * power + static_cast<int>(digit - raised.begin());
    rest = rest.substr(digit->size());
  }
  return (ten == 0 ? 1 : std::stod(text)) * std::pow(10, -power);
}

/// Two digits are printed.
inline bool near(double printed, double true_value) {
  return std::abs(printed - true_value) <= 0.06 * std::abs(true_value) + 1e-12;
}

/// What follows `opening` in a sentence, up to the full stop; "" if it is not said.
inline std::string said_after(const std::string& text, const std::string& opening) {
  const auto at = text.find(opening);
  if (at == std::string::npos) return "";
  const auto from = at + opening.size(), stop = text.find(". ", from);
  return text.substr(from, (stop == std::string::npos ? text.size() - 1 : stop) - from);
}

/// The records of a report, each once.
class Raw {
 public:
  explicit Raw(const ReportInput& input) {
    std::set<std::string> keys;
    for (const StudyResult& study : input.studies)
      for (const Record& r : study.records)
        if (keys.insert(r.key).second)
          all.push_back(&r), scenes.insert(r.scene), solvers.insert(r.solver);
  }
  std::vector<const Record*> all;
  std::set<std::string> scenes, solvers;

  static int number(const Record& r, const char* name) {
    return r.params.contains(name) ? std::stoi(r.params.at(name)) : -1;
  }
  static bool good(const Record& r) {
    return r.status.kind == Status::Kind::ok || r.status.kind == Status::Kind::unsettled;
  }
  static std::optional<double> value(const Record* r, const std::string& metric) {
    if (!r || !good(*r) || !r->values.contains(metric)) return {};
    const double v = r->values.at(metric);
    return std::isnan(v) ? std::nullopt : std::optional(v);
  }
  /// (substeps, sweeps) of a case; -1: the solver has none.
  static std::pair<int, int> work(const Record& r) {
    return {number(r, "substeps"), number(r, "iterations")};
  }
  using Works = std::map<std::string, std::pair<int, int>>;  // by solver

  /// Of the cases at these works the one whose time step most solvers ran, of equals the nearest to
  /// 1/64 s.
  const Record* quoted(const std::string& scene, const std::string& solver,
                       const Works& works) const {
    std::map<double, std::map<std::string, const Record*>> at;
    for (const Record* r : all) {
      if (r->scene == scene && works.contains(r->solver) && work(*r) == works.at(r->solver))
        at[r->dt].try_emplace(r->solver, r);
    }
    const auto rank = [](const auto& entry) {
      return std::pair(-static_cast<int>(entry.second.size()),
                       std::abs(std::log(entry.first * 64)));
    };
    const auto best = std::ranges::min_element(at, {}, rank);
    return best != at.end() && best->second.contains(solver) ? best->second.at(solver) : nullptr;
  }

  /// Whether some work was run by all solvers, which then have to be compared at it.
  bool any_work_in_common() const {
    std::map<std::pair<int, int>, std::set<std::string>> who;
    for (const Record* r : all) who[work(*r)].insert(r->solver);
    return std::ranges::any_of(who, [&](const auto& w) { return w.second == solvers; });
  }
};

}  // namespace taut::report::reading
