#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"

namespace taut {

namespace {

/// Escapes characters that would end a cell or a line, or begin a tag.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '\\' || c == '<' || c == '*' || c == '_' || c == '`') out += '\\';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out;
}

}  // namespace

std::string to_markdown(const Answer& answer, bool details) {
  std::string out;
  for (const auto& [column, cell] : answer.facts)
    if (details || !column.detail)
      out += "- " + escaped(column.heading) + ": " + escaped(text(cell, column)) + '\n';
  for (const Table& table : answer.tables) {
    if (!table.is_shown(details)) continue;
    out += out.empty() ? "" : "\n";
    if (!table.title.empty()) out += escaped(table.title) + "\n\n";
    const auto add = [&](const auto& cell_of) {
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (details || !table.columns[i].detail) cells.push_back(cell_of(i));
      out += "| " + join(cells, " | ") + " |\n";
    };
    add([&](std::size_t i) { return escaped(label(table.columns[i])); });
    add([](std::size_t) { return std::string("---"); });
    const std::size_t shown = table.rows_shown(details);
    for (std::size_t r = 0; r < shown; ++r)
      add([&](std::size_t i) { return escaped(text(table.rows[r][i], table.columns[i], false)); });
    if (shown < table.rows.size())
      out += "\nand " + std::to_string(table.rows.size() - shown) + " more: --all\n";
    if (!table.caption.empty()) out += '\n' + escaped(table.caption) + '\n';
  }
  return out;
}

}  // namespace taut
