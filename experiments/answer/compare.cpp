#include <cmath>
#include <map>

#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"

namespace taut {

namespace {

bool agree(const Cell& before, const Cell& now, double relative) {
  if (before.value.index() != now.value.index()) return false;
  const double was = before.number(), is = now.number();
  return std::isnan(was) ? before.value == now.value
                         : std::abs(is - was) <= relative * std::abs(was);
}

std::map<std::string, const std::vector<Cell>*> by_name(const Table& table,
                                                        const std::vector<std::string>& names) {
  std::map<std::string, const std::vector<Cell>*> rows;
  for (const auto& row : table.rows)
    rows[join(names, ", ", [&](const std::string& name) { return table.at(row, name).text(); })] =
        &row;
  return rows;
}

}  // namespace

std::vector<Difference> differences(const Table& before, const Table& now,
                                    const std::vector<std::string>& names,
                                    const std::vector<std::string>& held, double relative) {
  std::vector<Difference> all;
  auto were = by_name(before, names);
  for (const auto& [name, row] : by_name(now, names)) {
    const auto node = were.extract(name);
    if (node.empty()) {
      all.push_back({name + " is not in the baseline"});
      continue;
    }
    std::string text;
    for (const std::string& column : held) {
      const Cell &was = before.at(*node.mapped(), column), &is = now.at(*row, column);
      if (agree(was, is, relative)) continue;
      const auto shown = [](const Cell& cell) {
        return cell.text().empty() ? number_text(cell.number(), 6) : cell.text();
      };
      text += (text.empty() ? ": " : "; ") + column + " " + shown(was) + " -> " + shown(is);
    }
    if (!text.empty()) all.push_back({name + text, true});
  }
  for (const auto& [name, row] : were) all.push_back({name + " is gone"});
  return all;
}

}  // namespace taut
