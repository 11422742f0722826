#include "experiments/report/chart/format.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/truths/vasilovici/claims.hpp"

namespace taut::report {

Json json_of_seed_claims(const std::optional<Truths>& truths) {
  Json all = Json::array();
  for (const VasiloviciClaim& claim : vasilovici_claims()) {
    Json one{{"section", claim.section},
             {"claim", typeset(claim.claim)},
             {"verdict", to_string(claim.verdict)},
             {"because", typeset(claim.because)}};
    if (truths)
      if (const auto now = truths->claims.find(std::string(claim.claim));
          now != truths->claims.end()) {
        one["verdict"] = now->second.first;
        add_if(one, "figure", typeset(now->second.second));
      }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace taut::report
