#include "experiments/report/claims/claim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/format.hpp"

namespace taut::report {

namespace {

constexpr double kTolerance = kAlike - 1;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::string_view to_string(Sure sure) {
  constexpr std::array<std::string_view, 5> kWords{"clear", "likely", "too noisy", "no difference",
                                                   "single run"};
  return kWords[static_cast<std::size_t>(sure)];
}

std::string_view meaning(Sure sure) {
  constexpr std::array<std::string_view, 5> kMeanings{
      "the whole 95 % interval is further from 1 than 5 % and than identical code differed from "
      "itself, which was less than 5 %",
      "the 95 % interval excludes 1, and its middle is further from 1 than 5 % and than identical "
      "code differed from itself",
      "identical code differed from itself by more than the difference",
      "the 95 % interval has 1 in it, or its middle is within 5 % of 1",
      "computed, not timed: the same build gives the same bits on every run, so there is no "
      "spread"};
  return kMeanings[static_cast<std::size_t>(sure)];
}

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

Claim::Claim(std::string name, ClaimKind what, std::string of, std::string text, Sure how,
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

Claim::Claim(const Claim& of, std::string heading, std::string what, std::vector<Bar> bars)
    : id("tile-" + of.id),
      kind(ClaimKind::tile),
      about(of.about),
      sentence(std::move(what)),
      sure(of.sure),
      basis(of.basis),
      heading_(std::move(heading)),
      bars_(std::move(bars)) {}

Claim& Claim::emphasise(const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (!part.empty() && sentence.find(part) != std::string::npos) strong_.push_back(part);
  return *this;
}

Claim Claim::tile(std::string heading, std::string what, std::vector<Bar> bars) const {
  return {*this, std::move(heading), std::move(what), std::move(bars)};
}

std::optional<Sure> judge_ratio(const Interval& ratio, const Interval& control) {
  const double noise = spread(control), change = std::abs(std::log(ratio.mid));
  if (change <= std::log1p(kTolerance)) return {};
  if (change <= std::log1p(noise)) return Sure::too_noisy;
  if (ratio.contains(1)) return {};
  const double nearest = std::log(ratio.mid < 1 ? ratio.high : ratio.low);
  const bool clear = std::abs(nearest) > std::log1p(std::max(kTolerance, noise)) &&
                     (nearest < 0) == (ratio.mid < 1) && noise <= kTolerance;
  return clear ? Sure::clear : Sure::likely;
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

}  // namespace taut::report
