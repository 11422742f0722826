#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/render/film/case_pictures.hpp"
#include "experiments/require/requirement_answer.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::requiring {

namespace {

namespace fs = std::filesystem;

constexpr double kPictureSeconds = 8;  ///< s that have to be left for the picture

struct Options {
  std::string scene, solver = "jakobsen", output, out;
  std::vector<std::string> keep;
  SceneSettings settings;
  double patience = 120;
  int jobs = 1;
  Format format;
};

/// Name of the picture; "" if there is no renderer.
std::string draw(const Requirement& found, const Store& store, const fs::path& file) {
  try {
    draw_side_by_side({{found.full.spec, "full model"}, {found.smallest->spec, "smallest model"}},
                      store, file);
    return file.string();
  } catch (const InputError& error) {
    std::cerr << "no picture: " << error.what() << '\n';
    return "";
  }
}

int exit_code(const Requirement& found) {
  if (found.interrupted) return kInterrupted;
  if (found.smallest && !found.verified && found.not_done.empty()) return kConflict;
  return found.not_done.empty() ? kPass : kIncomplete;
}

/// Adds a row to `scenes`. If `alone`, prints the whole answer.
int run_one(const Options& options, const std::string& scene, RequirementTable& scenes,
            bool alone) {
  const auto start = SteadyClock::now();
  const auto seconds = [&] { return seconds_since(start); };
  const CaseSpec spec{scene, options.settings, parse_solver(options.solver).canonical()};
  const Case full = make_case(spec);
  for (const std::string& reason :
       full.choice.entry->unsupported(*full.scene, full.choice.params)) {
    if (alone) throw InputError(full.id + ": " + reason);
    scenes.add_refused(full.scene->name, reason);
    return kPass;
  }
  Store store(options.out);
  store.prepare();
  store.begin_session("taut require " + full.id);
  const fs::path folder =
      fs::path(options.out) / "require" / (full.scene->name + "-" + full.key.substr(0, 8));
  const Requirement found = find_requirement({.full = spec,
                                              .keep = options.keep,
                                              .patience = options.patience,
                                              .jobs = options.jobs,
                                              .progress = show_ended_cases()},
                                             store, folder);
  std::string picture;
  if (found.smallest && seconds() + kPictureSeconds < options.patience)
    picture =
        draw(found, store,
             options.output.empty() || !alone ? folder / "models.png" : fs::path(options.output));
  scenes.add(found);
  const Answer answer = answer_of(found, store, picture, seconds(), options.patience);
  if (!found.answers.empty()) store.keep(answer);
  if (alone)
    print(answer, options.format);
  else
    progress() << full.scene->name << ": without " << answer.fact("can_go").text() << '\n';
  return exit_code(found);
}

int run(const Options& options) {
  RequirementTable scenes;
  if (options.scene != "all") {
    find_scene(options.scene);
    return run_one(options, options.scene, scenes, true);
  }
  int worst = kPass;
  for (const std::string& scene : shipped("scenes")) {
    const int code = run_one(options, scene, scenes, false);
    if (code == kInterrupted) return code;
    worst = std::max(worst, code);
  }
  Answer answer{"require", "all, " + options.solver};
  answer.add(scenes.table());
  print(answer, options.format);
  return worst;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("SCENE", o.scene,
                  "Name of a shipped scene, or a path; all: every shipped scene, as a table")
      .required();
  args.add_option("SOLVER", o.solver, "NAME or NAME:key=value,... (default: " + o.solver + ")");
  args.add_option("--keep", o.keep,
                  "An answer to keep: shape or a metric value, and :TOLERANCE in SI units, in the "
                  "unit shown (:2mm) or in % of the cloth, of the duration or of the value; repeat "
                  "it for each (default: shape, stretch, depth, crossings, settling time)")
      .one_each();
  add_settings(args, o.settings);
  args.add_option("--patience", o.patience,
                  "Search, verify and time within this time for a scene [s] (default: " +
                      as_typed(o.patience) + ")")
      .check(above_zero_seconds());
  add_output(args, o.output,
             "Where to draw both models (default: models.png beside the smallest scene)");
  add_jobs(args, o.jobs);
  add_results(args, o.out);
  add_format(args, o.format, "Print all that was tried, too");
}

}  // namespace
}  // namespace taut::verb::requiring

TAUT_VERB(require) = {
    .name = "require",
    .group = VerbGroup::extremes,
    .summary = "Finds the smallest model of a scene that keeps its answers",
    .example =
        "taut require flag\n  taut require ball jakobsen:faces=on --keep shape:2% --keep "
        "stretch.max:0.5%\n  taut require my/scene.toml bullet --json\n"
        "Exit: 0 found; 3 stopped by --patience; 6 the smallest model does not repeat bit for bit",
    .answer = {{"facts",
                "key scene solver can_go required kept chaotic horizon bytes smallest file "
                "verified time_left control picture cases ran seconds patience complete"},
               {"answers", "name shown value tolerance noise order unit"},
               {"effects", "name change * time bytes verdict may_go"},
               {"not_kept", "what"},
               {"not_done", "what"},
               {"trials", "effect change done within why bytes work_per_step steps scene solver *"},
               {"scenes", "scene chaotic kept can_go required time_left"}},
    .bind = taut::bind_verb<taut::verb::requiring::add_options, taut::verb::requiring::run>};
