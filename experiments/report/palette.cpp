#include "experiments/report/palette.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace taut::report {

namespace {

// Text in these colours keeps a contrast of 4.5 on its theme's background. Hues follow Wong (2011),
// darkened for text on white and lightened for text on #14171C.
constexpr std::array kColours{
    Colour{"ink", "#111827", "#F3F4F6"},         Colour{"muted", "#5B6472", "#9BA5B3"},
    Colour{"axis", "#6B7281", "#8A94A3"},        Colour{"grid", "#E5E7EB", "#2A3039"},
    Colour{"stair", "#D5D9E2", "#3A424E"},       Colour{"page", "#FFFFFF", "#1B2027"},
    Colour{"s-blue", "#0B6BCB", "#5AA9F5"},      Colour{"s-orange", "#C8470C", "#FF8A54"},
    Colour{"s-purple", "#8250C4", "#B791F2"},    Colour{"s-green", "#0F7B5D", "#3CCB9F"},
    Colour{"s-magenta", "#B52C77", "#F284BB"},   Colour{"s-brown", "#866000", "#E0B040"},
    Colour{"s-teal", "#0C7680", "#4CC8D4"},      Colour{"s-slate", "#56606F", "#A9B4C2"},
    Colour{"ok", "#2F9E77", "#2C8F6C"},          Colour{"unsettled", "#F2BF4B", "#DDA83A"},
    Colour{"exploded", "#C9423B", "#C9473F"},    Colour{"unsupported", "#9AA3AF", "#5F6977"},
    Colour{"timeout", "#7A5BB5", "#7F62B8"},     Colour{"oom", "#5A3E8E", "#5C4291"},
    Colour{"crash", "#1F2430", "#05070A"},       Colour{"error", "#6E4A1E", "#7A5426"},
    Colour{"glyph-light", "#FFFFFE", "#FFFFFE"}, Colour{"glyph-dark", "#1A1A19", "#1A1A19"},
};

Colour colour(std::string_view name) {
  const auto found = std::ranges::find(kColours, name, &Colour::name);
  if (found == kColours.end()) throw std::logic_error("no colour " + std::string(name));
  return *found;
}

struct Known {
  std::string_view solver, colour;
  int marker, hollow;
  double size;
  std::string_view dash;
};
// Bullet's line is dashed because a correct pair coincides: the solid line must show through.
constexpr std::array kKnown{
    Known{"jakobsen", "s-blue", 7, 6, 1.0, ""},
    Known{"bullet", "s-orange", 5, 4, 0.85, "(9,4)"},
    Known{"mass-spring", "s-purple", 9, 8, 1.05, "(3,3)"},
    Known{"bullet-deformable", "s-magenta", 13, 12, 1.05, "(9,3,2,3)"},
    Known{"reference", "s-green", 11, 10, 1.05, "(6,2)"},
};
constexpr std::array kOthers{
    Known{"", "s-teal", 15, 14, 1.05, "(12,3)"},     Known{"", "s-brown", 9, 8, 1.05, "(5,3)"},
    Known{"", "s-green", 11, 10, 1.05, "(9,3,2,3)"}, Known{"", "s-magenta", 13, 12, 1.05, "(2,3)"},
    Known{"", "s-slate", 5, 4, 0.85, "(6,2)"},
};
/// Of settings of one solver: eight that nobody takes for each other.
constexpr std::array<std::string_view, 8> kVariantDashes{
    "", "(7,4)", "(2,3)", "(10,3,2,3)", "(16,4)", "(4,2)", "(10,3,2,3,2,3)", "(2,6)"};

const Known& known(std::string_view solver) {
  const auto found = std::ranges::find(kKnown, solver, &Known::solver);
  if (found != kKnown.end()) return *found;
  std::uint32_t hash = 2166136261U;  // FNV-1a: stable across runs and machines
  for (const char c : solver) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return kOthers[hash % kOthers.size()];
}

}  // namespace

SolverStyle solver_style(std::string_view solver, int variant) {
  const Known& k = known(solver);
  SolverStyle style{colour(k.colour), k.marker, k.hollow, k.size, k.dash};
  if (variant > 0) {
    std::vector<std::string_view> others;  // the solver's own pattern belongs to its first setting
    for (const std::string_view dash : kVariantDashes)
      if (dash != k.dash && !dash.empty()) others.push_back(dash);
    style.dash = others[static_cast<std::size_t>(variant - 1) % others.size()];
    if (variant % 2 == 1) std::swap(style.marker, style.hollow);
  }
  return style;
}

std::string solver_title(std::string_view solver) {
  if (solver == "xpbd") return "XPBD";
  std::string title(solver);
  std::ranges::replace(title, '_', ' ');
  std::ranges::replace(title, '-', ' ');
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z')
    title[0] = static_cast<char>(title[0] - 'a' + 'A');
  return title;
}

StatusStyle status_style(Status::Kind kind) {
  const Colour light = colour("glyph-light"), dark = colour("glyph-dark");
  switch (kind) {
    case Status::Kind::ok:
      return {colour("ok"), "", "settled or ran to the end", light};
    case Status::Kind::unsettled:
      return {colour("unsettled"), "~", "still moving at the end", dark};
    case Status::Kind::exploded:
      return {colour("exploded"), "×", "non-finite or gained energy", light};
    case Status::Kind::unsupported:
      return {colour("unsupported"), "–", "the solver cannot represent the scene", dark};
    case Status::Kind::timeout:
      return {colour("timeout"), "T", "hit the time limit", light};
    case Status::Kind::oom:
      return {colour("oom"), "M", "hit the memory limit", light};
    case Status::Kind::crash:
      return {colour("crash"), "!", "killed by a signal", light};
    case Status::Kind::error:
    case Status::Kind::interrupted:
      break;
  }
  return {colour("error"), "E", "ended with an error", light};
}

Colour neutral(std::string_view name) { return colour(name); }

std::span<const Colour> colours() { return kColours; }

}  // namespace taut::report
