// Implicit Euler by Newton's method. With y = x_t + h v_t + h^2 a, a step from x_t, v_t is the
// minimum of
//
//     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2,     C = |d| - r,  d = x_b - x_a,  u = d/|d|
//
// Each iteration solves H p = -g for the gradient g [N] and the Hessian of the springs
//
//     K [ u u^T + c (I - u u^T) ],     c = 1 - r/|d|
//
// where c is clamped to at least 0, which keeps H positive definite (Choi, Ko: Stable but
// Responsive Cloth, SIGGRAPH 2002); that of the membrane (core/model/membrane.hpp) is clamped
// alike. Damped links are other springs in each step (core/model/link_damping.hpp). Once full steps
// no longer reduce the gradient fast, the unclamped Hessian is used if it is positive definite. The
// step is halved until G falls (Armijo). One iteration from x_t without line search is the
// linearised step of Baraff, Witkin: Large Steps in Cloth Simulation (SIGGRAPH 1998). start=inertia
// starts at y instead, unless something touches.
//
// With multipliers=keep (core/solver/newton/kept_tensions.hpp), each link's tension is kept from
// step to step as its resistance to sideways motion, and iterations start at y. A step is
// recomputed as above if its gradient, in the norm of 1/M, has grown by the end, or if anything
// touches. integrator=bdf2 and midpoint are steps of the same form with another y and h
// (newton/integrator.hpp). Contact adds a term to G (core/solver/contact/augmented_contacts.hpp);
// its forces are updated once the gradient is small.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/newton/integrator.hpp"
#include "core/solver/newton/kept_tensions.hpp"
#include "core/solver/newton/step_energy.hpp"
#include "core/solver/springs.hpp"

namespace taut::solver::implicit {

namespace {

/// Tolerances of the Newton iterations, as shares of |M/h^2 (y - x_t)|, which is all that drives
/// the step. Iterations end where |g| [N] is below kTolerance of it or below what rounding of the
/// positions makes of the spring forces. The first iteration is skipped only if |g| is also below
/// kFirstTolerance of it: a light cloth is driven by less than that rounding.
constexpr double kTolerance = 1e-9, kFirstTolerance = 1e-6;
/// Where rounding ends the iterations, they have converged if |g| is below this multiple of the
/// tolerance.
constexpr double kOfRounding = 1e3;
/// Largest number of moving vertices for which linear=auto factors the matrix. The factor is faster
/// than conjugate gradients at every size that was tried (methods.md); its memory is the limit, 6
/// kB a vertex at this size.
constexpr std::size_t kFactorPays = 100000;
const ParamSpec kOwn[] = {
    loop::iterations("50", lasting("Newton iterations, at most; they end at " +
                                   as_typed(kTolerance) + " of the forces of inertia")),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    Integrator::kParam,
    KeptTensions::kParam,
    ParamSpec::choice(
        "start", "last", "last|inertia",
        "iterations begin where the last step ended (last) or where inertia and gravity alone lead "
        "(inertia); always inertia with multipliers=keep, and always last if anything touches"),
    ParamSpec::choice("line-search", "on", "on|off",
                      "halve steps until the energy falls; iterations=1,line-search=off is Baraff "
                      "and Witkin's step"),
    ParamSpec::choice("linear", "auto", "auto|ldlt|cg",
                      "solver of the linear systems: a sparse LDLT, conjugate gradients with a "
                      "block Jacobi preconditioner, or one of them by the number of vertices"),
};
const auto kParams = loop::with_common(kOwn);

bool factors(const Params& params, std::size_t moving) {
  return params.is("linear", "auto") ? moving <= kFactorPays : params.is("linear", "ldlt");
}

class NewtonPass final : public Pass<double> {
 public:
  explicit NewtonPass(const loop::Setup& s)
      : step_(s, factors(s.params, to_index(static_cast<int>(std::ranges::count_if(
                                       s.w, [](double w) { return w > 0; }))))),
        starts_at_y_(s.params.is("start", "inertia") || s.params.is("multipliers", "keep")),
        line_search_(s.params.is("line-search", "on")),
        iterations_(s.params.integer("iterations")),
        integrator_(s.params, s.scene.gravity),
        kept_(s.params, step_.springs) {}

  void restart() override {
    step_.contacts.forget();
    kept_.forget();
    integrator_.forget();
  }

  void take_over(const Pass<double>& before) override {
    const auto& old = static_cast<const NewtonPass&>(before);
    step_.contacts.take_over(old.step_.contacts);
    kept_.take_over(old.kept_);
  }

  Points<double>* target() override { return &step_.y; }
  std::optional<bool> converged() const override { return converged_; }
  bool leaves_colliders() const override { return step_.contacts.any(); }
  TouchingPieces* touching_pieces() override {
    return step_.contacts.any() ? &step_.contacts.pieces() : nullptr;
  }

  void begin(Particles<double>& p, double t, double step) override {
    step_.y = p.x;
    integrator_.predict(p, step_.y, step);
    const double h = integrator_.own_step(step);
    step_.damped.begin(step_.springs, p.previous);
    step_.membrane.begin([&](std::size_t v) { return p.previous[v]; });
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    step_.contacts.begin(t, h);
    clamped_ = first_ = true;
    ended_at_.clear();
    converged_ = false;
    set_tolerances(p, h);
    plain_ = !kept_.on();
    from_y_ = starts_at_y_;
    if (!from_y_) return;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, step_.y[i]);
    first_ = false;
    step_.contacts.let_go();
    if (!plain_) at_first_ = step_.in_norm_of_masses(step_.gradient(positions(p), h));
  }

  void end(Particles<double>& p, double t, double h) override {
    if (!plain_ && went_astray(p, integrator_.own_step(h))) {
      start_over(p);
      for (int k = 0; k < iterations_; ++k) apply(p, t, h);
    }
    step_.contacts.leave(p);
    integrator_.finish(p, h);
  }

  void apply(Particles<double>& p, double, double step) override {
    const double h = integrator_.own_step(step);
    std::vector<Vec3> x = positions(p);
    if (x == ended_at_ && !step_.contacts.pieces().changed) return;
    converged_ = false;
    step_.contacts.find(p);
    if (from_y_ && step_.contacts.touch()) {
      start_over(p);
      x = positions(p);
      step_.contacts.find(p);
    }
    const bool first = std::exchange(first_, false);
    const Vector g = step_.gradient(x, h);
    if (g.norm() <= (first ? enough_at_first_ : enough_) || !(first    ? first_iteration(x, p, g, h)
                                                              : plain_ ? iterate(x, g, h)
                                                                       : iterate_kept(x, g, h))) {
      // x is the minimum for the current contact forces; the substep is done if these do not change
      left_ = 0;
      if (!step_.contacts.update(p, x, h, left_, enough_)) {
        converged_ = g.norm() <= kOfRounding * enough_ && !step_.contacts.pieces().changed;
        ended_at_ = std::move(x);
      }
      return;
    }
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, x[i]);
    const bool changed = step_.contacts.update(p, x, h, left_, enough_);
    converged_ = line_search_ && plain_ && left_ <= enough_ && !changed;
  }

  std::vector<PassCost> cost() const override {
    const std::size_t bytes = step_.y.bytes() + step_.springs.size() * sizeof(Spring) +
                              step_.damped.bytes() + step_.bending.size() * sizeof(BendingElement);
    std::vector<PassCost> costs{
        {.pass = "spring Hessians", .items = step_.springs.size(), .bytes = bytes}};
    if (!step_.membrane.empty())
      costs.push_back({.pass = "membrane Hessians",
                       .items = step_.membrane.elements.size(),
                       .bytes = step_.membrane.bytes()});
    costs.push_back({.pass = step_.hessian.factored() ? "LDLT" : "conjugate gradients",
                     .items = step_.hessian.factored() ? step_.hessian.factor_entries()
                                                       : to_index(step_.hessian.size()),
                     .bytes = step_.hessian.bytes()});
    return costs;
  }

 private:
  /// Restarts the substep at x_t with plain Newton iterations; tensions are kept again from the
  /// next one.
  void start_over(Particles<double>& p) {
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    plain_ = first_ = clamped_ = true;
    from_y_ = false;
    ended_at_.clear();
    kept_.forget();
  }

  /// The step from x_t, linearised with the pins still at x_t: their displacement to t + h is on
  /// the right-hand side, so that a steadily moving frame behaves like a frame at rest. The unknown
  /// is x - y, so that rounding in stiff links does not move the centre of mass. If the
  /// factorisation breaks down in double precision, positions become NaN, which ends a case as
  /// exploded.
  bool first_iteration(std::vector<Vec3>& x, const Particles<double>& p, const Vector& g,
                       double h) {
    std::vector<Vec3> start(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) start[i] = p.previous[i];
    step_.linearise(start, clamped_);
    const auto way_of_pin = [&](std::size_t v) { return Vec3(x[v] - start[v]); };
    Vector direction;
    if (step_.hessian.factored()) {
      const Vector to_y = step_.way_to_y(x);
      if (!step_.hessian.solve(
              h, -step_.elastic(start) - step_.hessian.elastic_times(to_y, way_of_pin),
              direction)) {
        x.assign(x.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
        return true;
      }
      direction += to_y;
    } else {
      const Vector still = Vector::Zero(step_.hessian.size());
      if (!step_.hessian.solve(
              h, -step_.gradient(start, h) - step_.hessian.elastic_times(still, way_of_pin),
              direction))
        return false;
    }
    if (frame_.isZero(0)) return take(x, direction, g, h);
    // The step is judged from x_t as the pins have moved it: the same in every frame.
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = step_.hessian.column(i); c >= 0) {
        x[i] += frame_;
        direction.segment<3>(c) -= frame_;
      }
    return take(x, direction, step_.gradient(x, h), h);
  }

  /// One Newton step. Returns false if rounding does not let the energy fall any further.
  bool iterate(std::vector<Vec3>& x, const Vector& g, double h) {
    step_.linearise(x, clamped_);
    Vector direction;
    if (!step_.hessian.solve(h, -g, direction)) {
      step_.linearise(x, clamped_ = true);
      if (!step_.hessian.solve(h, -g, direction)) return false;
    }
    return take(x, direction, g, h);
  }

  bool went_astray(const Particles<double>& p, double h) {
    const double now = step_.in_norm_of_masses(step_.gradient(positions(p), h));
    const double rounding = enough_ * std::sqrt(*std::ranges::max_element(p.w));
    return !(now <= std::max(at_first_, rounding));
  }
  /// One iteration with the kept tensions. Returns false if the matrix has no factor.
  bool iterate_kept(std::vector<Vec3>& x, const Vector& g, double h) {
    step_.linearise(x, true);
    kept_.put_into(step_.hessian, x);
    Vector direction;
    if (!step_.hessian.solve(h, -g, direction)) return false;
    kept_.follow(direction, step_.hessian);
    x = step_.moved(x, direction, 1);
    left_ = 0;
    return true;
  }

  /// Moves x along the direction, halving the step until the energy falls. Returns false if it does
  /// not.
  bool take(std::vector<Vec3>& x, const Vector& direction, const Vector& g, double h) {
    if (!line_search_) {
      left_ = 0;
      x = step_.moved(x, direction, 1);
      return true;
    }
    const double energy_before = step_.energy(x, h), slope = g.dot(direction);
    double step = 1;
    const int most_halvings = g.norm() <= enough_ ? 1 : 50;
    for (int halvings = 0; halvings < most_halvings; ++halvings, step /= 2) {
      std::vector<Vec3> trial = step_.moved(x, direction, step);
      const double now = step_.energy(trial, h);
      const Vector g_now = step_.gradient(trial, h);
      const bool falls = now <= energy_before + 1e-4 * step * slope;
      // near the minimum, differences of the energy are mere rounding: the gradient decides
      const bool rounds = now <= energy_before * (1 + 1e-12) && g_now.norm() < g.norm();
      if (!falls && !rounds) continue;
      left_ = g_now.norm();
      clamped_ = clamped_ && (step < 1 || left_ < 0.25 * g.norm());
      x = std::move(trial);
      return true;
    }
    return false;
  }

  /// Mean displacement of the pins [m], with which the cloth moves before anything drives it.
  Vec3 mean_way_of_pins(const Particles<double>& p) const {
    Vec3 sum = Vec3::Zero();
    int pins = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (step_.hessian.column(i) < 0) {
        sum += p.x[i] - p.previous[i];
        ++pins;
      }
    return pins > 0 ? Vec3(sum / pins) : sum;
  }

  /// p.x holds x_t, but pins are already where they are at the end of the step.
  void set_tolerances(const Particles<double>& p, double h) {
    double inertia2 = 0, rounding2 = 0;
    frame_ = mean_way_of_pins(p);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (step_.hessian.column(i) >= 0) {
        const double m = step_.hessian.mass(i) / (h * h);
        inertia2 += m * m * (step_.y[i] - p.x[i] - frame_).squaredNorm();
        rounding2 += std::pow((step_.stiffness[i] + m) * p.x[i].cwiseAbs().maxCoeff(), 2);
      }
    enough_ = std::max(kTolerance * std::sqrt(inertia2),
                       std::numeric_limits<double>::epsilon() * std::sqrt(rounding2));
    enough_at_first_ = std::min(enough_, kFirstTolerance * std::sqrt(inertia2));
    step_.contacts.set_stiffness(p, step_.stiffness, h);
  }

  StepEnergy step_;
  bool starts_at_y_, line_search_;
  int iterations_;
  Integrator integrator_;
  KeptTensions kept_;
  Vec3 frame_ = Vec3::Zero();  ///< m, mean displacement of the pins in this substep
  double at_first_ = 0;        ///< N/sqrt(kg), |g| at the prediction
  bool plain_ = true;          ///< this substep is plain Newton's method, without kept tensions
  bool from_y_ = false;        ///< iterations of this substep began at y
  double left_ = 0;            ///< N, |g| after the last Newton step
  bool clamped_ = true, first_ = true;
  bool converged_ = false;                   ///< this substep
  double enough_ = 0, enough_at_first_ = 0;  ///< N, tolerances of |g| in this substep
  std::vector<Vec3> ended_at_;  ///< m, where this substep converged; empty: it has not yet
};

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (scene.membrane && params.is("multipliers", "keep"))
    reasons.emplace_back("multipliers=keep keeps tensions of links, and a membrane has none");
  if (params.is("integrator", "euler")) return reasons;
  const std::string own = "integrator=" + std::string(params.choice("integrator"));
  if (!scene.colliders.empty() || (scene.self_collision && !params.is("self", "off")))
    reasons.push_back(own + " knows no contact: it would act at another time than the links");
  if (scene.wind) reasons.push_back(own + " knows no wind");
  if (scene.damping > 0 || scene.link_damping > 0 ||
      (scene.membrane && scene.membrane->damping > 0))
    reasons.push_back(own + " knows no damping but its own");
  return reasons;
}

DeclaredStep declared_step(const Scene& scene, const Params& params) {
  DeclaredStep step = loop::implicit_euler(scene, params);
  if (!params.is("integrator", "euler"))
    step.none = "it is a step of " +
                std::string(params.is("integrator", "bdf2") ? "BDF2" : "the midpoint rule");
  return step;
}

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = std::make_unique<NewtonPass>(s),
          .bends = true,
          .stretches = true,
          .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make<double>(scene, params, links);
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const std::size_t moving = to_index(scene.mesh.size()) - scene.pins.size();
  const ResolvedSettings own{
      describe_springs(scene, params),
      {"links solved", std::string(params.is("integrator", "bdf2")       ? "BDF2"
                                   : params.is("integrator", "midpoint") ? "the midpoint rule"
                                                                         : "implicit Euler") +
                           " by Newton's method, " +
                           (params.is("multipliers", "keep") ? "tensions kept, " : "") +
                           (factors(params, moving) ? "sparse LDLT, analysed once as set-up"
                                                    : "conjugate gradients")},
      {"work unit", "Newton iterations, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the Hessian",
                                 loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {
    {{"multipliers"}, {"keep"}}, {{"start"}, {"inertia"}}, {{"line-search"}, {"off"}}};

}  // namespace
}  // namespace taut::solver::implicit

TAUT_SOLVER(implicit) = {
    .name = "implicit",
    .title = "implicit Euler (Newton)",
    .summary = "Implicit Euler of springs, each step solved by Newton's method",
    .source = "Baraff, Witkin 1998; Choi, Ko 2002",
    .params = taut::solver::implicit::kParams,
    .make = taut::solver::implicit::make,
    .unsupported = taut::solver::implicit::unsupported,
    .resolved_settings = taut::solver::implicit::resolved_settings,
    .declared_step = taut::solver::implicit::declared_step,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .all_at_once = true,
                 .stiffness = taut::kStiffnesses,
                 .alternatives = taut::solver::implicit::kAlternatives,
                 .labelled = {"substeps", "iterations", "structural", "multipliers", "start",
                              "line-search"}},
    .optional_effects = taut::loop::kOptionalEffects};
