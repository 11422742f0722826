#include "experiments/case/record_io.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"
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

Json result_json(const Record& r) {
  Json step_cost = Json::array(), resolved_settings = Json::array(), values = Json::object();
  for (const PassCost& p : r.step_cost)
    step_cost.push_back({{"pass", p.pass},
                         {"items", p.items},
                         {"repeats", p.repeats},
                         {"bytes", p.bytes},
                         {"projections", p.projections}});
  for (const auto& [name, text] : r.resolved_settings) resolved_settings.push_back({name, text});
  for (const auto& [name, value] : r.values)
    values[name] = std::isfinite(value) ? Json(value) : Json(nullptr);
  return {{"status", status_json(r.status)},        {"values", values},
          {"projections", r.projections},           {"step_cost", step_cost},
          {"resolved_settings", resolved_settings}, {"digest", r.digest}};
}

void append(std::string& text, double value) {
  if (!std::isnan(value)) text += shortest(value);
}

double number(std::string_view field) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(field.data(), field.data() + field.size(), value);
  return value;
}

std::string_view take(std::string_view& text, char separator) {
  const auto end = std::min(text.find(separator), text.size());
  const std::string_view head = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return head;
}

Record from_json(const Json& j) {
  Record r;
  r.key = j.at("key");
  r.id = j.at("id");
  r.spec = {j.at("spec").at("scene"), j.at("spec").at("overrides"), j.at("spec").at("solver")};
  r.scene = j.at("scene");
  r.solver = j.at("solver");
  r.params = j.at("params");
  r.dt = j.at("dt");
  r.steps = j.at("steps");
  r.vertices = j.at("vertices");
  r.links = j.at("links");
  const Json& status = j.at("status");
  r.status = {status_kind(status.at("kind").get<std::string>()), status.at("reason"),
              status.at("step"), status.at("vertex")};
  for (const auto& [name, value] : j.at("values").items())
    r.values[name] =
        value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  r.projections = j.at("projections");
  for (const Json& p : j.at("step_cost"))
    r.step_cost.push_back(
        {p.at("pass"), p.at("items"), p.at("repeats"), p.at("bytes"), p.at("projections")});
  for (const Json& e : j.at("resolved_settings"))
    r.resolved_settings.emplace_back(e.at(0), e.at(1));
  r.digest = j.at("digest");
  return r;
}

}  // namespace

bool completed(const Status& status) {
  return status.kind == Status::Kind::ok || status.kind == Status::Kind::unsettled;
}

std::string describe(const Status& status) {
  std::string text(to_string(status.kind));
  if (!status.reason.empty()) text += " (" + status.reason + ")";
  if (status.step >= 0) text += " at step " + std::to_string(status.step);
  if (status.vertex >= 0) text += ", vertex " + std::to_string(status.vertex);
  return text;
}

std::string to_json(const Record& r, int indent) {
  Json j = result_json(r);
  j.update({{"schema", kRecordSchema},
            {"key", r.key},
            {"id", r.id},
            {"spec",
             {{"scene", r.spec.scene}, {"overrides", r.spec.overrides}, {"solver", r.spec.solver}}},
            {"scene", r.scene},
            {"solver", r.solver},
            {"params", r.params},
            {"dt", r.dt},
            {"steps", r.steps},
            {"vertices", r.vertices},
            {"links", r.links}});
  return to_text(j, indent);
}

Record record_from_json(std::string_view text, const std::string& where) try {
  const Json j = parse_json(text);
  if (j.at("schema") != kRecordSchema)
    throw InputError(where + ": schema " + to_text(j.at("schema")) + ", this program reads " +
                     std::to_string(kRecordSchema));
  return from_json(j);
} catch (const Json::exception& error) {
  throw InputError(where + ": not a record: " + error.what());
}

std::string result_digest(const Record& r) { return sha256(to_text(result_json(r))); }

std::string to_csv(const Series& series) {
  std::string text;
  for (const std::string& column : series.columns) text += (text.empty() ? "" : ",") + column;
  text += '\n';
  for (const auto& row : series.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) text += ',';
      append(text, row[i]);
    }
    text += '\n';
  }
  return text;
}

Series series_from_csv(std::string_view text) {
  Series series;
  for (std::string_view header = take(text, '\n'); !header.empty();)
    series.columns.emplace_back(take(header, ','));
  while (!text.empty()) {
    std::string_view line = take(text, '\n');
    std::vector<double> row;
    for (std::size_t i = 0; i < series.columns.size(); ++i) row.push_back(number(take(line, ',')));
    series.rows.push_back(std::move(row));
  }
  return series;
}

std::string to_csv(const State& state) {
  std::string text = "vertex,x,y,z,vx,vy,vz\n";
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    text += std::to_string(i);
    for (const Vec3* value : {&state.x[i], &state.v[i]})
      for (const double c : *value) {
        text += ',';
        append(text, c);
      }
    text += '\n';
  }
  return text;
}

}  // namespace taut
