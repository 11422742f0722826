#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace taut::report {

/// Width of a text in a sans-serif font of `size` px [px]. DejaVu Sans, the widest of those that a
/// page may get: no reader's font needs more.
double text_width(std::string_view utf8, double size = 12);

/// A rectangle on the picture [px] by its centre; y grows downwards, `angle` [rad] turns it
/// anticlockwise.
struct Box {
  double x = 0, y = 0, width = 0, height = 0, angle = 0;

  /// They share more than an edge. Separating axes: exact for turned ones too.
  bool meets(const Box&) const;
  std::array<std::pair<double, double>, 4> corners() const;
};

enum class Anchor { left, center, right };

/// A text of a picture, one line.
struct Label {
  std::string text;
  double x = 0, y = 0;  ///< px; the middle of its height
  Anchor anchor = Anchor::left;
  std::string_view colour;  ///< "#5B6472"
  double size = 12;         ///< px
  double angle = 0;         ///< rad, anticlockwise

  /// What its letters cover.
  Box box() const;
};

/// The texts of a picture, and what they may not hide. Those that say what is what are put; those
/// that only help are placed where there is room, or left out.
class Labels {
 public:
  Labels(int width, int height) : width_(width), height_(height) {}

  /// Puts a text where the picture needs it.
  void put(Label label) { labels_.push_back(std::move(label)); }
  /// Puts a text that is drawn by other means, such as a tick's: it only takes its place.
  void reserve(Label label) { reserved_.push_back(std::move(label)); }
  /// A marker: no text may lie on it.
  void mark(const Box& box) { marks_.push_back(box); }
  /// A line: texts keep off it where they can.
  void line(double x0, double y0, double x1, double y1) { lines_.push_back({x0, y0, x1, y1}); }

  /// Inside the picture, and on no other text and no marker.
  bool fits(const Label&) const;
  /// Puts the first of the alternatives that fits and crosses least of the lines; false: none fits,
  /// and nothing was put.
  bool place(const std::vector<Label>& alternatives);

  /// Every text with its place, reserved ones first.
  std::vector<Label> all() const;
  const std::vector<Box>& marks() const { return marks_; }
  /// gnuplot's commands for what was put.
  std::string script() const;

 private:
  struct Line {
    double x0, y0, x1, y1;
  };
  double crossed(const Label&) const;

  int width_, height_;
  std::vector<Label> labels_, reserved_;
  std::vector<Box> marks_;
  std::vector<Line> lines_;
};

}  // namespace taut::report
