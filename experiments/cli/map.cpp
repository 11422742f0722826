#include "experiments/study/map.hpp"

#include <iomanip>
#include <iostream>
#include <memory>
#include <thread>

#include "experiments/command_line/progress.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut::verb::map {

namespace {

struct Options {
  std::vector<std::string> studies;
  std::string preset, out = default_results();
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  double seconds = Limits{}.seconds;
  bool quiet = false;
};

/// A letter per class: what was run, and, beside it, what its block says.
std::pair<char, char> glyphs(int status) {
  switch (static_cast<Status::Kind>(status)) {
    case Status::Kind::ok:
      return {'o', '.'};
    case Status::Kind::exploded:
      return {'X', 'x'};
    case Status::Kind::unsettled:
      return {'U', 'u'};
    case Status::Kind::unsupported:
      return {'N', 'n'};
    case Status::Kind::timeout:
    case Status::Kind::oom:
      return {'T', 't'};
    default:
      return {'C', 'c'};
  }
}

char glyph(const StudyMap& map, const MapPanel& panel, const MapCell& cell) {
  const std::optional<int> inferred = panel.found.inferred(cell);
  if (!map.cell(panel, cell) || !inferred) return ' ';
  const auto [run, guessed] = glyphs(*inferred);
  return panel.found.measured(cell) ? run : guessed;
}

void print_panel(const StudyMap& map, const MapPanel& panel) {
  std::cout << '\n' << panel.scene << "  " << panel.solver << '\n';
  for (std::size_t j = map.y.values.size(); j-- > 0;) {
    std::cout << "  " << std::setw(12) << std::right << map.y.values[j] << "  ";
    for (std::size_t i = 0; i < map.x.values.size(); ++i)
      std::cout << glyph(map, panel, {i, j}) << ' ';
    std::cout << '\n';
  }
  std::cout << "  " << std::setw(12) << map.y.name << "  " << map.x.name << " "
            << map.x.values.front() << " to " << map.x.values.back() << '\n';
}

int draw(const std::string& study, const Options& options, const Store& store) {
  StudyMap map = map_of(load_study(study, options.preset));
  const Session session(store, "taut map " + study, {}, {});
  Progress progress;
  explore(map, store, session,
          {.jobs = options.jobs,
           .limits = {.seconds = options.seconds},
           .shard = {},
           .only_failed = false,
           .progress = [&](const Tally& t, const Record* record) {
             if (record) progress.show(t, record);
           }});
  if (options.quiet) return map.interrupted ? kInterrupted : kPass;
  std::cout << study << '\n';
  for (const MapPanel& panel : map.panels) print_panel(map, panel);
  std::cout << "\no ok  X exploded  U unsettled  N unsupported  T no time or memory  C crash or "
               "error; . x u n t c: not run, its neighbours all say so\n"
            << map.known() << " of the " << map.dense() << " cases of the dense grid were needed ("
            << map.ran << " were run now): " << map.dense() - map.known() << " saved\n\n";
  return map.interrupted ? kInterrupted : kPass;
}

int run(Options options) {
  if (options.studies.empty()) {
    options.studies = shipped_maps();
    if (options.preset.empty()) options.preset = "quick";
  }
  const Store store(options.out);
  store.prepare();
  for (const std::string& study : options.studies)
    if (const int code = draw(study, options, store); code != kPass) return code;
  return kPass;
}

std::function<int()> bind(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  arguments.option(
      "STUDY", options->studies,
      "Names or paths of studies with two sweeps; none: every shipped map, preset quick");
  arguments.option("--preset", options->preset,
                   "A smaller or larger version that the study defines");
  arguments.option("-j,--jobs", options->jobs, "Cases at a time (default: one per core)")
      .range(1, 1024);
  arguments.option("--timeout", options->seconds, "Wall time limit of a case [s] (default: 120)")
      .positive();
  arguments.flag("--quiet", options->quiet, "Do not print the maps");
  arguments.option("--out", options->out, "Results folder (default: " + options->out + ")");
  return [options] { return run(*options); };
}

}  // namespace
}  // namespace taut::verb::map

TAUT_VERB(map) = {
    .name = "map",
    .summary = "Runs a study of two sweeps along the borders between outcomes, not densely",
    .example = "taut map\n  taut map map-dt-iterations --preset quick",
    .bind = taut::verb::map::bind};
