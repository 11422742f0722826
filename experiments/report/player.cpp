#include "experiments/report/player.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/report/axis.hpp"
#include "experiments/report/gnuplot.hpp"
#include "experiments/report/html.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

/// A chart over time [px] and the class of the pages that show it.
struct Variant {
  const char* name;
  int width, height;
};
/// Across the page, half of it, on a phone.
constexpr std::array kVariants{Variant{"wide", 1100, 190}, Variant{"half", 540, 170},
                               Variant{"phone", kPhoneWidth, 180}};

std::string data_uri(const std::string& type, const std::string& bytes) {
  return "data:" + type + ";base64," + base64(bytes);
}

std::string names(const Clip& clip) {
  std::string out = "<div class=\"who\">";
  for (const auto& [solver, settings] : clip.panels)
    out += "<span>" + solver_dot(solver) + "<b>" + escape_html(solver_title(solver)) + "</b> <em>" +
           escape_html(settings) + "</em></span>";
  return out + "</div>";
}

/// A film's bytes become its source when the script sees it coming: a page of many films opens as
/// fast as one with a few.
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
         "<video muted playsinline preload=\"auto\" aria-label=\"" + alt + "\" data-speed=\"" +
         exact(media.speed) + "\" data-frame=\"" + exact(media.frame) + "\" data-poster=\"" +
         exact(media.poster) + "\"" +
         (clip.poster.empty() ? ""
                              : " poster=\"" + data_uri(clip.poster_type, clip.poster) + "\"") +
         " data-src=\"" + data_uri(clip.type, clip.bytes) + "\"></video></div>";
}

/// In place of a panel: who does not run this scene, and why.
std::string refusal(const std::string& solver, const std::string& why) {
  return "<div class=\"refused\"><p>" + solver_dot(solver) + "<b>" +
         escape_html(solver_title(solver)) + "</b> cannot run this scene</p><p>" +
         escape_html(why) + "</p></div>";
}

std::string colour_bar(const ColourBar& bar) {
  if (bar.stops.empty()) return "";
  std::string stops, ticks;
  for (const std::string& stop : bar.stops) stops += "," + stop;
  for (std::size_t k = 0; k < bar.ticks.size(); ++k) {
    const auto& [at, label] = bar.ticks[k];
    // What lies beyond an end has the end's colour.
    const std::string beyond = k + 1 == bar.ticks.size()    ? "≥ "
                               : at == 0 && label[0] != '0' ? "≤ "
                                                            : "";
    ticks += "<span style=\"left:" + exact(std::round(1000 * at) / 10) + "%\">" + beyond +
             escape_html(label) + "</span>";
  }
  return "<div class=\"scale\"><p>" + escape_html(bar.title) +
         "</p><i style=\"background:" + "linear-gradient(90deg" + stops +
         ")\"></i><div class=\"ticks\">" + ticks + "</div></div>";
}

/// What the film covers of the scene's curves; all of them without a film.
std::vector<TimeSeries> curves_of(const Page& page, const std::string& scene, double until) {
  std::vector<TimeSeries> here;
  for (const TimeSeries& series : page.input().series) {
    if (series.scene != scene) continue;
    TimeSeries& part = here.emplace_back(series);
    const auto past = std::ranges::find_if(part.t, [&](double t) { return t > until + 1e-9; });
    part.t.erase(past, part.t.end());
    part.y.resize(std::min(part.y.size(), part.t.size()));
  }
  return here;
}

std::string attribute(const char* name, double v) {
  return std::string(" data-") + name + "=\"" + exact(v) + "\"";
}

/// Its plot area becomes attributes by which the playhead finds its place.
std::string plot(const std::string& svg, const PlotArea& area, const Variant& variant) {
  return std::string("<div class=\"plot ") + variant.name + "\"" +
         attribute("left", area.left / variant.width) +
         attribute("right", area.right / variant.width) + ">" + svg +
         "<div class=\"playhead\" hidden></div></div>";
}

/// Where the slider begins and ends below the plot: thumb and playhead in line.
std::string reach(const PlotArea& area, const Variant& variant) {
  const std::string name = std::string("--") + variant.name;
  return name + "-from:" + exact(area.left / variant.width) + ";" + name +
         "-to:" + exact(area.right / variant.width) + ";";
}

std::string timeline(Page& page, const std::string& scene, const std::string& value, double until,
                     bool half) {
  const std::vector<TimeSeries> here = curves_of(page, scene, until);
  const std::string heading = quantity(value).title + " over time, " + scene;
  std::string plots, style;
  Figure figure;
  try {
    for (const Variant& variant : kVariants) {
      if (half && &variant == &kVariants.front()) continue;
      std::string svg;
      Figure drawn = page.draw({.kind = "series",
                                .y = value,
                                .title = heading,
                                .width = variant.width,
                                .height = variant.height},
                               {{}, here}, svg);
      plots += plot(svg, drawn.area, variant);
      style += reach(drawn.area, variant);
      if (figure.table.rows.empty()) figure = std::move(drawn);
    }
  } catch (const InputError&) {
    return "";
  } catch (const PlotError& error) {
    return absent(error.what(), "");
  }
  const PlotArea& a = figure.area;
  return "<div class=\"timeline\"" + attribute("low", a.low) + attribute("high", a.high) + ">" +
         plots + "<input type=\"range\" class=\"scrub\" min=\"" + exact(a.low) + "\" max=\"" +
         exact(a.high) + "\" step=\"any\" value=\"" + exact(a.low) + "\" style=\"" + style +
         "\" aria-label=\"Simulated time of " + escape_html(scene) + " in seconds\" hidden>" +
         html_data(figure.table, heading, read_text(figure.csv), slug(scene) + "-series.csv") +
         "</div>";
}

/// "half", "one eighth"; "" in real time.
std::string pace(double speed) {
  if (speed >= 1) return "";
  return "<span class=\"pace\">" +
         (speed == 0.5 ? "half" : "1/" + std::to_string(std::lround(1 / speed)) + " of") +
         " real time</span>";
}

std::string controls(const std::string& scene, const SceneMedia& media) {
  const std::string of = "<span class=\"sr\"> " + escape_html(scene) + "</span>";
  return "<div class=\"controls\" hidden><button type=\"button\" class=\"play\"><span>play</span>" +
         of + "</button><button type=\"button\" class=\"back\" aria-label=\"One frame back, " +
         escape_html(scene) +
         "\">◂</button><button type=\"button\" class=\"forward\" aria-label=\"One frame forward, " +
         escape_html(scene) + "\">▸</button><span class=\"clock\"></span>" + pace(media.speed) +
         "<span class=\"hint\">space plays, ← → step a frame, drag the chart to scrub</span></div>";
}

}  // namespace

std::string scene_player(Page& page, const std::string& scene, bool half) {
  std::string stage, bar, buttons;
  double until = 1e300;
  for (const SceneMedia& media : page.input().media) {
    if (media.scene != scene) continue;
    for (const Clip& clip : media.clips) stage += picture(page, clip, media);
    for (const auto& [solver, why] : media.refused) stage += refusal(solver, why);
    bar = colour_bar(media.bar);
    buttons = controls(scene, media);
    until = media.duration;
  }
  const std::string chart = timeline(page, scene, "stretch.rms", until, half);
  if (stage.empty() && chart.empty()) return "";
  const std::string missing = stage.empty() ? absent("No pictures were rendered; this makes them:",
                                                     "taut render " + scene + " --video")
                                            : "";
  return (stage.empty() ? ""
                        : "<div class=\"stage\"><div class=\"clips\">" + stage + bar + "</div>" +
                              buttons + "</div>") +
         chart + missing;
}

}  // namespace taut::report
