#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/reference_store.hpp"
#include "experiments/system/data.hpp"

namespace taut::verb::references {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes;
  bool all = false;
  std::string out = references_folder().string();
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

/// A static reference, or why there is none; true if one was written.
bool write_static(const Scene& scene, const fs::path& out) {
  const reference::Equilibrium rest = reference::static_equilibrium(scene);
  std::cout << scene.name << "\tstatic\t";
  if (!rest.unique) {
    std::cout << "refused: " << rest.reason << '\n';
    return false;
  }
  write_reference({scene.name, reference_digest(scene, "static"), "static", 0, rest.derivation,
                   rest.floor, rest.x},
                  out / scene.name);
  std::cout << "floor " << rest.floor << " m\t" << rest.derivation << '\n';
  return true;
}

/// The same for the state after half a second, before any chaos.
bool write_motion(const Scene& scene, const fs::path& out) {
  const double t = 0.5;
  const reference::Trajectory motion = reference::converged_motion(scene, {t}, 1.0 / 1024);
  std::cout << scene.name << "\tmotion\t";
  if (!motion.unique) {
    std::cout << "refused: " << motion.reason << '\n';
    return false;
  }
  write_reference({scene.name, reference_digest(scene, "motion"), "motion", t, motion.derivation,
                   motion.floor[0], motion.states[0].x},
                  out / scene.name);
  std::cout << "floor " << motion.floor[0] << " m at " << t << " s\t" << motion.derivation << '\n';
  return true;
}

int run(const Options& options) {
  int written = 0;
  for (const fs::path& file : chosen(options)) {
    const Scene scene = load_scene(file);
    written += write_static(scene, options.out);
    written += write_motion(scene, options.out);
  }
  std::cerr << written << " references in " << options.out << '\n';
  return written > 0 || options.all ? kPass : kNothing;
}

std::function<int()> bind(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  arguments.option("SCENE", options->scenes, "Names of shipped scenes, or scene files");
  arguments.flag("--all", options->all, "Every shipped scene");
  arguments.option("-o,--out", options->out,
                   "Where references are kept (default: " + options->out + ")");
  return [options] { return run(*options); };
}

}  // namespace
}  // namespace taut::verb::references

TAUT_VERB(reference) = {.name = "reference",
                        .summary =
                            "Rebuilds the converged references of scenes that have a unique "
                            "truth, and says why the others have none",
                        .example = "taut reference drape\n  taut reference --all",
                        .bind = taut::verb::references::bind};
