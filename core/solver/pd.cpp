// Projective Dynamics: Bouaziz et al. (SIGGRAPH 2014), of springs as in Liu et al., Fast Simulation
// of Mass-Spring Systems (SIGGRAPH Asia 2013). An iteration gives each link its length in the
// direction that it has (local), q = r d/|d|, and then places all vertices by one factored system
// (global):
//
//     (M/h^2 + sum K (e_b - e_a)(e_b - e_a)^T) x = M/h^2 y + sum K (e_b - e_a) q^T
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

class ProjectivePass final : public Pass<double> {
 public:
  explicit ProjectivePass(const loop::Setup& s)
      : system_(s, make_springs(s.scene, s.w, stiffnesses(s.scene, s.params))),
        wanted_(system_.springs().size()),
        anderson_(to_index(s.params.integer("anderson")), s.w.size()) {}

  void restart() override { system_.restart(); }

  void begin(Particles<double>& p, double t, double h) override {
    anderson_.begin();
    if (anderson_.on()) {
      y_ = positions(p);
      energy_ = std::numeric_limits<double>::infinity();
    }
    system_.begin(p, t, h);
  }

  void apply(Particles<double>& p, double, double h) override {
    if (!anderson_.on()) return solve(p);
    fall_back(p, h);
    const std::vector<Vec3> from = positions(p);
    solve(p);
    last_image_ = positions(p);
    const std::vector<Vec3> next = anderson_.next(from, last_image_);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, next[i]);
  }

  std::vector<PassCost> cost() const override {
    return system_.cost("directions of links", wanted_.size() * sizeof(Vec3) + anderson_.bytes());
  }

 private:
  void solve(Particles<double>& p) {
    for (std::size_t j = 0; j < wanted_.size(); ++j) {
      const auto& [a, b, rest, k] = system_.springs()[j];
      const Vec3 d = p.x[b] - p.x[a];
      const double length = d.norm();
      wanted_[j] = length > 0 ? Vec3(rest / length * d) : Vec3(Vec3::Zero());
    }
    system_.solve(wanted_, p);
  }

  /// To the last solution of the global system if the combination raised the energy.
  void fall_back(Particles<double>& p, double h) {
    double now = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) now += (p.x[i] - y_[i]).squaredNorm() / (2 * h * h * p.w[i]);
    for (const auto& [a, b, rest, k] : system_.springs()) {
      const double c = (p.x[b] - p.x[a]).norm() - rest;
      now += k / 2 * c * c;
    }
    for (const BendingElement& e : system_.bending())
      now += e.stiffness / 2 * e.value([&](std::size_t v) { return p.x[v]; }).squaredNorm();
    if (now > energy_) {
      for (std::size_t i = 0; i < p.size(); ++i)
        if (p.w[i] > 0) p.x.set(i, last_image_[i]);
      anderson_.begin();
      energy_ = std::numeric_limits<double>::infinity();
    } else {
      energy_ = now;
    }
  }

  GlobalSystem system_;
  std::vector<Vec3> wanted_;  ///< m, q of each link
  Anderson anderson_;
  std::vector<Vec3> y_, last_image_;  ///< m; with Anderson acceleration
  double energy_ = 0;                 ///< J, of the last iterate
};

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = with_chebyshev<double>(std::make_unique<ProjectivePass>(s),
                                         s.params.real("chebyshev"), s.w.size(), s.pool),
          .bends = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make<double>(scene, params, links);
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
       "all at once by a sparse LLT, factored as set-up; other pins or links factor again"},
      {"work unit", "solutions of the whole system, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the factored system",
                                 loop::kSolvedFriction);
}

}  // namespace
}  // namespace taut::solver::pd

TAUT_SOLVER(pd) = {
    .name = "pd",
    .title = "Projective Dynamics",
    .summary = "Projective Dynamics of springs on one factored system",
    .source = "Liu et al. 2013; Bouaziz et al. 2014; Wang 2015; Peng et al. 2018",
    .params = taut::solver::pd::kParams,
    .make = taut::solver::pd::make,
    .unsupported = taut::solver::pd::unsupported,
    .resolved_settings = taut::solver::pd::resolved_settings,
    .accuracy = {.substeps = "substeps", .sweeps = "iterations", .all_at_once = true}};
