#include <algorithm>
#include <cmath>

#include "experiments/report/chart/settings.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

std::vector<std::size_t> spread(std::size_t n, std::size_t most) {
  const std::size_t count = std::min(n, most);
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = n <= most ? i : i * (n - 1) / (most - 1);
  return places;
}

References::References(const ReportInput& input) {
  const auto add = [&](const Record& r, const std::string& study) {
    const auto [at, fresh] = known_.try_emplace(r.key);
    if (fresh) cases_.push_back(&r);
    at->second.studies.push_back(&study);
  };
  // Of a case that several know, the first is kept: studies have its cost, where it was timed.
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) add(r, study.name);
  for (const MapResult& map : input.maps)
    for (const Record& r : map.records) add(r, map.study);
  if (input.bench)
    for (const SceneBench& scene : input.bench->scenes)
      for (const BenchedCase& c : scene.cases) add(c.record, input.bench->study);
  std::vector<std::string_view> keys;
  for (const Record* r : cases_) keys.push_back(r->key);
  std::ranges::sort(keys);
  const auto alike = [&](std::string_view a, std::string_view b) {
    return b.size() > length_ && a.substr(0, length_) == b.substr(0, length_);
  };
  while (std::ranges::adjacent_find(keys, alike) != keys.end()) length_ += 4;
}

std::string References::key(const std::string& key) {
  const auto at = known_.find(key);
  if (at == known_.end()) return "";
  at->second.named = true;
  return key.substr(0, length_);
}

std::set<std::string> References::studies_of(const Record& r) const {
  std::set<std::string> names;
  for (const std::string* name : known_.at(r.key).studies) names.insert(*name);
  return names;
}

std::vector<const Record*> References::listed() const {
  const auto named = [&](const Record* r) { return known_.at(r->key).named; };
  std::vector<const Record*> others = cases_;
  std::erase_if(others, named);
  const std::size_t room = kMostCases - std::min(kMostCases, cases_.size() - others.size());
  std::set<const Record*> chosen;
  for (const std::size_t i : spread(others.size(), room)) chosen.insert(others[i]);
  std::vector<const Record*> all = cases_;
  std::erase_if(all, [&](const Record* r) { return !named(r) && !chosen.contains(r); });
  return all;
}

const Quantity& References::use(const std::string& name) {
  const auto at = quantities_.find(name);
  return at != quantities_.end() ? at->second
                                 : quantities_.emplace(name, quantity(name)).first->second;
}

Json json_of(const Claim& claim, References& refs) {
  Json one{{"id", claim.id},
           {"kind", to_string(claim.kind)},
           {"about", claim.about},
           {"sentence", claim.sentence},
           {"sure", to_string(claim.sure)}};
  add_if(one, "strong", claim.strong());
  add_if(one, "heading", claim.heading());
  for (const Bar& bar : claim.bars()) {
    Json at{{"solver", bar.solver},
            {"label", bar.label},
            {"value", bar.value ? json_number(*bar.value) : Json()},
            {"text", bar.text}};
    if (bar.interval) at["low"] = bar.interval->low, at["high"] = bar.interval->high;
    one["bars"].push_back(std::move(at));
  }
  if (!claim.bars().empty()) one["metric"] = claim.basis->front().quantity().name;
  for (const Evidence& evidence : *claim.basis) {
    const Quantity& q = refs.use(evidence.quantity().name);
    Json basis{{"metric", q.name},
               {"window", q.window.empty() ? "whole run" : q.window},
               {"rule", evidence.rule()}};
    std::set<std::string> scenes, cases;
    std::map<std::string, std::set<std::string_view>> settings;
    std::map<std::string, std::map<std::string, int>> statuses;
    std::vector<const Evidence::Seen*> listed;
    for (const Evidence::Seen& seen : evidence.seen()) {
      const Record& r = *seen.record;
      scenes.insert(r.scene);
      settings[seen.label].insert(r.spec.solver);
      ++statuses[seen.label][std::string(to_string(r.status.kind))];
      listed.push_back(&seen);
    }
    if (listed.size() > kMostValues) {  // what has no value is listed first
      basis["unlisted"] = listed.size() - kMostValues;
      std::ranges::stable_partition(listed, [](const auto* s) { return !std::isfinite(s->value); });
      listed.resize(kMostValues);
    }
    for (const Evidence::Seen* seen : listed) {
      const Record& r = *seen->record;
      const std::string key = refs.key(r);
      Json value{{"scene", r.scene},
                 {"solver", r.solver},
                 {"label", seen->label},
                 {"value", json_number(seen->value)},
                 {"n", seen->n},
                 {"status", to_string(r.status.kind)},
                 {"text", evidence.text(*seen)}};
      if (!key.empty()) value["case"] = key, cases.insert(key);
      if (seen->interval) value["low"] = seen->interval->low, value["high"] = seen->interval->high;
      basis["values"].push_back(std::move(value));
    }
    basis["scenes"] = scenes, basis["statuses"] = statuses, basis["cases"] = cases;
    for (const auto& [label, texts] : settings)
      basis["settings"].push_back(
          {{"solver", label},
           {"text", texts.size() == 1
                        ? brief_settings(std::string(*texts.begin()))
                        : std::to_string(texts.size()) + " settings: see its cases"}});
    add_if(basis, "left_out", evidence.left_out());
    one["basis"].push_back(std::move(basis));
  }
  return one;
}

}  // namespace taut::report
