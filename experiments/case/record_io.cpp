#include "experiments/case/record_io.hpp"

#include <array>
#include <cmath>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

Json status_json(const Status& status) {
  return {{"kind", to_string(status.kind)},
          {"reason", status.reason},
          {"step", status.step},
          {"vertex", status.vertex}};
}

Json result_json(const Record& r) {  // a value that is not finite is null
  return {{"status", status_json(r.status)},
          {"values", r.values},
          {"projections", r.projections},
          {"step_cost", r.step_cost},
          {"resolved_settings", r.resolved_settings},
          {"digest", r.digest}};
}

/// Doubles in shortest exact form, NaN as an empty field.
template <class Values>
std::string csv_line(const Values& values) {
  const auto field = [](double v) { return std::isnan(v) ? std::string() : shortest(v); };
  return join(values, ",", field) + '\n';
}

}  // namespace

void read_into(const JsonReader& j, CaseSpec& spec) {
  spec = {j.at("scene").text(), j.at("overrides").texts(), j.at("solver").text()};
}

Status::Kind status_of(const JsonReader& j) {
  if (!is_status(j.text())) j.fail("unknown status '" + j.text() + "'");
  return status_kind(j.text());
}

std::map<std::string, std::string> parameters_of(const JsonReader& j) {
  std::map<std::string, std::string> parameters;
  for (const auto& [name, value] : j.members()) parameters[name] = value.text();
  return parameters;
}

std::vector<PassCost> step_cost_of(const JsonReader& j) {
  std::vector<PassCost> all;
  for (const JsonReader& p : j.items())
    all.push_back({p.at("pass").text(), p.at("items").count(), p.at("repeats").count(),
                   p.at("bytes").count(), p.at("projections").flag()});
  return all;
}

ResolvedSettings resolved_settings_of(const JsonReader& j) {
  ResolvedSettings all;
  for (const JsonReader& e : j.items()) {
    const std::vector<JsonReader> pair = e.items(2);
    all.emplace_back(pair[0].text(), pair[1].text());
  }
  return all;
}

Record record_of(const JsonReader& j) {
  constexpr int kNone = -1;
  j.require_schema(kRecordSchema);
  Record r;
  r.key = j.at("key").text();
  if (!is_key(r.key)) j.at("key").fail("expected 64 hexadecimal digits");
  r.id = j.at("id").text();
  read_into(j.at("spec"), r.spec);
  r.scene = j.at("scene").text();
  r.solver = j.at("solver").text();
  r.params = parameters_of(j.at("params"));
  r.dt = j.at("dt").number();
  if (!(r.dt > 0)) j.at("dt").fail("expected a time step greater than 0");
  r.steps = j.at("steps").integer(0);
  r.vertices = j.at("vertices").integer(0);
  r.links = j.at("links").integer(0);
  const JsonReader status = j.at("status");
  r.status = {status_of(status.at("kind")), status.at("reason").text(),
              status.at("step").integer(kNone), status.at("vertex").integer(kNone)};
  for (const auto& [name, value] : j.at("values").members())
    r.values[name] = value.number_or_null();
  r.projections = j.at("projections").count();
  r.step_cost = step_cost_of(j.at("step_cost"));
  r.resolved_settings = resolved_settings_of(j.at("resolved_settings"));
  r.digest = j.at("digest").text();
  if (const auto log = j.find("log")) r.log = log->text();
  return r;
}

bool completed(const Status& status) {
  return status.kind == Status::Kind::ok || status.kind == Status::Kind::unsettled;
}

std::string describe(const Status& status) {
  std::string text(to_string(status.kind));
  if (!status.reason.empty()) text += " (" + printable(status.reason) + ")";
  if (status.step >= 0) text += " at step " + std::to_string(status.step);
  if (status.vertex >= 0) text += ", vertex " + std::to_string(status.vertex);
  return text;
}

std::string to_json(const Record& r, int indent) {
  Json j = result_json(r);
  j.update({{"schema", kRecordSchema},
            {"key", r.key},
            {"id", r.id},
            {"spec", r.spec},
            {"scene", r.scene},
            {"solver", r.solver},
            {"params", r.params},
            {"dt", r.dt},
            {"steps", r.steps},
            {"vertices", r.vertices},
            {"links", r.links}});
  if (!r.log.empty()) j["log"] = r.log;
  return to_text(j, indent);
}

Record record_from_json(std::string_view text, const std::string& where) {
  return read_json(text, where, record_of);
}

bool is_key(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

std::string result_digest(const Record& r) { return sha256(to_text(result_json(r))); }

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
