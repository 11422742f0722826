#include "experiments/timing/candidate.hpp"

#include <cmath>
#include <utility>

namespace taut {

bool Target::meets(const Candidate& c) const {
  if (!c.failure.empty() || std::isnan(c.error)) return false;
  return error ? c.error <= *error : c.cost.mid <= *budget;
}

bool Target::prefers(const Candidate& a, const Candidate& b) const {
  if (meets(a) != meets(b)) return meets(a);
  const std::pair by_cost_a(a.cost.mid, a.error), by_cost_b(b.cost.mid, b.error);
  const std::pair by_error_a(a.error, a.cost.mid), by_error_b(b.error, b.cost.mid);
  return error ? by_cost_a < by_cost_b : by_error_a < by_error_b;
}

std::optional<std::size_t> best_for(const Target& target, std::span<const Candidate> candidates,
                                    const std::string& solver) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (target.meets(candidates[i]) && (solver.empty() || candidates[i].solver == solver) &&
        (!best || target.prefers(candidates[i], candidates[*best])))
      best = i;
  return best;
}

}  // namespace taut
