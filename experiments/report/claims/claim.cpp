#include "experiments/report/claims/claim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/wording.hpp"

namespace taut::report {

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
