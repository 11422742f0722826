#include <algorithm>
#include <cmath>

#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

std::string case_name(const Record& r) {
  return r.scene + ", " + solver_title(r.solver) + " " + brief_settings(r.spec.solver);
}

Claim claim_statuses(const Differences& differences) {
  Evidence evidence("steps", "statuses of cases of the same scene, solver and settings");
  std::map<std::string, int> changed;
  std::size_t alike = 0;
  for (const auto& [a, b] : differences.pairs) {
    evidence.look("A", a), evidence.look("B", b);
    if (a.status.kind == b.status.kind)
      ++alike;
    else
      ++changed[std::string(to_string(a.status.kind)) + " in A and " +
                std::string(to_string(b.status.kind)) + " in B"];
  }
  std::vector<std::string> others;
  for (const auto& [how, n] : changed) others.push_back(std::to_string(n) + " " + how);
  std::string text = "Of " + std::to_string(differences.pairs.size()) + " cases that both have, " +
                     std::to_string(alike) + " end alike";
  if (!others.empty()) text += "; otherwise: " + joined(others);
  text += ".";
  if (differences.only_a + differences.only_b > 0)
    text += " A alone has " + std::to_string(differences.only_a) + " cases, B alone " +
            std::to_string(differences.only_b) + ".";
  return {"differences-statuses", ClaimKind::headline, "differences", text,
          Certainty::single_run,  {evidence}};
}

std::optional<Claim> claim_values(const Differences& differences, const std::string& metric) {
  const Quantity q = quantity(metric);
  Evidence evidence(metric, "values of cases of the same scene, solver and settings");
  int compared = 0, less = 0, more = 0;
  double largest = 0;
  std::string where;
  for (const auto& [one, other] : differences.pairs) {
    const auto a = evidence.look("A", one), b = evidence.look("B", other);
    if (!a || !b) continue;
    ++compared, less += *b<*a, more += *b> * a;
    const double change = std::abs(*b - *a) / std::max({std::abs(*a), std::abs(*b), 1e-300});
    if (change <= largest) continue;
    largest = change;
    where = case_name(other) + ": " + q.text(*a, 3) + " in A, " + q.text(*b, 3) + " in B";
  }
  if (compared == 0) return {};
  std::string text = capitalised(q.title) + ", " + std::to_string(compared) +
                     (compared == 1 ? " case" : " cases") + " that completed in both: ";
  text += less + more == 0
              ? "the same to the bit."
              : "less in B in " + std::to_string(less) + ", more in " + std::to_string(more) +
                    "; the largest change is that of " + where + ".";
  return Claim{"differences-" + slug(metric), ClaimKind::headline, "differences", text,
               Certainty::single_run,         {evidence}};
}

/// What B costs over A; each was timed in a session of its own, so nothing is clear.
Claim claim_cost(const Differences& differences, const std::string& solver) {
  Evidence evidence("cpu.per_second",
                    "geometric mean of B over A of cases of the same scene, solver and settings");
  std::vector<double> ratios;
  for (const auto& [a, b] : differences.timed) {
    if (a.record.solver != solver) continue;
    const Interval cost_a = a.cost(), cost_b = b.cost();
    evidence.look(a, cost_a, "A"), evidence.look(b, cost_b, "B");
    if (a.stable() && b.stable()) ratios.push_back(cost_b.mid / cost_a.mid);
  }
  const double mean = ratios.empty() ? 1 : geometric_mean(ratios), noise = differences.noise;
  const Certainty judged = judge({mean, mean, mean}, {1 / (1 + noise), 1, 1 + noise});
  std::string text = "CPU time of " + solver_title(solver) + ", " + std::to_string(ratios.size()) +
                     (ratios.size() == 1 ? " case" : " cases") + " in sessions of their own: ";
  if (ratios.empty())
    text += "none completed in both";
  else if (!is_difference(judged))
    text += undecided(judged) + " (B over A " + fixed(mean, 2) + ")";
  else
    text += (mean < 1 ? "B uses " : "A uses ") + share_text(mean < 1 ? mean : 1 / mean) +
            " of the CPU time of " + (mean < 1 ? "A" : "B");
  text += "; identical code differed by up to " + shown(kShare, noise) + ".";
  const Certainty sure =
      ratios.empty() ? Certainty::single_run : std::max(judged, Certainty::likely);
  return {"differences-cost-" + solver, ClaimKind::headline, "differences", text, sure, {evidence}};
}

}  // namespace

std::vector<Claim> difference_claims(const ReportInput& input) {
  std::vector<Claim> claims;
  if (!input.differences || input.differences->pairs.empty()) return claims;
  const Differences& differences = *input.differences;
  claims.push_back(claim_statuses(differences));
  for (const ValueSpec* value : values_with_role())
    if (const auto claim = claim_values(differences, std::string(value->name)))
      claims.push_back(*claim);
  std::vector<std::string> solvers;
  for (const auto& [a, b] : differences.timed) push_unique(solvers, a.record.solver);
  for (const std::string& solver : solvers) claims.push_back(claim_cost(differences, solver));
  return claims;
}

}  // namespace taut::report
