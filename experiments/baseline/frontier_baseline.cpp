#include "experiments/baseline/frontier_baseline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

fs::path frontier_baseline(const fs::path& folder, const std::string& solver) {
  return folder / kFrontiersFolder / (slug(solver) + ".json");
}

void keep_frontiers(const Answer& answer, const fs::path& file) {
  make_folder(file.parent_path());
  write_durably(file, to_json(answer));
}

std::optional<std::vector<Difference>> changes_of_frontiers(const Answer& now,
                                                            const fs::path& file) {
  if (!fs::exists(file)) return {};
  const Answer before = answer_from_json(read_text(file), file.string());
  return differences(before.table("parameters"), now.table("parameters"), {"solver", "parameter"},
                     {"lacks", "symptom", "at_start", "from", "to", "good", "bad"}, kBracketWidth);
}

FrontierCheck check_frontiers(const Answer& now, const std::string& solver, const fs::path& folder,
                              bool update) {
  const fs::path file = frontier_baseline(folder, solver);
  if (update) {
    keep_frontiers(now, file);
    return {.news = file.string(), .changes = {}};
  }
  auto changes = changes_of_frontiers(now, file);
  if (!changes)
    return {
        .end = CheckEnd::nothing, .news = solver + ": no baseline " + file.string(), .changes = {}};
  FrontierCheck found{.news = std::to_string(now.table("parameters").rows.size()) +
                              " frontiers compared with " + file.string() + ": " +
                              std::to_string(changes->size()) + " differ",
                      .changes = std::move(*changes)};
  if (std::ranges::any_of(found.changes, &Difference::moved))
    found.end = CheckEnd::moved;
  else if (!found.changes.empty())
    found.end = CheckEnd::nothing;
  return found;
}

Table commands_of(const std::vector<ParameterFrontier>& found) {
  Table table{"commands",
              "commands that run the cases beyond",
              {{"solver"}, {"parameter"}, Column("command").of_commands()}};
  for (const ParameterFrontier& one : found)
    if (!std::isnan(one.bad))
      table.rows.push_back({one.solver, one.parameter, reproduce(one.beyond)});
  return table;
}

}  // namespace taut
