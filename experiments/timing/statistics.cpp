#include "experiments/timing/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iomanip>
#include <limits>
#include <random>
#include <sstream>

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

std::string number_text(double value, int digits) {
  if (std::isnan(value)) return "-";
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

std::string interval_text(const Interval& i, double unit) {
  return number_text(i.mid / unit) + " (" + number_text(i.low / unit) + " to " +
         number_text(i.high / unit) + ")";
}

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
    // The high bits times the count: the same index everywhere, unlike
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

Difference compare_costs(const Interval& ratio, const Interval& control, double tolerance) {
  if (!(spread(control) <= tolerance)) return Difference::too_noisy;
  if (ratio.contains(1) || !(std::abs(std::log(ratio.mid)) > std::log1p(tolerance)))
    return Difference::none;
  return ratio.mid < 1 ? Difference::faster : Difference::slower;
}

}  // namespace taut
