// Implicit Euler by Newton's method. A step from x_t, v_t with y = x_t + h v_t + h^2 a is the
// minimum of
//
//     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2,     C = |d| - r,  d = x_b - x_a,  u = d/|d|
//
// and each iteration solves H p = -g for the gradient g [N] and the Hessian of the springs
//
//     K [ u u^T + c (I - u u^T) ],     c = 1 - r/|d|
//
// with c clamped to at least 0, which keeps H positive definite (Choi, Ko: Stable but Responsive
// Cloth, SIGGRAPH 2002). Where full steps no longer bring the gradient down fast, the Hessian is
// taken as it is, if it is positive definite. The step is halved until G falls (Armijo). From x_t,
// one iteration without line search is the linearised step of Baraff, Witkin: Large Steps in Cloth
// Simulation (SIGGRAPH 1998). start=inertia begins at y instead, where nothing touches.
//
// With multipliers=keep (core/solver/newton/kept_tensions.hpp) the tension across links is one that
// outlives the step, and iterations begin at y; a step whose gradient, in the norm of 1/M, has
// grown in the end, and one in which anything touches, is computed as above. integrator=bdf2 and
// midpoint are steps of the same form with another y and h (newton/integrator.hpp). Contact adds
// its own part to G (core/solver/contact/augmented_contacts.hpp), whose forces follow once the
// gradient is small.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/model/bending.hpp"
#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/newton/hessian.hpp"
#include "core/solver/newton/integrator.hpp"
#include "core/solver/newton/kept_tensions.hpp"
#include "core/solver/springs.hpp"

namespace taut::solver::implicit {

namespace {

/// Iterations end where |g| [N] is below this share of |M/h^2 (y - x_t)|, all that drives the step,
/// or below what rounding of the places makes of the springs: the first one only if that, too, is
/// below a share, for a light cloth is moved by less.
constexpr double kTolerance = 1e-9, kFirstTolerance = 1e-6;
/// Up to so many vertices that move, the factor is taken. It is faster than conjugate gradients at
/// any size that was tried (methods.md) and is bound by its memory, 6 kB a vertex there.
constexpr std::size_t kFactorPays = 100000;
constexpr ParamSpec kOwn[] = {
    loop::iterations("50", "Newton iterations, at most; they end at 1e-9 of the forces of inertia"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    Integrator::kParam,
    KeptTensions::kParam,
    ParamSpec::choice("start", "last", "last|inertia",
                      "iterations begin where the last step ended, or where inertia and gravity "
                      "alone lead; with multipliers=keep always there, and where anything touches "
                      "never"),
    ParamSpec::choice("line-search", "on", "on|off",
                      "halve steps until the energy falls; iterations=1,line-search=off is Baraff "
                      "and Witkin's step"),
    ParamSpec::choice("linear", "auto", "auto|ldlt|cg",
                      "the linear systems by a sparse LDLT, by conjugate gradients with a block "
                      "Jacobi preconditioner, or by the number of vertices"),
};
constexpr auto kParams = loop::with_common(kOwn);

bool factors(const Params& params, std::size_t moving) {
  return params.is("linear", "auto") ? moving <= kFactorPays : params.is("linear", "ldlt");
}

class NewtonPass final : public Pass<double> {
 public:
  explicit NewtonPass(const loop::Setup& s)
      : springs_(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params))),
        bending_(make_bending(s.scene)),
        starts_at_y_(s.params.is("start", "inertia") || s.params.is("multipliers", "keep")),
        line_search_(s.params.is("line-search", "on")),
        iterations_(s.params.integer("iterations")),
        integrator_(s.params, s.scene.gravity),
        kept_(s.params, springs_),
        hessian_(springs_, bending_, s.w,
                 factors(s.params, to_index(static_cast<int>(std::ranges::count_if(
                                       s.w, [](double w) { return w > 0; })))),
                 s.simd, sides_of_pieces(s)),
        stiffness_(s.w.size()),
        contacts_(s.scene, s.params) {
    for (const Spring& spring : springs_) {
      stiffness_[spring.a] += spring.stiffness;
      stiffness_[spring.b] += spring.stiffness;
    }
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j < e.size; ++j)
          stiffness_[to_index(e.vertex[i])] += e.stiffness * std::abs(e.weight[i] * e.weight[j]);
  }

  void restart() override {
    contacts_.forget();
    kept_.forget();
    integrator_.forget();
  }

  void take_over(const Pass<double>& before) override {
    const auto& old = static_cast<const NewtonPass&>(before);
    contacts_.take_over(old.contacts_);
    kept_.take_over(old.kept_);
  }

  Points<double>* target() override { return &y_; }
  TouchingPieces* touching_pieces() override {
    return contacts_.any() ? &contacts_.pieces() : nullptr;
  }

  void begin(Particles<double>& p, double t, double step) override {
    y_ = p.x;
    integrator_.predict(p, y_, step);
    const double h = integrator_.own_step(step);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    contacts_.begin(t, h);
    clamped_ = first_ = true;
    ended_at_.clear();
    set_tolerances(p, h);
    plain_ = !kept_.on();
    from_y_ = starts_at_y_;
    if (!from_y_) return;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, y_[i]);
    first_ = false;
    contacts_.let_go();
    if (!plain_) at_first_ = in_norm_of_masses(gradient(positions(p), h));
  }

  void end(Particles<double>& p, double t, double h) override {
    if (!plain_ && went_astray(p, integrator_.own_step(h))) {
      start_over(p);
      for (int k = 0; k < iterations_; ++k) apply(p, t, h);
    }
    integrator_.finish(p, h);
  }

  void apply(Particles<double>& p, double, double step) override {
    const double h = integrator_.own_step(step);
    std::vector<Vec3> x = positions(p);
    if (x == ended_at_ && !contacts_.pieces().changed) return;
    contacts_.find(p);
    if (from_y_ && contacts_.touch()) {
      start_over(p);
      x = positions(p);
      contacts_.find(p);
    }
    const bool first = std::exchange(first_, false);
    const Vector g = gradient(x, h);
    if (g.norm() <= (first ? enough_at_first_ : enough_) || !(first    ? first_iteration(x, p, g, h)
                                                              : plain_ ? iterate(x, g, h)
                                                                       : iterate_kept(x, g, h))) {
      // the minimum for these forces of contact; the end if theirs is no other one
      left_ = 0;
      if (!contacts_.update(p, x, h, left_, enough_)) ended_at_ = std::move(x);
      return;
    }
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, x[i]);
    contacts_.update(p, x, h, left_, enough_);
  }

  std::vector<PassCost> cost() const override {
    const std::size_t bytes =
        y_.bytes() + springs_.size() * sizeof(Spring) + bending_.size() * sizeof(BendingElement);
    return {{.pass = "spring Hessians", .items = springs_.size(), .bytes = bytes},
            {.pass = hessian_.factored() ? "LDLT" : "conjugate gradients",
             .items = hessian_.factored() ? hessian_.factor_entries() : to_index(hessian_.size()),
             .bytes = hessian_.bytes()}};
  }

 private:
  /// The step is computed from x_t on, and tensions count from the next one.
  void start_over(Particles<double>& p) {
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    plain_ = first_ = clamped_ = true;
    from_y_ = false;
    ended_at_.clear();
    kept_.forget();
  }

  /// The step from x_t, linearised with the pins still there: their way to t + h is on the
  /// right-hand side, so that a frame that moves steadily is as one at rest. It is solved for x -
  /// y, so that rounding in stiff links moves no centre of mass; where a factor breaks down in
  /// double precision its places are NaN, which ends a case as exploded.
  bool first_iteration(std::vector<Vec3>& x, const Particles<double>& p, const Vector& g,
                       double h) {
    std::vector<Vec3> start(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) start[i] = p.previous[i];
    linearise(start, clamped_);
    const auto way_of_pin = [&](std::size_t v) { return Vec3(x[v] - start[v]); };
    Vector direction;
    if (hessian_.factored()) {
      const Vector to_y = way_to_y(x);
      if (!hessian_.solve(h, -elastic(start) - hessian_.elastic_times(to_y, way_of_pin),
                          direction)) {
        x.assign(x.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
        return true;
      }
      direction += to_y;
    } else {
      const Vector still = Vector::Zero(hessian_.size());
      if (!hessian_.solve(h, -gradient(start, h) - hessian_.elastic_times(still, way_of_pin),
                          direction))
        return false;
    }
    return take(x, direction, g, h);
  }

  /// One Newton step; false: rounding does not let the energy fall any further.
  bool iterate(std::vector<Vec3>& x, const Vector& g, double h) {
    linearise(x, clamped_);
    Vector direction;
    if (!hessian_.solve(h, -g, direction)) {
      linearise(x, clamped_ = true);
      if (!hessian_.solve(h, -g, direction)) return false;
    }
    return take(x, direction, g, h);
  }

  double in_norm_of_masses(const Vector& g) const {
    double sum = 0;
    for (std::size_t i = 0; i < stiffness_.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0)
        sum += g.segment<3>(c).squaredNorm() / hessian_.mass(i);
    return std::sqrt(sum);
  }
  bool went_astray(const Particles<double>& p, double h) {
    const double now = in_norm_of_masses(gradient(positions(p), h));
    const double rounding = enough_ * std::sqrt(*std::ranges::max_element(p.w));
    return !(now <= std::max(at_first_, rounding));
  }
  /// One iteration with the tensions that were kept; false: there is no factor.
  bool iterate_kept(std::vector<Vec3>& x, const Vector& g, double h) {
    linearise(x, true);
    kept_.put_into(hessian_, x);
    Vector direction;
    if (!hessian_.solve(h, -g, direction)) return false;
    kept_.follow(direction, hessian_);
    x = moved(x, direction, 1);
    left_ = 0;
    return true;
  }

  /// Moves x along the direction, by halves of it until the energy falls; false: it does not.
  bool take(std::vector<Vec3>& x, const Vector& direction, const Vector& g, double h) {
    if (!line_search_) {
      left_ = 0;
      x = moved(x, direction, 1);
      return true;
    }
    const double energy_before = energy(x, h), slope = g.dot(direction);
    double step = 1;
    const int most_halvings = g.norm() <= enough_ ? 1 : 50;
    for (int halvings = 0; halvings < most_halvings; ++halvings, step /= 2) {
      std::vector<Vec3> trial = moved(x, direction, step);
      const double now = energy(trial, h);
      const Vector g_now = gradient(trial, h);
      const bool falls = now <= energy_before + 1e-4 * step * slope;
      // near the minimum, differences of the energy are rounding: the gradient decides
      const bool rounds = now <= energy_before * (1 + 1e-12) && g_now.norm() < g.norm();
      if (!falls && !rounds) continue;
      left_ = g_now.norm();
      clamped_ = clamped_ && (step < 1 || left_ < 0.25 * g.norm());
      x = std::move(trial);
      return true;
    }
    return false;
  }

  /// A cloth moves with its pins before anything drives it [m].
  Vec3 mean_way_of_pins(const Particles<double>& p) const {
    Vec3 sum = Vec3::Zero();
    int pins = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (hessian_.column(i) < 0) {
        sum += p.x[i] - p.previous[i];
        ++pins;
      }
    return pins > 0 ? Vec3(sum / pins) : sum;
  }

  /// p.x is x_t, of pins where they are at its end.
  void set_tolerances(const Particles<double>& p, double h) {
    double inertia2 = 0, rounding2 = 0;
    const Vec3 frame = mean_way_of_pins(p);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (hessian_.column(i) >= 0) {
        const double m = hessian_.mass(i) / (h * h);
        inertia2 += m * m * (y_[i] - p.x[i] - frame).squaredNorm();
        rounding2 += std::pow((stiffness_[i] + m) * p.x[i].cwiseAbs().maxCoeff(), 2);
      }
    enough_ = std::max(kTolerance * std::sqrt(inertia2),
                       std::numeric_limits<double>::epsilon() * std::sqrt(rounding2));
    enough_at_first_ = std::min(enough_, kFirstTolerance * std::sqrt(inertia2));
    contacts_.set_stiffness(p, stiffness_, h);
  }

  void linearise(const std::vector<Vec3>& x, bool clamped) {
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) {
        hessian_.block(j) = {stiffness, 0, Vec3::UnitX()};
        continue;
      }
      const double across = 1 - rest / length;
      const double c = clamped ? std::max(0.0, across) : across;
      hessian_.block(j) = {stiffness * c, stiffness * (1 - c), d / length};
    }
    hessian_.clear_contacts();
    contacts_.each(x, [&](std::size_t vertex, const AugmentedContacts::Part& part) {
      hessian_.add_contact(vertex, part.hessian);
    });
    contacts_.each_piece(x, [&](const TouchingPiece& piece, const AugmentedContacts::Part& part) {
      each_corner(piece, [&](std::size_t c, double weight) {
        each_corner(piece, [&](std::size_t d, double other) {
          const std::size_t a = to_index(piece.corners[c]), b = to_index(piece.corners[d]);
          if (d <= c) hessian_.add_contact(a, b, weight * other * part.hessian);
        });
      });
    });
  }

  double energy(const std::vector<Vec3>& x, double h) const {
    double sum = bending_energy(bending_, x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (hessian_.column(i) >= 0)
        sum += hessian_.mass(i) / (2 * h * h) * (x[i] - y_[i]).squaredNorm();
    for (const auto& [a, b, rest, stiffness] : springs_) {
      const double c = (x[b] - x[a]).norm() - rest;
      sum += stiffness / 2 * c * c;
    }
    contacts_.each(x,
                   [&](std::size_t, const AugmentedContacts::Part& part) { sum += part.energy; });
    contacts_.each_piece(
        x, [&](const TouchingPiece&, const AugmentedContacts::Part& part) { sum += part.energy; });
    return sum;
  }

  /// y - x of the vertices that move [m].
  Vector way_to_y(const std::vector<Vec3>& x) const {
    Vector way(hessian_.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0) way.segment<3>(c) = y_[i] - x[i];
    return way;
  }

  Vector gradient(const std::vector<Vec3>& x, double h) const {
    Vector g = elastic(x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0)
        g.segment<3>(c) += hessian_.mass(i) / (h * h) * (x[i] - y_[i]);
    return g;
  }

  /// The part of links, bending and contact.
  Vector elastic(const std::vector<Vec3>& x) const {
    Vector g = Vector::Zero(hessian_.size());
    for (const auto& [a, b, rest, stiffness] : springs_) {
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) continue;  // no direction to push in
      const Vec3 pull = stiffness * (length - rest) / length * d;
      if (hessian_.column(a) >= 0) g.segment<3>(hessian_.column(a)) -= pull;
      if (hessian_.column(b) >= 0) g.segment<3>(hessian_.column(b)) += pull;
    }
    for (const BendingElement& e : bending_) {
      const Vec3 pull = e.stiffness * e.value([&](std::size_t v) { return x[v]; });
      for (std::size_t i = 0; i < e.size; ++i)
        if (const int c = hessian_.column(to_index(e.vertex[i])); c >= 0)
          g.segment<3>(c) += e.weight[i] * pull;
    }
    contacts_.each(x, [&](std::size_t vertex, const AugmentedContacts::Part& part) {
      g.segment<3>(hessian_.column(vertex)) -= part.force;
    });
    contacts_.each_piece(x, [&](const TouchingPiece& piece, const AugmentedContacts::Part& part) {
      each_corner(piece, [&](std::size_t c, double weight) {
        if (const int column = hessian_.column(to_index(piece.corners[c])); column >= 0)
          g.segment<3>(column) -= weight * part.force;
      });
    });
    return g;
  }

  /// visit(corner, weight) of those with one.
  template <class Visit>
  static void each_corner(const TouchingPiece& piece, const Visit& visit) {
    for (std::size_t c = 0; c < 3; ++c)
      if (const double weight = piece.weights[static_cast<Eigen::Index>(c)]; weight != 0)
        visit(c, weight);
  }
  /// Between whose ends contact of faces and edges acts, where the scene has any.
  static std::vector<std::pair<int, int>> sides_of_pieces(const loop::Setup& s) {
    std::vector<std::pair<int, int>> sides;
    if (s.scene.colliders.empty() || s.params.is("faces", "off")) return sides;
    for (const Triangle& face : s.scene.mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(face[k], face[(k + 1) % 3]);
    return sides;
  }

  std::vector<Vec3> moved(std::vector<Vec3> x, const Vector& direction, double step) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0) x[i] += step * direction.segment<3>(c);
    return x;
  }

  std::vector<Spring> springs_;
  std::vector<BendingElement> bending_;
  bool starts_at_y_, line_search_;
  int iterations_;
  Integrator integrator_;
  KeptTensions kept_;
  double at_first_ = 0;  ///< N/sqrt(kg), of |g| at the prediction
  bool plain_ = true;    ///< Newton's method, without kept tensions, in this substep
  bool from_y_ = false;  ///< iterations of this substep began at y
  Hessian hessian_;
  std::vector<double> stiffness_;  ///< N/m, of all links and bending at each vertex
  AugmentedContacts contacts_;
  double left_ = 0;  ///< N, the gradient after the last Newton step
  bool clamped_ = true, first_ = true;
  double enough_ = 0, enough_at_first_ = 0;  ///< N, of |g| in this substep
  Points<double> y_;                         ///< m, where they would go without links
  std::vector<Vec3> ended_at_;  ///< m, where nothing was left to do in this substep; empty: nowhere
};

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (params.is("integrator", "euler")) return reasons;
  const std::string own = "integrator=" + std::string(params.choice("integrator"));
  if (!scene.colliders.empty() || (scene.self_collision && !params.is("self", "off")))
    reasons.push_back(own + " knows no contact: it would act at another time than the links");
  if (scene.wind) reasons.push_back(own + " knows no wind");
  if (scene.damping > 0) reasons.push_back(own + " knows no damping but its own");
  return reasons;
}

DeclaredStep declared_step(const Scene& scene, const Params& params) {
  DeclaredStep step = implicit_euler(scene, params);
  if (!params.is("integrator", "euler"))
    step.none = "it is a step of " +
                std::string(params.is("integrator", "bdf2") ? "BDF2" : "the midpoint rule");
  return step;
}

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = std::make_unique<NewtonPass>(s),
          .bends = true,
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
    {"multipliers", "keep"}, {"start", "inertia"}, {"line-search", "off"}};

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
                 .labelled = "substeps|iterations|structural|multipliers|start|line-search"},
    .optional_effects = taut::loop::kOptionalEffects};
