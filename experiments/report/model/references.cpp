#include "experiments/report/chart/settings.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

References::References(const ReportInput& input) {
  const auto add = [&](const Record& r, const std::string& study) {
    auto& studies = studies_[r.key];
    if (studies.empty()) cases_.push_back(&r);
    studies.insert(study);
  };
  // Of a case that several know, the first is kept: studies have its cost, where it was timed.
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) add(r, study.name);
  for (const MapResult& map : input.maps)
    for (const Record& r : map.records) add(r, map.study);
  if (input.bench)
    for (const SceneBench& scene : input.bench->scenes)
      for (const BenchedCase& c : scene.cases) add(c.record, input.bench->study);
  std::set<std::string> brief;
  for (bool again = true; again; length_ += again ? 4 : 0) {
    brief.clear();
    again = false;
    for (const auto& [key, studies] : studies_)
      again = again || (!brief.insert(key.substr(0, length_)).second && length_ < key.size());
  }
}

std::string References::key(const std::string& key) const {
  return studies_.contains(key) ? key.substr(0, length_) : "";
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
  if (!claim.bars().empty()) one["metric"] = claim.basis.front().quantity().name;
  for (const Evidence& evidence : claim.basis) {
    const Quantity& q = refs.use(evidence.quantity().name);
    Json basis{{"metric", q.name},
               {"window", q.window.empty() ? "whole run" : q.window},
               {"rule", evidence.rule()}};
    std::set<std::string> scenes, cases;
    std::map<std::string, std::set<std::string>> settings;
    std::map<std::string, std::map<std::string, int>> statuses;
    for (const Evidence::Seen& seen : evidence.seen()) {
      scenes.insert(seen.scene);
      if (const std::string key = refs.key(seen.key); !key.empty()) cases.insert(key);
      settings[seen.label].insert(brief_settings(seen.setting));
      ++statuses[seen.label][std::string(to_string(seen.status))];
      Json value{{"scene", seen.scene}, {"solver", seen.solver},
                 {"label", seen.label}, {"value", json_number(seen.value)},
                 {"n", seen.n},         {"status", to_string(seen.status)},
                 {"text", seen.text}};
      add_if(value, "case", refs.key(seen.key));
      if (seen.interval) value["low"] = seen.interval->low, value["high"] = seen.interval->high;
      basis["values"].push_back(std::move(value));
    }
    basis["scenes"] = scenes, basis["statuses"] = statuses, basis["cases"] = cases;
    for (const auto& [label, texts] : settings)
      basis["settings"].push_back({{"solver", label},
                                   {"text", texts.size() == 1 ? *texts.begin()
                                                              : std::to_string(texts.size()) +
                                                                    " settings: see its cases"}});
    add_if(basis, "left_out", evidence.left_out());
    one["basis"].push_back(std::move(basis));
  }
  return one;
}

}  // namespace taut::report
