#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/larger.hpp"
#include "core/model/solver.hpp"
#include "core/reference/fit.hpp"
#include "experiments/answer/answer.hpp"

namespace taut {

/// Verdict on a measured number compared with a known one.
enum class TruthVerdict {
  passed,          ///< agrees within the tolerance
  deviates,        ///< differs for a known reason, by as much as that reason explains
  not_applicable,  ///< the solver does not offer what the truth is about
  broken           ///< differs: the testbed or the solver is wrong
};
std::string_view to_string(TruthVerdict);
Cell cell_of(TruthVerdict);
/// Inverse of to_string(); `broken` for any other text.
TruthVerdict verdict_of(std::string_view);

/// A number of a subject, compared with the truth.
struct Finding {
  std::string subject;   ///< "jakobsen:projection=exact,...", "static reference", "closed form"
  std::string quantity;  ///< what was measured
  std::string unit;      ///< "1" if dimensionless
  double measured = 0;
  double expected = 0;     ///< what the truth says
  double tolerance = 0;    ///< largest |measured - expected|; also for `deviates`
  double uncertainty = 0;  ///< standard error of a fitted slope; 0: not fitted
  TruthVerdict verdict = TruthVerdict::passed;
  std::string why;  ///< reason for a deviation, or what the solver does not offer
};

/// Collects the findings of one truth, and knows which solvers were asked for.
class Findings {
 public:
  /// only: names or texts of solvers; empty: all subjects. References count as "reference".
  explicit Findings(std::vector<std::string> only = {}) : only_(std::move(only)) {}

  /// Whether this subject's solver was asked for; if not, its work can be skipped.
  bool wants(std::string_view subject) const;
  /// The solvers that were asked for: names, and whole texts for external solvers. Empty: all.
  const std::vector<std::string>& asked() const { return only_; }

  /// Requires |measured - expected| <= tolerance (absolute, in the quantity's unit).
  void equal(std::string_view subject, std::string_view quantity, std::string_view unit,
             double measured, double expected, double tolerance);
  /// Requires a statement to be true.
  void holds(std::string_view subject, std::string_view quantity, bool measured);
  /// Requires 0 <= measured <= limit, for an error that has to be small.
  void below(std::string_view subject, std::string_view quantity, std::string_view unit,
             double measured, double limit);
  /// Compares a fitted exponent that has a standard error.
  void slope(std::string_view subject, std::string_view quantity, const PowerLaw& fitted,
             double expected, double tolerance);
  /// The truth says `expected`, but this subject legitimately has `explained` (within tolerance).
  /// It passes if both are within the tolerance of the measured number, since they cannot be told
  /// apart.
  void deviates(std::string_view subject, std::string_view quantity, std::string_view unit,
                double measured, double expected, double explained, double tolerance,
                std::string_view why);
  void not_applicable(std::string_view subject, std::string_view why);

  const std::vector<Finding>& all() const { return findings_; }

  /// Calls `watch` with each scene that can_run() lets run.
  void watch(std::function<void(const Scene&)> watch) { watch_ = std::move(watch); }
  void saw(const Scene& scene) const {
    if (watch_) watch_(scene);
  }

 private:
  void add(Finding);
  std::function<void(const Scene&)> watch_;
  std::vector<std::string> only_;
  std::vector<Finding> findings_;
};

/// Description of a truth, found by its TAUT_TRUTH line.
struct TruthEntry {
  std::string_view name;  ///< "hanging-chain-sweeps"
  /// 1 constraint, 2 twin, 3 free motion, 4 pendulum and chain, 5 stability, 6 cloth, 7 contact, 8
  /// published, 9 references, 10 metrics, 11 conformance.
  int section = 0;
  int row = 0;                 ///< within the section, from 1
  std::string_view statement;  ///< what must hold, one sentence with the formula
  std::string_view source;     ///< paper, book or derivation
  void (*check)(Findings&);
  /// The phenomenon whose one test in the conformance suite this is (experiments/truths/
  /// conformance); "": it does not belong to the suite.
  std::string_view phenomenon = "";
  std::string_view needs = "";  ///< what a solver has to have for it: "links, gravity"
};

/// An identifier with hyphens: "hanging-chain-sweeps" for hanging_chain_sweeps.
template <std::size_t length>
struct Hyphenated {
  consteval Hyphenated(const char (&id)[length]) {
    for (std::size_t i = 0; i < length; ++i) text[i] = id[i] == '_' ? '-' : id[i];
  }
  char text[length];
};

/// All truths (generated; see cmake/registry.cmake).
std::span<const TruthEntry* const> truths();

/// Title of a section of the list.
std::string_view section_title(int section);

/// A solver on a scene, stepped by hand. Solvers with a link order use the mesh order, which the
/// recurrences of the truths assume, unless the text chooses another.
class Simulation {
 public:
  /// Starts the scene and makes this many steps. From a program of its own a state that is not
  /// finite is a failure (SolverFailure: exploded), as in a case.
  Simulation(const Scene&, std::string_view solver, int steps = 0);
  void step(int n = 1);
  /// The values that `value()` returns after each of `steps` steps.
  template <class Value>
  std::vector<double> record(int steps, const Value& value) {
    std::vector<double> all;
    for (int n = 0; n < steps; ++n) {
      step();
      all.push_back(value());
    }
    return all;
  }
  /// The largest value that `error(n)` returns after the steps n = 1, 2, ... `steps`.
  template <class Error>
  double worst(int steps, const Error& error) {
    double most = 0;
    for (int n = 1; n <= steps; ++n) {
      step();
      most = larger(most, error(n));
    }
    return most;
  }
  const State& state() const { return state_; }
  const Vec3& x(int i) const { return state_.x[to_index(i)]; }
  const Vec3& v(int i) const { return state_.v[to_index(i)]; }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  std::unique_ptr<Solver> solver_;
  bool foreign_;
  State state_;
  int n_ = 0;
};

/// Whether the solver was asked for, exists in this program and can run the scene. If it was asked
/// for but cannot, the findings get "not applicable" with the reasons.
bool can_run(Findings&, std::string_view solver, const Scene&);

constexpr const char* kStatic = "reference:static";  ///< core/reference/static_equilibrium
constexpr const char* kShake = "reference:shake";    ///< core/reference/shake

/// Settings that the truths hold to rounding: jakobsen as published, with one substep and the links
/// in the scene's own order unless `more` says otherwise, and the corresponding ones of other
/// solvers.
std::string jakobsen(int iterations, std::string_view projection = "exact",
                     std::string_view more = "");
std::string bullet(int iterations);
std::string xpbd(int substeps, std::string_view more = "");
std::string mass_spring(std::string_view integrator, double stiffness, double drag = 0);

/// Scenes without gravity, damping, wind or contact, with dt = 1/64 s, which truths complete.
namespace bare {

/// A scene of only vertices, masses and links.
Scene scene(std::vector<Vec3> x, std::vector<double> mass, std::vector<Link> links,
            std::vector<int> pins = {});
/// Two vertices `distance` apart on a link of length `rest`.
Scene pair(double distance, double rest, double mass1 = 1, double mass2 = 1);
/// `n` free vertices of `mass` on links of length/n, hung straight along `direction` from the
/// pinned vertex 0 at the origin.
Scene chain(int n, double length, double mass, const Vec3& direction = -Vec3::UnitY());
/// A flat sheet in the x-y plane, not pinned.
Scene sheet(int nu, int nv, const LinkChoice& = {}, Lumping = Lumping::area, double width = 1,
            double height = 1, double mass = 0.2);

}  // namespace bare

/// The scene with gravity downwards in y.
Scene under_gravity(Scene);

/// (length - rest) [m] of every link.
std::vector<double> strains(const Scene&, const State&);
/// Largest and root mean square of | length/rest - 1 | over the links.
double max_strain(const Scene&, const State&);
double rms_strain(const Scene&, const State&);
/// Largest distance between corresponding vertices [m].
double max_distance(const std::vector<Vec3>&, const std::vector<Vec3>&);

/// Runs until the fastest vertex is slower than `speed` [m/s] at 10 successive looks, `every` steps
/// apart, or for at most `limit` steps. Returns whether it came to rest.
bool settle(Simulation&, double speed, int every, int limit);

/// The power law through y(x) at the given x.
template <class Y>
PowerLaw fit_over(const std::vector<double>& x, const Y& y) {
  std::vector<double> values;
  for (const double at : x) values.push_back(y(at));
  return fit_power_law(x, values);
}

inline constexpr double kG = 9.81;  ///< m/s^2

}  // namespace taut

/// Defines a truth within namespace taut: its name with underscores, section and row of the list
/// (as in `taut verify --section 4`), what must hold, and its source; then follows the function
/// that checks it:
///     TAUT_TRUTH(weightless, 3, 99, "Without forces ...", "Newton") { findings.below(...); }
/// A test of the conformance suite also has its phenomenon and what it needs.
#define TAUT_TRUTH(id, section, row, statement, source, ...)                                   \
  static void check_##id(Findings&);                                                           \
  static constexpr Hyphenated name_##id(#id);                                                  \
  extern const TruthEntry truth_##id;                                                          \
  const TruthEntry truth_##id{name_##id.text, section, row,                                    \
                              statement,      source,  check_##id __VA_OPT__(, ) __VA_ARGS__}; \
  static void check_##id(Findings& findings)
