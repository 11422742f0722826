#include "core/model/input_error.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/model/text.hpp"

namespace taut {

namespace {

/// Number of insertions, deletions, substitutions and swaps of neighbours (optimal string alignment
/// distance).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, above, row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, substitute});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string Diagnostic::text() const {
  if (file.empty()) return printable(message);
  std::string place = file + ":";
  if (line > 0)
    place += std::to_string(line) + (column > 0 ? ":" + std::to_string(column) : "") + ":";
  else if (column > 0)  // column of an argument
    place += " column " + std::to_string(column) + ":";
  return printable(place + " " + message);
}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(join(diagnostics, "\n", &Diagnostic::text)),
      diagnostics_(std::move(diagnostics)) {}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  // Longer than any name; the distance costs the product of the lengths.
  constexpr std::size_t kMost = 200;
  if (word.size() > kMost) return "";
  const std::string* best = nullptr;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates)
    if (const std::size_t d = edit_distance(word, candidate); d < least) {
      least = d;
      best = &candidate;
    }
  const std::string begin = word.substr(0, std::max<std::size_t>(3, word.size()) - 1);
  for (const std::string& candidate : candidates)  // an abbreviation, or its plural
    if (!best && begin.size() > 2 && candidate.starts_with(begin)) best = &candidate;
  return best ? "; did you mean '" + *best + "'?" : "";
}

}  // namespace taut
