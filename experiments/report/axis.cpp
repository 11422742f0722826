#include "experiments/report/axis.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "experiments/metrics/metric.hpp"
#include "experiments/report/format.hpp"

namespace taut::report {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Titled {
  std::string_view name, title, unit;
};
constexpr std::array kTitles{
    Titled{"dt", "time step", "s"},
    Titled{"iterations", "sweeps per step", ""},
    Titled{"substeps", "substeps per step", ""},
    Titled{"steps", "steps", ""},
    Titled{"t", "simulated time", "s"},
    Titled{"projections", "constraint projections per step", ""},
    Titled{"vertices", "vertices", ""},
    Titled{"links", "links", ""},
    Titled{"cpu.per_second", "CPU time per simulated second", "s"},
    Titled{"cpu.per_step", "CPU time per step", "s"},
    Titled{"wall.per_step", "wall time per step", "s"},
    Titled{"memory.peak", "peak memory of the process", "MB"},
    Titled{"reference.rms", "distance from the reference (RMS)", "m"},
    Titled{"reference.max", "largest distance from the reference", "m"},
    Titled{"reference.motion", "distance from the reference in motion (RMS)", "m"},
    Titled{"structural", "stiffness of structural springs", "N/m"},
    Titled{"omega", "relaxation factor", ""},
    Titled{"cloth.weights.0.factor", "mass ratio", ""},
};

/// The number that makes up all of the text; NaN if none does.
double number(const std::string& text) {
  double value = kNaN;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end ? value : kNaN;
}

/// The last number that the case gives a scene key; NaN if none.
double overridden(const Record& record, const std::string& key) {
  double value = kNaN;
  for (const std::string& text : record.spec.overrides)
    if (text.starts_with(key + "=")) value = number(text.substr(key.size() + 1));
  return value;
}

std::string metric_title(std::string_view name) {
  std::string title(name);
  std::ranges::replace_if(
      title, [](char c) { return c == '.' || c == '_'; }, ' ');
  for (const auto& [from, to] : {std::pair<std::string, std::string>{" rms", "RMS "},
                                 {" max", "largest "},
                                 {" p95", "95th percentile "},
                                 {" mean", "mean "}})
    if (title.ends_with(from)) title = to + title.substr(0, title.size() - from.size());
  return title;
}

/// Strains and shares read as per cent; counts and ratios of energies do not.
bool is_share(std::string_view name) {
  constexpr std::array<std::string_view, 8> kStarts{
      "stretch", "compression", "structural", "shear",
      "bend",    "area",        "strain",     "penetration.share"};
  return name == "tunnelling.share" ||
         std::ranges::any_of(kStarts, [&](auto start) { return name.starts_with(start); });
}

void set_unit(Quantity& q, std::string_view si) {
  if (si == "1") {
    if (is_share(q.name)) q.unit = "%", q.scale = 100;
  } else if (si == "m") {
    q.unit = "mm", q.scale = 1e3;
  } else if (si == "s" && q.name != "t" && !q.name.starts_with("settle")) {
    q.unit = "ms", q.scale = 1e3;
  } else if (si == "MB") {
    q.unit = si, q.scale = 1e-6;
  } else {
    q.unit = si;
  }
}

}  // namespace

double value_of(const Record& record, std::string_view name) {
  if (name == "dt") return record.dt;
  if (name == "steps") return record.steps;
  if (name == "vertices") return record.vertices;
  if (name == "links") return record.links;
  if (name == "projections") return static_cast<double>(record.projections);
  const std::string key(name);
  if (const auto value = record.values.find(key); value != record.values.end())
    return value->second;
  const auto param = record.params.find(key);
  return param == record.params.end() ? overridden(record, key) : number(param->second);
}

std::string Quantity::text(double si, int digits) const {
  const bool counted = unit.empty() && si == std::round(si) && std::abs(si) < 1e7;
  const std::string number = counted ? exact(si) : significant(si * scale, digits);
  return unit.empty() || !std::isfinite(si) ? number : number + "\u00A0" + unit;
}

Quantity quantity(std::string_view name) {
  Quantity q{std::string(name), std::string(name), "", 1};
  if (const auto known = std::ranges::find(kTitles, name, &Titled::name); known != kTitles.end()) {
    q.title = known->title;
    set_unit(q, known->unit);
    return q;
  }
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values)
      if (value.name == name) {
        q.title = metric_title(name);
        set_unit(q, value.unit);
      }
  return q;
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> names;
  for (const Titled& known : kTitles) names.emplace_back(known.name);
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values) names.emplace_back(value.name);
  return names;
}

double Axis::position(double shown) const {
  const double t =
      log ? std::log(shown / low) / std::log(high / low) : (shown - low) / (high - low);
  return std::clamp(t, 0.0, 1.0);
}

namespace {

/// Decades, with 2 and 5 between them if there are few.
void log_ticks(Axis& axis) {
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  const int last = static_cast<int>(std::ceil(std::log10(axis.high)));
  const bool few = std::log10(axis.high / axis.low) < 2.2;
  const int stride = std::max(1, (last - first) / 5);
  for (int e = first; e <= last; ++e)
    for (int m = 1; m < 10; ++m) {
      const double at = m * std::pow(10.0, e);
      if (at < axis.low * (1 - 1e-9) || at > axis.high * (1 + 1e-9)) continue;
      const bool labelled = m == 1 ? (e - first) % stride == 0 : few && (m == 2 || m == 5);
      if (labelled || stride == 1) axis.ticks.emplace_back(at, labelled ? tick_text(at, 1) : "");
    }
}

void linear_ticks(Axis& axis) {
  const double raw = (axis.high - axis.low) / 4;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * decade;
  for (const double m : {5.0, 2.5, 2.0, 1.0})
    if (m * decade >= raw * 0.999) step = m * decade;
  axis.low = std::floor(axis.low / step + 1e-9) * step;
  axis.high = std::ceil(axis.high / step - 1e-9) * step;
  const int count = static_cast<int>(std::lround((axis.high - axis.low) / step));
  for (int i = 0; i <= count; ++i) {
    const double at = axis.low + i * step;
    axis.ticks.emplace_back(at, significant(std::abs(at) < step * 1e-6 ? 0 : at, 3));
  }
  for (auto& [at, text] : axis.ticks)  // 0.50 -> 0.5
    if (text.find('.') != std::string::npos && text.find('e') == std::string::npos) {
      while (text.back() == '0') text.pop_back();
      if (text.back() == '.') text.pop_back();
    }
}

}  // namespace

Axis fit_axis(const Quantity& q, const std::vector<double>& shown, bool log) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : shown)
    if (std::isfinite(value) && (!log || value > 0))
      low = std::min(low, value), high = std::max(high, value);
  Axis axis{q, low, high, log, {}};
  if (!(low <= high)) axis.low = log ? 0.1 : 0, axis.high = 1;  // nothing to show
  if (log) {
    axis.low /= 2.2;
    axis.high *= 1.5;
    if (axis.high / axis.low < 12) {
      const double middle = std::sqrt(axis.low * axis.high);
      axis.low = middle / 3.5, axis.high = middle * 3.5;
    }
    log_ticks(axis);
  } else {
    axis.low = std::min(0.0, axis.low);
    if (axis.high <= axis.low) axis.high = axis.low + 1;
    linear_ticks(axis);
  }
  return axis;
}

Axis sweep_axis(const Quantity& q, std::vector<double> shown, std::size_t most_labels) {
  std::erase_if(shown, [](double v) { return !std::isfinite(v) || v <= 0; });
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  if (shown.empty()) return fit_axis(q, shown, true);
  Axis axis{q, shown.front() / 1.15, shown.back() * 1.15, true, {}};
  if (shown.size() == 1) axis.low /= 2, axis.high *= 2;
  const std::size_t stride = (shown.size() + most_labels - 1) / most_labels;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // Counted from the right: the largest value always has its label.
    const bool labelled = (shown.size() - 1 - i) % stride == 0;
    const int digits = shown[i] == std::round(shown[i]) && shown[i] < 1e5 ? 5 : 2;
    axis.ticks.emplace_back(shown[i], !labelled ? ""
                                      : digits == 5 && shown[i] < 1e4
                                          ? exact(shown[i])
                                          : tick_text(shown[i], digits));
  }
  return axis;
}

}  // namespace taut::report
