#include "experiments/timing/bench/effects.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/solver/thread_pool.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/interleave.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

/// The scene with sheets of `side` x `side` vertices if side > 0; nothing if it is not a sheet
/// then.
std::optional<Scene> scene_of(const std::string& name, int side) {
  const auto file = find_scene(name);
  Scene scene = load_scene(file);
  if (side == 0) return scene;
  if (!scene.mesh.grid || std::min(scene.mesh.grid->nu, scene.mesh.grid->nv) < 2) return {};
  const std::string n = std::to_string(side);
  SceneSettings changes{"cloth.grid=[" + n + "," + n + "]"};
  const double finer = (std::min(scene.mesh.grid->nu, scene.mesh.grid->nv) - 1.0) / (side - 1);
  if (!scene.colliders.empty() || scene.self_collision)
    changes.push_back("cloth.thickness=" + shortest(scene.thickness * finer));
  if (scene.self_collision)
    changes.push_back("self_collision.radius=" + shortest(scene.self_collision->radius * finer));
  return load_scene(file, changes);
}

std::string effects_of(const Scene& scene) {
  std::vector<std::string> all;
  if (!scene.mesh.grid) all.emplace_back("any mesh");
  if (scene.membrane) all.emplace_back("membrane");
  if (scene.bending) all.emplace_back("bending");
  if (scene.wind) all.emplace_back("wind");
  for (const Collider& c : scene.colliders) all.emplace_back(type_name(c.shape));
  if (scene.self_collision) all.emplace_back("itself");
  return join(all, ", ");
}

/// The scene with structural and shear links of the warp's stiffness in place of its membrane.
void put_links(Scene& scene) {
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.stiffness.fill(scene.membrane->warp);
  scene.membrane.reset();
}

Scene without_effects(Scene scene) {
  if (scene.membrane && scene.mesh.grid) put_links(scene);
  scene.bending.reset();
  scene.wind.reset();
  scene.colliders.clear();
  scene.self_collision.reset();
  return scene;
}

/// The scene with its colliders far away: every particle still tests for contact with them, in
/// vain.
Scene touching_nothing(Scene scene) {
  constexpr double kAway = 1000;  // m
  for (Collider& c : scene.colliders) {
    if (auto* const plane = std::get_if<Plane>(&c.shape)) plane->offset -= kAway;
    if (auto* const ball = std::get_if<Ball>(&c.shape)) ball->center.y() -= kAway;
    if (auto* const box = std::get_if<Box>(&c.shape)) box->center.y() -= kAway;
    if (auto* const capsule = std::get_if<Capsule>(&c.shape)) {
      capsule->from.y() -= kAway;
      capsule->to.y() -= kAway;
    }
    if (auto* const body = std::get_if<MeshBody>(&c.shape)) body->center.y() -= kAway;
  }
  return scene;
}

/// Many independent sheets on two threads; a step is one step of each.
class Copies final : public Solver {
 public:
  Copies(const Scene& scene, const SolverChoice& choice, int count) {
    for (int n = 0; n < count; ++n) sheets_.push_back(choice.entry->make(scene, choice.params));
  }
  void load(const State& state) override {
    for (const auto& sheet : sheets_) sheet->load(state);
  }
  void step(double t, double dt) override {
    threads_.run(sheets_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) sheets_[n]->step(t, dt);
    });
  }
  void store(State& state) const override { sheets_.back()->store(state); }
  std::vector<PassCost> step_cost() const override { return sheets_.back()->step_cost(); }

 private:
  std::vector<std::unique_ptr<Solver>> sheets_;
  ThreadPool threads_{2};
};

/// One scene, timed with its effects and without them.
class TimedScene {
 public:
  TimedScene(const std::string& scene, const std::string& why) : wall_(false) {
    row_.scene = scene;
    row_.refused = why;
  }
  TimedScene(const Scene& scene, const EffectBenchOptions& options) : wall_(options.copies > 0) {
    const SolverChoice choice = parse_solver(options.solver);
    row_ = {.scene = scene.name,
            .effects = effects_of(scene),
            .vertices = scene.start.x.size(),
            .dt = scene.dt,
            .refused = {},
            .whole = {},
            .links_alone = {},
            .copies = {},
            .touching_nothing = {}};
    if (const auto reasons = choice.entry->unsupported(scene, choice.params); !reasons.empty()) {
      row_.refused = reasons.front();
      return;
    }
    whole_ = choice.entry->make(scene, choice.params);
    links_alone_ = choice.entry->make(without_effects(scene), choice.params);
    if (!scene.colliders.empty())
      touching_nothing_ = choice.entry->make(touching_nothing(scene), choice.params);
    if (options.copies > 0) copies_ = std::make_unique<Copies>(scene, choice, options.copies);
    run_.emplace(scene, *whole_, scene.steps);
    State end;
    whole_->store(end);
    if (!std::ranges::all_of(end.x, [](const Vec3& x) { return x.allFinite(); })) {
      row_.refused = "it exploded";
      return;
    }
    const StepTime step = run_->whole();
    steps_ = std::clamp(static_cast<int>(options.seconds / (wall_ ? step.wall : step.cpu)), 1,
                        scene.steps);
  }

  void sample() {
    if (!row_.refused.empty()) return;
    row_.whole.push_back(time(*whole_));
    row_.links_alone.push_back(time(*links_alone_));
    if (touching_nothing_) row_.touching_nothing.push_back(time(*touching_nothing_));
    if (copies_) row_.copies.push_back(time(*copies_));
  }

  EffectRow take() { return std::move(row_); }

 private:
  double time(Solver& solver) const {
    const StepTime step = run_->sample(solver, steps_);
    return 1e9 * (wall_ ? step.wall : step.cpu) / static_cast<double>(row_.vertices);
  }

  EffectRow row_;
  bool wall_;
  std::unique_ptr<Solver> whole_, links_alone_, touching_nothing_, copies_;
  std::optional<CheckpointedRun> run_;
  int steps_ = 1;
};

}  // namespace

std::vector<EffectRow> bench_effects(const EffectBenchOptions& options) {
  std::vector<TimedScene> subjects;
  for (const std::string& name : options.scenes) try {
      if (const auto scene = scene_of(name, options.side)) subjects.emplace_back(*scene, options);
    } catch (const InputError& error) {
      subjects.emplace_back(name, error.what());
    }
  interleave(subjects.size(), {.count = options.rounds, .progress = options.progress},
             [&](std::size_t i) { subjects[i].sample(); });
  std::vector<EffectRow> rows;
  for (TimedScene& subject : subjects) rows.push_back(subject.take());
  return rows;
}

}  // namespace taut
