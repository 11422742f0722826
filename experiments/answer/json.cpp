#include "experiments/system/json.hpp"

#include "experiments/answer/answer.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-answer-1";

Json json_of(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell.value)) return *text;
  if (const auto* number = std::get_if<double>(&cell.value)) return *number;
  if (const auto* interval = std::get_if<Interval>(&cell.value)) return *interval;
  if (const auto* yes = std::get_if<bool>(&cell.value)) return *yes;
  return nullptr;
}

/// State of a cell that its JSON notes do not override.
Cell::State usual_state(const Cell& cell) {
  return cell.empty() ? Cell::State::none : Cell::State::value;
}

bool has_notes(const Cell& cell) {
  return !cell.note.empty() || !cell.terms.empty() || !cell.key.empty() || !cell.scene.empty() ||
         cell.best || cell.state != usual_state(cell);
}

void add_notes(Json& json, const Cell& cell) {
  if (cell.state != usual_state(cell)) json["state"] = std::string(to_string(cell.state));
  if (!cell.note.empty()) json["note"] = cell.note;
  if (!cell.terms.empty()) json["terms"] = cell.terms;
  if (!cell.key.empty()) json["key"] = cell.key;
  if (!cell.scene.empty()) json["scene"] = cell.scene;
  if (cell.best) json["best"] = true;
}

/// Adds a column without the members that have their default values.
void add_column(Json& json, const Column& column) {
  json["heading"] = column.heading;
  json["unit"] = column.unit;
  if (!column.shown.empty()) json["shown"] = column.shown;
  if (column.scale != 1) json["scale"] = column.scale;
  if (column.digits != Column("").digits) json["digits"] = column.digits;
  if (column.detail) json["detail"] = true;
  if (column.command) json["command"] = true;
}

Json json_of(const Table& table) {
  Json json{{"title", table.title}, {"caption", table.caption}, {"detail", table.detail}};
  if (table.most > 0) json["most"] = table.most;
  json["columns"] = json_array(table.columns, [](const Column& column) {
    Json one{{"name", column.name}};
    add_column(one, column);
    return one;
  });
  json["rows"] = Json::array();
  json["notes"] = Json::array();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Json row = Json::array();
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      const Cell& cell = table.rows[r][c];
      row.push_back(json_of(cell));
      if (!has_notes(cell)) continue;
      json["notes"].push_back({{"row", r}, {"column", table.columns[c].name}});
      add_notes(json["notes"].back(), cell);
    }
    json["rows"].push_back(std::move(row));
  }
  return json;
}

Cell read_cell(const JsonReader& json) {
  if (json.is_null()) return {};
  if (json.is_text()) return json.text();
  if (json.is_flag()) return json.flag();
  if (json.is_array()) {
    const auto ends = json.items(3);
    return Interval{ends[0].number(), ends[1].number(), ends[2].number()};
  }
  return json.number();
}

Cell::State read_state(const JsonReader& json) {
  if (const auto state = cell_state(json.text())) return *state;
  json.fail("unknown state '" + json.text() + "'");
}

void read_notes(Cell& cell, const JsonReader& json) {
  if (const auto state = json.find("state")) cell.state = read_state(*state);
  if (const auto note = json.find("note")) cell.note = note->text();
  if (const auto terms = json.find("terms")) cell.terms = terms->texts();
  if (const auto key = json.find("key")) cell.key = key->text();
  if (const auto scene = json.find("scene")) cell.scene = scene->text();
  if (const auto best = json.find("best")) cell.best = best->flag();
}

Column read_column(std::string name, const JsonReader& json) {
  Column column(std::move(name));
  column.heading = json.at("heading").text();
  column.unit = json.at("unit").text();
  if (const auto shown = json.find("shown")) column.shown = shown->text();
  if (const auto scale = json.find("scale")) column.scale = scale->number();
  if (const auto digits = json.find("digits")) column.digits = digits->integer(1, 17);
  if (const auto detail = json.find("detail")) column.detail = detail->flag();
  if (const auto command = json.find("command")) column.command = command->flag();
  return column;
}

Table read_table(std::string name, const JsonReader& json) {
  Table table{std::move(name), json.at("title").text(), {}};
  table.caption = json.at("caption").text();
  table.detail = json.at("detail").flag();
  if (const auto most = json.find("most")) table.most = most->count();
  for (const JsonReader& column : json.at("columns").items())
    table.columns.push_back(read_column(column.at("name").text(), column));
  for (const JsonReader& row : json.at("rows").items()) {
    auto& cells = table.rows.emplace_back();
    for (const JsonReader& cell : row.items(table.columns.size())) cells.push_back(read_cell(cell));
  }
  for (const JsonReader& note : json.at("notes").items()) {
    const std::size_t row = note.at("row").count();
    const auto column = std::ranges::find(table.columns, note.at("column").text(), &Column::name);
    if (row >= table.rows.size() || column == table.columns.end())
      note.fail("is no cell of the table");
    read_notes(table.rows[row][static_cast<std::size_t>(column - table.columns.begin())], note);
  }
  return table;
}

}  // namespace

std::string to_json(const Answer& answer) {
  Json json{{"schema", kSchema}, {"kind", answer.kind}, {"subject", answer.subject}};
  json["facts"] = json["tables"] = Json::object();
  for (const auto& [column, cell] : answer.facts) {
    Json& fact = json["facts"][column.name];
    fact["value"] = json_of(cell);
    add_column(fact, column);
    add_notes(fact, cell);
  }
  for (const Table& table : answer.tables) json["tables"][table.name] = json_of(table);
  return to_text(json, 1) + '\n';
}

Answer answer_from_json(std::string_view text, const std::string& file) {
  return read_json(text, file, [](const JsonReader& root) {
    root.require_schema(kSchema);
    Answer answer{root.at("kind").text(), root.at("subject").text()};
    for (const auto& [name, json] : root.at("facts").members()) {
      answer.add(read_column(name, json), read_cell(json.at("value")));
      read_notes(answer.facts.back().cell, json);
    }
    for (const auto& [name, json] : root.at("tables").members()) answer.add(read_table(name, json));
    return answer;
  });
}

}  // namespace taut
