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
  std::string width, height, font;
  std::vector<std::string> solvers, scenes;
  bool no_title = false, json = false;
};

/// A plot's `slope`, the exponent of a theory; nothing if it names none.
std::optional<double> exponent(const std::string& text) {
  if (text.empty()) return {};
  const std::optional<double> value = whole<double>(text);
  if (!value || !std::isfinite(*value))
    throw InputError("slope = " + text + " in [[plot]]: expected a number");
  return value;
}

/// "84mm" as 84: a number with this unit. Throws InputError.
double size_of(const char* option, const std::string& text, const std::string& unit) {
  if (text.empty()) return 0;
  const auto value = text.ends_with(unit) ? whole<double>(text.substr(0, text.size() - unit.size()))
                                          : std::nullopt;
  if (!value || !(*value > 0 && *value <= 2000))
    throw InputError(std::string(option) + " " + text + ": expected a number with its unit, as 8" +
                     unit);
  return *value;
}

report::FigureSize figure_size(const Options& options) {
  return {size_of("--width", options.width, "mm"), size_of("--height", options.height, "mm"),
          size_of("--font", options.font, "pt")};
}

/// A picture, and the exponent of a theory that it names.
struct Wanted {
  PlotSpec spec;
  std::optional<double> slope = {};
};

/// What the command line asks for; without --kind, --x and --y the pictures that the study asks
/// for.
std::vector<Wanted> wanted(const Options& options, const Study& study) {
  if (!options.kind.empty() || !options.x.empty() || !options.y.empty())
    return {{{.kind = options.kind.empty() ? "work-precision" : options.kind,
              .x = options.x,
              .y = options.y,
              .title = options.title}}};
  std::vector<Wanted> all;
  for (const Plot& plot : study.plots) {
    const auto option = [&](const char* name) {
      const auto at = plot.options.find(name);
      return at == plot.options.end() ? std::string() : at->second;
    };
    all.push_back({{.kind = plot.kind,
                    .x = option("x"),
                    .y = option("y"),
                    .along = option("along"),
                    .title = option("title"),
                    .file = option("file")},
                   exponent(option("slope"))});
  }
  if (all.empty()) throw InputError("study '" + study.name + "' asks for no plot; use --kind");
  return all;
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

/// Of one scene; a setting that is neither on an axis nor what orders the curves is held at its
/// commonest.
report::PlotPanel panel_of(const Wanted& want, const report::StudyResult& study,
                           const std::string& scene, const Store& store) {
  const PlotSpec& spec = want.spec;
  report::PlotPanel panel{scene, study.records, {}, want.slope};
  std::erase_if(panel.records, [&](const Record* r) { return r->scene != scene; });
  if (spec.kind == "scaling") panel.slope = 1;
  if (spec.kind != "stability") panel.title += hold_other(spec, panel.records, scene);
  if (spec.kind == "series") panel.series = report::stored_series(panel.records, spec.y, store);
  const ValueSpec* value = find_value(spec.y).second;
  if (const auto slope = study.slopes.find(scene);
      slope != study.slopes.end() && spec.kind == "convergence" && spec.x == report::kSweeps &&
      !panel.slope && value && value->falls_with_sweeps)
    panel.slope = slope->second;
  return panel;
}

/// A figure of these scenes; of a single one it bears the name. Several panels have titles of their
/// own, and the figure has one only if it is asked for.
report::PlotFiles draw(Wanted want, const Options& options, const report::StudyResult& study,
                       const std::vector<std::string>& scenes, const Store& store,
                       const std::filesystem::path& out) {
  PlotSpec& spec = want.spec;
  const report::PlotKind& kind = report::find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  std::vector<report::PlotPanel> panels;
  for (const std::string& scene : scenes) panels.push_back(panel_of(want, study, scene, store));
  if (spec.title.empty())
    spec.title = report::capitalised(report::quantity(spec.y).title) + " over " +
                 report::quantity(spec.x).title;
  if (panels.size() == 1) spec.title += ", " + panels.front().title;
  if (options.no_title || (panels.size() > 1 && options.title.empty())) spec.title.clear();
  report::Records drawn;
  for (const report::PlotPanel& panel : panels)
    drawn.insert(drawn.end(), panel.records.begin(), panel.records.end());
  if (const std::string unequal = report::unequal_work(drawn); !unequal.empty())
    spec.remark = "unequal work: " + unequal;
  if (!spec.remark.empty()) progress() << spec.remark << '\n';
  if (spec.file.empty()) spec.file = spec.kind + "-" + spec.y + "-over-" + spec.x;
  spec.file = slug((scenes.size() == 1 ? scenes.front() + "-" : "") + spec.file);
  return report::make_plot(spec, panels, out);
}

/// Keeps what was chosen, all if nothing was; throws InputError if the study has no such.
template <class NameOf>
void keep(const char* option, std::vector<Record>& records, const std::vector<std::string>& names,
          NameOf name_of) {
  std::vector<std::string> known;
  for (const Record& r : records) push_unique(known, name_of(r));
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw InputError(std::string(option) + ": the study has no results of '" + name + "'" +
                       suggestion(name, known));
  if (!names.empty())
    std::erase_if(records, [&](const Record& r) {
      return std::ranges::find(names, name_of(r)) == names.end();
    });
}

/// Every figure of a study, and how many could not be drawn, which is said. Maps have their panels
/// by solver: a figure for each scene.
std::vector<report::PlotFiles> draw_all(const std::vector<Wanted>& wanted, const Options& options,
                                        const report::ReportInput& input, const Store& store,
                                        const std::filesystem::path& out, int& dropped) {
  const report::StudyResult& study = input.studies.front();
  std::vector<std::string> scenes;
  for (const Record& r : study.records) push_unique(scenes, r.scene);
  std::vector<report::PlotFiles> figures;
  for (Wanted want : wanted) {
    want.spec.size = figure_size(options);
    if (want.spec.kind == "profile") {
      if (!input.bench) throw InputError("no cost was measured: taut bench " + study.name);
      if (want.spec.title.empty() && !options.no_title)
        want.spec.title = "How often each solver is near the cheapest";
      figures.push_back(report::make_profile_plot(want.spec, *input.bench, out));
      continue;
    }
    std::vector<std::vector<std::string>> sets{scenes};
    if (want.spec.kind == "stability") {
      sets.clear();
      for (const std::string& scene : scenes) sets.push_back({scene});
    }
    for (const std::vector<std::string>& set : sets) try {
        figures.push_back(draw(want, options, study, set, store, out));
      } catch (const report::FigureNotWritten&) {
        throw;
      } catch (const InputError& error) {
        std::cerr << "not drawn: " << error.what() << '\n';
        ++dropped;
      }
  }
  return figures;
}

int run(const Options& options) {
  const Study study = load_study_to_plot(options.study, options.preset);
  const Store store(options.results);
  report::ReportInput input = report::stored_results({study}, store);
  report::StudyResult& result = input.studies.front();
  if (result.records.empty())
    throw InputError("none of the " + std::to_string(result.planned) + " cases of study '" +
                     study.name + "' is in " + options.results +
                     " as this build would run them; taut run " + study_words(study) +
                     " makes them" + where_else(study, store));
  const std::size_t missing = result.planned - result.records.size();
  if (missing > 0)
    std::cerr << missing << " of the " << result.planned << " cases of study '" << study.name
              << "' are not there and not drawn" << where_else(study, store) << '\n';
  keep("--solver", result.records, options.solvers, [](const Record& r) { return r.solver; });
  keep("--scene", result.records, options.scenes, [](const Record& r) { return r.scene; });
  const std::filesystem::path out =
      options.output.empty() ? std::filesystem::path(options.results) / "figures" /
                                   (study.name + (study.preset.empty() ? "" : "-" + study.preset))
                             : std::filesystem::path(options.output);
  const std::vector<Wanted> all = wanted(options, study);
  figure_size(options);
  for (const auto& [key, name] : {std::pair("--x: ", options.x), std::pair("--y: ", options.y)})
    if (!name.empty()) try {
        report::check_value_name(name, result.records);
      } catch (const InputError& error) {
        throw InputError(key + error.diagnostics().front().message);
      }
  make_folder(out);  // what cannot be written is said once, not for every scene
  std::vector<std::string> files;
  bool drawn = true;
  int dropped = 0;
  try {
    for (const report::PlotFiles& plot : draw_all(all, options, input, store, out, dropped)) {
      for (const auto& file : {plot.svg, plot.pdf}) files.push_back(file.string());
      for (const std::string& why : plot.without) std::cerr << why << '\n';
    }
  } catch (const report::PlotError& error) {
    std::cerr << error.what() << '\n';
    drawn = false;
  }
  print_files(files, options.json);
  if (!drawn) return kEnvironment;
  if (files.empty()) return kNothing;
  return missing > 0 || dropped > 0 ? kIncomplete : kPass;
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
  app.add_option("--scene", options.scenes, "Only this scene; repeat it for each")
      ->allow_extra_args(false);
  app.add_option("--title", options.title, "Title above the figure");
  app.add_flag("--no-title", options.no_title, "No title above the figure")->excludes("--title");
  app.add_option("--width", options.width,
                 "Width of the figure on paper, as 84mm; its key then stands below");
  app.add_option("--height", options.height, "Its height, as 60mm (default: from its width)");
  app.add_option("--font", options.font, "Size of its text, as 8pt (default with --width: 8pt)");
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
                       "iterations --preset quick --x projections --y stretch.max\n  taut plot "
                       "iterations --preset quick --width 84mm --font 8pt\n"
                       "Exit: 0 drawn; 3 drawn, but for cases that were not run or a figure "
                       "that cannot be drawn; 4 nothing to draw",
                   .bind = taut::bind_verb<taut::verb::plot::add_options, taut::verb::plot::run>};
