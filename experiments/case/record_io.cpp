#include "experiments/case/record_io.hpp"

#include <charconv>
#include <cmath>
#include <limits>

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

Json result_json(const Record& r) {
  Json step_cost = Json::array(), resolved_settings = Json::array(), values = Json::object();
  for (const PassCost& p : r.step_cost)
    step_cost.push_back({{"pass", p.pass},
                         {"items", p.items},
                         {"repeats", p.repeats},
                         {"bytes", p.bytes},
                         {"projections", p.projections}});
  for (const auto& [name, text] : r.resolved_settings) resolved_settings.push_back({name, text});
  for (const auto& [name, value] : r.values) values[name] = value;  // null where it is not finite
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

}  // namespace

Record record_of(const JsonReader& j) {
  constexpr int kNone = -1;
  j.require_schema(kRecordSchema);
  Record r;
  r.key = j.at("key").text();
  if (!is_key(r.key)) j.at("key").fail("expected 64 hexadecimal digits");
  r.id = j.at("id").text();
  const JsonReader spec = j.at("spec");
  r.spec = {spec.at("scene").text(), spec.at("overrides").texts(), spec.at("solver").text()};
  r.scene = j.at("scene").text();
  r.solver = j.at("solver").text();
  for (const auto& [name, value] : j.at("params").members()) r.params[name] = value.text();
  r.dt = j.at("dt").number();
  if (!(r.dt > 0)) j.at("dt").fail("expected a time step greater than 0");
  r.steps = j.at("steps").integer(0);
  r.vertices = j.at("vertices").integer(0);
  r.links = j.at("links").integer(0);
  const JsonReader status = j.at("status");
  const std::string kind = status.at("kind").text();
  if (!is_status(kind)) status.at("kind").fail("unknown status '" + kind + "'");
  r.status = {status_kind(kind), status.at("reason").text(), status.at("step").integer(kNone),
              status.at("vertex").integer(kNone)};
  for (const auto& [name, value] : j.at("values").members())
    r.values[name] = value.number_or_null();
  r.projections = j.at("projections").count();
  for (const JsonReader& p : j.at("step_cost").items())
    r.step_cost.push_back({p.at("pass").text(), p.at("items").count(), p.at("repeats").count(),
                           p.at("bytes").count(), p.at("projections").flag()});
  for (const JsonReader& e : j.at("resolved_settings").items()) {
    const std::vector<JsonReader> pair = e.items(2);
    r.resolved_settings.emplace_back(pair[0].text(), pair[1].text());
  }
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
            {"spec",
             {{"scene", r.spec.scene}, {"overrides", r.spec.overrides}, {"solver", r.spec.solver}}},
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
