// Augmented Vertex Block Descent: Giles, Diaz, Yuksel (SIGGRAPH 2025), of rigid links. Each link
// has a multiplier l [N] and a stiffness k [N/m] that grows while it is violated. With C the
// stretch, C_0 that at x_t, n its length and u as in vbd.cpp:
//
//     substep:  l *= alpha gamma;   k = clamp(gamma k, k_min, k_max)
//     sweep:    F = k (C - alpha C_0) + l,    f = -m/h^2 (x - y) + sum F u
//               H = m/h^2 I + sum k u u^T + diag |columns of F (I - u u^T)/n|,    x += H^-1 f
//     then:     l = k (C - alpha C_0) + l;    k = min(k + beta |C - alpha C_0|, k_max)
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"
#include "core/solver/vertex_blocks.hpp"

namespace taut::solver::avbd {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("10", "sweeps over all vertices per substep"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kVertexOrder,
    kAdaptiveStart,
    ParamSpec::real("alpha", "", "0.95", 0, 1,
                    "share of the violation at a substep's start that is left for later"),
    ParamSpec::real("beta", "N/m^2", "10", 0, 1e12, "growth of k per violation and sweep"),
    ParamSpec::real("gamma", "", "0.99", 0, 1, "share of l and k kept from substep to substep"),
    ParamSpec::real("k-min", "N/m", "1", 1e-9, 1e12, "least stiffness of a link"),
    ParamSpec::real("k-max", "N/m", "1e9", 1e-9, 1e15, "largest stiffness of a link"),
};
constexpr auto kParams = loop::with_common(kOwn);

class AugmentedPass final : public Pass<double> {
 public:
  explicit AugmentedPass(const loop::Setup& s)
      : springs_(make_springs(s.scene, s.w, {1, 1, 1})),
        blocks_(s, springs_),
        start_(s.scene, s.params.is("start", "adaptive")),
        alpha_(s.params.real("alpha")),
        beta_(s.params.real("beta")),
        gamma_(s.params.real("gamma")),
        k_min_(s.params.real("k-min")),
        k_max_(std::max(s.params.real("k-max"), k_min_)),
        links_(springs_.size()) {
    restart();
  }

  void restart() override {
    start_.restart();
    blocks_.restart();
    links_.assign(links_.size(), {.k = k_min_});
  }

  void begin(Particles<double>& p, double t, double h) override {
    for (std::size_t j = 0; j < links_.size(); ++j) {
      LinkState& link = links_[j];
      const auto& [a, b, rest, unused] = springs_[j];
      link.left = alpha_ * ((p.previous[b] - p.previous[a]).norm() - rest);
      link.multiplier *= alpha_ * gamma_;
      link.k = std::clamp(gamma_ * link.k, k_min_, k_max_);
    }
    y_ = positions(p);
    start_.begin(p, h);
    blocks_.begin(p, y_, t, h);
  }

  void apply(Particles<double>& p, double, double h) override {
    blocks_.sweep(p, [&](std::size_t i, const Vec3& x, const auto& links) {
      const double inertia = 1 / (p.w[i] * h * h);
      Vec3 force = -inertia * (x - y_[i]);
      Eigen::Matrix3d hessian = inertia * Eigen::Matrix3d::Identity();
      links([&](std::size_t j, const Vec3& u, double stretch, double length) {
        const LinkState& link = links_[j];
        const double pull = link.k * (stretch - link.left) + link.multiplier;
        force += pull * u;
        hessian += link.k * u * u.transpose();
        // a column of I - u u^T, a projection, has the norm sqrt(1 - u_c^2)
        hessian.diagonal().array() +=
            std::abs(pull) / length * (1 - u.array().square()).max(0.0).sqrt();
      });
      blocks_.add_bending(p, i, force, hessian);
      return blocks_.minimum(p, i, x, force, hessian);
    });
    for (std::size_t j = 0; j < links_.size(); ++j) {
      LinkState& link = links_[j];
      const auto& [a, b, rest, unused] = springs_[j];
      const double violation = (p.x[b] - p.x[a]).norm() - rest - link.left;
      link.multiplier += link.k * violation;
      link.k = std::min(link.k + beta_ * std::abs(violation), k_max_);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "vertices",
             .items = y_.size(),
             .bytes = y_.size() * sizeof(Vec3) + start_.bytes()},
            {.pass = "links, each from both ends and once for its multiplier",
             .items = 3 * springs_.size(),
             .bytes = blocks_.bytes() + links_.size() * sizeof(LinkState)}};
  }

 private:
  struct LinkState {
    double k = 0;           ///< N/m
    double multiplier = 0;  ///< N
    double left = 0;        ///< m, alpha C_0
  };
  std::vector<Spring> springs_;
  VertexBlocks blocks_;
  AdaptiveStart start_;
  double alpha_, beta_, gamma_, k_min_, k_max_;
  std::vector<LinkState> links_;
  std::vector<Vec3> y_;  ///< m, where they would go without links
};

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = std::make_unique<AugmentedPass>(s),
          .bends = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make<double>(scene, params, links);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  for (std::string& reason : elastic_links(scene)) reasons.push_back(std::move(reason));
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  return loop::resolved_settings(scene, params,
                                 {{"links", "rigid"},
                                  {"vertex order", std::string(params.choice("order"))},
                                  {"work unit", "vertices, not projections"}},
                                 "in each vertex' force and Hessian", loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"beta", "10|100|1000"},
                                                        {"k-min", "1|10|100"}};

}  // namespace
}  // namespace taut::solver::avbd

TAUT_SOLVER(avbd) = {.name = "avbd",
                     .title = "AVBD",
                     .summary = "Augmented Vertex Block Descent of rigid links",
                     .source = "Giles, Diaz, Yuksel 2025",
                     .params = taut::solver::avbd::kParams,
                     .make = taut::solver::avbd::make,
                     .unsupported = taut::solver::avbd::unsupported,
                     .resolved_settings = taut::solver::avbd::resolved_settings,
                     .accuracy = {.substeps = "substeps",
                                  .sweeps = "iterations",
                                  .alternatives = taut::solver::avbd::kAlternatives,
                                  .labelled = "substeps|iterations|beta|k-min"}};
