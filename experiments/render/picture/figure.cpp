#include "experiments/render/picture/figure.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

constexpr Rgb8 kAlarm = rgb(0xB3261E);

/// "t = 2.48 s    max |ε| = 4.10 %    mean ε = +0.72 %    33 × 33 vertices"
std::vector<std::string> caption(const SceneRenderer& renderer, const RecordedRun& run, double t) {
  const Scene& scene = renderer.scene();
  const auto& frame = run.at(t);
  std::vector<std::string> parts{formatted("t = %.2f s", frame.t)};
  const LiveFigures live = live_figures(scene, frame.state, frame.t);
  for (std::string& part : caption_of(renderer.scale().colour_by, live))
    parts.push_back(std::move(part));
  parts.push_back(scene.mesh.grid ? std::to_string(scene.mesh.grid->nu) + " × " +
                                        std::to_string(scene.mesh.grid->nv) + " vertices"
                                  : std::to_string(scene.mesh.size()) + " vertices");
  return parts;
}

void draw_header(Canvas& canvas, const SceneRenderer& renderer, const RecordedRun& run, double t,
                 Point corner, const PageLayout& layout) {
  const double u = layout.unit, left = corner.x + 70 * u;
  const double available = layout.panel_width - 90 * u;
  const double title_y = corner.y + 0.42 * layout.header, line_y = corner.y + 0.76 * layout.header;
  canvas.disc({corner.x + 45 * u, title_y - 9 * u}, 9 * u, run.colour);
  const double settings = run.settings.empty() ? 0 : text_width("   " + run.settings, 21 * u);
  const double title = text_width(run.title, 27 * u, Weight::bold);
  const double shrink = std::min(1.0, available / (title + settings));
  const double advance =
      canvas.text({left, title_y}, run.title, {27 * u * shrink, kInk, Weight::bold});
  if (!run.settings.empty())
    canvas.text({left + advance, title_y}, "   " + run.settings, {21 * u * shrink, kMuted});
  const std::string line = join(caption(renderer, run, t), "      ");
  const double size = 19 * u * std::min(1.0, available / text_width(line, 19 * u));
  canvas.text({left, line_y}, line, {size, kMuted});
}

void draw_inset(Image& picture, const SceneRenderer& renderer, std::size_t run, double t,
                Point panel, const PageLayout& layout) {
  const double u = layout.unit;
  const int side =
      static_cast<int>(std::min(0.18 * layout.panel_width, 0.22 * layout.panel_height));
  const Image flat = renderer.material_space(run, t, side);
  if (flat.width() == 0) return;
  const double label = 15.5 * u, pad = 7 * u;
  const double width =
      std::max<double>(flat.width(), text_width("material space", label)) + 2 * pad;
  const double height = flat.height() + 2 * pad + 1.9 * label;
  const double x = panel.x + layout.panel_width - 20 * u - width, y = panel.y + 22 * u;
  Canvas canvas(picture);
  canvas.fill_rounded(x, y, width, height, 8 * u, rgb(0xFFFFFF), 0.92);
  picture.paste(flat, static_cast<int>(std::lround(x + (width - flat.width()) / 2)),
                static_cast<int>(std::lround(y + pad)));
  canvas.text({x + width / 2, y + height - 0.85 * label}, "material space",
              {label, kMuted, Weight::regular, Align::centre});
}

void draw_footer(Canvas& canvas, const SceneRenderer& renderer, const PageLayout& layout,
                 double t) {
  const double u = layout.unit, top = layout.height - layout.footer;
  const TextStyle label{18 * u, kMuted, Weight::regular, Align::centre};
  const ColourScale& scale = renderer.scale();
  canvas.text({layout.width / 2.0, top + 30 * u}, scale.title(), label);
  const double width = 690 * u, x = (layout.width - width) / 2;
  draw_colour_bar(canvas, scale, {x, top + 43 * u, width, 21 * u}, u);
  if (scale.colour_by == ColourBy::strain) {
    canvas.text({x - 36 * u, top + 60 * u}, "compressed",
                {18 * u, kMuted, Weight::regular, Align::right});
    canvas.text({x + width + 36 * u, top + 60 * u}, "stretched", {18 * u, kMuted});
  }
  const bool hatched = std::ranges::any_of(renderer.runs(), [&](const RecordedRun& run) {
    const auto& frame = run.at(t);
    return live_figures(renderer.scene(), frame.state, frame.t).max_depth > renderer.hatch_depth();
  });
  if (hatched && layout.columns > 1)
    canvas.text(
        {layout.width - 24 * u, top + 98 * u},
        formatted("hatched: over %.2g mm inside the collider", 1e3 * renderer.hatch_depth()),
        {15.5 * u, kMuted, Weight::regular, Align::right});
}

}  // namespace

std::string strain_text(double value, bool sign) {
  const double size = std::abs(100 * value);
  const std::string digits = formatted(size < 9.995   ? "%.2f %%"
                                       : size < 99.95 ? "%.1f %%"
                                                      : "%.0f %%",
                                       size);
  return (sign ? value < 0 ? "\u2212" : "+" : "") + digits;
}

std::vector<std::string> caption_of(ColourBy colour_by, const LiveFigures& live) {
  switch (colour_by) {
    case ColourBy::strain:
      return {"max |ε| = " + strain_text(live.max_strain, false),
              "mean ε = " + strain_text(live.mean_strain, true)};
    case ColourBy::penetration:
      return {"max depth = " + formatted("%.3g mm", 1e3 * live.max_depth)};
    case ColourBy::speed:
      break;
  }
  return {"max |v| = " + formatted("%.3g m/s", live.max_speed)};
}

PageLayout::PageLayout(int w, int h, int panels)
    : width(w),
      height(h),
      columns(panels == 4 ? 2 : panels),
      rows(panels == 4 ? 2 : 1),
      unit(std::min(h / 1080.0, w / 1920.0 * (panels == 1 ? 1.6 : 1))) {
  header = static_cast<int>(std::lround((rows == 1 ? 118 : 96) * unit));
  footer = static_cast<int>(std::lround(126 * unit));
  panel_width = width / columns;
  panel_height = (height - footer) / rows - header;
}

Image compose(const SceneRenderer& renderer, const PageLayout& layout, double t) {
  Image picture(layout.width, layout.height, rgb(0xFFFFFF));
  Canvas canvas(picture);
  for (std::size_t k = 0; k < renderer.runs().size(); ++k) {
    const int column = static_cast<int>(k) % layout.columns;
    const int row = static_cast<int>(k) / layout.columns;
    const int x = column * layout.panel_width;
    const int y = row * (layout.header + layout.panel_height);
    const RecordedRun& run = renderer.runs()[k];
    Image panel = renderer.panel(k, t);
    mark_absence(panel, renderer, k, t, layout.unit);
    picture.paste(panel, x, y + layout.header);
    draw_header(canvas, renderer, run, t, {1.0 * x, 1.0 * y}, layout);
    draw_inset(picture, renderer, k, t, {1.0 * x, 1.0 * y + layout.header}, layout);
    canvas.fill(x, y + layout.header - 1, layout.panel_width, 1, kRule);
    canvas.fill(x, y + layout.header + layout.panel_height, layout.panel_width, 1, kRule);
    if (column > 0) canvas.fill(x, y + layout.header, 1, layout.panel_height, kRule);
  }
  draw_footer(canvas, renderer, layout, t);
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

/// A line of text on a plate, in the lower left corner.
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
  plate(panel, stop.why + formatted(" after t = %.2f s: last good state", stop.t), kAlarm, unit);
}

void mark_absence(Image& panel, const SceneRenderer& renderer, std::size_t run, double t,
                  double unit) {
  const auto& stop = renderer.runs()[run].stop;
  if (stop && t > stop->t)
    mark_stop(panel, *stop, unit);
  else if (!renderer.in_sight(run, t))
    plate(panel, "has left the picture", rgb(0x4A5361), unit);
}

Image compose_sheet(const SceneRenderer& renderer, const std::vector<double>& times) {
  const int wide = renderer.options().width, high = renderer.options().height, gap = 6;
  const double u = high / 400.0;
  const Rgb8 background = renderer.options().theme.top;
  const Rgb8 on_background = background.g > 128 ? kMuted : rgb(0xC3CBD8);
  const int head = static_cast<int>(64 * u), foot = static_cast<int>(96 * u);
  const int columns = static_cast<int>(renderer.runs().size());
  const int rows = static_cast<int>(times.size());
  Image picture(columns * (wide + gap) - gap, head + rows * (high + gap) + foot, rgb(0xFFFFFF));
  Canvas canvas(picture);
  for (int column = 0; column < columns; ++column) {
    const auto index = static_cast<std::size_t>(column);
    const RecordedRun& run = renderer.runs()[index];
    const double x = column * (wide + gap) + 18 * u;
    canvas.disc({x + 8 * u, 34 * u}, 7 * u, run.colour);
    const double room = wide - 60 * u, gap_width = 14 * u;
    const double needed =
        text_width(run.title, 21 * u, Weight::bold) + gap_width + text_width(run.settings, 15 * u);
    const double shrink = std::min(1.0, room / needed);
    const double advance =
        canvas.text({x + 26 * u, 41 * u}, run.title, {21 * u * shrink, kInk, Weight::bold});
    canvas.text({x + 26 * u + advance + gap_width, 41 * u}, run.settings,
                {15 * u * shrink, kMuted});
    for (int row = 0; row < rows; ++row) {
      const double t = times[static_cast<std::size_t>(row)];
      Image panel = renderer.panel(index, t);
      if (run.stop && t > run.stop->t) mark_stop(panel, *run.stop, u * 0.8);
      const auto& frame = run.at(t);
      const LiveFigures live = live_figures(renderer.scene(), frame.state, frame.t);
      Canvas(panel).text({18 * u, 30 * u},
                         formatted("t = %.2f s    ", frame.t) +
                             caption_of(renderer.scale().colour_by, live).front(),
                         {15 * u, on_background});
      picture.paste(panel, column * (wide + gap), head + row * (high + gap));
    }
  }
  const double bar = std::min(460 * u, 0.6 * picture.width());
  const double top = head + rows * (high + gap);
  canvas.text({picture.width() / 2.0, top + 22 * u}, renderer.scale().title(),
              {13.5 * u, kMuted, Weight::regular, Align::centre});
  draw_colour_bar(canvas, renderer.scale(),
                  {(picture.width() - bar) / 2, top + 34 * u, bar, 15 * u}, 0.72 * u);
  return picture;
}

}  // namespace taut
