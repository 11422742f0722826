#include "core/solver/loop.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <typeinfo>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "core/solver/bending.hpp"
#include "core/solver/constraints/tethers.hpp"
#include "core/solver/membrane.hpp"
#include "core/solver/wind.hpp"

namespace taut::loop {

namespace {

template <class T>
using Choice = std::pair<std::string_view, T>;

constexpr Choice<Response> kResponses[] = {
    {"continuous", Response::continuous}, {"discrete", Response::discrete},
    {"before", Response::before},         {"after", Response::after},
    {"freeze", Response::freeze},         {"halt", Response::halt}};
constexpr Choice<SelfCollisionMethod> kSelfCollision[] = {{"grid", SelfCollisionMethod::grid},
                                                          {"octree", SelfCollisionMethod::octree},
                                                          {"off", SelfCollisionMethod::off}};

/// The instruction set of parameter `simd`. Throws InputError if this machine does not have it.
Simd simd_of(const Params& params) {
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512})
    if (params.is("simd", to_string(simd))) {
      if (available(simd)) return simd;
      throw InputError(params.owner() + ": simd=" + std::string(to_string(simd)) +
                       ": this machine does not have it; its widest is " +
                       std::string(to_string(widest())));
    }
  return widest();
}

ContactSettings contact_settings(const Params& params) {
  return {.response = params.one_of("contact", kResponses),
          .edges = !params.is("faces", "off"),
          .faces = params.is("faces", "on"),
          .self = params.one_of("self", kSelfCollision),
          .simd = simd_of(params)};
}

/// The vertices that are not integrated: they are held, or follow the scene's motions.
class Pins {
 public:
  Pins(const Scene& scene, const Layout& layout) {
    std::vector<int> free = scene.pins;
    std::vector<Moved> moved;
    for (const PinMotion& group : scene.pin_motions) {
      motions_.push_back(group.motion);
      for (const int v : group.vertices) {
        std::erase(free, v);
        moved.push_back({v, motions_.size() - 1, scene.start.x[static_cast<std::size_t>(v)]});
      }
    }
    std::vector<Held> held;
    for (const int v : free) held.push_back({v});
    held_ = {std::move(held), layout};
    moved_ = {std::move(moved), layout};
  }
  Pins() = default;

  /// Moves the pins in blocks [begin, end) to their positions at time t [s], overriding the
  /// integration.
  template <class Real>
  void place(Particles<Real>& p, std::size_t begin, std::size_t end, double t) {
    for (const auto& [v] : held_.of(begin, end))
      p.x.set(static_cast<std::size_t>(v), p.previous[static_cast<std::size_t>(v)]);
    for (const auto& [v, motion, start] : moved_.of(begin, end))
      p.x.set(static_cast<std::size_t>(v), motions_[motion].moved(start, t).template cast<Real>());
  }

  bool empty() const { return held_.empty() && moved_.empty(); }
  std::size_t size() const { return held_.size() + moved_.size(); }
  std::size_t bytes() const { return held_.bytes() + moved_.bytes(); }

 private:
  struct Held {
    int vertex;
  };
  struct Moved {
    int vertex;
    std::size_t motion;
    Vec3 start;  ///< m
  };
  std::vector<Motion> motions_;
  ByBlock<Held> held_;
  ByBlock<Moved> moved_;
};

/// The step of Thomas Jakobsen, Advanced Character Physics (GDC 2001), with any solver of links.
template <class Real>
class Loop final : public Solver {
 public:
  Loop(const Scene& scene, const Params& params, MakeLinks<Real> make_links)
      : iterations_(params.has("iterations") ? params.integer("iterations") : 1),
        substeps_(params.integer("substeps")),
        h_(scene.dt / substeps_),
        gravity_(scene.gravity),
        damping_(scene.damping),
        simd_(simd_of(params)),
        pool_(params.integer("threads")) {
    const std::vector<double> w = inverse_masses(scene);
    Links<Real> links = make_links({scene, params, w, simd_, pool_});
    p_ = Particles<Real>(std::move(links.layout));
    p_.w.assign(w.begin(), w.end());
    p_.x = p_.previous = Points<Real>(p_.layout);
    if (links.accelerates) accelerating_ = links.pass.get();
    if (scene.wind) forces_.push_back(make_wind<Real>(scene, w, *p_.layout, simd_, pool_));
    if (accelerating_ || scene.wind) p_.a = Points<Real>(p_.layout);
    constraints_ = std::move(links.coarse);
    if (params.has("tethers") && params.is("tethers", "on"))
      if (const std::vector<Tether> tethers = make_tethers(scene); !tethers.empty())
        constraints_.push_back(
            std::make_unique<TetherPass<Real>>(scene, tethers, links.tethers, simd_));
    Pass<Real>* const solving = links.contacts ? links.pass.get() : nullptr;
    if (links.pass) constraints_.push_back(std::move(links.pass));
    if (scene.membrane && !links.stretches)
      constraints_.push_back(make_membrane_pass<Real>(scene, w, h_));
    if (scene.bending && !links.bends) constraints_.push_back(make_bending_pass<Real>(scene, w));
    pins_ = Pins(scene, *p_.layout);
    contact_ = make_contact<Real>(scene, *p_.layout, contact_settings(params), solving, pool_);
    contact_begins_ = solving != nullptr;
  }

  /// The published TimeStep(), run `substeps` times with dt / substeps.
  void step(double t, double dt) override {
    const double h = dt / substeps_;
    prepare_verlet(h);
    bool missed = false;
    for (int s = 0; s < substeps_; ++s, t += h) {
      if (accelerating_) ready_for(*accelerating_).accelerate(p_, t, h);
      apply(forces_, t, h);  // AccumulateForces
      verlet(t + h);         // Verlet
      if (contact_begins_) begin(contact_.sweep, t, h);
      begin(constraints_, t, h);
      begin(contact_.before, t, h);
      if (!contact_begins_) begin(contact_.sweep, t, h);
      begin(contact_.after, t, h);
      apply(contact_.before, t, h);
      for (int k = 0; k < iterations_; ++k) {  // SatisfyConstraints
        apply(constraints_, t, h);
        apply(contact_.sweep, t, h);
      }
      apply(contact_.after, t, h);
      for (auto& pass : constraints_) {
        ready_for(*pass).end(p_, t, h);
        if (const auto converged = pass->converged()) {
          missed = missed || !*converged;
          unconverged_ = unconverged_.value_or(0);
        }
      }
      if (s + 1 < substeps_) substep_ended(t + h);
    }
    if (missed) unconverged_ = *unconverged_ + 1;
    pool_.finish();
  }
  std::optional<int> unconverged_steps() const override { return unconverged_; }

  void load(const State& state) override {
    for (std::size_t i = 0; i < p_.size(); ++i) {
      const Vec3 previous = state.x[i] - h_ * state.v[i];
      p_.x.set(i, state.x[i].template cast<Real>());
      p_.previous.set(i, previous.template cast<Real>());
    }
    unconverged_.reset();
    for (Pass<Real>* pass : all_passes()) pass->restart();
  }

  /// Continues from `before`: copies every coordinate, and the k-th pass of a class takes over from
  /// the k-th of that class.
  void go_on(const Solver& before) override {
    Solver::go_on(before);
    const auto& old = dynamic_cast<const Loop&>(before);
    unconverged_ = old.unconverged_;
    for (std::size_t i = 0; i < p_.size(); ++i) {
      p_.x.set(i, old.p_.x[i]);
      p_.previous.set(i, old.p_.previous[i]);
    }
    const std::vector<Pass<Real>*> passes = all_passes(), earlier = old.all_passes();
    std::size_t next = 0;
    for (Pass<Real>* pass : passes)
      for (std::size_t k = next; k < earlier.size(); ++k)
        if (typeid(*pass) == typeid(*earlier[k])) {
          pass->take_over(*earlier[k]);
          next = k + 1;
          break;
        }
  }

  void displace(const std::vector<Vec3>& ways) override {
    for (std::size_t i = 0; i < p_.size(); ++i) {
      const auto way = ways[i].template cast<Real>();
      p_.x.add(i, way);
      p_.previous.add(i, way);
    }
  }

  void store(State& state) const override {
    pool_.finish();  // visitors of substeps come while work is queued
    state.x.resize(p_.size());
    state.v.resize(p_.size());
    for (std::size_t i = 0; i < p_.size(); ++i) {
      state.x[i] = p_.x[i].template cast<double>();
      state.v[i] = (p_.x[i] - p_.previous[i]).template cast<double>() / h_;
    }
  }

  std::vector<PassCost> step_cost() const override {
    std::vector<PassCost> costs;
    const auto add = [&](std::vector<PassCost> lines, int repeats) {
      for (PassCost& line : lines) {
        line.repeats = static_cast<std::size_t>(repeats);
        costs.push_back(std::move(line));
      }
    };
    const std::size_t bytes = p_.x.bytes() + p_.previous.bytes() + p_.a.bytes() +
                              p_.w.size() * sizeof(Real) + p_.layout->bytes();
    for (const auto& force : forces_) add(force->cost(), substeps_);
    add({{.pass = "verlet", .items = p_.size(), .bytes = bytes}}, substeps_);
    if (!pins_.empty())
      add({{.pass = "pins", .items = pins_.size(), .bytes = pins_.bytes()}}, substeps_);
    for (const auto& pass : contact_.before) add(pass->cost(), substeps_);
    for (const auto& constraint : constraints_) add(constraint->cost(), substeps_ * iterations_);
    for (const auto& pass : contact_.sweep) add(pass->cost(), substeps_ * iterations_);
    for (const auto& pass : contact_.after) add(pass->cost(), substeps_);
    return costs;
  }

 private:
  using PassList = std::vector<std::unique_ptr<Pass<Real>>>;

  std::vector<Pass<Real>*> all_passes() const {
    std::vector<Pass<Real>*> all;
    for (const auto* list :
         {&forces_, &constraints_, &contact_.before, &contact_.sweep, &contact_.after})
      for (const auto& pass : *list) all.push_back(pass.get());
    return all;
  }
  void apply(PassList& passes, double t, double dt) {
    for (auto& pass : passes) ready_for(*pass).apply(p_, t, dt);
  }
  void begin(PassList& passes, double t, double h) {
    for (auto& pass : passes) ready_for(*pass).begin(p_, t, h);
  }
  Pass<Real>& ready_for(Pass<Real>& pass) {
    if (!pass.queues()) pool_.finish();
    return pass;
  }

  /// Sets gravity and damping for substeps of dt [s]. This costs as much as integrating hundreds of
  /// particles.
  void prepare_verlet(double dt) {
    if (dt == prepared_for_) return;
    for (std::size_t i = 0; i < kGrain; ++i) {
      const int axis = p_.layout->axis(i);
      g_[i] = static_cast<Real>(axis < 3 ? gravity_[axis] * dt * dt : 0);
    }
    verlet_ = {.x = p_.x.data(),
               .previous = p_.previous.data(),
               .a = p_.a.empty() ? nullptr : p_.a.data(),
               .keep = static_cast<Real>(std::exp(-damping_ * dt)),
               .dt2 = static_cast<Real>(dt * dt),
               .g = g_};
    prepared_for_ = dt;
  }

  /// Verlet: x* = x + (x - x') + a dt^2, with the velocity x - x' damped; pins move to their
  /// positions at t.
  void verlet(double t) {
    pool_.queue(
        p_.layout->blocks(),
        [this, t](std::size_t begin, std::size_t end) {
          const Kernels<Real>& k = kernels<Real>(simd_);
          const auto kernel = p_.layout->stride() == kWide ? k.wide_verlet : k.narrow_verlet;
          kernel(verlet_, p_.layout->place_of_block(begin), p_.layout->place_of_block(end));
          pins_.place(p_, begin, end, t);
        },
        p_.size() >= ThreadPool::kWorthSharing);
  }

  int iterations_;
  int substeps_;
  std::optional<int> unconverged_;
  double h_;  ///< s, length of a substep
  Vec3 gravity_;
  double damping_;
  Simd simd_;
  mutable ThreadPool pool_;
  Pins pins_;
  Particles<Real> p_;
  alignas(64) Real g_[kGrain];
  VerletStep<Real> verlet_{};
  double prepared_for_ = 0;  ///< s; 0: no substep yet
  PassList forces_;
  PassList constraints_;
  Pass<Real>* accelerating_ = nullptr;  ///< one of constraints_
  ContactPasses<Real> contact_;
  bool contact_begins_ = false;  ///< contact forces of the last substep are part of y
};

bool in_float(const Params& params) {
  return params.has("precision") && params.is("precision", "float");
}

/// Largest coordinate [m] at the scene's start; of cloth that nothing holds or stops, its mean over
/// the run: a third of the way it falls is added.
double farthest_coordinate(const Scene& scene) {
  double farthest = 0;
  for (const Vec3& x : scene.start.x) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  if (!scene.pins.empty() || !scene.colliders.empty()) return farthest;
  return farthest + scene.gravity.norm() * scene.duration() * scene.duration() / 6;
}

/// What rounding in float does to gravity. Verlet's x - x_previous is a whole number of units in
/// the last place of x. Gravity's g h^2 is rounded to such a unit in every substep, always the same
/// way while the coordinate keeps its exponent.
struct Rounding {
  double farthest;  ///< [m] a coordinate of the cloth
  double unit;      ///< [m] the unit in the last place just below it
  double move;      ///< [m] g h^2

  double share() const { return move == 0 ? 0 : std::min(1.0, unit / 2 / move); }
  std::string said() const {
    return "rounding in coordinates of " + general(farthest, 4) + " m changes gravity by up to " +
           std::to_string(std::lround(100 * share())) + " %";
  }
};

Rounding rounding_in_float(const Scene& scene, const Params& params) {
  const double h = scene.dt / params.integer("substeps");
  const double farthest = farthest_coordinate(scene);
  const double below = std::max(std::nextafter(farthest, 0), 1e-30);
  return {.farthest = farthest,
          .unit = std::ldexp(1.0, std::ilogb(below) - 23),
          .move = scene.gravity.norm() * h * h};
}

std::string precision_of(const Scene& scene, const Params& params) {
  if (!in_float(params)) return "double";
  const Rounding rounding = rounding_in_float(scene, params);
  if (rounding.share() < 0.01) return "float";
  return "float: " + rounding.said() +
         ", farther out by more; by less with fewer substeps, not at all with precision=double";
}

}  // namespace

template <class Real>
std::unique_ptr<Solver> make(const Scene& scene, const Params& params, MakeLinks<Real> links) {
  return std::make_unique<Loop<Real>>(scene, params, links);
}
template std::unique_ptr<Solver> make(const Scene&, const Params&, MakeLinks<float>);
template std::unique_ptr<Solver> make(const Scene&, const Params&, MakeLinks<double>);

/// In float, what may change gravity by more than an eighth is refused (truth float-gravity).
std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  const auto is_thin = [](const Collider& c) {
    const MeshBody* body = std::get_if<MeshBody>(&c.shape);
    return body && body->sides == MeshBody::Sides::both;
  };
  if (!params.is("faces", "off") && std::ranges::any_of(scene.colliders, is_thin))
    return {"faces=" + std::string(params.choice("faces")) +
            ": the side of a thin body is known for vertices only, not for faces and edges"};
  if (!in_float(params)) return {};
  const Rounding rounding = rounding_in_float(scene, params);
  if (rounding.share() <= 0.125) return {};
  const auto most =
      static_cast<int>(scene.dt / std::sqrt(4 * rounding.unit / scene.gravity.norm()));
  return {"float: " + rounding.said() + ": at most " + std::to_string(std::max(most, 1)) +
          " substeps, or precision=double"};
}

void refuse_faces(const Scene& scene, const Params& params, std::string_view solver,
                  std::vector<std::string>& reasons) {
  if (params.is("faces", "off") || scene.colliders.empty()) return;
  reasons.push_back("faces=" + std::string(params.choice("faces")) +
                    ": cloth whose edges touch a collider does not come to rest with " +
                    std::string(solver) + "; take implicit, pd or admm");
}

void refuse_membrane(const Scene& scene, std::string_view why, std::vector<std::string>& reasons) {
  if (scene.membrane) reasons.push_back("a membrane: " + std::string(why));
}

DeclaredStep implicit_euler(const Scene& scene, const Params& params) {
  DeclaredStep step{.stiffness = stiffness_of(scene, params),
                    .substeps = params.integer("substeps")};
  if (scene.self_collision && !params.is("self", "off"))
    step.none = "the exact step leaves out self-collision";
  else if (!scene.colliders.empty() && !params.is("faces", "off"))
    step.none = "the exact step leaves out contact of faces";
  return step;
}

ResolvedSetting link_order(const Params& params, const std::string& of) {
  const std::string order(params.choice("order"));
  if (order == "mesh") return {kLinkOrder, "the scene's" + of, "mesh order"};
  const bool coloured = order == "coloured";
  return {kLinkOrder, order + (coloured ? " (links of a colour share no vertex)" : "") + of, order};
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params,
                                   const ResolvedSettings& own, std::string_view bending,
                                   std::string_view friction) {
  const double h = scene.dt / params.integer("substeps");
  ResolvedSettings lines{
      {"time step", shortest(h) + " s x " + std::string(params.value("substeps"))},
      {"integration", "Verlet"}};
  lines.insert(lines.end(), own.begin(), own.end());
  if (scene.bending)
    lines.emplace_back("bending", shortest(scene.bending->warp) + " N m along the warp, " +
                                      shortest(scene.bending->weft) + " N m along the weft, " +
                                      std::string(bending));
  if (scene.membrane) {
    const auto& [law, warp, weft, poisson, shear, direction, damping] = *scene.membrane;
    lines.emplace_back(
        "membrane", std::string(law == Membrane::Law::arap ? "arap" : "stvk") + ": " +
                        shortest(warp) + " N/m along the warp, " + shortest(weft) +
                        " N/m along the weft, Poisson's number " + shortest(poisson) + ", shear " +
                        shortest(shear) + " N/m" +
                        (damping > 0 ? ", damping " + shortest(damping) + " s" : ""));
  }
  lines.emplace_back("gravity", "the scene's");
  lines.emplace_back("precision", precision_of(scene, params),
                     in_float(params) ? "float" : "double");
  if (scene.damping > 0)
    lines.emplace_back("damping",
                       "velocity x " + shortest(std::exp(-scene.damping * h)) + " per substep");
  if (scene.link_damping > 0)
    lines.emplace_back("damping of links",
                       shortest(scene.link_damping) + " s times their stiffness");
  if (!scene.colliders.empty()) {
    lines.emplace_back("contact response", std::string(params.choice("contact")));
    const bool every_sweep = params.is("contact", "continuous") || params.is("contact", "discrete");
    lines.emplace_back("friction", std::string(every_sweep ? friction : kProjectedFriction));
    lines.emplace_back("contact distance", "the scene's thickness");
    lines.emplace_back("contact of faces", std::string(params.choice("faces")));
  }
  if (scene.self_collision)
    lines.emplace_back("self-collision", std::string(params.choice("self")));
  return lines;
}

}  // namespace taut::loop
