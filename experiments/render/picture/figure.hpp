#pragma once

#include "experiments/render/image/canvas.hpp"
#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

/// Text colours of a page.
constexpr Rgb8 kInk = rgb(0x1B1F27), kMuted = rgb(0x5A6474);

/// Largest number of runs in a picture.
inline constexpr int kMostPanels = 9;

/// Positions of the parts of a picture, in pixels. Each run has a panel: up to three side by side,
/// more in rows of two or three. With several moments, each moment has a row.
struct PageLayout {
  int width = 1920, height = 1080;
  int columns = 1, rows = 1;
  double unit = 1;  ///< scale of texts: 1 at a height of 1080
  int header = 0, footer = 0, gap = 0;
  int panel_width = 0, panel_height = 0;

  /// Panels side by side: two if there are four panels, otherwise up to three.
  static int columns_of(int panels);
  /// A picture of this size with titles above the panels and the colour bar below.
  static PageLayout page(int width, int height, int panels);
  /// Titles and the colour bar around panels of this size.
  static PageLayout sheet(int panel_width, int panel_height, int runs, int moments);
  /// Panels without titles, captions and colour bar, for a viewer that writes them itself.
  static PageLayout bare(int width, int height, int panels);

  bool has_text() const { return header > 0; }
  /// Upper left corner of a run's panel in the row of a moment.
  std::pair<int, int> corner(std::size_t run, std::size_t moment) const;
};

/// "4.10 %", "27.4 %", "1153 %", optionally with a sign: at least three significant digits.
std::string strain_text(double value, bool sign);

/// Caption texts for this quantity at one moment: the strains, the depth ("max depth = 1.5 mm") or
/// the speed.
std::vector<std::string> caption_of(ColourBy, const LiveFigures&);

/// A picture of all runs at these moments: panels with live figures, titles and the colour bar. The
/// cloth laid flat is in a corner of each panel, unless it would hide cloth. Panel sizes are those
/// for which the renderer was made. Precondition: one moment, or one row of runs.
Image compose(const SceneRenderer&, const PageLayout&, const std::vector<double>& times);

/// The band of the canvas that a colour bar covers.
struct BarPlace {
  double x = 0, y = 0, width = 0, height = 0;
};
/// Draws the colour bar with ticks, and with arrows for values beyond its ends. The two outermost
/// pixel columns of the bar itself have the exact colours of the ends.
void draw_colour_bar(Canvas&, const ColourScale&, const BarPlace&, double unit);

/// Marks a panel to show that the run ended before this moment.
void mark_stop(Image& panel, const RecordedRun::Stop&, double unit);

/// Marks a panel if the run ended before this moment or if its cloth is out of sight.
void mark_absence(Image& panel, const SceneRenderer&, std::size_t run, double t, double unit);

}  // namespace taut
