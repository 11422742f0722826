#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/references.hpp"
#include "experiments/system/data.hpp"

namespace taut::verb::references {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes;
  SceneSettings settings;
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

int run(const Options& options) {
  int written = 0;
  Answer answer{"reference"};
  Table& table = answer.add(Table{"references",
                                  "",
                                  {{"scene"},
                                   {"kind"},
                                   {"t", "horizon", kTime},
                                   {"floor", "", kLength},
                                   {"floor_share", "floor over the motion", kShare},
                                   {"derivation"},
                                   {"refused", "why there is none"}}});
  const std::vector<fs::path> files = chosen(options);
  const Countdown countdown("scene");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Scene scene = load_scene(files[i], options.settings);
    for (const ReferenceOutcome& o : write_references(scene, options.output, options.replace)) {
      written += o.refused.empty();
      table.rows.push_back(
          {o.scene, o.kind, o.t > 0 ? Cell(o.t) : Cell(), o.floor > 0 ? Cell(o.floor) : Cell(),
           o.floor_share > 0 ? Cell(o.floor_share) : Cell(), o.derivation, o.refused});
    }
    countdown(i + 1, files.size());
  }
  print(answer, options.format);
  progress() << written << " references in " << options.output << '\n';
  return written > 0 || options.all ? kPass : kNothing;
}

void add_options(Arguments& args, Options& options) {
  args.add_option("SCENE", options.scenes, "Names of shipped scenes, or scene files");
  args.add_flag("--all", options.all, "Every shipped scene");
  add_settings(args, options.settings);
  add_output(args, options.output, "Where references are kept (default: " + options.output + ")");
  args.add_flag("--replace", options.replace,
                "Compute existing references of the same scene again");
  add_json(args, options.format.json, "the references, or why there are none,");
}

}  // namespace
}  // namespace taut::verb::references

TAUT_VERB(reference) = {
    .name = "reference",
    .group = VerbGroup::one_case,
    .summary = "Rebuilds converged references of scenes, or says why there is none",
    .example = "taut reference drape\n  taut reference --all",
    .answer = {{"references", "scene kind t floor floor_share derivation refused"}},
    .bind = taut::bind_verb<taut::verb::references::add_options, taut::verb::references::run>};
