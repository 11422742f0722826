#include "experiments/require/effects.hpp"

#include <algorithm>

#include "core/model/scene_keys.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// Fewest vertices along the longer side of a coarser grid.
constexpr int kFewest = 4;

using Effects = std::vector<Effect>;

/// Adds an effect unless there is no way to reduce it.
void add(Effects& effects, const std::string& name, std::vector<Reduction> reductions) {
  if (!reductions.empty()) effects.push_back({name, std::move(reductions)});
}
void gone(Effects& effects, const std::string& name, std::function<void(Draft&)> apply) {
  add(effects, name, {{"gone", std::move(apply), true}});
}

bool has_family(const Scene& scene, Family family) {
  return std::ranges::any_of(scene.links, [&](const Link& l) { return l.family == family; });
}

/// Adds an effect for each key that is not at its default: it is removed wherever the scene has it.
/// A choice at its default is changed to the last value instead. Each effect is added once.
template <class Part>
void add_keys(Effects& effects, std::string_view section, const Part& part) {
  each_key(section, part, [&]<class Of>(const SceneKey& key, const Of& value, const Of& initial) {
    const std::string of(section), name(key.name()), effect(key.effect);
    if (effect.empty() || std::ranges::count(effects, effect, &Effect::name) > 0) return;
    if constexpr (std::is_enum_v<Of>) {
      const std::vector<std::string> all = parts_of(key.choices);
      if (value == initial)
        add(effects, effect, {{all.front() + " -> " + all.back(), [=](Draft& draft) {
                                 if (draft.has(of)) draft.set(of, name, "'" + all.back() + "'");
                               }}});
    } else if (value != initial) {
      gone(effects, effect, [=](Draft& draft) { draft.remove(of, name); });
    }
  });
}

void add_links_and_forces(const Case& one, Effects& effects) {
  const Scene& scene = *one.scene;
  const auto no_links = [](const char* family) {
    return [family](Draft& draft) { draft.set("links", family, "false"); };
  };
  if (has_family(scene, Family::bend)) gone(effects, "bend links", no_links("bend"));
  if (has_family(scene, Family::shear)) gone(effects, "shear links", no_links("shear"));
  add_keys(effects, "links", scene);
  if (scene.membrane) {
    gone(effects, "membrane", [](Draft& draft) { draft.remove("membrane"); });
    add_keys(effects, "membrane", *scene.membrane);
  }
  if (scene.bending) gone(effects, "bending", [](Draft& draft) { draft.remove("bending"); });
  if (scene.wind) {
    gone(effects, "wind", [](Draft& draft) { draft.remove("wind"); });
    add_keys(effects, "wind", *scene.wind);
  }
  add_keys(effects, "forces", scene);
}

void add_contact(const Case& one, Effects& effects) {
  const Scene& scene = *one.scene;
  for (const Collider& collider : scene.colliders) add_keys(effects, "collider", collider);
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const std::string number =
        scene.colliders.size() > 1 ? " " + std::to_string(k + 1) : std::string();
    gone(effects, std::string(type_name(scene.colliders[k].shape)) + number,
         [k](Draft& draft) { (*draft.tables("collider"))[k] = Value{}; });
  }
  if (scene.self_collision)
    gone(effects, "self-collision", [](Draft& draft) { draft.remove("self_collision"); });
  if (!scene.colliders.empty()) add_keys(effects, "cloth", scene);
}

/// Adds the reductions of a parameter: the cheaper values of a choice, or an integer halved down to
/// 1.
void add_parameter(const Case& one, Effects& effects, const OptionalEffect& effect) {
  const std::string parameter(effect.parameter);
  const auto spec = std::ranges::find(one.choice.entry->params, parameter, &ParamSpec::name);
  if (spec == one.choice.entry->params.end()) return;
  const std::string from(one.choice.params.value(parameter));
  std::vector<Reduction> reductions;
  const auto reduce_to = [&](std::string_view text) {
    const std::string value(text);
    reductions.push_back({from + " -> " + value, [parameter, value](Draft& draft) {
                            draft.set_parameter(parameter, value);
                          }});
  };
  if (spec->kind == ParamSpec::Kind::integer)
    for (int n = std::stoi(from); n > 1;) {
      n = (n + 1) / 2;
      reduce_to(std::to_string(n));
    }
  const auto own = std::ranges::find(effect.values, from);
  if (own != effect.values.end()) std::for_each(own + 1, effect.values.end(), reduce_to);
  add(effects, std::string(effect.name), std::move(reductions));
}

void add_sizes(const Case& one, Effects& effects) {
  const Scene& scene = *one.scene;
  if (scene.mesh.grid) {
    const Grid& grid = *scene.mesh.grid;
    const auto halved = [](int n) { return n == 1 ? 1 : (n + 1) / 2; };
    const auto text = [](int nu, int nv) { return std::to_string(nu) + "x" + std::to_string(nv); };
    std::vector<Reduction> coarser;
    int nu = halved(grid.nu), nv = halved(grid.nv);
    for (int k = 0; k < 2 && std::max(nu, nv) >= kFewest && (nu >= 2 || grid.nu == 1) &&
                    (nv >= 2 || grid.nv == 1);
         ++k, nu = halved(nu), nv = halved(nv))
      coarser.push_back({text(grid.nu, grid.nv) + " -> " + text(nu, nv), [=](Draft& draft) {
                           draft.set("cloth", "grid",
                                     "[" + std::to_string(nu) + ", " + std::to_string(nv) + "]");
                         }});
    add(effects, "resolution", std::move(coarser));
  }
  std::vector<Reduction> shorter;
  for (const int part : {2, 4, 8}) {
    const double seconds = scene.duration() / part;
    if (seconds < scene.dt) break;
    shorter.push_back({shortest(scene.duration()) + " s -> " + shortest(seconds) + " s",
                       [=](Draft& draft) { draft.set("time", "duration", shortest(seconds)); }});
  }
  add(effects, "duration", std::move(shorter));
}

}  // namespace

std::vector<Effect> effects_of(const Case& one) {
  Effects effects;
  add_links_and_forces(one, effects);
  add_contact(one, effects);
  const SolverEntry& solver = *one.choice.entry;
  for (const OptionalEffect& effect : solver.optional_effects)
    if (!effect.of_contact || !one.scene->colliders.empty()) add_parameter(one, effects, effect);
  add_parameter(one, effects, {"substeps", solver.accuracy.substeps});
  add_parameter(one, effects, {"sweeps", solver.accuracy.sweeps});
  add_parameter(one, effects,
                {"precision",
                 parameter_with(ParamSpec::Role::precision, solver.params),
                 {"double", "float"}});
  add_sizes(one, effects);
  return effects;
}

}  // namespace taut
