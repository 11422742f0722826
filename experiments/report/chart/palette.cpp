#include "experiments/report/chart/palette.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/model/solver.hpp"

namespace taut::report {

namespace {

// Text in these colours keeps a contrast of 4.5 on its theme's background. Hues follow Wong (2011),
// darkened for text on white and lightened for text on #14171C.
constexpr std::array kColours{
    Colour{"s-blue", "#0B6BCB", "#5AA9F5"},      Colour{"s-orange", "#C8470C", "#FF8A54"},
    Colour{"s-purple", "#8250C4", "#B791F2"},    Colour{"s-green", "#0F7B5D", "#3CCB9F"},
    Colour{"s-magenta", "#B52C77", "#F284BB"},   Colour{"s-brown", "#866000", "#E0B040"},
    Colour{"s-teal", "#0C7680", "#4CC8D4"},      Colour{"s-slate", "#56606F", "#A9B4C2"},
    Colour{"ok", "#2F9E77", "#2C8F6C"},          Colour{"unsettled", "#F2BF4B", "#DDA83A"},
    Colour{"extreme", "#E8894A", "#D97B3C"},     Colour{"exploded", "#C9423B", "#C9473F"},
    Colour{"unsupported", "#9AA3AF", "#5F6977"}, Colour{"timeout", "#7A5BB5", "#7F62B8"},
    Colour{"oom", "#5A3E8E", "#5C4291"},         Colour{"crash", "#1F2430", "#05070A"},
    Colour{"protocol", "#24506B", "#2A5C7A"},    Colour{"error", "#6E4A1E", "#7A5426"},
    Colour{"glyph-light", "#FFFFFE", "#FFFFFE"}, Colour{"glyph-dark", "#1A1A19", "#1A1A19"},
};

Colour colour(std::string_view name) {
  const auto found = std::ranges::find(kColours, name, &Colour::name);
  if (found == kColours.end()) throw std::logic_error("no colour " + std::string(name));
  return *found;
}

struct Style {
  std::string_view colour, shape;
  int marker;
  std::string_view dash;
};
/// By the solver's place among those of this program. Most lines are dashed because a correct pair
/// coincides: the lower one must show through.
constexpr std::array kStyles{
    Style{"s-orange", "square", 5, "9 4"},
    Style{"s-magenta", "diamond", 13, "9 3 2 3"},
    Style{"s-blue", "circle", 7, ""},
    Style{"s-purple", "triangle", 9, "3 3"},
    Style{"s-green", "triangle-down", 11, "9 3 2 3"},
    Style{"s-teal", "pentagon", 15, "12 3"},
    Style{"s-brown", "triangle", 9, "5 3"},
    Style{"s-slate", "square", 5, "6 2"},
};

/// What stands for a status whose name is its colour's.
struct Mark {
  Status::Kind status;
  std::string_view glyph, help;
  bool dark = false;  ///< the glyph
};
constexpr std::array kMarks{
    Mark{Status::Kind::ok, "✓", "settled or ran to the end"},
    Mark{Status::Kind::unsettled, "~", "still moving at the end", true},
    Mark{Status::Kind::extreme, "^", "ran to the end, stretched beyond what the scene accounts for",
         true},
    Mark{Status::Kind::exploded, "×", "non-finite or gained energy"},
    Mark{Status::Kind::unsupported, "–", "the solver cannot represent the scene", true},
    Mark{Status::Kind::timeout, "T", "hit the time limit"},
    Mark{Status::Kind::oom, "M", "hit the memory limit"},
    Mark{Status::Kind::crash, "!", "killed by a signal"},
    Mark{Status::Kind::protocol, "P", "its program broke the protocol"},
    Mark{Status::Kind::error, "E", "ended with an error"}};

}  // namespace

SolverStyle solver_style(std::string_view solver) {
  const auto known = solvers();
  auto place = static_cast<std::size_t>(std::ranges::find(known, solver, &SolverEntry::name) -
                                        known.begin());
  if (place == known.size()) {
    std::size_t hash = 0;
    for (const char c : solver) hash = 31 * hash + static_cast<unsigned char>(c);
    place += hash % (kStyles.size() - std::min(place, kStyles.size() - 1));
  }
  const Style& style = kStyles[place % kStyles.size()];
  return {colour(style.colour), style.shape, style.marker, style.dash};
}

StatusStyle status_style(Status::Kind kind) {
  const auto found = std::ranges::find(kMarks, kind, &Mark::status);
  const Mark& mark = found == kMarks.end() ? kMarks.back() : *found;
  return {colour(to_string(mark.status)), mark.glyph, mark.help,
          colour(mark.dark ? "glyph-dark" : "glyph-light")};
}

}  // namespace taut::report
