#include "experiments/report/claims/claim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "experiments/case/record_io.hpp"

namespace taut::report {

std::vector<std::size_t> places_of(std::size_t n, std::size_t most) {
  const std::size_t count = std::min(n, most);
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i)
    places[i] = n <= most ? i : i * (n - 1) / std::max<std::size_t>(1, most - 1);
  return places;
}

Citations::Citations(const ReportInput& input) {
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

std::string Citations::key(const std::string& key) {
  const auto at = known_.find(key);
  if (at == known_.end()) return "";
  at->second.named = true;
  return key.substr(0, length_);
}

std::set<std::string> Citations::studies_of(const Record& r) const {
  std::set<std::string> names;
  for (const std::string* name : known_.at(r.key).studies) names.insert(*name);
  return names;
}

std::vector<const Record*> Citations::listed() const {
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

const Quantity& Citations::use(const std::string& name) {
  const auto at = quantities_.find(name);
  return at != quantities_.end() ? at->second
                                 : quantities_.emplace(name, quantity(name)).first->second;
}

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::string_view to_string(ClaimKind kind) {
  constexpr std::array<std::string_view, 3> kWords{"headline", "tile", "note"};
  return kWords[static_cast<std::size_t>(kind)];
}

std::optional<double> Evidence::look(const std::string& label, const Record& r) {
  const double value = value_of(r, quantity_.name);
  const bool has = completed(r.status) && std::isfinite(value);
  seen_.push_back({&r, label, has ? value : kNothing});
  return has ? std::optional(value) : std::nullopt;
}

std::string Evidence::text(const Seen& seen) const {
  if (std::isfinite(seen.value)) return quantity_.text(seen.value);
  if (!seen.why.empty()) return seen.why;
  return std::string(completed(seen.record->status) ? "no value"
                                                    : to_string(seen.record->status.kind));
}

void Evidence::look(const BenchedCase& c, const Interval& cost, const std::string& label) {
  Seen seen{&c.record, label, kNothing};
  seen.n = c.timing.samples.size();
  if (c.stable()) {
    seen.interval = cost;
    if (quantity_.name == "cpu.per_step")
      for (double* end : {&seen.interval->low, &seen.interval->mid, &seen.interval->high})
        *end *= c.record.dt;
    seen.value = seen.interval->mid;
  } else {
    seen.why = c.timing.failure.empty() ? to_string(c.record.status.kind) : c.timing.failure;
  }
  seen_.push_back(std::move(seen));
}

void Evidence::leave_out(const std::string& sentence) {
  left_out_ += (left_out_.empty() ? "" : " ") + sentence;
}

Claim::Claim(std::string name, ClaimKind what, std::string of, std::string text, Certainty how,
             std::vector<Evidence> evidence)
    : id(std::move(name)),
      kind(what),
      about(std::move(of)),
      sentence(std::move(text)),
      sure(how),
      basis(std::make_shared<const std::vector<Evidence>>(std::move(evidence))) {
  if (basis->empty() || std::ranges::any_of(*basis, [](const auto& e) { return e.seen().empty(); }))
    throw std::logic_error("a claim without its basis: " + sentence);
}

Claim Claim::tile(std::string title, std::string what, std::vector<Bar> all) const {
  Claim made = *this;
  made.id = "tile-" + id, made.kind = ClaimKind::tile;
  made.sentence = std::move(what), made.strong.clear();
  made.heading = std::move(title), made.bars = std::move(all);
  return made;
}

Interval geometric_mean(const std::vector<Interval>& ratios) {
  double mid = 0, below = 0, above = 0;
  for (const Interval& r : ratios) {
    mid += std::log(r.mid);
    below += std::pow(std::log(r.mid / r.low), 2);
    above += std::pow(std::log(r.high / r.mid), 2);
  }
  const auto n = static_cast<double>(ratios.size());
  return {std::exp((mid - std::sqrt(below)) / n), std::exp(mid / n),
          std::exp((mid + std::sqrt(above)) / n)};
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

std::string sentence_if(const std::string& opening, const std::vector<std::string>& names) {
  return names.empty() ? "" : opening + joined(names) + ".";
}

std::string share_text(double ratio) {
  return ratio <= 0.55 ? "1/" + significant(1 / ratio, 2) : fixed(100 * ratio, 0) + "\u00A0%";
}

std::string undecided(Certainty sure) {
  return sure == Certainty::too_noisy ? "too noisy to judge" : "no difference that can be told";
}

Json json_of(const Claim& claim, Citations& refs) {
  Json one{{"id", claim.id},
           {"kind", to_string(claim.kind)},
           {"about", claim.about},
           {"sentence", claim.sentence},
           {"sure", to_string(claim.sure)}};
  add_if(one, "strong", claim.strong);
  add_if(one, "heading", claim.heading);
  for (const Bar& bar : claim.bars) {
    Json at{{"solver", bar.solver},
            {"label", bar.label},
            {"value", bar.value ? json_number(*bar.value) : Json()},
            {"text", bar.text}};
    if (bar.interval) at["low"] = bar.interval->low, at["high"] = bar.interval->high;
    one["bars"].push_back(std::move(at));
  }
  if (!claim.bars.empty()) one["metric"] = claim.basis->front().quantity().name;
  for (const Evidence& evidence : *claim.basis) {
    const Quantity& q = refs.use(evidence.quantity().name);
    Json basis{{"metric", q.name},
               {"window", to_string(q.window == Window::none ? Window::run : q.window)},
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
      std::stable_partition(listed.begin(), listed.end(),
                            [](const auto* s) { return !std::isfinite(s->value); });
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
