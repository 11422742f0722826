#include <cmath>
#include <cstdio>

#include "experiments/render/picture/figure.hpp"

namespace taut {

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
      char time[32];
      std::snprintf(time, sizeof time, "t = %.2f s    ", frame.t);
      Canvas(panel).text({18 * u, 30 * u},
                         time + quantity_text(renderer.scale().quantity, live).front(),
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
