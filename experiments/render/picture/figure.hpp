#pragma once

#include "experiments/render/image/canvas.hpp"
#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

/// Colours of what is written and ruled on a page.
constexpr Rgb8 kInk = rgb(0x1B1F27), kMuted = rgb(0x5A6474), kRule = rgb(0xDDE0E6);

/// Where the parts of a picture go; all in pixels.
struct PageLayout {
  int width = 1920, height = 1080;
  int columns = 1, rows = 1;
  double unit = 1;  ///< 1 at a height of 1080
  int header = 0, footer = 0;
  int panel_width = 0, panel_height = 0;

  /// One to four panels: side by side, four in two rows.
  PageLayout(int width, int height, int panels);
};

/// "4.10 %", "27.4 %", "1153 %", with its sign if that is wanted: three digits are what is told
/// apart.
std::string strain_text(double value, bool sign);

/// What is written below a picture of this quantity: the strains, the depth or the speed of this
/// moment, "max depth = 1.5 mm".
std::vector<std::string> caption_of(ColourBy, const LiveFigures&);

/// A picture of all runs at one moment: captions with live figures, panels, material space, the
/// colour bar. Sizes come from the layout that the renderer was made for.
Image compose(const SceneRenderer&, const PageLayout&, double t);

/// A contact sheet: a row for each moment, a column for each run. Precondition: times not empty.
Image compose_sheet(const SceneRenderer&, const std::vector<double>& times);

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
