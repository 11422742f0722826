#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/report/axis.hpp"
#include "experiments/report/gnuplot.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/report.hpp"
#include "experiments/report/section.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

std::vector<std::string> scene_names(const ReportInput& input) {
  std::vector<std::string> names;
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records)
      if (std::ranges::find(names, r.scene) == names.end()) names.push_back(r.scene);
  return names;
}

/// Filmed scenes that no study ran.
std::size_t others(const ReportInput& input) {
  const std::vector<std::string> studied = scene_names(input);
  return static_cast<std::size_t>(std::ranges::count_if(input.media, [&](const SceneMedia& media) {
    return std::ranges::find(studied, media.scene) == studied.end();
  }));
}

/// Scenes that show most come first when one has to stand on top.
constexpr std::array<std::string_view, 4> kShowpieces{"ball", "drape", "flag", "hang"};

std::string hero_scene(const ReportInput& input, const std::vector<std::string>& scenes) {
  const auto filmed = [&](std::string_view scene) {
    return std::ranges::any_of(input.media, [&](const SceneMedia& media) {
      return media.scene == scene && !media.clips.empty();
    });
  };
  const auto curved = [&](std::string_view scene) {
    return std::ranges::find(input.series, scene, &TimeSeries::scene) != input.series.end();
  };
  std::vector<std::string> order;
  for (const std::string_view scene : kShowpieces)
    if (std::ranges::find(scenes, scene) != scenes.end()) order.emplace_back(scene);
  order.insert(order.end(), scenes.begin(), scenes.end());
  for (const auto& scene : order)
    if (filmed(scene)) return scene;
  for (const auto& scene : order)
    if (curved(scene)) return scene;
  return order.front();
}

}  // namespace

Page::Page(const ReportInput& input, std::filesystem::path scratch)
    : media_budget(report_limit(scene_names(input).size(), others(input)) * 2 / 3),
      input_(input),
      scratch_(std::move(scratch)),
      facts_(compare(input)),
      scenes_(scene_names(input)),
      hero_(hero_scene(input, scenes_)) {}

std::vector<Record> Page::sweep(const std::string& scene, const std::string& setting,
                                const std::string& needs) const {
  std::vector<Record> best;
  std::size_t most = 1;
  for (const StudyResult& study : input_.studies) {
    std::vector<Record> here;
    std::set<double> values;
    bool any = needs.empty();
    for (const Record& r : study.records) {
      const double value = value_of(r, setting);
      if (r.scene != scene || !std::isfinite(value)) continue;
      any = any || std::isfinite(value_of(r, needs));
      values.insert(value);
      here.push_back(r);
    }
    if (any && values.size() > most) most = values.size(), best = std::move(here);
  }
  return best;
}

Figure Page::draw(FigureSpec spec, const FigureData& data, std::string& svg) {
  const std::string id = "f" + std::to_string(++figures_);
  // The heading is text of the page; in the picture it would only repeat itself.
  const std::string title = std::exchange(spec.title, "");
  spec.legend = false;
  spec.formats = {Format::svg};
  spec.file = id + "-" + slug(spec.file.empty() ? spec.kind : spec.file);
  Figure figure = make_figure(spec, data, scratch_);
  svg = inline_svg(read_text(figure.svg), id, title, figure.description);
  return figure;
}

std::string Page::figure(FigureSpec spec, const FigureData& data, const std::string& heading,
                         const std::string& caption, const std::string& classes) {
  std::string svg, phone, note;
  Figure figure;
  try {
    figure = draw(spec, data, svg);
    FigureSpec narrow = spec;
    narrow.width = kPhoneWidth, narrow.height = std::min(spec.height, 330);
    draw(narrow, data, phone);
  } catch (const PlotError& error) {
    note = absent(error.what(), "");
    const FigureEntry& entry = find_figure(spec.kind);
    if (spec.x.empty()) spec.x = entry.x;
    if (spec.y.empty()) spec.y = entry.y;
    if (spec.along.empty()) spec.along = spec.x == "dt" ? "dt" : entry.along;
    const Drawing drawing = entry.draw(spec, data);
    figure.table = drawing.table;
    figure.csv = scratch_ / ("f" + std::to_string(figures_) + "-" + slug(spec.kind) + ".csv");
    write_file(figure.csv, drawing.csv);
  } catch (const InputError&) {
    return "";  // nothing to draw
  }
  return "<figure class=\"card " + classes + "\"><figcaption><h4>" + escape_html(heading) +
         "</h4><p>" + caption + "</p></figcaption>" +
         (svg.empty()
              ? note
              : "<div class=\"broad\">" + svg + "</div><div class=\"narrow\">" + phone + "</div>") +
         html_data(figure.table, heading, read_text(figure.csv), figure.csv.filename().string()) +
         "</figure>\n";
}

}  // namespace taut::report
