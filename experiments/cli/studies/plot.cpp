#include "core/model/text.hpp"
#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/report/study_figures.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::plot {

namespace {

struct Options {
  std::string study, preset, kind, x, y, title, results, output;
  std::string width, height, font;
  std::vector<std::string> solvers, scenes;
  bool no_title = false, json = false;
};

/// The pictures that the command line requests; without --kind, --x and --y, those that the study
/// requests.
std::vector<report::FigureRequest> wanted(const Options& options, const Study& study) {
  using Title = report::FigureRequest::Title;
  std::vector<report::FigureRequest> all;
  if (options.kind.empty() && options.x.empty() && options.y.empty())
    all = report::figures_of(study);
  else
    all.push_back({.spec = {.kind = options.kind.empty() ? "work-precision" : options.kind,
                            .x = options.x,
                            .y = options.y,
                            .title = options.title}});
  const report::FigureSize size =
      report::parse_figure_size(options.width, options.height, options.font);
  for (report::FigureRequest& one : all) {
    one.spec.size = size;
    one.title = options.no_title        ? Title::none
                : options.title.empty() ? Title::single
                                        : Title::always;
  }
  return all;
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
  report::keep_chosen(result, options.solvers, options.scenes);
  const std::filesystem::path out =
      options.output.empty() ? std::filesystem::path(options.results) / "figures" /
                                   (study.name + (study.preset.empty() ? "" : "-" + study.preset))
                             : std::filesystem::path(options.output);
  const std::vector<report::FigureRequest> all = wanted(options, study);
  for (const auto& [key, name] : {std::pair("--x: ", options.x), std::pair("--y: ", options.y)})
    if (!name.empty()) try {
        report::check_value_name(name, result.records);
      } catch (const InputError& error) {
        throw InputError(key + error.diagnostics().front().message);
      }
  make_folder(out);  // reports a folder that cannot be written once, not for every scene
  report::StudyFigures figures;
  bool drawn = true;
  try {
    figures = report::draw_figures(all, input, store, out,
                                   [](const std::string& text) { progress() << text << '\n'; });
  } catch (const report::PlotError& error) {
    std::cerr << error.what() << '\n';
    drawn = false;
  }
  std::vector<std::string> files;
  for (const report::PlotFiles& plot : figures.files) {
    for (const auto& file : {plot.svg, plot.pdf}) files.push_back(file.string());
    for (const std::string& why : plot.without) std::cerr << why << '\n';
  }
  for (const std::string& why : figures.not_drawn) std::cerr << "not drawn: " << why << '\n';
  print_files(files, options.json);
  if (!drawn) return kEnvironment;
  if (files.empty()) return kNothing;
  return missing > 0 || !figures.not_drawn.empty() ? kIncomplete : kPass;
}

void add_options(Arguments& args, Options& options) {
  std::vector<std::string> names;
  for (const report::PlotKind& kind : report::plot_kinds()) names.emplace_back(kind.name);
  add_study(args, options.study).required();
  add_stored(args, options.preset, options.results);
  args.add_option("--kind", options.kind,
                  "One of: " + join(names, ", ") + " (default: what the study asks for)")
      .check(known("kind of plot", names));
  args.add_option("--x", options.x, "Value on x: dt, iterations, projections or a metric's value");
  args.add_option("--y", options.y, "Value on y, such as stretch.rms");
  add_solvers(args, options.solvers, "Only this solver");
  args.add_option("--scene", options.scenes, "Only this scene; repeat it for each").one_each();
  args.add_option("--title", options.title, "Title above the figure");
  args.add_flag("--no-title", options.no_title, "No title above the figure").excludes("--title");
  args.add_option("--width", options.width,
                  "Width of the figure on paper, as 84mm; puts the key below the figure");
  args.add_option("--height", options.height, "Its height, as 60mm (default: from its width)");
  args.add_option(
      "--font", options.font,
      "Size of its text, as 8pt (default with --width: " + as_typed(report::kPaperFont) + "pt)");
  add_output(args, options.output,
             "Where figures go (default: figures/STUDY or figures/STUDY-PRESET in the results)");
  add_json(args, options.json, "the names of the files");
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
