#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

/// A solver on a scene, stepped by hand. Solvers that offer a link order get the mesh order, which
/// the recurrences of the truths assume, unless the text chooses one.
class Simulation {
 public:
  /// After so many steps.
  Simulation(const Scene&, std::string_view solver, int steps = 0);
  void step(int n = 1);
  /// What `value()` gives after each of so many steps.
  template <class Value>
  std::vector<double> record(int steps, const Value& value) {
    std::vector<double> all;
    for (int n = 0; n < steps; ++n) step(), all.push_back(value());
    return all;
  }
  /// The largest of what `error(n)` gives after the steps n = 1, 2, ... `steps`.
  template <class Error>
  double worst(int steps, const Error& error) {
    double most = 0;
    for (int n = 1; n <= steps; ++n) step(), most = std::max(most, error(n));
    return most;
  }
  const State& state() const { return state_; }
  const Vec3& x(int i) const { return state_.x[to_index(i)]; }
  const Vec3& v(int i) const { return state_.v[to_index(i)]; }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  std::unique_ptr<Solver> solver_;
  State state_;
  int n_ = 0;
};

/// Whether the solver was asked for, exists in this program and can do the scene; if it was asked
/// for but cannot, the findings get "not applicable" with the reasons.
bool can_run(Findings&, std::string_view solver, const Scene&);

constexpr const char* kStatic = "reference:static";  ///< core/reference/static_equilibrium
constexpr const char* kShake = "reference:shake";    ///< core/reference/shake

/// The settings that the truths hold to rounding: ours as published, one substep, the links in the
/// scene's own order, unless `more` says otherwise; and those of the others.
std::string jakobsen(int iterations, std::string_view projection = "exact",
                     std::string_view more = "");
std::string bullet(int iterations);
std::string xpbd(int substeps, std::string_view more = "");
std::string mass_spring(std::string_view integrator, double stiffness, double drag = 0);

/// Scenes without gravity, damping, wind or contact, dt = 1/64 s, that truths complete.
namespace bare {

/// From vertices, masses and links alone.
Scene scene(std::vector<Vec3> x, std::vector<double> mass, std::vector<Link> links,
            std::vector<int> pins = {});
/// Two vertices `distance` apart on a link of length `rest`.
Scene pair(double distance, double rest, double mass1 = 1, double mass2 = 1);
/// `n` free vertices of `mass` on links of length/n, hung straight from the pinned vertex 0 at the
/// origin along `direction`.
Scene chain(int n, double length, double mass, const Vec3& direction = -Vec3::UnitY());
/// A flat sheet in the x-y plane, not pinned.
Scene sheet(int nu, int nv, const LinkChoice& = {}, Lumping = Lumping::area, double width = 1,
            double height = 1, double mass = 0.2);

}  // namespace bare

Scene under_gravity(Scene);  ///< the same with gravity, downwards in y

/// (length - rest) [m] of every link.
std::vector<double> strains(const Scene&, const State&);
/// Largest and root mean square of | length/rest - 1 | over the links.
double max_strain(const Scene&, const State&);
double rms_strain(const Scene&, const State&);
/// Largest distance between corresponding vertices [m].
double max_distance(const std::vector<Vec3>&, const std::vector<Vec3>&);

/// Runs until the fastest vertex is slower than `speed` [m/s] in 10 successive looks, `every` steps
/// apart, or for at most `limit` steps; true if it came to rest.
bool settle(Simulation&, double speed, int every, int limit);

/// The power law through y(x) at these x.
template <class Y>
PowerLaw fit_over(const std::vector<double>& x, const Y& y) {
  std::vector<double> values;
  for (const double at : x) values.push_back(y(at));
  return fit_power_law(x, values);
}

inline constexpr double kG = 9.81;  ///< m/s^2

}  // namespace taut
