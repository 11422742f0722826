// Projective Dynamics: Bouaziz et al. (SIGGRAPH 2014), of springs as in Liu et al., Fast Simulation
// of Mass-Spring Systems (SIGGRAPH Asia 2013). An iteration gives each link its length in the
// direction that it has (local), q = r d/|d|, and then places all vertices by one factored system
// (global):
//
//     (M/h^2 + sum K (e_b - e_a)(e_b - e_a)^T) x = M/h^2 y + sum K (e_b - e_a) q^T
//
// Written as the way from the x before, the right-hand side is minus the gradient of the energy of
// implicit Euler there, and K (d - q) the force of a spring: no q is kept.
//
// Its fixed point is implicit Euler's step (implicit.cpp). Motion across stretched links of strain
// e contracts by s lambda (1 - e)/(1 + s lambda) per iteration, s = h^2 K/m, which tends to 1: the
// stiffer the links, the more iterations until the cloth moves at all, and a strain near zero does
// not say that it did.
#include <Eigen/Cholesky>
#include <limits>

#include "core/solver/chebyshev.hpp"
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
};
constexpr auto kParams = loop::with_common(kOwn);

/// Peng et al.: Anderson Acceleration for Geometry Optimization and Physics Simulation (SIGGRAPH
/// 2018). With f the fixed-point map and F = f(x) - x, the next iterate is f(x) - sum theta_i dG_i
/// where theta minimises |F - sum theta_i dF_i| over the last iterations' differences.
class Anderson {
 public:
  Anderson(std::size_t window, std::size_t vertices) : window_(window), vertices_(vertices) {}
  bool on() const { return window_ > 0; }
  void begin() { residuals_.clear(), images_.clear(); }

  /// image = f(x) for this x.
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
    if (residuals_.size() == window_)
      residuals_.erase(residuals_.begin()), images_.erase(images_.begin());
    residuals_.push_back(f), images_.push_back(g);
    return out;
  }
  std::size_t bytes() const { return 2 * window_ * vertices_ * sizeof(Vec3); }

 private:
  std::size_t window_, vertices_;
  std::vector<Eigen::VectorXd> residuals_, images_;  ///< of the last iterations
};

template <class Real>
class ProjectivePass final : public Pass<Real> {
 public:
  explicit ProjectivePass(const loop::Setup& s)
      : forces_(kernels<Real>(s.simd).spring_forces),
        system_(s, make_springs(s.scene, s.w, stiffnesses(s.scene, s.params))),
        slots_(system_.template make_slots<SpringSlot<Real>>(kNothingElse)),
        anderson_(to_index(s.params.integer("anderson")), s.w.size()) {}

  const Layout& layout() const { return system_.layout(); }

  void restart() override { system_.restart(); }
  Points<Real>* target() override { return &system_.target(); }

  void begin(Particles<Real>& p, double t, double h) override {
    anderson_.begin();
    energy_ = std::numeric_limits<double>::infinity();
    system_.begin(p, t, h);
  }

  void apply(Particles<Real>& p, double, double h) override {
    if (!anderson_.on()) return solve(p);
    fall_back(p, h);
    const std::vector<Vec3> from = positions(p);
    solve(p);
    last_image_ = positions(p);
    move_to(p, anderson_.next(from, last_image_));
  }

  std::vector<PassCost> cost() const override {
    return system_.cost("forces of links", slots_.size() * sizeof slots_[0] + anderson_.bytes());
  }

 private:
  /// k (d - q) of a link is the force of a spring.
  void solve(Particles<Real>& p) {
    system_.solve(p, [this](const ForceSweep<Real>& sweep, std::size_t begin, std::size_t end) {
      forces_(sweep, slots_.data(), begin, end);
    });
  }

  static void move_to(Particles<Real>& p, const std::vector<Vec3>& x) {
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, x[i].template cast<Real>());
  }

  /// To the last solution of the global system if the combination raised the energy.
  void fall_back(Particles<Real>& p, double h) {
    const std::vector<Vec3> x = positions(p);
    double now = bending_energy(system_.bending(), x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (p.w[i] > 0)
        now += (x[i] - system_.target()[i].template cast<double>()).squaredNorm() /
               (2 * h * h * static_cast<double>(p.w[i]));
    for (const auto& [a, b, rest, k] : system_.springs()) {
      const double c = (x[b] - x[a]).norm() - rest;
      now += k / 2 * c * c;
    }
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
  Anderson anderson_;
  std::vector<Vec3> last_image_;  ///< m; with Anderson acceleration
  double energy_ = 0;             ///< J, of the last iterate
};

template <class Real>
loop::Links<Real> links(const loop::Setup& s) {
  auto pass = std::make_unique<ProjectivePass<Real>>(s);
  Layout layout = pass->layout();
  return {
      .layout = std::move(layout),
      .pass = with_chebyshev<Real>(std::move(pass), s.params.real("chebyshev"), s.w.size(), s.pool),
      .bends = true,
      .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, links<float>, links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (params.real("chebyshev") > 0 && params.integer("anderson") > 0)
    reasons.emplace_back("chebyshev and anderson are two ways to accelerate: take one");
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const ResolvedSettings own{
      {"links", describe_springs(scene, params)},
      {"links solved",
       "all at once by a sparse LDLT, factored as set-up; other pins or links factor again"},
      {"work unit", "solutions of the whole system, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the factored system",
                                 loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"precision", "double|float"}};

}  // namespace
}  // namespace taut::solver::pd

TAUT_SOLVER(pd) = {.name = "pd",
                   .title = "Projective Dynamics",
                   .summary = "Projective Dynamics of springs on one factored system",
                   .source = "Liu et al. 2013; Bouaziz et al. 2014; Wang 2015; Peng et al. 2018",
                   .params = taut::solver::pd::kParams,
                   .make = taut::solver::pd::make,
                   .unsupported = taut::solver::pd::unsupported,
                   .resolved_settings = taut::solver::pd::resolved_settings,
                   .accuracy = {.substeps = "substeps",
                                .sweeps = "iterations",
                                .all_at_once = true,
                                .stiffness = taut::kStiffnesses,
                                .alternatives = taut::solver::pd::kAlternatives,
                                .labelled = "substeps|iterations|structural|precision"}};
