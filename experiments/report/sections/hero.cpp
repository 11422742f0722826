#include <algorithm>

#include "core/model/input_error.hpp"
#include "experiments/report/axis.hpp"
#include "experiments/report/gnuplot.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report {

namespace {

constexpr int kWidth = 1100;  ///< px of the chart over time

std::string data_uri(const std::string& type, const std::string& bytes) {
  return "data:" + type + ";base64," + base64(bytes);
}

std::string names(const Clip& clip) {
  std::string out = "<div class=\"who\">";
  for (const auto& [solver, settings] : clip.panels)
    out += "<span>" + solver_dot(solver) + "<b>" + escape_html(solver_title(solver)) + "</b> " +
           escape_html(settings) + "</span>";
  return out + "</div>";
}

std::string picture(Page& page, const Clip& clip, const SceneMedia& media) {
  const std::size_t weight = (clip.bytes.size() + clip.poster.size()) * 4 / 3;
  if (clip.bytes.empty() || weight > page.media_budget)
    return absent("A picture was left out to keep this page small.", "");
  page.media_budget -= weight;
  const std::string alt = escape_html(clip.alt);
  if (!clip.type.starts_with("video/"))
    return "<div class=\"clip\">" + names(clip) + "<img alt=\"" + alt + "\" src=\"" +
           data_uri(clip.type, clip.bytes) + "\"></div>";
  return "<div class=\"clip\">" + names(clip) +
         "<video muted playsinline preload=\"auto\" aria-label=\"" + alt + "\" data-duration=\"" +
         exact(media.duration) + "\" data-speed=\"" + exact(media.speed) + "\"" +
         (clip.poster.empty() ? "" : " poster=\"" + data_uri("image/png", clip.poster) + "\"") +
         " src=\"" + data_uri(clip.type, clip.bytes) + "\"></video></div>";
}

/// Strain over time; its plot area becomes attributes by which the playhead finds its place.
std::string timeline(Page& page, const std::string& value) {
  std::vector<TimeSeries> here;
  for (const TimeSeries& series : page.input().series)
    if (series.scene == page.hero()) here.push_back(series);
  std::string svg;
  const Quantity q = quantity(value);
  try {
    const Figure figure = page.draw({.kind = "series",
                                     .y = value,
                                     .title = q.title + " over time, " + page.hero(),
                                     .width = kWidth,
                                     .height = 190},
                                    {{}, here}, svg);
    const PlotArea& a = figure.area;
    const auto attribute = [](const char* name, double v) {
      return std::string(" data-") + name + "=\"" + exact(v) + "\"";
    };
    return "<div class=\"timeline\"" + attribute("left", a.left / kWidth) +
           attribute("right", a.right / kWidth) + attribute("low", a.low) +
           attribute("high", a.high) +
           "><div class=\"scroll\" tabindex=\"0\" role=\"group\" "
           "aria-label=\"" +
           escape_html(q.title) + " over time\"><div class=\"plot\">" + svg +
           "<div class=\"playhead\" hidden></div></div></div>" +
           "<input type=\"range\" class=\"scrub\" min=\"" + exact(a.low) + "\" max=\"" +
           exact(a.high) + "\" step=\"any\" value=\"" + exact(a.low) +
           // Below the plot area, half a thumb wider at either end: thumb and playhead stay in
           // line.
           "\" style=\"--from:" + exact(a.left / kWidth) + ";--to:" + exact(a.right / kWidth) +
           "\" aria-label=\"Simulated time in seconds\" hidden>" +
           html_data(figure.table, q.title + " over time", read_file(figure.csv),
                     page.hero() + "-series.csv") +
           "</div>";
  } catch (const InputError&) {
    return "";
  } catch (const PlotError& error) {
    return absent(error.what(), "");
  }
}

std::string controls() {
  return "<div class=\"controls\" hidden><button type=\"button\" id=\"play\">play</button>"
         "<button type=\"button\" id=\"back\" aria-label=\"One frame back\">◂</button>"
         "<button type=\"button\" id=\"forward\" aria-label=\"One frame forward\">▸</button>"
         "<output id=\"clock\">0.00 s</output><span class=\"hint\">space plays, ← → step a frame, "
         "drag the chart to scrub</span></div>";
}

std::string render(Page& page, const std::string&) {
  const std::string& scene = page.hero();
  std::string stage;
  for (const SceneMedia& media : page.input().media)
    if (media.scene == scene)
      for (const Clip& clip : media.clips) stage += picture(page, clip, media);
  const std::string chart = timeline(page, "stretch.rms");
  if (stage.empty() && chart.empty()) return "";
  const std::string missing = stage.empty() ? absent("No pictures were rendered; this makes them:",
                                                     "taut render " + scene + " --video")
                                            : "";
  return "<section id=\"hero\" class=\"card hero\" aria-label=\"" + escape_html(scene) +
         " side by side\">" +
         (stage.empty() ? "" : "<div class=\"stage\">" + stage + controls() + "</div>") + chart +
         missing + "</section>\n";
}

}  // namespace
}  // namespace taut::report

TAUT_SECTION(hero) = {.name = "hero", .order = 10, .render = taut::report::render};
