#include "experiments/timing/bench.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr int kBenchSchema = 2;

Interval scaled(const Interval& i, double factor) {
  return {i.low * factor, i.mid * factor, i.high * factor};
}

Json json_of(const Interval& i) { return {i.low, i.mid, i.high}; }
Interval interval_of(const Json& j) { return {j.at(0), j.at(1), j.at(2)}; }

}  // namespace

bool BenchedCase::stable() const {
  return timing.failure.empty() && !timing.samples.empty() && completed(record.status);
}

Interval BenchedCase::cost() const {
  return scaled(bootstrap_median(timing.samples), 1 / record.dt);
}

std::vector<Candidate> SceneBench::candidates(const std::string& metric) const {
  std::vector<Candidate> all;
  for (const BenchedCase& c : cases) {
    const auto value = c.record.values.find(metric);
    const double error = value == c.record.values.end() ? std::nan("") : std::abs(value->second);
    std::string failure = c.timing.failure;
    if (failure.empty() && !c.stable()) failure = describe(c.record.status);
    all.push_back({c.record.solver, c.record.spec.solver, c.cost(), error, failure});
  }
  return all;
}

std::optional<Interval> SceneBench::ratio(std::size_t i, std::size_t j) const {
  const BenchedCase &a = cases[i], &b = cases[j];
  if (!a.timing.failure.empty() || !b.timing.failure.empty()) return {};
  return scaled(interleaved_ratio(a.timing.samples, b.timing.samples), b.record.dt / a.record.dt);
}

std::vector<std::string> solvers_of(const SceneBench& bench) {
  std::vector<std::string> names;
  for (const BenchedCase& c : bench.cases)
    if (std::find(names.begin(), names.end(), c.record.solver) == names.end())
      names.push_back(c.record.solver);
  return names;
}

std::vector<Record> BenchSession::records() const {
  std::vector<Record> records;
  for (const SceneBench& scene : scenes)
    for (const BenchedCase& c : scene.cases) {
      records.push_back(c.record);
      if (!c.timing.failure.empty()) continue;
      records.back().values["cpu.per_step"] = median(c.timing.samples);
      records.back().values["cpu.per_second"] = c.cost().mid;
      records.back().values["wall.per_step"] = median(c.timing.wall);
      records.back().values["memory.peak"] = static_cast<double>(c.timing.peak_bytes);
    }
  return records;
}

std::string to_json(const BenchSession& session) {
  Json all{{"schema", kBenchSchema}, {"study", session.study}, {"machine", session.machine}};
  for (const SceneBench& scene : session.scenes) {
    Json one{{"scene", scene.scene}, {"control", json_of(scene.control)}};
    for (const auto& [record, timing] : scene.cases)
      one["cases"].push_back({{"record", parse_json(to_json(record))},
                              {"cpu_seconds_per_step", timing.samples},
                              {"wall_seconds_per_step", timing.wall},
                              {"peak_bytes", timing.peak_bytes},
                              {"failure", timing.failure}});
    all["scenes"].push_back(std::move(one));
  }
  return to_text(all, 1) + "\n";
}

BenchSession bench_from_json(std::string_view text, const std::string& where) try {
  const auto all = parse_json(text);
  if (all.at("schema") != kBenchSchema)
    throw InputError(where + ": not a bench of schema 2; run `taut bench` again");
  BenchSession session{all.at("study"), all.at("machine"), {}};
  for (const auto& one : all.at("scenes")) {
    SceneBench scene{one.at("scene"), interval_of(one.at("control")), {}};
    for (const auto& c : one.at("cases")) {
      BenchedCase benched{record_from_json(to_text(c.at("record")), where), {}};
      benched.timing = {.spec = benched.record.spec,
                        .samples = c.at("cpu_seconds_per_step"),
                        .wall = c.at("wall_seconds_per_step"),
                        .peak_bytes = c.at("peak_bytes"),
                        .failure = c.at("failure")};
      scene.cases.push_back(std::move(benched));
    }
    session.scenes.push_back(std::move(scene));
  }
  return session;
} catch (const Json::exception& error) {
  throw InputError(where + ": damaged bench: " + error.what());
}

std::filesystem::path bench_file(const std::filesystem::path& results, const std::string& study) {
  return results / "bench" / (study + ".json");
}

}  // namespace taut
