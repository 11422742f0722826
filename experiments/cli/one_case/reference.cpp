#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"

namespace taut::verb::references {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes, settings;
  bool all = false, replace = false;
  Format format;
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
  double t = 0, floor = 0;  ///< s, m
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
  return {scene.name, "static", rest.derivation, "", 0, rest.floor};
}

/// Two answers for one moment are the same motion if they differ by less than this share of the
/// cloth's size.
constexpr double kConverged = 1e-4;

/// How often the step is halved for a moment that is not converged, while that brings it nearer.
constexpr int kHalvings = 3;

/// The first moment that is not converged; floor.size(): all are.
std::size_t horizon(const reference::Trajectory& motion, const Scene& scene) {
  const auto beyond = [&](double floor) { return !(floor <= kConverged * extent(scene)); };
  return static_cast<std::size_t>(std::ranges::find_if(motion.floor, beyond) -
                                  motion.floor.begin());
}

/// At as many of these moments as the projection reaches, from steps halved until they are
/// converged or come no nearer.
reference::Trajectory motion_of(const Scene& scene, std::vector<double>& times) {
  reference::Trajectory motion = reference::converged_motion(scene, times, 1.0 / 1024);
  for (; !motion.unique && times.size() > 1 && reference::refuse_dynamic(scene).empty();
       motion = reference::converged_motion(scene, times, 1.0 / 1024))
    times.pop_back();  // the last of them may be out of reach
  for (int halved = 0; motion.unique && halved < kHalvings; ++halved) {
    const std::size_t k = horizon(motion, scene);
    if (k == times.size()) break;
    reference::Trajectory finer = reference::converged_motion(scene, times, motion.dt / 2);
    if (!finer.unique || !(finer.floor[k] < motion.floor[k] / 2)) break;
    motion = std::move(finer);
  }
  return motion;
}

/// The same for states in motion, up to the horizon to which they are converged.
std::vector<Outcome> write_motion(const Scene& scene, const Options& options) {
  const fs::path out = options.output;
  if (const std::string why = kept(scene, "motion", 0.5, options); !why.empty())
    return {{scene.name, "motion", "", why}};
  std::vector<double> times{0.5, 1, 1.5, 2};
  const reference::Trajectory motion = motion_of(scene, times);
  if (!motion.unique) return {{scene.name, "motion", "", motion.reason}};
  std::vector<Outcome> outcomes;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (k == horizon(motion, scene)) {
      outcomes.push_back({scene.name, "motion", "",
                          "chaotic: with dt = 1/" + shortest(1 / motion.dt) +
                              " s and half of it places differ by this floor, more than 1e-4 of "
                              "the cloth's size, and half the steps are no cure: statistics alone "
                              "have a meaning",
                          times[k], motion.floor[k]});
      break;
    }
    write_reference({scene.name, reference_digest(scene, "motion"), "motion", times[k],
                     motion.derivation, motion.floor[k], motion.states[k].x},
                    out / scene.name);
    outcomes.push_back({scene.name, "motion", motion.derivation, "", times[k], motion.floor[k]});
  }
  return outcomes;
}

int run(const Options& options) {
  int written = 0;
  Answer answer{"reference"};
  Table& table = answer.add(Table{"references",
                                  "",
                                  {{"scene"},
                                   {"kind"},
                                   {"t", "at", kTime},
                                   {"floor", "", kLength},
                                   {"derivation"},
                                   {"refused", "why there is none"}}});
  const std::vector<fs::path> files = chosen(options);
  const Countdown countdown("scene");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Scene scene = load_scene(files[i], options.settings);
    std::vector<Outcome> outcomes = write_motion(scene, options);
    outcomes.insert(outcomes.begin(), write_static(scene, options));
    for (const Outcome& o : outcomes) {
      written += o.refused.empty();
      table.rows.push_back({o.scene, o.kind, o.t > 0 ? Cell(o.t) : Cell(),
                            o.refused.empty() || o.floor > 0 ? Cell(o.floor) : Cell(), o.derivation,
                            o.refused});
    }
    countdown(i + 1, files.size());
  }
  print(answer, options.format);
  progress() << written << " references in " << options.output << '\n';
  return written > 0 || options.all ? kPass : kNothing;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("SCENE", options.scenes, "Names of shipped scenes, or scene files");
  app.add_flag("--all", options.all, "Every shipped scene");
  add_settings(app, options.settings);
  add_output(app, options.output, "Where references are kept (default: " + options.output + ")");
  app.add_flag("--replace", options.replace, "Compute again what is there of the same scene");
  add_json(app, options.format.json, "What became of each");
}

}  // namespace
}  // namespace taut::verb::references

TAUT_VERB(reference) = {
    .name = "reference",
    .group = VerbGroup::one_case,
    .summary = "Rebuilds converged references of scenes, or says why there is none",
    .example = "taut reference drape\n  taut reference --all",
    .answer = "references: scene kind t floor derivation refused",
    .bind = taut::bind_verb<taut::verb::references::add_options, taut::verb::references::run>};
