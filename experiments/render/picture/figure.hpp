#pragma once

#include "experiments/render/image/canvas.hpp"
#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

/// Colours of what is written on a page.
constexpr Rgb8 kInk = rgb(0x1B1F27), kMuted = rgb(0x5A6474);

/// As many runs as fit a picture.
inline constexpr int kMostPanels = 9;

/// Where the parts of a picture go; all in pixels. A panel for each run: up to three side by side,
/// more in rows of two or three; of several moments a row for each.
struct PageLayout {
  int width = 1920, height = 1080;
  int columns = 1, rows = 1;
  double unit = 1;  ///< of texts: 1 at a height of 1080
  int header = 0, footer = 0, gap = 0;
  int panel_width = 0, panel_height = 0;

  /// How many stand side by side: four in two rows, else up to three.
  static int columns_of(int panels);
  /// Titles above the panels and the colour bar below, in a picture of this size.
  static PageLayout page(int width, int height, int panels);
  /// The same around panels of this size.
  static PageLayout sheet(int panel_width, int panel_height, int runs, int moments);
  /// Panels alone: who shows the picture writes titles, captions and the colour bar itself.
  static PageLayout bare(int width, int height, int panels);

  bool has_text() const { return header > 0; }
  /// The upper left corner of a run's panel in a row of moments.
  std::pair<int, int> corner(std::size_t run, std::size_t moment) const;
};

/// "4.10 %", "27.4 %", "1153 %", with its sign if that is wanted: three digits are what is told
/// apart.
std::string strain_text(double value, bool sign);

/// What is written on a picture of this quantity: the strains, the depth or the speed of this
/// moment, "max depth = 1.5 mm".
std::vector<std::string> caption_of(ColourBy, const LiveFigures&);

/// A picture of all runs at these moments: panels with the cloth laid flat in a corner as long as
/// it hides none, live figures, titles, the colour bar. Panel sizes are those that the renderer was
/// made for. Precondition: one moment, or one row of runs.
Image compose(const SceneRenderer&, const PageLayout&, const std::vector<double>& times);

/// The colour bar with ticks, and arrows for what lies beyond its ends, in a band of the canvas.
/// The two outermost pixel columns of the bar itself have the exact colours of the ends.
struct BarPlace {
  double x = 0, y = 0, width = 0, height = 0;
};
void draw_colour_bar(Canvas&, const ColourScale&, const BarPlace&, double unit);

/// Says on a panel that the run ended before this moment.
void mark_stop(Image& panel, const RecordedRun::Stop&, double unit);

/// Says on a panel that the run ended before this moment, or that its cloth is out of sight.
void mark_absence(Image& panel, const SceneRenderer&, std::size_t run, double t, double unit);

}  // namespace taut
