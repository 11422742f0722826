#include "core/solver/stick.hpp"

#include <algorithm>
#include <cmath>

#include "core/solver/distance.hpp"

namespace taut {

double softened(const Firmness& firm, Family family, double w) {
  const double stiffness = firm.stiffness[static_cast<std::size_t>(family)];
  if (std::isinf(stiffness) || firm.iterations == 0) return firm.omega;
  // 1 - c = 1 / (1 + K h^2 w); expm1 and log1p keep the digits of very soft links
  const double ratio = stiffness * firm.substep * firm.substep * w;
  return -firm.omega * std::expm1(-std::log1p(ratio) / firm.iterations);
}

template <class Real>
std::vector<Stick<Real>> make_sticks(std::span<const Link> links, std::span<const double> w,
                                     const Firmness& firm) {
  std::vector<Stick<Real>> sticks;
  sticks.reserve(links.size());
  for (const Link& link : links) {
    const double wa = w[static_cast<std::size_t>(link.a)], wb = w[static_cast<std::size_t>(link.b)];
    if (!moves(link, w)) continue;
    const double share = softened(firm, link.family, wa + wb);
    sticks.push_back({link.a, link.b, static_cast<Real>(std::max(link.rest, kTinyLength)),
                      static_cast<Real>(share * (wa / (wa + wb))),
                      static_cast<Real>(share * (wb / (wa + wb)))});
  }
  return sticks;
}

template std::vector<Stick<float>> make_sticks(std::span<const Link>, std::span<const double>,
                                               const Firmness&);
template std::vector<Stick<double>> make_sticks(std::span<const Link>, std::span<const double>,
                                                const Firmness&);

}  // namespace taut
