#include "experiments/case/record_io.hpp"

#include <array>
#include <cmath>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/record_parts.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr std::tuple kPassCost{Field{"pass", &PassCost::pass}, Field{"items", &PassCost::items},
                               Field{"repeats", &PassCost::repeats},
                               Field{"bytes", &PassCost::bytes},
                               Field{"projections", &PassCost::projections}};

/// "status" and "kind" of "status.kind"; "" and "scene" of "scene".
std::pair<std::string, std::string> object_and_key(std::string_view path) {
  const std::size_t dot = path.find('.');
  if (dot == path.npos) return {"", std::string(path)};
  return {std::string(path.substr(0, dot)), std::string(path.substr(dot + 1))};
}

/// Appends the values of the columns, or only those that are part of the result.
void append_columns(Json& json, const Record& record, bool result_alone) {
  for (const RecordColumn& column : record_columns()) {
    if (result_alone && !column.is_result) continue;
    const auto [object, key] = object_and_key(column.json);
    Json value = with_member(record, column, [](const auto& member) { return Json(member); });
    if (column.may_be_absent() && value == "") continue;
    (object.empty() ? json : json[object])[key] = std::move(value);
  }
}

/// Doubles in shortest exact form, NaN as an empty field.
template <class Values>
std::string csv_line(const Values& values) {
  const auto field = [](double v) { return std::isnan(v) ? std::string() : shortest(v); };
  return join(values, ",", field) + '\n';
}

}  // namespace

void to_json(Json& json, const PassCost& pass) { json = json_of(pass, kPassCost); }

void to_json(Json& json, const SceneSetting& setting) { json = setting.text(); }

void to_json(Json& json, const ResolvedSetting& s) {
  json = {{"name", s.name}, {"text", s.text}};
  if (!s.token.empty()) json["token"] = s.token;
  if (!std::isnan(s.number)) json["number"] = s.number;
}

void to_json(Json& json, const Status::Kind& kind) { json = std::string(to_string(kind)); }

void to_json(Json& json, const StatusReason& reason) { json = reason.text(); }

void read_into(const JsonReader& j, Status::Kind& kind) {
  if (!is_status(j.text())) j.fail("unknown status '" + j.text() + "'");
  kind = status_kind(j.text());
}

void read_into(const JsonReader& j, StatusReason& reason) {
  reason = StatusReason::stored(j.text());
}

void read_into(const JsonReader& j, std::vector<PassCost>& all) {
  for (const JsonReader& one : j.items()) all.push_back(read_as(one, kPassCost));
}

void read_into(const JsonReader& j, SceneSettings& all) { all = scene_settings(j.texts()); }

void read_into(const JsonReader& j, ResolvedSettings& all) {
  for (const JsonReader& one : j.items()) {
    all.emplace_back(one.at("name").text(), one.at("text").text());
    if (const auto token = one.find("token")) all.back().token = token->text();
    if (const auto number = one.find("number")) all.back().number = number->number();
  }
}

Record record_of(const JsonReader& j) {
  j.require_schema(kRecordSchema);
  Record r;
  for (const RecordColumn& column : record_columns()) {
    const auto [object, key] = object_and_key(column.json);
    const JsonReader within = object.empty() ? j : j.at(object.c_str());
    const std::optional<JsonReader> value =
        column.may_be_absent() ? within.find(key.c_str()) : within.at(key.c_str());
    if (value) with_member(r, column, [&](auto& member) { read_into(*value, member); });
  }
  if (const auto wrong = impossible_field(r)) j.at(wrong->name).fail(wrong->why);
  return r;
}

bool completed(const Status& status) {
  return status.kind == Status::Kind::ok || status.kind == Status::Kind::unsettled;
}

bool failed(const Status& status) {
  return !completed(status) && status.kind != Status::Kind::unsupported;
}

std::string describe(const Status& status) {
  std::string text(to_string(status.kind));
  if (!status.reason.empty()) text += " (" + printable(status.reason.text()) + ")";
  if (status.step >= 0) text += " at step " + std::to_string(status.step);
  if (status.vertex >= 0) text += ", vertex " + std::to_string(status.vertex);
  return text;
}

std::string to_json(const Record& r, int indent) {
  Json j{{"schema", kRecordSchema}};
  append_columns(j, r, false);
  return to_text(j, indent);
}

Record record_from_json(std::string_view text, const std::string& where) {
  return read_json(text, where, record_of);
}

bool is_key(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

std::string result_digest(const Record& r) {
  Json j;
  append_columns(j, r, true);
  return sha256(to_text(j));
}

std::string to_csv(const Series& series) {
  std::string text = join(series.columns, ",") + '\n';
  for (const auto& row : series.rows) text += csv_line(row);
  return text;
}

std::string to_json(const Series& series) {
  Json json = Json::object();
  for (std::size_t i = 0; i < series.columns.size(); ++i)
    json[series.columns[i]] =
        json_array(series.rows, [i](const auto& row) { return json_number(row[i]); });
  return to_text(json);
}

Series series_from_json(std::string_view text, const std::string& where) {
  return read_json(text, where, [](const JsonReader& j) {
    Series series;
    for (const auto& [name, values] : j.members()) {
      const std::vector<JsonReader> column = values.items();
      if (series.columns.empty()) series.rows.resize(column.size());
      if (column.size() != series.rows.size()) values.fail("is not as long as the first");
      for (std::size_t k = 0; k < column.size(); ++k)
        series.rows[k].push_back(column[k].number_or_null());
      series.columns.push_back(name);
    }
    return series;
  });
}

std::string to_csv(const State& state) {
  std::string text = "vertex,x,y,z,vx,vy,vz\n";
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3 &x = state.x[i], &v = state.v[i];
    text += std::to_string(i) + ',' + csv_line(std::array{x[0], x[1], x[2], v[0], v[1], v[2]});
  }
  return text;
}

}  // namespace taut
