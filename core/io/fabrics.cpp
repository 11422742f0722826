#include "core/io/fabrics.hpp"

#include <algorithm>
#include <vector>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr std::string_view kPetrak = "Petrak et al., Sustainability 17, 1388 (2025), KES-F",
                           kBy = "CC BY 4.0";

// To add a fabric, read every number in the source itself, and check what its licence permits.
constexpr Fabric kFabrics[] = {
    {"petrak-m1", 0.135, 1950e-9, 610e-9, 0.223, kPetrak, kBy},
    {"petrak-m2", 0.084, 850e-9, 330e-9, 0.228, kPetrak, kBy},
    {"petrak-m3", 0.179, 2140e-9, 2000e-9, 0.349, kPetrak, kBy},
    {"petrak-m4", 0.286, 2970e-9, 2400e-9, 0.286, kPetrak, kBy},
    {"petrak-m5", 0.242, 3220e-9, 3880e-9, 0.443, kPetrak, kBy},
    {"petrak-m6", 0.253, 7430e-9, 3700e-9, 0.549, kPetrak, kBy},
};

}  // namespace

std::span<const Fabric> fabrics() { return kFabrics; }

const Fabric* find_fabric(const std::string& name, std::string& problem) {
  const auto found = std::ranges::find(kFabrics, name, &Fabric::name);
  if (found != std::end(kFabrics)) return found;
  std::vector<std::string> names;
  for (const Fabric& fabric : kFabrics) names.emplace_back(fabric.name);
  problem = "must be one of " + join(names, ", ") + ", not '" + name + "'" +
            suggestion(name, names) + " (to add one: experiments/scenes/README.md)";
  return nullptr;
}

}  // namespace taut
