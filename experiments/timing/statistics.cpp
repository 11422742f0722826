#include "experiments/timing/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <random>

#include "core/model/names.hpp"

namespace taut {

namespace {

double median_of(std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace

double median(std::span<const double> samples) {
  std::vector<double> values(samples.begin(), samples.end());
  return median_of(values);
}

Interval bootstrap_median(std::span<const double> samples, double confidence, std::uint64_t seed) {
  constexpr std::size_t kResamples = 2000;
  if (samples.empty()) return {median(samples), median(samples), median(samples)};
  std::mt19937_64 random(seed);
  std::vector<double> medians(kResamples), resample(samples.size());
  for (double& m : medians) {
    // Multiplying the high bits by the count gives the same index on every platform, unlike
    // std::uniform_int_distribution.
    for (double& value : resample) value = samples[((random() >> 32) * samples.size()) >> 32];
    m = median_of(resample);
  }
  std::sort(medians.begin(), medians.end());
  const auto at = [&](double q) {
    return medians[static_cast<std::size_t>(std::lround(q * static_cast<double>(kResamples - 1)))];
  };
  return {at((1 - confidence) / 2), median(samples), at((1 + confidence) / 2)};
}

Interval interleaved_ratio(std::span<const double> a, std::span<const double> b, double confidence,
                           std::uint64_t seed) {
  assert(a.size() == b.size() && a.size() % 2 == 0);
  std::vector<double> logs;
  for (std::size_t i = 0; i < a.size(); i += 2)
    logs.push_back(std::log((a[i] + a[i + 1]) / (b[i] + b[i + 1])));
  const Interval log = bootstrap_median(logs, confidence, seed);
  return {std::exp(log.low), std::exp(log.mid), std::exp(log.high)};
}

double spread(const Interval& control) {
  return std::expm1(std::max(std::abs(std::log(control.low)), std::abs(std::log(control.high))));
}

std::string_view to_string(Certainty certainty) {
  constexpr Names<Certainty::unopposed> kWords{"clear",         "likely",     "too noisy",
                                               "no difference", "single run", "unopposed"};
  return kWords[certainty];
}

Certainty judge(const Interval& ratio, const Interval& control, double tolerance) {
  const double noise = spread(control), change = std::abs(std::log(ratio.mid));
  if (change <= std::log1p(tolerance)) return Certainty::none;
  if (change <= std::log1p(noise)) return Certainty::too_noisy;
  if (ratio.contains(1)) return Certainty::none;
  const double nearest = std::abs(std::log(ratio.mid < 1 ? ratio.high : ratio.low));
  return noise <= tolerance && nearest > std::log1p(tolerance) ? Certainty::clear
                                                               : Certainty::likely;
}

bool beyond_both(const Interval& ratio, const Interval& control, double tolerance) {
  const double nearest = std::abs(std::log(ratio.mid < 1 ? ratio.high : ratio.low));
  return !ratio.contains(1) && nearest > std::log1p(std::max(tolerance, spread(control)));
}

bool same_within(double tolerance, const Interval& ratio) { return spread(ratio) <= tolerance; }

}  // namespace taut
