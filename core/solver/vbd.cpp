// Vertex Block Descent: Chen, Liu, Yang, Yuksel (SIGGRAPH 2024), of springs. A sweep moves each
// vertex to the minimum of a quadratic model of implicit Euler's energy (implicit.cpp) in its own
// coordinates, all others held:
//
//     f = -m/h^2 (x - y) + sum K C u              u from the vertex towards the link's other end
//     H = m/h^2 I + sum K [ u u^T + max(0, 1 - r/n) (I - u u^T) ],      x += H^-1 f
//
// with damping k_d: H gains k_d/h times the springs' part, f loses that times x - x_t.
#include "core/solver/chebyshev.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"
#include "core/solver/vertex_blocks.hpp"

namespace taut::solver::vbd {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("10", "sweeps over all vertices per substep"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    kVertexOrder,
    kAdaptiveStart,
    ParamSpec::real("damping", "s", "0", 0, 1e3,
                    "k_d, of the springs' Hessian; as published it brakes each vertex' own way, "
                    "rigid motion, too"),
    kChebyshev,
};
constexpr auto kParams = loop::with_common(kOwn);

class DescentPass final : public Pass<double> {
 public:
  explicit DescentPass(const loop::Setup& s)
      : springs_(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params))),
        blocks_(s, springs_),
        start_(s.scene, s.params.is("start", "adaptive")),
        damping_(s.params.real("damping")) {}

  void restart() override {
    start_.restart();
    blocks_.restart();
  }

  void begin(Particles<double>& p, double t, double h) override {
    y_ = positions(p);
    start_.begin(p, h);
    blocks_.begin(p, y_, t, h);
  }

  void apply(Particles<double>& p, double, double h) override {
    blocks_.sweep(p, [&](std::size_t i, const Vec3& x, const auto& links) {
      using Eigen::Matrix3d;
      const double inertia = 1 / (p.w[i] * h * h);
      Vec3 force = -inertia * (x - y_[i]);
      Matrix3d hessian = Matrix3d::Zero();
      links([&](std::size_t j, const Vec3& u, double stretch, double length) {
        const double k = springs_[j].stiffness, across = k * std::max(0.0, stretch / length);
        force += k * stretch * u;
        hessian += across * Matrix3d::Identity() + (k - across) * u * u.transpose();
      });
      if (damping_ > 0) {
        force -= damping_ / h * (hessian * (x - p.previous[i]));
        hessian *= 1 + damping_ / h;
      }
      blocks_.add_bending(p, i, force, hessian);
      hessian.diagonal().array() += inertia;
      return blocks_.minimum(p, i, x, force, hessian);
    });
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "vertices",
             .items = y_.size(),
             .bytes = y_.size() * sizeof(Vec3) + start_.bytes()},
            {.pass = "links, each from both ends",
             .items = 2 * springs_.size(),
             .bytes = blocks_.bytes()}};
  }

 private:
  std::vector<Spring> springs_;
  VertexBlocks blocks_;
  AdaptiveStart start_;
  double damping_;       ///< s
  std::vector<Vec3> y_;  ///< m, where they would go without links
};

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = with_chebyshev<double>(std::make_unique<DescentPass>(s),
                                         s.params.real("chebyshev"), s.w.size(), s.pool),
          .bends = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make<double>(scene, params, links);
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  return loop::resolved_settings(scene, params,
                                 {{"links", describe_springs(scene, params)},
                                  {"vertex order", std::string(params.choice("order"))},
                                  {"work unit", "vertices, not projections"}},
                                 "in each vertex' force and Hessian", loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"chebyshev", "0.5|0.8|0.9"},
                                                        {"start", "adaptive|inertia"}};

}  // namespace
}  // namespace taut::solver::vbd

TAUT_SOLVER(vbd) = {.name = "vbd",
                    .title = "VBD",
                    .summary = "Vertex Block Descent on the energy of implicit Euler",
                    .source = "Chen, Liu, Yang, Yuksel 2024; Wang 2015",
                    .params = taut::solver::vbd::kParams,
                    .make = taut::solver::vbd::make,
                    .unsupported = taut::unsupported_of_springs,
                    .resolved_settings = taut::solver::vbd::resolved_settings,
                    .accuracy = {.substeps = "substeps",
                                 .sweeps = "iterations",
                                 .alternatives = taut::solver::vbd::kAlternatives,
                                 .labelled = "substeps|iterations|chebyshev|start",
                                 .accelerators = "chebyshev|threads"}};
