#include "experiments/render/picture/figure.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr Rgb8 kAlarm = rgb(0xB3261E);

/// "t = 2.48 s    max |ε| = 4.10 %    mean ε = +0.72 %    33 × 33 vertices"
std::string caption(const SceneRenderer& renderer, const RecordedRun& run, double t) {
  const Scene& scene = renderer.scene();
  const auto& frame = run.at(t);
  std::vector<std::string> parts{"t = " + decimal(frame.t, 2) + " s"};
  const LiveFigures live = live_figures(scene, frame.state, frame.t);
  for (std::string& part : caption_of(renderer.scale().colour_by, live))
    parts.push_back(std::move(part));
  parts.push_back(scene.mesh.grid ? std::to_string(scene.mesh.grid->nu) + " × " +
                                        std::to_string(scene.mesh.grid->nv) + " vertices"
                                  : std::to_string(scene.mesh.size()) + " vertices");
  return join(parts, "      ");
}

void draw_title(Canvas& canvas, const RecordedRun& run, Point corner, const PageLayout& layout) {
  const double u = layout.unit, left = corner.x + 70 * u;
  const double available = layout.panel_width - 90 * u, y = corner.y + 0.62 * layout.header;
  canvas.disc({corner.x + 45 * u, y - 9 * u}, 9 * u, run.colour);
  const double settings = run.settings.empty() ? 0 : text_width("   " + run.settings, 21 * u);
  const double title = text_width(run.title, 27 * u, Weight::bold);
  const double shrink = std::min(1.0, available / (title + settings));
  const double advance = canvas.text({left, y}, run.title, {27 * u * shrink, kInk, Weight::bold});
  if (!run.settings.empty())
    canvas.text({left + advance, y}, "   " + run.settings, {21 * u * shrink, kMuted});
}

/// An inset in a panel's upper right corner that shows the cloth laid flat [px].
struct Flat {
  static constexpr int kRim = 3;
  int side, margin;
  explicit Flat(const PageLayout& layout)
      : side(std::min(layout.panel_height / 5, layout.panel_width / 4)),
        margin(layout.panel_height / 28) {}

  /// True if part of a run's cloth lies behind the inset.
  bool hides(const SceneRenderer& renderer, std::size_t run, double t) const {
    const auto edge = [&](int pixels) {
      return 1 - 2.f * static_cast<float>(side + margin + kRim) / static_cast<float>(pixels);
    };
    const float x = edge(renderer.options().width), y = edge(renderer.options().height);
    return std::ranges::any_of(renderer.projected(run, t), [&](const auto& p) {
      return p.x() > x && p.x() < 1 && p.y() > y && p.y() < 1;
    });
  }

  void add(Image& panel, const SceneRenderer& renderer, std::size_t run, double t) const {
    const Image flat = renderer.material_space(run, t, side);
    if (flat.width() == 0) return;
    const int x = panel.width() - margin - flat.width(), y = margin;
    Canvas(panel).fill_rounded(x - kRim, y - kRim, flat.width() + 2 * kRim,
                               flat.height() + 2 * kRim, kRim, rgb(0x4A5361));
    panel.paste(flat, x, y);
  }
};

/// A run's panel, with its inset and texts.
Image panel_of(const SceneRenderer& renderer, const PageLayout& layout, std::size_t run, double t,
               bool with_flat) {
  const double u = layout.unit;
  const Flat flat(layout);
  Image panel = renderer.panel(run, t);
  if (with_flat) flat.add(panel, renderer, run, t);
  if (layout.has_text()) {
    const bool light = renderer.options().theme.top.g > 128;
    const std::string line = caption(renderer, renderer.runs()[run], t);
    const double room = layout.panel_width - 48 * u - (with_flat ? flat.side + flat.margin : 0);
    const double size = 19 * u * std::min(1.0, room / text_width(line, 19 * u));
    Canvas(panel).text({24 * u, 38 * u}, line, {size, light ? kMuted : rgb(0xC3CBD8)});
  }
  mark_absence(panel, renderer, run, t, u);
  return panel;
}

void draw_footer(Canvas& canvas, const SceneRenderer& renderer, const PageLayout& layout,
                 const std::vector<double>& times) {
  const double u = layout.unit, top = layout.height - layout.footer;
  const TextStyle label{18 * u, kMuted, Weight::regular, Align::centre};
  const ColourScale& scale = renderer.scale();
  canvas.text({layout.width / 2.0, top + 30 * u}, scale.title(), label);
  const double width = std::min(690 * u, 0.6 * layout.width), x = (layout.width - width) / 2;
  draw_colour_bar(canvas, scale, {x, top + 43 * u, width, 21 * u}, u);
  if (scale.colour_by == ColourBy::strain && x > 160 * u) {
    canvas.text({x - 36 * u, top + 60 * u}, "compressed",
                {18 * u, kMuted, Weight::regular, Align::right});
    canvas.text({x + width + 36 * u, top + 60 * u}, "stretched", {18 * u, kMuted});
  }
  const bool hatched = std::ranges::any_of(renderer.runs(), [&](const RecordedRun& run) {
    return std::ranges::any_of(times, [&](double t) {
      const auto& frame = run.at(t);
      return live_figures(renderer.scene(), frame.state, frame.t).max_depth >
             renderer.hatch_depth();
    });
  });
  if (hatched && layout.columns > 1)
    canvas.text(
        {layout.width - 24 * u, top + 98 * u},
        "hatched: over " + general(1e3 * renderer.hatch_depth(), 2) + " mm inside the collider",
        {15.5 * u, kMuted, Weight::regular, Align::right});
}

}  // namespace

std::string strain_text(double value, bool sign) {
  const double size = std::abs(100 * value);
  const std::string digits = decimal(size, size < 9.995 ? 2 : size < 99.95 ? 1 : 0) + " %";
  return (sign ? value < 0 ? "\u2212" : "+" : "") + digits;
}

std::vector<std::string> caption_of(ColourBy colour_by, const LiveFigures& live) {
  switch (colour_by) {
    case ColourBy::strain:
      return {"max |ε| = " + strain_text(live.max_strain, false),
              "mean ε = " + strain_text(live.mean_strain, true)};
    case ColourBy::penetration:
      return {"max depth = " + general(1e3 * live.max_depth, 3) + " mm"};
    case ColourBy::speed:
      break;
  }
  return {"max |v| = " + general(live.max_speed, 3) + " m/s"};
}

int PageLayout::columns_of(int panels) { return panels == 4 ? 2 : std::min(panels, 3); }

PageLayout PageLayout::page(int width, int height, int panels) {
  PageLayout p{.width = width, .height = height, .columns = columns_of(panels)};
  p.rows = (panels + p.columns - 1) / p.columns;
  p.unit = std::min(height / 1080.0, width / 1920.0 * (panels == 1 ? 1.6 : 1));
  p.header = static_cast<int>(std::lround(66 * p.unit));
  p.footer = static_cast<int>(std::lround(126 * p.unit));
  p.gap = static_cast<int>(std::lround(4 * p.unit));
  p.panel_width = (width - (p.columns - 1) * p.gap) / p.columns;
  p.panel_height = (height - p.footer - (p.rows - 1) * p.gap) / p.rows - p.header;
  return p;
}

PageLayout PageLayout::sheet(int panel_width, int panel_height, int runs, int moments) {
  PageLayout p{.columns = runs, .rows = moments, .unit = panel_height / 514.0};
  p.header = static_cast<int>(std::lround(66 * p.unit));
  p.footer = static_cast<int>(std::lround(126 * p.unit));
  p.gap = 6;
  p.panel_width = panel_width;
  p.panel_height = panel_height;
  p.width = runs * (panel_width + p.gap) - p.gap;
  p.height = p.header + moments * (panel_height + p.gap) + p.footer;
  return p;
}

PageLayout PageLayout::bare(int width, int height, int panels) {
  const int columns = columns_of(panels), rows = (panels + columns - 1) / columns;
  return {.width = width,
          .height = height,
          .columns = columns,
          .rows = rows,
          .unit = height / rows / 836.0,
          .panel_width = width / columns,
          .panel_height = height / rows};
}

std::pair<int, int> PageLayout::corner(std::size_t run, std::size_t moment) const {
  const int column = static_cast<int>(run) % columns, row = static_cast<int>(run) / columns;
  return {column * (panel_width + gap),
          (row + 1) * header + (row + static_cast<int>(moment)) * (panel_height + gap)};
}

Image compose(const SceneRenderer& renderer, const PageLayout& layout,
              const std::vector<double>& times) {
  Image picture(layout.width, layout.height,
                layout.has_text() ? rgb(0xFFFFFF) : renderer.options().theme.top);
  Canvas canvas(picture);
  for (std::size_t m = 0; m < times.size(); ++m) {
    // A sheet may reach into the corner in the first moments; then no panel shows the inset.
    bool flats = true;
    for (std::size_t k = 0; k < renderer.runs().size(); ++k)
      flats = flats && !Flat(layout).hides(renderer, k, times[m]);
    for (std::size_t k = 0; k < renderer.runs().size(); ++k) {
      const auto [x, y] = layout.corner(k, m);
      picture.paste(panel_of(renderer, layout, k, times[m], flats), x, y);
      if (layout.has_text() && m == 0)
        draw_title(canvas, renderer.runs()[k], {1.0 * x, 1.0 * y - layout.header}, layout);
    }
  }
  if (layout.has_text()) draw_footer(canvas, renderer, layout, times);
  return picture;
}

void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const BarPlace& place, double unit) {
  const double x = place.x, y = place.y, width = place.width, height = place.height;
  const int columns = static_cast<int>(width);
  for (int k = 0; k < columns; ++k)
    canvas.fill(std::floor(x) + k, y, 1, height, scale.map().at(1.0 * k / (columns - 1)));
  const double gap = 1.5 * unit, tip = 16 * unit, left = std::floor(x), right = left + columns;
  const auto arrow = [&](double base, double direction, double s) {
    canvas.triangle(
        {Point{base, y}, Point{base, y + height}, Point{base + direction * tip, y + height / 2}},
        scale.map().at(s));
  };
  if (scale.low() < 0) arrow(left - gap, -1, 0);
  arrow(right + gap, 1, 1);
  for (const double value : scale.ticks()) {
    const double at = left + scale.position(value) * columns;
    canvas.fill(std::round(at) - 0.5, y + height, 1, 8 * unit, kMuted);
    canvas.text({at, y + height + 28 * unit}, scale.text(value),
                {18 * unit, kInk, Weight::regular, Align::centre});
  }
}

namespace {

/// Draws a line of text on a plate in the lower left corner.
void plate(Image& panel, const std::string& text, Rgb8 colour, double unit) {
  Canvas canvas(panel);
  const double size = std::max(11.0, 19 * unit), wide = text_width(text, size, Weight::bold);
  const double x = 24 * unit, y = panel.height() - 24 * unit - 2 * size;
  canvas.fill_rounded(x, y, wide + 2 * size, 2 * size, size * 0.4, colour);
  canvas.text({x + size, y + 1.35 * size}, text, {size, rgb(0xFFFFFF), Weight::bold});
}

}  // namespace

void mark_stop(Image& panel, const RecordedRun::Stop& stop, double unit) {
  Canvas canvas(panel);
  const double edge = std::max(3.0, 5 * unit);
  const double width = panel.width(), height = panel.height();
  canvas.fill(0, 0, width, edge, kAlarm);
  canvas.fill(0, height - edge, width, edge, kAlarm);
  canvas.fill(0, 0, edge, height, kAlarm);
  canvas.fill(width - edge, 0, edge, height, kAlarm);
  plate(panel, stop.why + " after t = " + decimal(stop.t, 2) + " s: last good state", kAlarm, unit);
}

void mark_absence(Image& panel, const SceneRenderer& renderer, std::size_t run, double t,
                  double unit) {
  const auto& stop = renderer.runs()[run].stop;
  if (stop && t > stop->t)
    mark_stop(panel, *stop, unit);
  else if (!renderer.in_sight(run, t))
    plate(panel, "has left the picture", rgb(0x4A5361), unit);
}

}  // namespace taut
