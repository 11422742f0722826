#include "experiments/report/questions/case_list.hpp"

#include <algorithm>

namespace taut::report {

std::vector<std::size_t> places_of(std::size_t n, std::size_t most) {
  const std::size_t count = std::min(n, most);
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i)
    places[i] = n <= most ? i : i * (n - 1) / std::max<std::size_t>(1, most - 1);
  return places;
}

CaseList::CaseList(const ReportInput& input) {
  const auto add = [&](const Record& r, const std::string& study) {
    const auto [at, fresh] = known_.try_emplace(r.key);
    if (fresh) cases_.push_back(&r);
    at->second.studies.push_back(&study);
  };
  // If several know a case, the first is kept: the studies' record has its cost, if it was timed.
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) add(r, study.name);
  for (const MapResult& map : input.maps)
    for (const Record& r : map.records) {
      add(r, map.study);
      maps_.insert(map.study);
    }
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

std::string CaseList::key(const std::string& key) {
  const auto at = known_.find(key);
  if (at == known_.end()) return "";
  at->second.named = true;
  return key.substr(0, length_);
}

std::set<std::string> CaseList::studies_of(const Record& r) const {
  std::set<std::string> names;
  for (const std::string* name : known_.at(r.key).studies) names.insert(*name);
  return names;
}

bool CaseList::only_in_maps(const Record& r) const {
  return std::ranges::all_of(known_.at(r.key).studies,
                             [&](const std::string* name) { return maps_.contains(*name); });
}

std::vector<const Record*> CaseList::listed() const {
  const auto named = [&](const Record* r) { return known_.at(r->key).named; };
  std::vector<const Record*> others = cases_;
  std::erase_if(others, named);
  const std::size_t room = kMostCases - std::min(kMostCases, cases_.size() - others.size());
  std::set<const Record*> chosen;
  for (const std::size_t i : places_of(others.size(), room)) chosen.insert(others[i]);
  std::vector<const Record*> all = cases_;
  std::erase_if(all, [&](const Record* r) { return !named(r) && !chosen.contains(r); });
  return all;
}

const Quantity& CaseList::use(const std::string& name) {
  const auto at = quantities_.find(name);
  return at != quantities_.end() ? at->second
                                 : quantities_.emplace(name, quantity(name)).first->second;
}

}  // namespace taut::report
