#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/model/adjacency.hpp"
#include "core/model/index.hpp"
#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/layout/vertex_groups.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/spring.hpp"

namespace taut {

/// Stiffness parameters of spring solvers, one for each family.
inline constexpr std::array kStiffness{
    ParamSpec::real("structural", "N/m", "10000", 0, 1e12,
                    "spring constant of structural links; 0: no spring")
        .stiffness_of(Family::structural),
    ParamSpec::real("shear", "N/m", "10000", 0, 1e12,
                    "spring constant of shear links; 0: no spring")
        .stiffness_of(Family::shear),
    ParamSpec::real("bend", "N/m", "100", 0, 1e12, "spring constant of bend links; 0: no spring")
        .stiffness_of(Family::bend)};

/// Stiffnesses that a search may try, for solvers that need more iterations the stiffer the
/// springs.
inline constexpr AccuracyParameters::Ladder kStiffnesses{
    {"structural", "shear"}, {"1000", "3000", "10000", "30000", "1e+05"}};

/// Spring constants [N/m] by family: the scene's, infinite where it leaves links rigid, or else the
/// solver's parameters.
inline std::array<double, kFamilies.size()> stiffnesses(const Scene& scene, const Params& params) {
  if (takes_stiffness(scene, params)) return scene.stiffness;
  std::array<double, kFamilies.size()> all{};
  for (const Family family : kFamilies)
    all[static_cast<std::size_t>(family)] = params.real(to_string(family));
  return all;
}

/// The links of the scene that have a stiffness and an end that moves, in the scene's order.
/// w: inverse masses [1/kg]; stiffness [N/m] by family.
inline std::vector<Spring> make_springs(const Scene& scene, std::span<const double> w,
                                        const std::array<double, kFamilies.size()>& stiffness) {
  std::vector<Spring> springs;
  for (const Link& l : scene.links)
    if (const double k = stiffness[static_cast<std::size_t>(l.family)]; k > 0 && moves(l, w))
      springs.push_back({to_index(l.a), to_index(l.b), l.rest, k});
  return springs;
}

/// The other ends of the springs at each vertex.
inline Adjacency ends_of(const std::vector<Spring>& springs, std::size_t vertices) {
  std::vector<Link> links;
  for (const Spring& s : springs)
    links.push_back({static_cast<int>(s.a), static_cast<int>(s.b), s.rest, Family::structural});
  return Adjacency(links, static_cast<int>(vertices));
}

/// Slots of the springs with rest length and stiffness filled in; set(slot, lane, spring) does the
/// rest.
template <class Slot, class Set>
std::vector<Slot> slots_of_springs(const VertexGroups& groups, const Adjacency& ends,
                                   const std::vector<Spring>& springs, const Set& set) {
  return groups.make_slots<Slot>(ends, [&](Slot& slot, std::size_t lane, std::size_t spring) {
    using Real = std::remove_reference_t<decltype(slot.rest[0])>;
    slot.rest[lane] = static_cast<Real>(springs[spring].rest);
    slot.stiffness[lane] = static_cast<Real>(springs[spring].stiffness);
    set(slot, lane, spring);
  });
}
inline constexpr auto kNothingElse = [](const auto&...) {};

/// Reasons why a solver that takes every K as a number cannot run the scene
/// (SolverEntry::unsupported): what the loop would get wrong, and links that are rigid in the scene
/// where others have a stiffness.
inline std::vector<std::string> unsupported_of_springs(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  const auto k = stiffnesses(scene, params);
  for (const Family family : kFamilies)
    if (std::isinf(k[static_cast<std::size_t>(family)]) &&
        std::ranges::any_of(scene.links, [&](const Link& l) { return l.family == family; }))
      reasons.push_back(std::string(to_string(family)) +
                        " links are rigid: springs need their stiffness in [links] stiffness");
  return reasons;
}

/// The line about springs in the resolved settings.
inline ResolvedSetting describe_springs(const Scene& scene, const Params& params) {
  const auto k = stiffnesses(scene, params);
  const auto of_family = [&](Family family) {
    const double one = k[static_cast<std::size_t>(family)];
    return std::string(to_string(family)) + " " +
           (std::isinf(one) ? "rigid" : shortest(one) + " N/m");
  };
  const double structural = k[static_cast<std::size_t>(Family::structural)];
  return {kLinksSetting, "Hooke springs: " + join(kFamilies, ", ", of_family), "",
          std::isinf(structural) ? std::nan("") : structural};
}

}  // namespace taut
