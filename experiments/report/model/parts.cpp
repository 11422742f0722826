
#include "experiments/report/model/parts.hpp"

namespace taut::report {

void add_by_id(Json& part, const char* list, Json one, Json& all) {
  part[list].push_back(one["id"]);
  all.push_back(std::move(one));
}

void add_table(Json& part, Table table, Answer& tables) {
  if (table.rows.empty()) return;
  part["tables"].push_back(table.name);
  tables.add(std::move(table));
}

Json json_of_tables(const Answer& answer) { return parse_json(to_json(answer))["tables"]; }

}  // namespace taut::report
