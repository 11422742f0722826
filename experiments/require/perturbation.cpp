#include "experiments/require/perturbation.hpp"

#include <algorithm>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/require/draft.hpp"

namespace taut {

namespace {

constexpr double kRounding = 0x1p-23;  ///< machine epsilon of binary32
/// Directions of the displacement. Several, since a vertex that touches a collider can move only in
/// some of them; asymmetric, so that a symmetric cloth reacts.
const Vec3 kDirections[] = {{0.8, 0.5, 0.3},   {-0.8, 0.5, 0.3},  {0.8, 0.5, -0.3},
                            {-0.8, 0.5, -0.3}, {0.8, -0.5, 0.3},  {-0.8, -0.5, 0.3},
                            {0.8, -0.5, -0.3}, {-0.8, -0.5, -0.3}};

/// Vertices that are not pinned, spread over the cloth.
std::vector<int> chosen_vertices(const Scene& scene, std::size_t count) {
  std::vector<int> free;
  for (int i = 0; i < scene.mesh.size(); ++i)
    if (!std::ranges::binary_search(scene.pins, i)) free.push_back(i);
  std::vector<int> chosen;
  for (std::size_t k = 0; k < count && !free.empty(); ++k)
    chosen.push_back(free[(2 * k + 1) * free.size() / (2 * count)]);
  return chosen;
}

/// Makes the scene with one vertex moved; false if it may not start there.
bool move_vertex(const Case& one, int vertex, const Vec3& way, const std::filesystem::path& folder,
                 const std::string& name, CaseSpec& spec) {
  Draft draft(one.spec);
  const Vec3 at = one.scene->start.x[to_index(vertex)] + way;
  const Value* known = draft.find("cloth", "placed");
  Value all = known ? *known : toml_value("[]");
  all.items.push_back(toml_value("{ vertex = " + std::to_string(vertex) + ", at = [" +
                                 shortest(at.x()) + ", " + shortest(at.y()) + ", " +
                                 shortest(at.z()) + "] }"));
  draft.set("cloth", "placed", all);
  spec = draft.write(folder, name);
  try {
    make_case(spec);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

Perturbations perturbations(const Case& one, const std::filesystem::path& folder) {
  constexpr std::size_t kRuns = 4;
  Perturbations found;
  const double size = kRounding * extent(*one.scene);
  for (const int vertex : chosen_vertices(*one.scene, kRuns)) {
    const std::string name = "rounding-" + std::to_string(found.rounding.size() + 1);
    for (const Vec3& direction : kDirections)
      if (CaseSpec spec; move_vertex(one, vertex, size * direction, folder, name, spec)) {
        found.rounding.push_back(spec);
        break;
      }
  }
  for (const ParamSpec& spec : one.choice.entry->params)
    if (spec.name == "order" && spec.choices.find("random") != std::string_view::npos)
      for (const char* order : {"random", "reversed"}) {
        Draft draft(one.spec);
        draft.set_parameter("order", order);
        if (one.choice.params.is("order", order)) draft.set_parameter("seed", "2");
        found.order.push_back(draft.write(folder, ""));
      }
  return found;
}

}  // namespace taut
