#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <sstream>

#include "experiments/answer/answer.hpp"

namespace taut {

namespace {

std::size_t characters(const std::string& text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins));
}

/// A cell as it is printed.
struct Printed {
  std::string text;
  bool command = false;
  Cell::Tone tone = Cell::Tone::plain;
};

/// Breaks a text at blanks into lines of at most `most` characters. A longer word has a line to
/// itself. A command stays on one line, since people copy it.
std::vector<std::string> wrapped(const Printed& cell, std::size_t most) {
  if (characters(cell.text) <= most || cell.command) return {cell.text};
  std::vector<std::string> lines;
  std::istringstream words(cell.text);
  for (std::string word; words >> word;)
    if (!lines.empty() && characters(lines.back()) + 1 + characters(word) <= most)
      lines.back() += ' ' + word;
    else
      lines.push_back(word);
  return lines;
}

/// Widths of columns: as wide as their content. If a line would exceed `most` characters, columns
/// of words shrink until it fits, but not below their longest word.
std::vector<std::size_t> widths_of(const std::vector<std::vector<Printed>>& rows,
                                   const std::vector<bool>& left, std::size_t most) {
  std::vector<std::size_t> all(left.size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) all[i] = std::max(all[i], characters(row[i].text));
  std::vector<std::size_t> fit = all;
  const auto line = [&] { return std::accumulate(fit.begin(), fit.end(), 2 * fit.size()); };
  if (line() <= most) return all;
  std::vector<std::size_t> least(left.size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      for (const std::string& word : wrapped(row[i], left[i] ? 0 : most))
        least[i] = std::max(least[i], characters(word));
  for (std::size_t cap = std::ranges::max(all); line() > most && cap-- > 0;)
    for (std::size_t i = 0; i < fit.size(); ++i) fit[i] = std::max(least[i], std::min(all[i], cap));
  return fit;
}

/// Columns of words are aligned left, columns of numbers right.
std::string lines_of(const std::vector<std::vector<Printed>>& rows, const std::vector<bool>& left,
                     std::size_t most, const Shown& shown) {
  const std::vector<std::size_t> width = widths_of(rows, left, most);
  std::string all;
  for (const auto& row : rows) {
    std::vector<std::vector<std::string>> cells;
    std::size_t lines = 1;
    for (std::size_t i = 0; i < row.size(); ++i)
      lines = std::max(lines, cells.emplace_back(wrapped(row[i], width[i])).size());
    for (std::size_t k = 0; k < lines; ++k) {
      std::string line;
      for (std::size_t i = 0; i < row.size(); ++i) {
        const std::string part = k < cells[i].size() ? cells[i][k] : "";
        const std::string blanks(width[i] - std::min(width[i], characters(part)), ' ');
        const std::string printed = part.empty() ? part : shown(part, row[i].tone);
        line += "  " + (left[i] ? printed + blanks : blanks + printed);
      }
      all += line.erase(line.find_last_not_of(' ') + 1) + '\n';
    }
  }
  return all;
}

std::string text_of(const Table& table, bool details, std::size_t width, const Shown& shown) {
  const std::size_t most = table.rows_shown(details);
  std::vector<std::vector<Printed>> rows(most + 1);
  std::vector<bool> left;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& column = table.columns[i];
    if (column.detail && !details) continue;
    rows[0].push_back({label(column)});
    bool words = true;
    for (std::size_t r = 0; r < most; ++r) {
      const Cell& cell = table.rows[r][i];
      rows[r + 1].push_back({text(cell, column, false), column.command, cell.tone});
      words = words && std::isnan(cell.number());
    }
    left.push_back(words);
  }
  std::string out = table.title.empty() ? "" : shown(table.title, Cell::Tone::plain) + "\n";
  out += lines_of(rows, left, width, shown);
  if (most < table.rows.size())
    out += "  and " + std::to_string(table.rows.size() - most) + " more: --all\n";
  return table.caption.empty() ? out
                               : out + lines_of({{Printed{table.caption}}}, {true}, width, shown);
}

}  // namespace

std::string to_text(const Answer& answer, bool details, std::size_t width, const Shown& shown) {
  std::string out = answer.subject.empty() ? "" : shown(answer.subject, Cell::Tone::plain) + '\n';
  std::vector<std::vector<Printed>> facts;
  for (const auto& [column, cell] : answer.facts)
    if (details || !column.detail)
      facts.push_back(
          {Printed{column.heading}, Printed{text(cell, column), column.command, cell.tone}});
  if (!facts.empty()) out += lines_of(facts, {true, true}, width, shown);
  for (const Table& table : answer.tables)
    if (table.is_shown(details))
      out += (out.empty() ? "" : "\n") + text_of(table, details, width, shown);
  return out;
}

}  // namespace taut
