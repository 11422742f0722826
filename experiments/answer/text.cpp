#include <algorithm>
#include <cmath>
#include <cstddef>

#include "experiments/answer/answer.hpp"

namespace taut {

namespace {

std::size_t characters(const std::string& text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string blanks(width - std::min(width, characters(text)), ' ');
  return left ? text + blanks : blanks + text;
}

/// Columns of words are flush left, those of numbers flush right.
std::string lines_of(const std::vector<std::vector<std::string>>& rows,
                     const std::vector<bool>& left) {
  std::vector<std::size_t> width(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], characters(row[i]));
  std::string all;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += "  " + padded(row[i], width[i], left[i]);
    all += line.erase(line.find_last_not_of(' ') + 1) + '\n';
  }
  return all;
}

std::string text_of(const Table& table, bool details) {
  const std::size_t shown = table.rows_shown(details);
  std::vector<std::vector<std::string>> rows(shown + 1);
  std::vector<bool> left;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& column = table.columns[i];
    if (column.detail && !details) continue;
    rows[0].push_back(label(column));
    bool words = true;
    for (std::size_t r = 0; r < shown; ++r) {
      const Cell& cell = table.rows[r][i];
      rows[r + 1].push_back(text(cell, column, false));
      words = words && std::isnan(cell.number());
    }
    left.push_back(words);
  }
  std::string out = table.title.empty() ? "" : table.title + "\n";
  out += lines_of(rows, left);
  if (shown < table.rows.size())
    out += "  and " + std::to_string(table.rows.size() - shown) + " more: --all\n";
  return table.caption.empty() ? out : out + "  " + table.caption + '\n';
}

}  // namespace

std::string to_text(const Answer& answer, bool details) {
  std::string out = answer.subject.empty() ? "" : answer.subject + '\n';
  std::size_t width = 0;
  for (const auto& [column, cell] : answer.facts)
    if (details || !column.detail) width = std::max(width, characters(column.heading));
  for (const auto& [column, cell] : answer.facts)
    if (details || !column.detail)
      out += "  " + padded(column.heading, width, true) + "  " + text(cell, column) + '\n';
  for (const Table& table : answer.tables)
    if (table.is_shown(details)) out += (out.empty() ? "" : "\n") + text_of(table, details);
  return out;
}

}  // namespace taut
