#include "core/reference/strain_at_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "core/reference/static_equilibrium.hpp"

namespace taut::reference {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A parameter without which the law holds.
struct Needed {
  std::string_view parameter, values;  ///< values: "a|b"
  std::string_view why;                ///< why not with others
};
/// A solver whose sweeps the law describes.
struct Sweeper {
  std::string_view solver;
  Visits visits;
  std::array<Needed, 4> needs;
};
constexpr Needed kNoTethers{"tethers", "off", "tethers hold vertices from afar"},
    kNoChebyshev{"chebyshev", "0", "Chebyshev's sweeps are not k equal ones"};
constexpr Sweeper kSweepers[] = {
    {"jakobsen",
     Visits::links,
     {{{"method", "gauss-seidel|jacobi-averaged|jacobi-underrelaxed",
        "lines, and corrections summed without damping, are no sweeps of this kind"},
       kNoChebyshev,
       {"levels", "1", "coarse levels carry what sweeps would have to"},
       kNoTethers}}},
    {"xpbd",
     Visits::links,
     {{{"method", "sweeps", "all links are solved at once"},
       {"multipliers", "keep", "it loses the compliance"},
       kNoTethers,
       {}}}},
    {"vbd",
     Visits::vertices,
     {{{"start", "inertia",
        "it never rests: its start takes back the fall of vertices that something held"},
       kNoChebyshev,
       {"damping", "0", "damping acts within the sweeps"},
       {}}}}};
const Sweeper* sweeper(const SolverChoice& choice) {
  const auto at = std::ranges::find(kSweepers, choice.entry->name, &Sweeper::solver);
  return at == std::end(kSweepers) ? nullptr : at;
}

/// A sheet of springs of more vertices would take too much memory, 6 kB each.
constexpr int kMostVertices = 100'000;
/// Vertices along a side of the twin, and along one of a strip; the most vertices of a mesh that is
/// its own twin.
constexpr int kTwin = 13, kLongTwin = 49, kOwnTwin = 1100;

/// Where the law ends: s; the largest strain; the RMS strain with square-root-free projections,
/// which correct 1 + e times as much on a link strained by e (there it is 10 % too high); the share
/// of a strain or of a fall that float may round; the share of the extent that the cloth may still
/// have to go to its rest at the scene's end.
constexpr double kMostSaturated = 1.5, kMostStrain = 1, kMostWithoutRoot = 0.02,
                 kMostRounding = 0.05, kMostWay = 0.05;
/// Largest mass of a vertex, over that of most, for descent.
constexpr double kMostMass = 2.5;
/// Least share of the strain that sweeps leave for s to matter.
constexpr double kSwept = 0.1;
/// s up to which the twin of a descent is run, and where its law ends. Above it, with soft springs
/// and one to three sweeps, 8 of 100 scenes were off by 15 to 51 %.
constexpr double kMostOfDescent = 0.3;

/// s / (e^s - 1), 1 at 0.
double left_of(double s) { return s > 1e-9 ? s / std::expm1(s) : 1; }

bool counts(const Link& l) { return l.family != Family::bend; }

/// Sums over the links of a sheet.
struct Sums {
  double square = 0, most = 0, energy = 0;  ///< energy: sum T C [J]
  int count = 0;
  double rms() const { return count > 0 ? std::sqrt(square / count) : 0; }
};
/// c: [links] m, the length beyond rest.
template <class Excess>
Sums sum_over(const Scene& scene, const std::vector<double>& w, const std::vector<double>& tension,
              const Excess& excess) {
  Sums out;
  for (std::size_t j = 0; j < scene.links.size(); ++j) {
    const Link& l = scene.links[j];
    if (w[to_index(l.a)] + w[to_index(l.b)] == 0) continue;
    const double c = excess(j);
    out.energy += tension[j] * c;
    if (!counts(l)) continue;
    const double e = c / l.rest;
    out.square += e * e;
    out.most = std::max(out.most, e);
    ++out.count;
  }
  return out;
}

/// Weight of what moves [N], each vertex `load` times; empty: once.
double weight_of(const Scene& scene, const std::vector<double>& w,
                 const std::vector<double>& load = {}) {
  double sum = 0;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) sum += (load.empty() ? 1 : load[i]) / w[i];
  return sum * scene.gravity.norm();
}
/// Mass of most vertices that move [kg]: their median, since edges weigh half.
double usual_mass(const std::vector<double>& w) {
  std::vector<double> all;
  for (const double one : w)
    if (one > 0) all.push_back(1 / one);
  if (all.empty()) return 0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  return *middle;
}

/// What a vertex's own update meets along gravity: the sum of its links' (u.g/|g|)^2, over that of
/// most vertices; 1 for pins.
std::vector<double> held_along(const Scene& scene, const std::vector<double>& w,
                               const std::vector<Vec3>& x) {
  std::vector<double> held(w.size());
  const Vec3 down = scene.gravity.normalized();
  for (const Link& l : scene.links) {
    const Vec3 d = x[to_index(l.b)] - x[to_index(l.a)];
    const double along = d.dot(down) / d.norm();
    held[to_index(l.a)] += along * along;
    held[to_index(l.b)] += along * along;
  }
  std::vector<double> of_free;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) of_free.push_back(held[i]);
  const auto middle = of_free.begin() + static_cast<std::ptrdiff_t>(of_free.size() / 2);
  std::ranges::nth_element(of_free, middle);
  for (std::size_t i = 0; i < w.size(); ++i) held[i] = w[i] > 0 ? held[i] / *middle : 1;
  return held;
}

/// A sheet of the same kind that is small enough to be run.
Scene twin_of(const Scene& scene) {
  Scene twin = scene;
  if (scene.mesh.grid) {
    // Cells keep their shape. A long strip is as wide as it is, or as kTwin.
    const auto [nu, nv] = std::pair(scene.mesh.grid->nu, scene.mesh.grid->nv);
    const int narrow = std::min(nu, nv), wide = std::max(nu, nv);
    const double smaller =
        std::min(1.0, (kTwin - 1.0) / std::max(1, (narrow > 2 ? narrow : wide) - 1));
    const auto side = [&](int n) {
      return n < 3 ? n
                   : std::min({n, kLongTwin, static_cast<int>(std::lround((n - 1) * smaller)) + 1});
    };
    twin = coarse_sheet(scene, side(nu), side(nv));
  }
  twin.stiffness = kRigid;
  twin.damping = 0;
  std::ranges::fill(twin.start.v, Vec3::Zero());
  return twin;
}

/// The solver with one sweep in one substep, in double, and with links that are rigid or have
/// springs of `stiffness`.
SolverChoice one_sweep(const SolverChoice& choice, double stiffness) {
  SolverChoice one = choice;
  const auto set = [&](std::string_view name, const std::string& value) {
    if (!name.empty() && one.params.has(name)) one = one.with(name, value);
  };
  set(choice.entry->accuracy.sweeps, "1");
  set(choice.entry->accuracy.substeps, "1");
  set(parameter_with(ParamSpec::Role::precision, choice.params.specs()), "double");
  for (const ParamSpec& spec : choice.params.specs())
    if (spec.family) set(spec.name, spec.is_compliance ? "0" : shortest(stiffness));
  return one;
}

}  // namespace

/// The sheet that is run, with rigid links, or springs so stiff that sweeps alone decide. It
/// starts as the scene does, since sheets that fold may rest in several ways. Damping ends its
/// swinging.
class StrainAtRest::Twin {
 public:
  Twin(const Scene& scene, const SolverChoice& choice, Visits visits)
      : scene_(twin_of(scene)),
        w_(inverse_masses(scene_)),
        time_(std::sqrt(extent(scene_) / scene_.gravity.norm())),
        step_(time_ / kSteps) {
    scene_.damping = 2 / time_;
    const double a = usual_mass(w_) / (step_ * step_);
    std::vector<double> unit;  // K of the law with c = 1
    for (const Link& l : scene_.links) {
      const double sum = w_[to_index(l.a)] + w_[to_index(l.b)];
      unit.push_back(kSweeps *
                     (visits == Visits::vertices || sum == 0 ? a : 1 / (step_ * step_ * sum)));
    }
    choice_ = one_sweep(choice, kStiff * a);
    RestingSprings springs(scene_);
    RestingSprings::Rest rest;
    // Stiff springs: each vertex is lifted by what its links hold, whatever its mass.
    std::vector<double> load;
    const auto put_on = [&](const std::vector<Vec3>& x) {
      if (visits == Visits::links) return;
      load = held_along(scene_, w_, x);
      for (std::size_t i = 0; i < load.size(); ++i) load[i] *= w_[i] * usual_mass(w_);
    };
    put_on(scene_.start.x);
    Sums ran;
    double c = kUsual;
    // strains are nearly proportional to 1/c, but not where links share loads anew as they stretch
    for (int n = 0; n < kRounds; ++n) {
      std::vector<double> k = unit;
      for (double& one : k) one *= c;
      rest = springs.rest(k, rest.found ? &rest : nullptr, load);
      if (!rest.found) break;
      put_on(rest.x);
      const Sums sums =
          sum_over(scene_, w_, rest.tension, [&](std::size_t j) { return rest.tension[j] / k[j]; });
      strain_ = sums.rms();
      most_ = sums.most / strain_;
      s_ = scene_.gravity.norm() * step_ * step_ / (sums.energy / weight_of(scene_, w_, load));
      if (n == 0) ran = run(static_cast<int>(kSweeps));
      const double law = left_of(s_) * strain_, too_much = law / ran.rms();
      if (!std::isfinite(too_much)) break;
      if (std::abs(too_much - 1) < kMatched) {
        c_ = c;
        known_[static_cast<int>(kSweeps)] = {1 / too_much, ran.most / (most_ * law)};
        break;
      }
      c *= too_much;
    }
  }

  double c() const { return c_; }

  /// Factors from the law to a run in which the corrections of a substep are s.
  struct Correction {
    double rms = 1, largest = 1;
  };
  Correction at(double s) {
    const int k =
        s < kSmall
            ? static_cast<int>(kSweeps)
            : static_cast<int>(std::lround(std::clamp(kSweeps * s / s_, kSweeps, kMostSweeps)));
    if (const auto known = known_.find(k); known != known_.end()) return known->second;
    const Sums ran = run(k);
    const double law = left_of(k / kSweeps * s_) * strain_;
    return known_[k] = {ran.rms() / law, ran.most / (most_ * law)};
  }

 private:
  static constexpr double kUsual = 1.5;  ///< c of a usual order
  static constexpr double kSmall = 0.1;  ///< s below which the law needs no correction for it
  static constexpr double kStiff = 1e6;  ///< as a multiple of m/h^2
  /// Sweeps in a step that is this part of sqrt(extent/g). With more sweeps, steps are longer, so
  /// that the strain stays as small.
  static constexpr double kSweeps = 4, kSteps = 200, kMostSweeps = 10000;
  /// A run lasts so many sqrt(extent/g), and until slow modes, of which a step takes s/2, have lost
  /// so many of their e-folds; its last part is averaged.
  static constexpr double kTimes = 4, kFolds = 8, kAveraged = 0.2;
  static constexpr int kMostSteps = 100000;
  /// Rounds in which c is matched to the run, and how well [relative].
  static constexpr int kRounds = 10;
  static constexpr double kMatched = 1e-3;

  Sums run(int k) const {
    Scene scene = scene_;
    scene.dt = step_ * std::sqrt(k / kSweeps);
    const SolverChoice choice = choice_.with(choice_.entry->accuracy.sweeps, std::to_string(k));
    const std::unique_ptr<Solver> solver = choice.entry->make(scene, choice.params);
    State state = scene.start;
    solver->load(state);
    const std::vector<double> none(scene.links.size());
    const double steps = std::min<double>(
        std::max(kTimes * time_ / scene.dt, 2 * kFolds * kSweeps / (k * s_)), kMostSteps);
    const int last = static_cast<int>(steps), from = static_cast<int>((1 - kAveraged) * steps);
    Sums mean;
    int count = 0;
    for (int n = 0; n <= last; ++n) {
      solver->step(n * scene.dt, scene.dt);
      if (n < from) continue;
      solver->store(state);
      const Sums now = sum_over(scene, w_, none, [&](std::size_t j) {
        const Link& l = scene.links[j];
        return (state.x[to_index(l.b)] - state.x[to_index(l.a)]).norm() - l.rest;
      });
      mean.square += now.square;
      mean.most += now.most;
      mean.count = now.count;
      ++count;
    }
    mean.square /= count;
    mean.most /= count;
    return mean;
  }

  Scene scene_;
  std::vector<double> w_;
  double time_, step_;  ///< s
  SolverChoice choice_;
  double strain_ = 0,
         most_ = 0;  ///< RMS strain of kSweeps, without share; the largest relative to it
  double s_ = 0;     ///< of kSweeps
  double c_ = kNone;
  std::map<int, Correction> known_;
};

struct StrainAtRest::Work {
  Work(const Scene& of, const SolverChoice& solver)
      : scene(of),
        choice(solver),
        visits(sweeper(solver)->visits),
        w(inverse_masses(of)),
        weight(weight_of(of, w)),
        stiffness(taut::stiffness_of(of, solver.params)),
        springs(of),
        twin(of, solver, visits),
        c(twin.c()) {}

  double inverse_mass(const Link& l) const { return w[to_index(l.a)] + w[to_index(l.b)]; }
  double spring_of(const Link& l) const { return stiffness[static_cast<std::size_t>(l.family)]; }

  /// Rest of the sheet with these springs, from that of the last ones.
  const RestingSprings::Rest& rest(const std::vector<double>& k,
                                   const std::vector<double>& load = {}) {
    last = springs.rest(k, last && last->found ? &*last : nullptr, load);
    return *last;
  }

  Strain at(double sweeps, double substeps) {
    const double h = scene.dt / substeps;
    return visits == Visits::links ? of_projections(sweeps, h) : of_descent(sweeps, h);
  }

  Strain strain_of(const Sums& sums, double s, double share) const {
    return {.rms = sums.rms(),
            .largest = sums.most,
            .sag = sums.energy / weight,
            .s = s,
            .share = share,
            .found = last->found};
  }
  double fall(double h) const { return scene.gravity.norm() * h * h; }

  Strain of_projections(double sweeps, double h) {
    std::vector<double> k(scene.links.size()), own(scene.links.size(), 1.0);
    for (std::size_t j = 0; j < k.size(); ++j)
      if (const double sum = inverse_mass(scene.links[j]); sum > 0) {
        own[j] = c * sweeps / (h * h * sum);
        k[j] = 1 / (1 / own[j] + 1 / spring_of(scene.links[j]));
      } else {
        k[j] = 1;
      }
    const auto& tension = rest(k).tension;
    const double sag =
        sum_over(scene, w, tension, [&](std::size_t j) { return tension[j] / k[j]; }).energy /
        weight;
    const double s = fall(h) / sag;
    const Twin::Correction ran = twin.at(std::min(s, kMostSaturated));
    const auto swept = [&](std::size_t j) {
      const double a = 1 / (spring_of(scene.links[j]) * h * h);
      const double more = a > 0 ? 2 * sweeps * a / (inverse_mass(scene.links[j]) + a) : 0;
      return left_of(s + more) * tension[j] / own[j];
    };
    const auto excess = [&](std::size_t j, double factor) {
      return tension[j] / spring_of(scene.links[j]) + factor * swept(j);
    };
    const Sums all = sum_over(scene, w, tension, [&](std::size_t j) { return excess(j, ran.rms); });
    Strain out = strain_of(all, s, left_of(s));
    out.largest =
        sum_over(scene, w, tension, [&](std::size_t j) { return excess(j, ran.largest); }).most;
    out.of_sweeps = sum_over(scene, w, tension, swept).rms() / all.rms();
    return out;
  }

  Strain of_descent(double sweeps, double h) {
    const double spring = *spring_of_all(), a = usual_mass(w) / (h * h);
    const std::vector<double> k(scene.links.size(), spring);
    double factor = spring * (1 / spring + 1 / (c * sweeps * a)), s = 0;
    std::vector<double> load(w.size(), factor);
    Sums sums;
    for (int round = 0; round < kRounds; ++round) {
      const auto& [x, tension, unbalanced, solves, found] = rest(k, load);
      sums = sum_over(scene, w, tension,
                      [&, &tension = tension](std::size_t j) { return tension[j] / spring; });
      const double sag = sums.energy / weight_of(scene, w, load) / factor;  // of the springs alone
      const double q = fall(h) / sag;
      const std::vector<double> held = held_along(scene, w, x);
      const auto s_of = [&](double own, double holds) {
        return sweeps * (1 + q) * own / (own + holds * spring / c);
      };
      const auto factor_of = [&](double one) {
        return (1 + q * std::exp(-one)) / -std::expm1(-one);
      };
      s = s_of(a, 1);
      factor = factor_of(s);
      for (std::size_t i = 0; i < w.size(); ++i)
        if (w[i] > 0) load[i] = factor_of(s_of(1 / (w[i] * h * h), held[i]));
    }
    const Twin::Correction ran = twin.at(std::min(s, kMostOfDescent));
    const auto corrected = [&](double by) { return (1 + (factor - 1) * by) / factor; };
    sums.square *= corrected(ran.rms) * corrected(ran.rms);
    sums.most *= corrected(ran.largest);
    sums.energy *= corrected(ran.rms) * weight / weight_of(scene, w, load);
    Strain out = strain_of(sums, s, left_of(s));
    out.of_sweeps = 1 - 1 / factor;
    return out;
  }
  static constexpr int kRounds = 3;

  /// The one stiffness of all links; nothing if they differ.
  std::optional<double> spring_of_all() const {
    std::optional<double> one;
    for (const Link& l : scene.links) {
      if (one && *one != spring_of(l)) return {};
      one = spring_of(l);
    }
    return one;
  }

  Strain of_springs(double k) {
    const auto& tension = rest(std::vector<double>(scene.links.size(), k)).tension;
    return strain_of(sum_over(scene, w, tension, [&](std::size_t j) { return tension[j] / k; }), 0,
                     1);
  }

  /// Way from the start to the rest of the sheet that is left at the scene's end, without what
  /// stretching adds to it, as a share of the extent. Swings lose their height by damping alone.
  double way_left(const Strain& strain) const {
    double square = 0, count = 0;
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] > 0) {
        square += (last->x[i] - scene.start.x[i]).squaredNorm();
        ++count;
      }
    const double way = std::max(0.0, std::sqrt(square / count) - 2 * strain.sag);
    return way / extent(scene) * std::exp(-scene.damping * scene.duration() / 2);
  }

  bool is(std::string_view parameter, std::string_view value) const {
    return choice.params.has(parameter) && choice.params.is(parameter, value);
  }

  Scene scene;
  SolverChoice choice;
  Visits visits;
  std::vector<double> w;  ///< 1/kg
  double weight;          ///< N
  Stiffness stiffness;    ///< N/m, of the springs that the solver is given
  RestingSprings springs;
  std::optional<RestingSprings::Rest> last;
  Twin twin;
  double c;
};

std::vector<std::string> StrainAtRest::refuse(const Scene& scene, const SolverChoice& choice) {
  const Sweeper* const one = sweeper(choice);
  if (!one)
    return {"no law is known for the sweeps of '" + std::string(choice.entry->name) +
            "': it is for " + join(kSweepers, ", ", [](const Sweeper& s) { return s.solver; })};
  std::vector<std::string> reasons = refuse_rest(scene);
  if (scene.bending) reasons.emplace_back("bending: the law is of links alone");
  for (const Needed& need : one->needs) {
    if (need.parameter.empty()) continue;
    const std::string_view value = choice.params.value(need.parameter);
    const std::string allowed = "|" + std::string(need.values) + "|";
    if (allowed.find("|" + std::string(value) + "|") == std::string::npos)
      reasons.push_back(std::string(need.parameter) + "=" + std::string(value) + ": " +
                        std::string(need.why));
  }
  if (choice.params.integer(choice.entry->accuracy.sweeps) == 0)
    reasons.emplace_back("no sweeps: nothing holds the links");
  for (std::string& reason : choice.entry->unsupported(scene, choice.params))
    reasons.push_back("the solver cannot run it: " + std::move(reason));
  if (one->visits == Visits::vertices) {
    const Stiffness k = taut::stiffness_of(scene, choice.params);
    std::optional<double> all;
    for (const Link& l : scene.links) {
      const double own = k[static_cast<std::size_t>(l.family)];
      if (all && *all != own) {
        reasons.emplace_back("its links have several stiffnesses: the law is for one");
        break;
      }
      all = own;
    }
  }
  const std::vector<double> w = inverse_masses(scene);
  const auto [nu, nv] = scene.mesh.grid ? *scene.mesh.grid : Grid{1, 1};
  if (one->visits == Visits::vertices && std::min(nu, nv) > 1 &&
      std::ranges::none_of(scene.links, [](const Link& l) { return l.family == Family::shear; }))
    reasons.emplace_back("no shear links: the sheet shears freely, and a vertex is held unevenly");
  if (one->visits == Visits::vertices &&
      std::ranges::any_of(
          w, [&, usual = usual_mass(w)](double i) { return i > 0 && 1 / i > kMostMass * usual; }))
    reasons.push_back("a vertex weighs more than " + shortest(kMostMass) +
                      " times what most weigh: the law is for a sheet of one mass");
  if (std::ranges::none_of(scene.links, [&](const Link& l) {
        return counts(l) && w[to_index(l.a)] + w[to_index(l.b)] > 0;
      }))
    reasons.emplace_back("no structural or shear link of it can stretch");
  if (scene.mesh.size() > kMostVertices)
    reasons.push_back("its " + std::to_string(scene.mesh.size()) + " vertices are more than the " +
                      std::to_string(kMostVertices) + " for which its sheet of springs is solved");
  if (!scene.mesh.grid && scene.mesh.size() > kOwnTwin)
    reasons.push_back("its mesh of " + std::to_string(scene.mesh.size()) +
                      " vertices has no twin: grids have one, and meshes of at most " +
                      std::to_string(kOwnTwin) + " vertices are their own");
  return reasons;
}

std::vector<std::string> StrainAtRest::outside(const Strain& strain, double substeps) const {
  const Work& work = *work_;
  std::vector<std::string> reasons;
  const auto refuse = [&](bool it, std::string why) {
    if (it) reasons.push_back(std::move(why));
  };
  const auto percent = [](double share) { return shortest(std::round(1e3 * share) / 10) + " %"; };
  if (std::isnan(work.c))
    return {"its twin did not come to rest: the sheet folds, or starts far from its rest"};
  if (!strain.found) return {"no rest of the sheet was found: it folds, in more than one way"};
  const double most = work.visits == Visits::links ? kMostSaturated : kMostOfDescent;
  refuse(strain.s > most && strain.of_sweeps > kSwept,
         "its sweeps leave hardly any strain: s = " + shortest(std::round(100 * strain.s) / 100) +
             ", and the law ends at " + shortest(most));
  refuse(strain.largest > kMostStrain, "its largest strain is " + percent(strain.largest) +
                                           ", and the law ends at " + percent(kMostStrain));
  refuse(work.is("projection", "sqrt-free") && strain.rms > kMostWithoutRoot,
         "its RMS strain is " + percent(strain.rms) + ", and the law ends at " +
             percent(kMostWithoutRoot) +
             " for projection=sqrt-free, which corrects more than the distance");
  const std::string_view precision =
      parameter_with(ParamSpec::Role::precision, work.choice.params.specs());
  if (!precision.empty() && work.is(precision, "float")) {
    double farthest = 0, shortest_link = std::numeric_limits<double>::infinity();
    for (const Vec3& x : work.scene.start.x) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
    for (const Link& l : work.scene.links) shortest_link = std::min(shortest_link, l.rest);
    const double rounding =
        farthest * static_cast<double>(std::numeric_limits<float>::epsilon()) / 2;
    refuse(rounding > kMostRounding * strain.rms * shortest_link ||
               rounding > kMostRounding * work.fall(work.scene.dt / substeps),
           "float rounds its strain or the fall of a substep by more than " +
               percent(kMostRounding) + ": take precision=double");
  }
  const double way = work.way_left(strain);
  refuse(way > kMostWay, "motion: it starts far from its rest and at its end is still " +
                             percent(way) + " of its extent away, by its damping alone");
  return reasons;
}

double StrainAtRest::stiffness_of(const Strain& strain) {
  // links of one K have about the strain of these: from a first K, in proportion, twice
  double k = work_->weight / work_->scene.links.front().rest / strain.rms;
  for (int n = 0; n < 3; ++n) k *= work_->of_springs(k).rms / strain.rms;
  return k;
}

StrainAtRest::StrainAtRest(const Scene& scene, const SolverChoice& choice)
    : work_(std::make_unique<Work>(scene, choice)) {}
StrainAtRest::~StrainAtRest() = default;
double StrainAtRest::correction() const { return work_->c; }
StrainAtRest::Strain StrainAtRest::at(double sweeps, double substeps) {
  return work_->at(sweeps, substeps);
}
StrainAtRest::Strain StrainAtRest::of_springs(double stiffness) {
  return work_->of_springs(stiffness);
}

}  // namespace taut::reference
