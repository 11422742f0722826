#include "experiments/report/chart/palette.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace taut::report {

namespace {

// Text in these colours has a contrast of 4.5 on the background of its theme. Hues follow Wong
// (2011), darkened for text on white and lightened for text on #14171C.

struct Named {
  std::string_view solver;
  SolverStyle style;
};
/// Most lines are dashed, since the lines of two correct solvers coincide and the lower one must
/// show through.
constexpr Named kSolvers[] = {
    {"bullet", {{"#C8470C", "#FF8A54"}, "square", "5", "9 4"}},  // orange
    {"bullet-deformable",
     {{"#B52C77", "#F284BB"}, "triangle-right", "'▶' ps 1.2", "9 3 2 3"}},         // magenta
    {"jakobsen", {{"#0B6BCB", "#5AA9F5"}, "circle", "7", ""}},                     // blue
    {"mass-spring", {{"#8250C4", "#B791F2"}, "pentagon", "15", "3 3"}},            // purple
    {"xpbd", {{"#0F7B5D", "#3CCB9F"}, "triangle-down", "11", "9 3 2 3"}},          // green
    {"implicit", {{"#2B2F36", "#D5DBE3"}, "triangle-left", "'◀' ps 1.2", "2 3"}},  // black
    {"pd", {{"#B3261E", "#F2827A"}, "diamond", "13", "12 3"}},                     // red
    {"admm", {{"#3B4CC0", "#98A5F5"}, "star", "'★' ps 1.2", "5 3"}},               // indigo
    {"vbd", {{"#5B6B00", "#B5C94A"}, "triangle", "9", "6 2"}},                     // olive
    {"avbd", {{"#9C2FA8", "#E08CEB"}, "plus", "'✚' ps 1.1", "9 4"}},               // violet
};
/// Styles of solvers that are not part of the program.
constexpr std::array kOthers{
    SolverStyle{{"#0C7680", "#4CC8D4"}, "hexagon", "'⬢' ps 1.2", "12 3"},  // teal
    SolverStyle{{"#866000", "#E0B040"}, "bar", "'▬' ps 1.2", "5 3"},       // brown
    SolverStyle{{"#56606F", "#A9B4C2"}, "post", "'▮' ps 1.2", "6 2"},      // slate
};

constexpr Colour kWhite{"#FFFFFE", "#FFFFFE"};
/// Styles in the order of the enumeration, up to the last status that is stored.
constexpr StatusStyle kStatuses[] = {
    {{"#2F9E77", "#2C8F6C"}, "✓", "settled or ran to the end", kWhite},
    {{"#C9423B", "#C9473F"},
     "×",
     "not finite, far outside the scene, or moving with 10 × the energy that the scene supplies",
     kWhite},
    {{"#F2BF4B", "#DDA83A"}, "~", "still moving at the end", kDarkInk},
    {{"#E8894A", "#D97B3C"},
     "^",
     "ran to the end, stretched beyond what the scene accounts for",
     kDarkInk},
    {{"#9AA3AF", "#5F6977"}, "–", "the solver cannot represent the scene", kDarkInk},
    {{"#7A5BB5", "#7F62B8"}, "T", "hit the time limit", kWhite},
    {{"#5A3E8E", "#5C4291"}, "M", "hit the memory limit", kWhite},
    {{"#1F2430", "#05070A"}, "!", "killed by a signal", kWhite},
    {{"#24506B", "#2A5C7A"}, "P", "its program broke the protocol", kWhite},
    {{"#6E4A1E", "#7A5426"}, "E", "ended with an error", kWhite}};
static_assert(std::size(kStatuses) == static_cast<std::size_t>(Status::Kind::interrupted));

}  // namespace

SolverStyle solver_style(std::string_view solver) {
  if (const auto* const named = std::ranges::find(kSolvers, solver, &Named::solver);
      named != std::end(kSolvers))
    return named->style;
  std::size_t hash = 0;
  for (const char c : solver) hash = 31 * hash + static_cast<unsigned char>(c);
  return kOthers[hash % kOthers.size()];
}

std::string_view dash_of(std::string_view solver, int variant) {
  constexpr std::array<std::string_view, 7> kVariants{"7 4", "2 3",          "10 3 2 3", "16 4",
                                                      "4 2", "10 3 2 3 2 3", "2 6"};
  return variant == 0 ? solver_style(solver).dash
                      : kVariants[static_cast<std::size_t>(variant - 1) % kVariants.size()];
}

std::span<const StretchShade> stretch_shades() {
  static constexpr StretchShade kShades[] = {
      {0.01, 1, "RMS stretch up to 1 %"},
      {0.03, 0.7, "up to 3 %"},
      {0.1, 0.45, "up to 10 %"},
      {0.3, 0.24, "up to 30 %"},
      {std::numeric_limits<double>::infinity(), 0.08, "more than 30 %"}};
  return kShades;
}

StatusStyle status_style(Status::Kind kind) {
  return kStatuses[std::min(static_cast<std::size_t>(kind), std::size(kStatuses) - 1)];
}

}  // namespace taut::report
