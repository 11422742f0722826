#include "experiments/truths/truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/solver.hpp"

namespace taut {

std::string_view to_string(TruthVerdict verdict) {
  constexpr std::array<std::string_view, 4> names{"passed", "deviates", "not applicable", "broken"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view section_title(int section) {
  constexpr std::array<std::string_view, 10> titles{"One constraint",
                                                    "The twin: Bullet is Jakobsen's algorithm",
                                                    "Motion without constraints",
                                                    "Pendulum, stick, chain",
                                                    "Stability of relaxation",
                                                    "Cloth",
                                                    "Contact",
                                                    "Published numbers",
                                                    "References",
                                                    "Metrics"};
  return titles[static_cast<std::size_t>(section - 1)];
}

bool Findings::wants(std::string_view subject) const {
  if (only_.empty()) return true;
  const std::string name = solver_name(subject);
  return std::any_of(only_.begin(), only_.end(),
                     [&](const std::string& o) { return o == name || o == subject; });
}

void Findings::add(Finding f) {
  if (wants(f.subject)) findings_.push_back(std::move(f));
}

namespace {

/// NaN is never within any tolerance.
bool within(double measured, double expected, double tolerance) {
  return std::abs(measured - expected) <= tolerance;
}

Finding finding(std::string_view subject, std::string_view quantity, std::string_view unit,
                double measured, double expected, double tolerance) {
  Finding f;
  f.subject = subject, f.quantity = quantity, f.unit = unit;
  f.measured = measured, f.expected = expected, f.tolerance = tolerance;
  f.verdict = within(measured, expected, tolerance) ? TruthVerdict::passed : TruthVerdict::broken;
  return f;
}

}  // namespace

void Findings::equal(std::string_view subject, std::string_view quantity, std::string_view unit,
                     double measured, double expected, double tolerance) {
  add(finding(subject, quantity, unit, measured, expected, tolerance));
}

void Findings::holds(std::string_view subject, std::string_view quantity, bool measured) {
  equal(subject, quantity, "1", measured, 1, 0);
}

void Findings::below(std::string_view subject, std::string_view quantity, std::string_view unit,
                     double measured, double limit) {
  equal(subject, quantity, unit, measured, 0, limit);
}

void Findings::slope(std::string_view subject, std::string_view quantity, const PowerLaw& fitted,
                     double expected, double tolerance) {
  Finding f = finding(subject, quantity, "1", fitted.exponent, expected, tolerance);
  f.uncertainty = fitted.error;
  add(std::move(f));
}

void Findings::deviates(std::string_view subject, std::string_view quantity, std::string_view unit,
                        double measured, double expected, double explained, double tolerance,
                        std::string_view why) {
  Finding f = finding(subject, quantity, unit, measured, expected, tolerance);
  const bool agrees = f.verdict == TruthVerdict::passed;
  if (!within(measured, explained, tolerance))
    f.verdict = TruthVerdict::broken;
  else if (!agrees)
    f.verdict = TruthVerdict::deviates;
  f.why = why;
  add(std::move(f));
}

void Findings::not_applicable(std::string_view subject, std::string_view why) {
  Finding f;
  f.subject = subject, f.verdict = TruthVerdict::not_applicable, f.why = why;
  f.measured = f.expected = std::nan("");
  add(std::move(f));
}

}  // namespace taut
