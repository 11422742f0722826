#include "experiments/report/plot/plot.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::plot {

namespace {

using report::PlotSpec;

struct Options {
  std::string study, preset, kind, x, y, title, results, output;
  std::vector<std::string> solvers;
  bool json = false;
};

/// A plot's `slope`, the exponent of a theory; nothing if it names none.
std::optional<double> exponent(const std::string& text) {
  if (text.empty()) return {};
  const std::optional<double> value = whole<double>(text);
  if (!value || !std::isfinite(*value))
    throw InputError("slope = " + text + " in [[plot]]: expected a number");
  return value;
}

/// What the command line asks for; without --kind, --x and --y the pictures that the study asks
/// for.
std::vector<PlotSpec> wanted(const Options& options, const Study& study) {
  if (!options.kind.empty() || !options.x.empty() || !options.y.empty())
    return {{.kind = options.kind.empty() ? "work-precision" : options.kind,
             .x = options.x,
             .y = options.y,
             .title = options.title}};
  std::vector<PlotSpec> specs;
  for (const Plot& plot : study.plots) {
    const auto option = [&](const char* name) {
      const auto at = plot.options.find(name);
      return at == plot.options.end() ? std::string() : at->second;
    };
    specs.push_back({.kind = plot.kind,
                     .x = option("x"),
                     .y = option("y"),
                     .along = option("along"),
                     .title = option("title"),
                     .file = option("file"),
                     .slope = exponent(option("slope"))});
  }
  if (specs.empty()) throw InputError("study '" + study.name + "' asks for no plot; use --kind");
  return specs;
}

/// Of many values of what is not on x, keeps the cases at the commonest, and says so: in the title
/// and on standard error.
std::string hold_other(const PlotSpec& spec, report::Records& records, const std::string& scene) {
  const std::string held = spec.x == "dt" ? report::kSweeps : "dt";
  const report::Slice slice = report::hold(records, held, held == "dt" ? 1.0 / 64 : 8);
  const std::size_t left_out = records.size() - slice.records.size();
  records = slice.records;
  if (left_out == 0) return "";
  const std::string at = report::quantity(held).text(slice.value, 3);
  const std::string setting = held == "dt" ? "dt = " + at : at + " sweeps";
  progress() << scene << ", " << spec.y << " over " << spec.x << ": " << setting << "; " << left_out
             << " cases at other values are not drawn\n";
  return ", " + setting;
}

/// One figure per scene; a setting that is neither on an axis nor what orders the curves is held at
/// its commonest.
report::PlotFiles draw(PlotSpec spec, const report::StudyResult& study, const std::string& scene,
                       const Store& store, const std::filesystem::path& out) {
  const report::PlotKind& kind = report::find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  report::Records records = study.records;
  std::erase_if(records, [&](const Record* r) { return r->scene != scene; });
  if (spec.kind == "scaling") spec.slope = 1;
  const std::string held = spec.kind == "stability" ? "" : hold_other(spec, records, scene);
  std::vector<report::TimeSeries> series;
  if (spec.kind == "series") series = report::stored_series(records, spec.y, store);
  const ValueSpec* value = find_value(spec.y).second;
  if (const auto slope = study.slopes.find(scene);
      slope != study.slopes.end() && spec.kind == "convergence" && spec.x == report::kSweeps &&
      !spec.slope && value && value->falls_with_sweeps)
    spec.slope = slope->second;
  if (spec.title.empty())
    spec.title = report::capitalised(report::quantity(spec.y).title) + " over " +
                 report::quantity(spec.x).title;
  spec.title += ", " + scene + held;
  if (const std::string unequal = report::unequal_work(records); !unequal.empty())
    spec.title += "; unequal work: " + unequal;
  spec.file = slug(scene + "-" +
                   (spec.file.empty() ? spec.kind + "-" + spec.y + "-over-" + spec.x : spec.file));
  return report::make_plot(spec, records, series, out);
}

/// Of all solvers, without names; throws InputError if one is none of the study's.
void keep_solvers(std::vector<Record>& records, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Record& r : records) push_unique(known, r.solver);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw InputError("--solver: the study has no results of '" + name + "'" +
                       suggestion(name, known));
  if (!names.empty())
    std::erase_if(records, [&](const Record& r) {
      return std::ranges::find(names, r.solver) == names.end();
    });
}

int run(const Options& options) {
  const Study study = load_study_to_plot(options.study, options.preset);
  const Store store(options.results);
  report::ReportInput input = report::stored_results({study}, store);
  report::StudyResult& result = input.studies.front();
  if (result.records.empty())
    throw InputError("none of the " + std::to_string(result.planned) + " cases of study '" +
                     study.name + "' is in " + options.results +
                     " as this build would run them; taut run makes them");
  keep_solvers(result.records, options.solvers);
  const std::filesystem::path out =
      options.output.empty() ? std::filesystem::path(options.results) / "figures" /
                                   (study.name + (study.preset.empty() ? "" : "-" + study.preset))
                             : std::filesystem::path(options.output);
  const std::vector<PlotSpec> specs = wanted(options, study);
  for (const auto& [key, name] : {std::pair("--x: ", options.x), std::pair("--y: ", options.y)})
    if (!name.empty()) try {
        report::check_value_name(name, result.records);
      } catch (const InputError& error) {
        throw InputError(key + error.diagnostics().front().message);
      }
  make_folder(out);  // what cannot be written is said once, not for every scene
  std::vector<std::string> files;
  bool drawn = true;
  try {
    for (PlotSpec spec : specs) {
      if (spec.kind == "profile") {
        if (!input.bench) throw InputError("no cost was measured: taut bench " + study.name);
        spec.title = spec.title.empty() ? "How often each solver is near the cheapest" : spec.title;
        const report::PlotFiles plot = report::make_profile_plot(spec, *input.bench, out);
        for (const auto& file : {plot.svg, plot.pdf}) files.push_back(file.string());
        continue;
      }
      for (const report::SceneInfo& scene : input.scenes) try {
          const report::PlotFiles plot = draw(spec, result, scene.name, store, out);
          for (const auto& file : {plot.svg, plot.pdf}) files.push_back(file.string());
        } catch (const InputError& error) {
          std::cerr << scene.name << ": " << error.what() << '\n';
        }
    }
  } catch (const report::PlotError& error) {
    std::cerr << error.what() << '\n';
    drawn = false;
  }
  print_files(files, options.json);
  return !drawn ? kEnvironment : files.empty() ? kNothing : kPass;
}

void add_options(CLI::App& app, Options& options) {
  std::vector<std::string> names;
  for (const report::PlotKind& kind : report::plot_kinds()) names.emplace_back(kind.name);
  app.add_option("STUDY", options.study, "Name or path of a study that was run")->required();
  add_stored(app, options.preset, options.results);
  app.add_option("--kind", options.kind,
                 "One of: " + join(names, ", ") + " (default: what the study asks for)")
      ->check(known("kind of plot", names));
  app.add_option("--x", options.x, "Value on x: dt, iterations, projections or a metric's value");
  app.add_option("--y", options.y, "Value on y, such as stretch.rms");
  app.add_option("--solver", options.solvers, "Only this solver; repeat it for each")
      ->allow_extra_args(false);
  app.add_option("--title", options.title, "Title above the figure");
  add_output(app, options.output,
             "Where figures go (default: figures/STUDY or figures/STUDY-PRESET in the results)");
  add_json(app, options.json, "The names of the files");
}

}  // namespace
}  // namespace taut::verb::plot

TAUT_VERB(plot) = {.name = "plot",
                   .group = VerbGroup::studies,
                   .summary = "Draws the figures of a study: SVG, PDF, gnuplot script and CSV",
                   .example =
                       "taut plot iterations --preset quick\n  taut plot time-steps --kind "
                       "stability -o figures\n  taut plot trade --kind profile\n  taut plot "
                       "iterations --x projections "
                       "--y stretch.max",
                   .bind = taut::bind_verb<taut::verb::plot::add_options, taut::verb::plot::run>};
