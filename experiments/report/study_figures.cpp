#include "experiments/report/study_figures.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

using Remark = std::function<void(const std::string&)>;

/// The `slope` of a plot, which is a theory's exponent; nothing if the plot has none.
std::optional<double> exponent(const std::string& text) {
  if (text.empty()) return {};
  const std::optional<double> value = whole<double>(text);
  if (!value || !std::isfinite(*value))
    throw InputError("slope = " + text + " in [[plot]]: expected a number");
  return value;
}

/// If the setting that is not on x has several values, keeps the cases at its commonest value.
/// Reports that to `remark` and returns the text for the title.
std::string hold_other(const PlotSpec& spec, Records& records, const std::string& scene,
                       const Remark& remark) {
  const std::string held = spec.x == "dt" ? kSweeps : "dt";
  const Slice slice = hold(records, held);
  const std::size_t left_out = records.size() - slice.records.size();
  records = slice.records;
  if (left_out == 0) return "";
  const std::string at = quantity(held).text(slice.value, 3);
  const std::string setting = held == "dt" ? "dt = " + at : at + " sweeps";
  remark(scene + ", " + spec.y + " over " + spec.x + ": " + setting + "; " +
         std::to_string(left_out) + " cases at other values are not drawn");
  return ", " + setting;
}

/// Panel of one scene. A setting that is neither on an axis nor orders the curves is held at its
/// commonest value.
PlotPanel panel_of(const FigureRequest& want, const PlotKind& kind, const StudyResult& study,
                   const std::string& scene, const Store& store, const Remark& remark) {
  using Content = PlotKind::Content;
  const PlotSpec& spec = want.spec;
  PlotPanel panel{scene, study.records, {}, want.slope};
  std::erase_if(panel.records, [&](const Record* r) { return r->scene != scene; });
  if (kind.slope == PlotKind::Slope::one) panel.slope = 1;
  if (kind.content != Content::maps) panel.title += hold_other(spec, panel.records, scene, remark);
  if (kind.content == Content::series) panel.series = stored_series(panel.records, spec.y, store);
  const ValueSpec* value = find_value(spec.y).second;
  if (const auto slope = study.slopes.find(scene);
      slope != study.slopes.end() && kind.slope == PlotKind::Slope::of_scene && spec.x == kSweeps &&
      !panel.slope && value && value->falls_with_sweeps)
    panel.slope = slope->second;
  return panel;
}

/// Draws a figure of these scenes. The title of a figure with a single scene includes its name.
/// With several panels, each has a title, and the figure has one only if requested.
PlotFiles draw(FigureRequest want, const StudyResult& study, const std::vector<std::string>& scenes,
               const Store& store, const std::filesystem::path& out, const Remark& remark) {
  PlotSpec& spec = want.spec;
  const PlotKind& kind = find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  std::vector<PlotPanel> panels;
  for (const std::string& scene : scenes)
    panels.push_back(panel_of(want, kind, study, scene, store, remark));
  if (spec.title.empty())
    spec.title = capitalised(quantity(spec.y).title) + " over " + quantity(spec.x).title;
  if (panels.size() == 1) spec.title += ", " + panels.front().title;
  if (want.title == FigureRequest::Title::none ||
      (panels.size() > 1 && want.title != FigureRequest::Title::always))
    spec.title.clear();
  Records drawn;
  for (const PlotPanel& panel : panels)
    drawn.insert(drawn.end(), panel.records.begin(), panel.records.end());
  if (const std::string unequal = unequal_work(drawn); !unequal.empty())
    spec.remark = "unequal work: " + unequal;
  if (!spec.remark.empty()) remark(spec.remark);
  if (spec.file.empty()) spec.file = spec.kind + "-" + spec.y + "-over-" + spec.x;
  spec.file = slug((scenes.size() == 1 ? scenes.front() + "-" : "") + spec.file);
  return make_plot(spec, panels, out);
}

/// Scenes of each figure: all in one figure, but a map has a figure for each scene.
std::vector<std::vector<std::string>> panels_of(const PlotKind& kind,
                                                const std::vector<Record>& records) {
  std::vector<std::string> scenes;
  for (const Record& r : records) push_unique(scenes, r.scene);
  if (kind.content != PlotKind::Content::maps) return {scenes};
  std::vector<std::vector<std::string>> sets;
  for (const std::string& scene : scenes) sets.push_back({scene});
  return sets;
}

/// Keeps the records whose name is in `names`, the values of an option. `name_of` returns a
/// record's name.
template <class NameOf>
void keep_named(const char* option, std::vector<Record>& records,
                const std::vector<std::string>& names, NameOf name_of) {
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

PlotFiles draw_profile(PlotSpec spec, const FigureRequest& want, const ReportInput& input,
                       const std::filesystem::path& out) {
  if (!input.bench)
    throw InputError("no cost was measured: taut bench " + input.studies.front().name);
  if (spec.title.empty() && want.title != FigureRequest::Title::none)
    spec.title = "How often each solver is near the cheapest";
  return make_profile_plot(spec, *input.bench, out);
}

}  // namespace

std::vector<FigureRequest> figures_of(const Study& study) {
  std::vector<FigureRequest> all;
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

void keep_chosen(StudyResult& study, const std::vector<std::string>& solvers,
                 const std::vector<std::string>& scenes) {
  keep_named("--solver", study.records, solvers, [](const Record& r) { return r.solver; });
  keep_named("--scene", study.records, scenes, [](const Record& r) { return r.scene; });
}

StudyFigures draw_figures(const std::vector<FigureRequest>& wanted, const ReportInput& input,
                          const Store& store, const std::filesystem::path& folder,
                          const Remark& remark) {
  const StudyResult& study = input.studies.front();
  StudyFigures figures;
  for (const FigureRequest& want : wanted) {
    const PlotKind& kind = find_plot_kind(want.spec.kind);
    if (kind.content == PlotKind::Content::profile) {
      figures.files.push_back(draw_profile(want.spec, want, input, folder));
      continue;
    }
    for (const std::vector<std::string>& scenes : panels_of(kind, study.records)) try {
        figures.files.push_back(draw(want, study, scenes, store, folder, remark));
      } catch (const FigureNotWritten&) {
        throw;
      } catch (const InputError& error) {
        figures.not_drawn.emplace_back(error.what());
      }
  }
  return figures;
}

}  // namespace taut::report
