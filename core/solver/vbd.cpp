// Vertex Block Descent (Chen, Liu, Yang, Yuksel, SIGGRAPH 2024) of springs. A sweep moves each
// vertex to the minimum of a quadratic model of implicit Euler's energy (implicit.cpp) in its own
// coordinates, with all others held:
//
//     f = -m/h^2 (x - y) + sum K C u              u from the vertex towards the link's other end
//     H = m/h^2 I + sum K [ u u^T + max(0, 1 - r/n) (I - u u^T) ],      x += H^-1 f
//
// With damping k_d, H gains k_d/h times the springs' part, and f loses that times x - x_t. A
// scene's own damping of links makes them other springs in each step (core/model/link_damping.hpp).
#include "core/solver/chebyshev.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"
#include "core/solver/vertex_blocks.hpp"

namespace taut::solver::vbd {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("10",
                     "sweeps over all vertices per substep; in contact with a friction of 0.7, 2 "
                     "of 200 steps do not converge, however many there are"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    kVertexOrder,
    kAdaptiveStart,
    kVertexPrecision,
    ParamSpec::real("damping", "s", "0", 0, 1e3,
                    "k_d, a factor of the springs' Hessian; as published it brakes the motion of "
                    "each vertex: a fall, too, which `links.damping` of a scene does not"),
    kChebyshev,
};
constexpr auto kParams = loop::with_common(kOwn);

template <class Real>
class DescentPass final : public Pass<Real> {
 public:
  explicit DescentPass(const loop::Setup& s)
      : springs_(
            stiffened(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params)), link_damping(s))),
        blocks_(s, springs_, kernels<Real>(s.simd).sweep_springs),
        damped_(link_damping(s), blocks_.slots()),
        damping_(s.params.real("damping")) {}

  const Layout& layout() const { return blocks_.groups().layout(); }
  Points<Real>* target() override { return &blocks_.target(); }

  void restart() override { blocks_.restart(); }
  void take_over(const Pass<Real>& before) override {
    blocks_.take_over(static_cast<const DescentPass&>(before).blocks_);
  }
  void begin(Particles<Real>& p, double t, double h) override {
    damped_.begin(blocks_.groups(), blocks_.slots(), p.previous);
    blocks_.begin(p, t, h);
  }
  void apply(Particles<Real>& p, double, double h) override { blocks_.sweep(p, damping_, h); }

  std::vector<PassCost> cost() const override {
    std::vector<PassCost> costs{
        {.pass = "vertices", .items = blocks_.groups().vertices(), .bytes = 0},
        {.pass = "links, each from both ends",
         .items = 2 * springs_.size(),
         .bytes = blocks_.bytes() + damped_.bytes()}};
    if (const std::size_t triangles = blocks_.membrane().elements.size(); triangles > 0)
      costs.push_back({.pass = "membrane, each triangle from its corners", .items = 3 * triangles});
    return costs;
  }

 private:
  std::vector<Spring> springs_;
  VertexBlocks<Real, SpringSlot<Real>> blocks_;
  DampedSlots<Real> damped_;
  double damping_;  ///< s, k_d
};

template <class Real>
loop::Links<Real> links(const loop::Setup& s) {
  auto pass = std::make_unique<DescentPass<Real>>(s);
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

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  return loop::resolved_settings(scene, params,
                                 {describe_springs(scene, params),
                                  {"vertex order", std::string(params.choice("order"))},
                                  {"work unit", "vertices, not projections"}},
                                 "in each vertex' force and Hessian", loop::kSolvedFriction);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  loop::refuse_faces(scene, params, "vbd", reasons);
  if (scene.membrane && params.real("damping") > 0)
    reasons.emplace_back("damping is of links: the membrane has none");
  if (params.real("damping") > 0)
    refuse_link_damping(scene, "vbd:damping brakes them, too: take one", reasons);
  return reasons;
}

DeclaredStep declared_step(const Scene& scene, const Params& params) {
  DeclaredStep step = loop::implicit_euler(scene, params);
  if (params.real("damping") > 0) step.none = "the exact step leaves out its damping";
  return step;
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"chebyshev"}, {"0.5", "0.8", "0.9"}},
                                                        {{"start"}, {"adaptive", "inertia"}},
                                                        {{"order"}, {"coloured", "mesh"}},
                                                        {{"precision"}, {"double", "float"}}};

}  // namespace
}  // namespace taut::solver::vbd

TAUT_SOLVER(vbd) = {.name = "vbd",
                    .title = "VBD",
                    .summary = "Vertex Block Descent on the energy of implicit Euler",
                    .source = "Chen, Liu, Yang, Yuksel 2024; Wang 2015",
                    .params = taut::solver::vbd::kParams,
                    .make = taut::solver::vbd::make,
                    .unsupported = taut::solver::vbd::unsupported,
                    .resolved_settings = taut::solver::vbd::resolved_settings,
                    .declared_step = taut::solver::vbd::declared_step,
                    .accuracy = {.substeps = "substeps",
                                 .sweeps = "iterations",
                                 .stiffness = taut::kStiffnesses,
                                 .alternatives = taut::solver::vbd::kAlternatives,
                                 .labelled = {"substeps", "iterations", "structural", "chebyshev",
                                              "start", "order", "precision"},
                                 .accelerators = {"chebyshev", "threads"}},
                    .optional_effects = taut::loop::kOptionalEffects};
