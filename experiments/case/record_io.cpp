#include "experiments/case/record_io.hpp"

#include <array>
#include <cmath>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr std::tuple kResult{Field{"status", &Record::status},
                             Field{"values", &Record::values},
                             Field{"projections", &Record::projections},
                             Field{"step_cost", &Record::step_cost},
                             Field{"resolved_settings", &Record::resolved_settings},
                             Field{"digest", &Record::digest}};
constexpr std::tuple kCase{Field{"key", &Record::key},
                           Field{"id", &Record::id},
                           Field{"spec", &Record::spec},
                           Field{"scene", &Record::scene},
                           Field{"solver", &Record::solver},
                           Field{"params", &Record::params},
                           Field{"dt", &Record::dt},
                           Field{"steps", &Record::steps},
                           Field{"vertices", &Record::vertices},
                           Field{"links", &Record::links}};
constexpr std::tuple kSpec{Field{"scene", &CaseSpec::scene},
                           Field{"overrides", &CaseSpec::overrides},
                           Field{"solver", &CaseSpec::solver}};
constexpr std::tuple kPassCost{Field{"pass", &PassCost::pass}, Field{"items", &PassCost::items},
                               Field{"repeats", &PassCost::repeats},
                               Field{"bytes", &PassCost::bytes},
                               Field{"projections", &PassCost::projections}};

/// Doubles in shortest exact form, NaN as an empty field.
template <class Values>
std::string csv_line(const Values& values) {
  const auto field = [](double v) { return std::isnan(v) ? std::string() : shortest(v); };
  return join(values, ",", field) + '\n';
}

}  // namespace

void read_into(const JsonReader& j, CaseSpec& spec) { read_into(j, spec, kSpec); }

void read_into(const JsonReader& j, Status& status) {
  const JsonReader kind = j.at("kind");
  if (!is_status(kind.text())) kind.fail("unknown status '" + kind.text() + "'");
  status.kind = status_kind(kind.text());
  read_into(j.at("reason"), status.reason);
  read_into(j.at("step"), status.step), read_into(j.at("vertex"), status.vertex);
}

void read_into(const JsonReader& j, std::vector<PassCost>& all) {
  for (const JsonReader& one : j.items()) all.push_back(read_as(one, kPassCost));
}

void read_into(const JsonReader& j, ResolvedSettings& all) {
  for (const JsonReader& e : j.items()) {
    const std::vector<JsonReader> pair = e.items(2);
    all.emplace_back(pair[0].text(), pair[1].text());
  }
}

Record record_of(const JsonReader& j) {
  j.require_schema(kRecordSchema);
  Record r = read_as(j, kCase);
  read_into(j, r, kResult);
  if (!is_key(r.key)) j.at("key").fail("expected 64 hexadecimal digits");
  if (!(r.dt > 0)) j.at("dt").fail("expected a time step greater than 0");
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
  Json j = json_of(r, kResult);
  j["schema"] = kRecordSchema;
  j.update(json_of(r, kCase));
  if (!r.log.empty()) j["log"] = r.log;
  return to_text(j, indent);
}

Record record_from_json(std::string_view text, const std::string& where) {
  return read_json(text, where, record_of);
}

bool is_key(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

std::string result_digest(const Record& r) { return sha256(to_text(json_of(r, kResult))); }

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
