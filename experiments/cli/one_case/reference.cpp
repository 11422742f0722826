#include "core/io/scene_io.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"

namespace taut::verb::references {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes;
  bool all = false, replace = false, json = false;
  std::string output = (results_folder() / "references").string();
};

std::vector<fs::path> chosen(const Options& options) {
  std::vector<fs::path> files;
  for (const std::string& scene : options.scenes) files.push_back(find_scene(scene));
  if (options.all)
    for (const std::string& scene : shipped("scenes")) files.push_back(find_scene(scene));
  if (files.empty()) throw InputError("reference: name a scene, or give --all");
  std::sort(files.begin(), files.end());
  return files;
}

/// What became of a reference: its floor [m], or why there is none.
struct Outcome {
  std::string scene, kind, derivation, refused;
  double floor = 0;
};

/// Why a reference of this kind is not computed; "": it is.
std::string kept(const Scene& scene, const std::string& kind, double t, const Options& options) {
  const fs::path file =
      reference_file({scene.name, reference_digest(scene, kind), kind, t, "", 0, {}},
                     fs::path(options.output) / scene.name);
  if (options.replace || !fs::exists(file)) return "";
  return file.string() + " is there; --replace computes it again";
}

Outcome write_static(const Scene& scene, const Options& options) {
  const fs::path out = options.output;
  if (const std::string why = kept(scene, "static", 0, options); !why.empty())
    return {scene.name, "static", "", why};
  const reference::Equilibrium rest = reference::static_equilibrium(scene);
  if (!rest.unique) return {scene.name, "static", "", rest.reason};
  write_reference({scene.name, reference_digest(scene, "static"), "static", 0, rest.derivation,
                   rest.floor, rest.x},
                  out / scene.name);
  return {scene.name, "static", rest.derivation, "", rest.floor};
}

/// The same for the state after half a second, before any chaos.
Outcome write_motion(const Scene& scene, const Options& options) {
  const fs::path out = options.output;
  const double t = 0.5;
  if (const std::string why = kept(scene, "motion", t, options); !why.empty())
    return {scene.name, "motion", "", why};
  const reference::Trajectory motion = reference::converged_motion(scene, {t}, 1.0 / 1024);
  if (!motion.unique) return {scene.name, "motion", "", motion.reason};
  write_reference({scene.name, reference_digest(scene, "motion"), "motion", t, motion.derivation,
                   motion.floor[0], motion.states[0].x},
                  out / scene.name);
  return {scene.name, "motion", motion.derivation, "", motion.floor[0]};
}

void print(const Outcome& o) {
  std::cout << o.scene << '\t' << o.kind << '\t';
  if (o.refused.empty())
    std::cout << "floor " << o.floor << " m\t" << o.derivation << '\n';
  else
    std::cout << "refused: " << o.refused << '\n';
}

int run(const Options& options) {
  int written = 0;
  Json all = Json::array();
  const std::vector<fs::path> files = chosen(options);
  const Countdown countdown("scene");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Scene scene = load_scene(files[i]);
    for (const Outcome& o : {write_static(scene, options), write_motion(scene, options)}) {
      written += o.refused.empty();
      all.push_back({{"scene", o.scene},
                     {"kind", o.kind},
                     {"floor", o.refused.empty() ? Json(o.floor) : Json()},
                     {"derivation", o.derivation},
                     {"refused", o.refused}});
      if (!options.json) print(o);
    }
    countdown(i + 1, files.size());
  }
  if (options.json) print_json(all);
  progress() << written << " references in " << options.output << '\n';
  return written > 0 || options.all ? kPass : kNothing;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("SCENE", options.scenes, "Names of shipped scenes, or scene files");
  app.add_flag("--all", options.all, "Every shipped scene");
  add_output(app, options.output, "Where references are kept (default: " + options.output + ")");
  app.add_flag("--replace", options.replace, "Compute again what is there of the same scene");
  add_json(app, options.json, "What became of each");
}

}  // namespace
}  // namespace taut::verb::references

TAUT_VERB(reference) = {
    .name = "reference",
    .group = VerbGroup::one_case,
    .summary = "Rebuilds converged references of scenes, or says why there is none",
    .example = "taut reference drape\n  taut reference --all",
    .bind = taut::bind_verb<taut::verb::references::add_options, taut::verb::references::run>};
