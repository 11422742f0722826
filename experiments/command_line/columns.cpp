#include "experiments/command_line/columns.hpp"

#include <algorithm>
#include <iostream>

namespace taut {

namespace {

std::size_t characters(const std::string& text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins));
}

}  // namespace

void print_columns(const std::vector<Row>& rows, std::size_t names) {
  std::vector<std::size_t> width(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], characters(row[i]));
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool last = i + 1 == row.size();
      const std::string blanks(width[i] - characters(row[i]), ' ');
      std::cout << "  " << (i < names || last ? row[i] + (last ? "" : blanks) : blanks + row[i]);
    }
    std::cout << '\n';
  }
}

}  // namespace taut
