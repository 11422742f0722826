#include "experiments/render/image/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

/// A colour of OKLab in polar form: lightness in [0, 1], chroma, hue in degrees.
struct Lch {
  double l = 0, c = 0, h = 0;
};

/// Linear sRGB, possibly out of gamut (B. Ottosson, "A perceptual color space", 2020).
std::array<double, 3> linear_rgb(const Lch& colour) {
  const double hue = colour.h * std::numbers::pi / 180;
  const double a = colour.c * std::cos(hue), b = colour.c * std::sin(hue);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(colour.l + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(colour.l - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(colour.l - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const std::array<double, 3>& rgb) {
  return std::ranges::all_of(rgb, [](double v) { return v >= -1e-4 && v <= 1 + 1e-4; });
}

std::uint8_t encode(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  const double srgb = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * srgb));
}

/// Nearest colour of the same lightness and hue that a screen can show.
Rgb8 to_rgb8(Lch colour) {
  if (!in_gamut(linear_rgb(colour))) {
    double inside = 0, outside = colour.c;
    for (int i = 0; i < 30; ++i) {
      colour.c = (inside + outside) / 2;
      (in_gamut(linear_rgb(colour)) ? inside : outside) = colour.c;
    }
    colour.c = inside;
  }
  const auto rgb = linear_rgb(colour);
  return {encode(rgb[0]), encode(rgb[1]), encode(rgb[2])};
}

template <class Function>
std::vector<Rgb8> tabulate(const Function& colour) {
  std::vector<Rgb8> table;
  for (int i = 0; i < ColourMap::kSize; ++i)
    table.push_back(to_rgb8(colour(static_cast<double>(i) / (ColourMap::kSize - 1))));
  return table;
}

/// OKLab lightness at zero and at both ends of the strain map.
constexpr double kLight = 0.955, kDark = 0.445;

/// Name and appearance of each ColourBy, in the order of the enumeration.
struct Style {
  const char *name, *title;
  double shown;  ///< displayed units per SI unit
  const char* unit;
  const ColourMap& (*map)();
};
constexpr Style kStyles[] = {
    {"strain", "mean edge strain ε at each vertex", 100, "%", ColourMap::diverging},
    {"penetration", "depth below a collider's surface", 1e3, "mm", ColourMap::violet},
    {"speed", "speed", 1, "m/s", ColourMap::teal}};

static_assert(std::size(kStyles) == static_cast<std::size_t>(ColourBy::speed) + 1);

const Style& style(ColourBy by) { return kStyles[static_cast<std::size_t>(by)]; }

}  // namespace

ColourBy parse_colour_by(const std::string& name) {
  const auto found = std::ranges::find(kStyles, name, &Style::name);
  if (found != std::end(kStyles)) return static_cast<ColourBy>(found - std::begin(kStyles));
  throw InputError("unknown colour '" + name + "': strain, penetration or speed" +
                   suggestion(name, {"strain", "penetration", "speed"}));
}

const ColourMap& ColourMap::diverging() {
  static const ColourMap map(tabulate([](double s) {
    const double a = std::abs(2 * s - 1);
    const double chroma = 0.19 * std::pow(a, 0.85);
    return Lch{kLight + (kDark - kLight) * a, chroma, s < 0.5 ? 250 + 7 * a : 54 - 29 * a};
  }));
  return map;
}

const ColourMap& ColourMap::violet() {
  static const ColourMap map(tabulate([](double s) {
    return Lch{0.9 + (0.36 - 0.9) * s, 0.21 * std::pow(s, 0.8), 350 - 45 * s};
  }));
  return map;
}

const ColourMap& ColourMap::teal() {
  static const ColourMap map(tabulate([](double s) {
    return Lch{0.9 + (0.36 - 0.9) * s, 0.13 * std::pow(s, 0.7), 165 + 80 * s};
  }));
  return map;
}

Rgb8 ColourMap::at(double s) const {
  const double clamped = std::isfinite(s) ? std::clamp(s, 0.0, 1.0) : 1;
  return table_[static_cast<std::size_t>(std::lround(clamped * (kSize - 1)))];
}

const ColourMap& ColourScale::map() const { return style(colour_by).map(); }

std::string ColourScale::title() const { return style(colour_by).title; }

double ColourScale::shown() const { return style(colour_by).shown; }

std::string ColourScale::text(double value) const {
  if (colour_by == ColourBy::strain && value == 0) return "0";
  const char* sign = colour_by != ColourBy::strain ? "" : value < 0 ? "\u2212" : "+";
  return sign + general(std::abs(shown() * value), 3) + " " + style(colour_by).unit;
}

std::vector<double> ColourScale::ticks() const {
  const double leading = high / std::pow(10, std::floor(std::log10(high) + 1e-9));
  const auto is = [leading](double x) { return std::abs(leading - x) < 1e-6; };
  const bool thirds = is(1.5) || is(3) || is(6);
  const bool both_signs = low() < 0;
  const int parts = thirds ? 3 : both_signs ? 2 : is(1) || is(5) ? 5 : 4;
  std::vector<double> values;
  for (int i = both_signs ? -parts : 0; i <= parts; ++i) values.push_back(high * i / parts);
  return values;
}

double round_up(double value, double least) {
  const double wanted = std::max(value, least) * (1 - 1e-9);
  const double unit = std::pow(10, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0})
    if (step * unit >= wanted) return step * unit;
  return 10 * unit;
}

double linear_of(std::uint8_t srgb) {
  const double v = srgb / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

}  // namespace taut
