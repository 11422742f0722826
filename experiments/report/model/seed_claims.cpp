#include "experiments/truths/seed_claims.hpp"

#include "experiments/report/chart/format.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

Json json_of_seed_claims() {
  Json all = Json::array();
  for (const SeedClaim& claim : seed_claims())
    all.push_back({{"section", claim.section},
                   {"claim", typeset(claim.claim)},
                   {"verdict", to_string(claim.verdict)},
                   {"because", typeset(claim.because)}});
  return all;
}

}  // namespace taut::report
