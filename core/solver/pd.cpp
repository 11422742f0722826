// Projective Dynamics (Bouaziz et al., SIGGRAPH 2014) of springs, as in Liu et al., Fast Simulation
// of Mass-Spring Systems (SIGGRAPH Asia 2013). An iteration first gives each link its rest length
// in the direction that it has, q = r d/|d| (local), and then places all vertices by one factored
// system (global):
//
//     (M/h^2 + sum K (e_b - e_a)(e_b - e_a)^T) x = M/h^2 y + sum K (e_b - e_a) q^T
//
// A triangle of a membrane with law = "arap" gets the rotation that is nearest to its F, with the
// weight A Y. The unknown is the displacement from the last x. The right-hand side is then minus
// the gradient of implicit Euler's energy there, in which K (d - q) is the force of a spring: no q
// is stored. Damped links are other springs in each step (core/model/link_damping.hpp).
//
// The fixed point is implicit Euler's step (implicit.cpp). Motion across stretched links of strain
// e contracts by s lambda (1 - e)/(1 + s lambda) per iteration, with s = h^2 K/m. This tends to 1:
// the stiffer the links, the more iterations until the cloth moves at all, and a strain near zero
// does not say that it did.
//
// method=lbfgs and method=ncg descend the same energy G from the same start. L-BFGS (Liu, Bouaziz,
// Kavan, Quasi-Newton Methods for Real-Time Simulation of Hyperelastic Materials, TOG 2017)
// corrects the factor's solution for -g by the last `history` pairs of displacements and gradient
// changes, in the two loops of Nocedal (1980); without pairs it is Projective Dynamics with a line
// search. NCG is the nonlinear conjugate gradient method of Polak and Ribiere, preconditioned by
// the factor or by the matrix' diagonal of links and masses. Both halve the step until G falls
// (Armijo).
#include <Eigen/Cholesky>
#include <limits>
#include <utility>

#include "core/solver/chebyshev.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"

namespace taut::solver::pd {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("10", "local and global solves per substep"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    kGlobalPrecision,
    kChebyshev,
    ParamSpec::integer("anderson", "0", 0, 20,
                       "earlier iterations that Anderson acceleration combines; 0: none"),
    ParamSpec::choice("method", "plain", "plain|lbfgs|ncg",
                      "how to minimise the energy: by the factor's solution as it is, corrected by "
                      "L-BFGS, or by nonlinear conjugate gradients; the last two without contact"),
    ParamSpec::integer("history", "5", 0, 20, "pairs that method=lbfgs keeps in a substep"),
    ParamSpec::choice("preconditioner", "diagonal", "diagonal|factor", "of method=ncg"),
};
constexpr auto kParams = loop::with_common(kOwn);

/// Anderson acceleration: Peng et al.: Anderson Acceleration for Geometry Optimization and Physics
/// Simulation (SIGGRAPH 2018). With the fixed-point map f and F = f(x) - x, the next iterate is
/// f(x) - sum theta_i dG_i, where theta minimises |F - sum theta_i dF_i| over the differences of
/// the last iterations.
class Anderson {
 public:
  Anderson(std::size_t window, std::size_t vertices) : window_(window), vertices_(vertices) {}
  bool on() const { return window_ > 0; }
  void begin() {
    residuals_.clear();
    images_.clear();
  }

  /// The next iterate after x. image = f(x).
  std::vector<Vec3> next(const std::vector<Vec3>& x, const std::vector<Vec3>& image) {
    const auto flat = [](const std::vector<Vec3>& v) {
      return Eigen::Map<const Eigen::VectorXd>(v.front().data(),
                                               3 * static_cast<Eigen::Index>(v.size()));
    };
    const Eigen::VectorXd g = flat(image), f = g - flat(x);
    std::vector<Vec3> out = image;
    if (const auto m = static_cast<Eigen::Index>(residuals_.size()); m > 0) {
      Eigen::MatrixXd df(f.size(), m), dg(f.size(), m);
      for (Eigen::Index i = 0; i < m; ++i) {
        df.col(i) = f - residuals_[static_cast<std::size_t>(i)];
        dg.col(i) = g - images_[static_cast<std::size_t>(i)];
      }
      const Eigen::MatrixXd gram = df.transpose() * df;
      const Eigen::VectorXd theta = (gram + 1e-14 * gram.trace() * Eigen::MatrixXd::Identity(m, m))
                                        .ldlt()
                                        .solve(df.transpose() * f);
      if (theta.allFinite())
        Eigen::Map<Eigen::VectorXd>(out.front().data(), g.size()) = g - dg * theta;
    }
    if (residuals_.size() == window_) {
      residuals_.erase(residuals_.begin());
      images_.erase(images_.begin());
    }
    residuals_.push_back(f);
    images_.push_back(g);
    return out;
  }
  std::size_t bytes() const { return 2 * window_ * vertices_ * sizeof(Vec3); }

 private:
  std::size_t window_, vertices_;
  std::vector<Eigen::VectorXd> residuals_, images_;  ///< of the last iterations
};

/// kLeastCurvature: a pair of displacement and gradient change with less curvature [m^2 N/m] is
/// dropped. kFallsOfLbfgs and kFallsOfNcg: sufficient decrease of the line search (Armijo), as
/// shares of the slope.
constexpr double kLeastCurvature = 1e-18, kFallsOfLbfgs = 0.03, kFallsOfNcg = 1e-4;
/// Largest displacement [m] of a step that is made for a difference of gradients.
constexpr double kDifference = 1e-6;
/// Most halvings of a step in the line search.
constexpr int kMostHalvings = 30;

/// Search directions down an energy, from gradients [N] at positions [m] in vectors of rows.
class Descent {
 public:
  using Vector = Eigen::VectorXd;
  Descent(const Params& params)
      : lbfgs_(params.is("method", "lbfgs")),
        on_(!params.is("method", "plain")),
        by_factor_(lbfgs_ || params.is("preconditioner", "factor")),
        history_(to_index(params.integer("history"))) {}
  bool on() const { return on_; }
  bool lbfgs() const { return lbfgs_; }
  double falls() const { return lbfgs_ ? kFallsOfLbfgs : kFallsOfNcg; }
  bool by_factor() const { return by_factor_; }
  void begin() {
    ways_.clear();
    changes_.clear();
    last_x_.resize(0);
  }

  /// precondition(v) turns v [N] into a displacement [m] in place.
  template <class Precondition>
  Vector direction(const Vector& x, const Vector& g, const Precondition& precondition) {
    Vector d = lbfgs_ ? two_loops(x, g, precondition) : conjugate(g, precondition);
    if (!(g.dot(d) < 0)) {
      begin();
      d = -preconditioned(g, precondition);
    }
    last_x_ = x;
    last_g_ = g;
    last_d_ = d;
    return d;
  }
  std::size_t bytes(std::size_t rows) const {
    return on_ ? (3 + 2 * history_) * 4 * rows * sizeof(double) : 0;
  }

 private:
  template <class Precondition>
  static Vector preconditioned(Vector v, const Precondition& precondition) {
    precondition(v);
    return v;
  }

  template <class Precondition>
  Vector two_loops(const Vector& x, const Vector& g, const Precondition& precondition) {
    if (last_x_.size() > 0 && history_ > 0) {
      Vector way = x - last_x_, change = g - last_g_;
      if (way.dot(change) >= kLeastCurvature) {
        if (ways_.size() == history_) {
          ways_.erase(ways_.begin());
          changes_.erase(changes_.begin());
        }
        ways_.push_back(std::move(way));
        changes_.push_back(std::move(change));
      }
    }
    Vector q = g;
    std::vector<double> taken(ways_.size());
    for (std::size_t i = ways_.size(); i-- > 0;) {
      taken[i] = ways_[i].dot(q) / ways_[i].dot(changes_[i]);
      q -= taken[i] * changes_[i];
    }
    precondition(q);
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      const double again = changes_[i].dot(q) / ways_[i].dot(changes_[i]);
      q += (taken[i] - again) * ways_[i];
    }
    return -q;
  }

  template <class Precondition>
  Vector conjugate(const Vector& g, const Precondition& precondition) {
    Vector z = preconditioned(g, precondition);
    Vector d = -z;
    if (last_x_.size() > 0) d += std::max(0.0, z.dot(g - last_g_) / last_g_.dot(last_z_)) * last_d_;
    last_z_ = std::move(z);
    return d;
  }

  bool lbfgs_, on_, by_factor_;
  std::size_t history_;
  std::vector<Vector> ways_, changes_;        ///< displacements [m], gradient changes [N]
  Vector last_x_, last_g_, last_z_, last_d_;  ///< of the last iteration; empty: none yet
};

template <class Real>
class ProjectivePass final : public Pass<Real> {
 public:
  explicit ProjectivePass(const loop::Setup& s)
      : forces_(kernels<Real>(s.simd).spring_forces),
        system_(s, stiffened(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params)),
                             link_damping(s))),
        slots_(system_.template make_slots<SpringSlot<Real>>(kNothingElse)),
        damped_(link_damping(s), system_.springs()),
        damped_slots_(link_damping(s), slots_),
        anderson_(to_index(s.params.integer("anderson")), s.w.size()),
        descent_(s.params),
        diagonal_(descent_.on() ? 4 * system_.rows() : 0) {
    const auto add = [&](std::size_t vertex, double k) {
      if (const int row = system_.row(vertex); row >= 0)
        for (std::size_t c = 0; c < 4; ++c) stiffness_[4 * to_index(row) + c] += k;
    };
    if (!descent_.on()) return;
    stiffness_.assign(4 * system_.rows(), 0);
    for (const Spring& spring : system_.springs()) {
      add(spring.a, spring.stiffness);
      add(spring.b, spring.stiffness);
    }
    for (const BendingElement& e : system_.bending())
      for (std::size_t i = 0; i < e.size; ++i)
        add(to_index(e.vertex[i]), e.stiffness * e.weight[i] * e.weight[i]);
    for (const MembraneElement& e : system_.membrane().elements)
      for (std::size_t a = 0; a < 3; ++a)
        add(to_index(e.vertex[a]),
            e.area * system_.membrane().law.stiffest() * e.gradient[a].squaredNorm());
  }

  const Layout& layout() const { return system_.layout(); }

  void restart() override { system_.restart(); }
  void take_over(const Pass<Real>& before) override {
    system_.take_over(static_cast<const ProjectivePass&>(before).system_);
  }
  Points<Real>* target() override { return &system_.target(); }
  TouchingPieces* touching_pieces() override { return system_.touching_pieces(); }

  void begin(Particles<Real>& p, double t, double h) override {
    damped_.begin(system_.springs(), p.previous);
    damped_slots_.begin(system_.groups(), slots_, p.previous);
    anderson_.begin();
    if (descent_.on()) {
      descent_.begin();
      for (std::size_t i = 0; i < p.size(); ++i)
        if (const int row = system_.row(i); row >= 0)
          for (std::size_t c = 0; c < 4; ++c) {
            const std::size_t at = 4 * to_index(row) + c;
            diagonal_[static_cast<Eigen::Index>(at)] =
                stiffness_[at] + 1 / (static_cast<double>(p.w[i]) * h * h);
          }
    }
    energy_ = std::numeric_limits<double>::infinity();
    system_.begin(p, t, h);
  }

  void apply(Particles<Real>& p, double, double h) override {
    if (descent_.on()) return descend(p, h);
    if (!anderson_.on()) return solve(p);
    fall_back(p, h);
    const std::vector<Vec3> from = positions(p);
    solve(p);
    last_image_ = positions(p);
    move_to(p, anderson_.next(from, last_image_));
  }

  std::vector<PassCost> cost() const override {
    return system_.cost("forces of links", slots_.size() * sizeof slots_[0] + damped_.bytes() +
                                               damped_slots_.bytes() + anderson_.bytes() +
                                               descent_.bytes(system_.rows()));
  }

 private:
  /// The iteration of Projective Dynamics; k (d - q) of a link is the force of a spring.
  void solve(Particles<Real>& p) {
    system_.solve(p, [this](const ForceSweep<Real>& sweep, std::size_t begin, std::size_t end) {
      forces_(sweep, slots_.data(), begin, end);
    });
  }

  using Vector = Eigen::VectorXd;

  /// Gradient of G at p.x [N].
  Vector gradient(const Particles<Real>& p) {
    Vector g(static_cast<Eigen::Index>(4 * system_.rows()));
    system_.find_forces(p,
                        [this](const ForceSweep<Real>& sweep, std::size_t begin, std::size_t end) {
                          forces_(sweep, slots_.data(), begin, end);
                        },
                        {g.data(), static_cast<std::size_t>(g.size())});
    return -g;
  }
  Vector place(const Particles<Real>& p) const {
    return Eigen::Map<const Eigen::Matrix<Real, Eigen::Dynamic, 1>>(
               p.x.data(), static_cast<Eigen::Index>(4 * system_.rows()))
        .template cast<double>();
  }
  void put(Particles<Real>& p, const Vector& x) const {
    for (Eigen::Index i = 0; i < x.size(); ++i) p.x.data()[i] = static_cast<Real>(x[i]);
  }

  /// One iteration of L-BFGS or of conjugate gradients.
  void descend(Particles<Real>& p, double h) {
    if (system_.rows() == 0) return;
    const Vector x = place(p), g = gradient(p);
    if (g.isZero(0)) return;
    const Vector d = descent_.direction(x, g, [this](Vector& v) {
      if (descent_.by_factor())
        system_.solve_forces({v.data(), static_cast<std::size_t>(v.size())});
      else
        v.array() /= diagonal_.array();
    });
    const double slope = g.dot(d), before = energy(positions(p), h, p);
    double share = 1;
    if (!descent_.lbfgs()) {
      const double small = kDifference / d.cwiseAbs().maxCoeff();
      put(p, x + small * d);
      const double curvature = (gradient(p) - g).dot(d) / small;
      if (curvature > 0) share = -slope / curvature;
    }
    for (int halvings = 0; halvings <= kMostHalvings; ++halvings, share /= 2) {
      put(p, x + share * d);
      const double now = energy(positions(p), h, p);
      if (now <= before + descent_.falls() * share * slope) return;
      // near the minimum, differences of the energy are mere rounding: the gradient decides
      if (now <= before * (1 + 1e-12) && gradient(p).norm() < g.norm()) return;
      if (!std::isfinite(now)) continue;
    }
    put(p, std::isfinite(slope) ? x : Vector::Constant(x.size(), slope));
  }

  static void move_to(Particles<Real>& p, const std::vector<Vec3>& x) {
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, x[i].template cast<Real>());
  }

  /// G [J] at x.
  double energy(const std::vector<Vec3>& x, double h, const Particles<Real>& p) const {
    double sum = bending_energy(system_.bending(), x) + system_.membrane().energy(x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (p.w[i] > 0)
        sum += (x[i] - system_.target()[i].template cast<double>()).squaredNorm() /
               (2 * h * h * static_cast<double>(p.w[i]));
    for (const auto& [a, b, rest, k] : system_.springs()) {
      const double c = (x[b] - x[a]).norm() - rest;
      sum += k / 2 * c * c;
    }
    return sum;
  }

  /// Goes back to the last solution of the global system if the combination raised the energy.
  void fall_back(Particles<Real>& p, double h) {
    const double now = energy(positions(p), h, p);
    if (now > energy_) {
      move_to(p, last_image_);
      anderson_.begin();
      energy_ = std::numeric_limits<double>::infinity();
    } else {
      energy_ = now;
    }
  }

  void (*forces_)(const ForceSweep<Real>&, SpringSlot<Real>*, std::size_t, std::size_t);
  GlobalSystem<Real> system_;
  std::vector<SpringSlot<Real>> slots_;
  DampedSprings damped_;
  DampedSlots<Real> damped_slots_;
  Anderson anderson_;
  Descent descent_;
  Vector diagonal_;                ///< [rows][4] N/m, diagonal of the matrix, for method=ncg
  std::vector<double> stiffness_;  ///< [rows][4] N/m, that diagonal's part without masses
  /// m; only with Anderson acceleration or a method other than plain.
  std::vector<Vec3> last_image_;
  double energy_ = 0;  ///< J, at the last iterate
};

template <class Real>
loop::Links<Real> links(const loop::Setup& s) {
  auto pass = std::make_unique<ProjectivePass<Real>>(s);
  Layout layout = pass->layout();
  return {
      .layout = std::move(layout),
      .pass = with_chebyshev<Real>(std::move(pass), s.params.real("chebyshev"), s.w.size(), s.pool),
      .bends = true,
      .stretches = true,
      .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, links<float>, links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (scene.membrane && scene.membrane->law != Membrane::Law::arap)
    loop::refuse_membrane(scene, "its local step is the nearest rotation, law = \"arap\"", reasons);
  if (scene.membrane && scene.membrane->damping > 0)
    loop::refuse_membrane(scene, "its damping is of Green's strain, which arap lacks", reasons);
  if (params.real("chebyshev") > 0 && params.integer("anderson") > 0)
    reasons.emplace_back("chebyshev and anderson are two ways to accelerate: take one");
  if (!params.is("method", "plain")) {
    const std::string method = "method=" + std::string(params.choice("method"));
    if (!scene.colliders.empty() || (scene.self_collision && !params.is("self", "off")))
      reasons.push_back(method + " knows no contact");
    if (params.real("chebyshev") > 0 || params.integer("anderson") > 0)
      reasons.push_back(method + " cannot be combined with chebyshev or anderson");
  }
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const ResolvedSettings own{
      describe_springs(scene, params),
      {"links solved",
       std::string(params.is("method", "lbfgs") ? "L-BFGS, "
                   : params.is("method", "ncg") ? "nonlinear conjugate gradients, "
                                                : "") +
           "all at once by a sparse LDLT, factored as set-up; other pins or links factor again"},
      {"work unit", "solutions of the whole system, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the factored system",
                                 loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"precision"}, {"double", "float"}},
                                                        {{"anderson"}, {"5"}},
                                                        {{"chebyshev"}, {"0.8", "0.95"}},
                                                        {{"method"}, {"lbfgs", "ncg"}}};

}  // namespace
}  // namespace taut::solver::pd

TAUT_SOLVER(pd) = {
    .name = "pd",
    .title = "Projective Dynamics",
    .summary = "Projective Dynamics of springs on one factored system",
    .source = "Liu et al. 2013, 2017; Bouaziz et al. 2014; Wang 2015; Peng et al. 2018",
    .params = taut::solver::pd::kParams,
    .make = taut::solver::pd::make,
    .unsupported = taut::solver::pd::unsupported,
    .resolved_settings = taut::solver::pd::resolved_settings,
    .declared_step = taut::loop::implicit_euler,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .all_at_once = true,
                 .stiffness = taut::kStiffnesses,
                 .alternatives = taut::solver::pd::kAlternatives,
                 .labelled = {"substeps", "iterations", "structural", "anderson", "chebyshev",
                              "method", "precision"},
                 .accelerators = {"anderson", "chebyshev", "method"}},
    .optional_effects = taut::loop::kOptionalEffects};
