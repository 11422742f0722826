#include "experiments/report/labels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "experiments/report/format.hpp"

namespace taut::report {

namespace {

constexpr double kAir = 2;        ///< px kept free around a text
constexpr double kLetters = 0.9;  ///< height of a line of letters with its descenders, in sizes

/// Advance widths of DejaVu Sans from space to tilde, in thousandths of its size.
constexpr std::array<std::int16_t, 95> kAdvance{
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361,  318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635,  611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352,  635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592,  525, 636, 337, 636, 838};
constexpr double kOther = 838;  ///< signs such as × and −, and whatever else

/// Length of the part of a line inside a box that is not turned (Liang and Barsky 1984).
double inside(const Box& b, double x0, double y0, double x1, double y1) {
  const double dx = x1 - x0, dy = y1 - y0;
  double from = 0, to = 1;
  for (const auto& [step, room] : {std::pair(-dx, x0 - (b.x - b.width / 2)),
                                   {dx, b.x + b.width / 2 - x0},
                                   {-dy, y0 - (b.y - b.height / 2)},
                                   {dy, b.y + b.height / 2 - y0}}) {
    if (step == 0 && room < 0) return 0;
    if (step < 0) from = std::max(from, room / step);
    if (step > 0) to = std::min(to, room / step);
  }
  return std::max(0.0, to - from) * std::hypot(dx, dy);
}

/// A box in the frame of another one: that one's centre is the origin, its sides are the axes.
std::pair<double, double> seen_from(const Box& frame, std::pair<double, double> p) {
  const double dx = p.first - frame.x, dy = p.second - frame.y;
  const double c = std::cos(frame.angle), s = std::sin(frame.angle);
  return {c * dx - s * dy, s * dx + c * dy};
}

/// One of the frame's sides separates it from the other box.
bool separated(const Box& frame, const Box& other) {
  const double big = std::numeric_limits<double>::infinity();
  double left = big, right = -big, top = big, bottom = -big;
  for (const auto& corner : other.corners()) {
    const auto [x, y] = seen_from(frame, corner);
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  return left >= frame.width / 2 || right <= -frame.width / 2 || top >= frame.height / 2 ||
         bottom <= -frame.height / 2;
}

Box grown(Box box, double by) {
  box.width += 2 * by, box.height += 2 * by;
  return box;
}

}  // namespace

double text_width(std::string_view utf8, double size) {
  double thousandths = 0;
  for (const char c : utf8) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 32 && byte < 127)
      thousandths += kAdvance[static_cast<std::size_t>(byte - 32)];
    else if ((byte & 0xC0U) != 0x80U)
      thousandths += kOther;
  }
  return thousandths * size / 1000;
}

std::array<std::pair<double, double>, 4> Box::corners() const {
  const double c = std::cos(angle), s = std::sin(angle), w = width / 2, h = height / 2;
  const auto at = [&](double u, double v) {
    return std::pair(x + c * u + s * v, y - s * u + c * v);
  };
  return {at(-w, -h), at(w, -h), at(w, h), at(-w, h)};
}

bool Box::meets(const Box& other) const {
  return !separated(*this, other) && !separated(other, *this);
}

Box Label::box() const {
  const double width = text_width(text, size);
  const double shift = anchor == Anchor::center ? 0
                       : anchor == Anchor::left ? width / 2
                                                : -width / 2;
  return {x + shift * std::cos(angle), y - shift * std::sin(angle), width, size * kLetters, angle};
}

bool Labels::fits(const Label& label) const {
  const Box box = grown(label.box(), kAir);
  for (const auto& [x, y] : box.corners())
    if (x < 0 || x > width_ || y < 0 || y > height_) return false;
  const auto hidden = [&](const Label& other) { return box.meets(other.box()); };
  return std::ranges::none_of(reserved_, hidden) && std::ranges::none_of(labels_, hidden) &&
         std::ranges::none_of(marks_, [&](const Box& mark) { return box.meets(mark); });
}

double Labels::crossed(const Label& label) const {
  double sum = 0;
  Box box = label.box();
  if (box.angle != 0) {  // the upright box around it: such texts are few
    double left = box.x, right = box.x, top = box.y, bottom = box.y;
    for (const auto& [x, y] : box.corners()) {
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    box = {(left + right) / 2, (top + bottom) / 2, right - left, bottom - top};
  }
  for (const Line& l : lines_) sum += inside(box, l.x0, l.y0, l.x1, l.y1);
  return sum;
}

bool Labels::place(const std::vector<Label>& alternatives) {
  const Label* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Label& label : alternatives) {
    if (!fits(label)) continue;
    const double crossing = crossed(label);
    if (crossing < least) best = &label, least = crossing;
  }
  if (best != nullptr) put(*best);
  return best != nullptr;
}

std::vector<Label> Labels::all() const {
  std::vector<Label> out = reserved_;
  out.insert(out.end(), labels_.begin(), labels_.end());
  return out;
}

std::string Labels::script() const {
  const auto share = [](double px, int of) { return exact(std::round(px * 1e5 / of) / 1e5); };
  std::string out;
  for (const Label& l : labels_) {
    out += "set label " + gnuplot_string(l.text) + " at screen " + share(l.x, width_) + "," +
           share(height_ - l.y, height_) +
           (l.anchor == Anchor::left     ? " left"
            : l.anchor == Anchor::center ? " center"
                                         : " right");
    if (l.angle != 0) out += " rotate by " + exact(std::round(l.angle * 180 / std::numbers::pi));
    out += " front tc rgb '" + std::string(l.colour) + "' font '," + exact(l.size) + "'\n";
  }
  return out;
}

}  // namespace taut::report
