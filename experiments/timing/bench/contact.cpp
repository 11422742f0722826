#include "experiments/timing/bench/contact.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

constexpr int kSweeps[] = {2, 18};

std::unique_ptr<Solver> make(const Scene& scene, const std::string& setting, int sweeps) {
  const SolverChoice choice =
      parse_solver("jakobsen:substeps=1,iterations=" + std::to_string(sweeps) + "," + setting);
  return choice.entry->make(scene, choice.params);
}

/// Thickness and radius shrink with the spacing, as far as they have to, and for self-collision so
/// does the time step: a particle moves as many of its diameters in a step whatever their number.
Scene load(const std::string& name, int side) {
  const double spacing = 0.8 / (side - 1);
  std::vector<std::string> changes{
      "cloth.grid=[" + std::to_string(side) + "," + std::to_string(side) + "]",
      "cloth.thickness=" + std::to_string(0.4 * spacing)};
  if (name == "crumple")
    for (const std::string& change : {"self_collision.radius=" + std::to_string(0.48 * spacing),
                                      "time.dt=" + std::to_string(spacing / 6.4)})
      changes.push_back(change);
  return load_scene(find_scene(name), changes);
}

void keep_structural(Scene& scene) {
  std::erase_if(scene.links, [](const Link& l) { return l.family != Family::structural; });
}

/// Where the cloth is after so many seconds.
State settled(const Scene& scene, double seconds) {
  const auto solver = make(scene, "order=coloured", scene.self_collision ? 8 : 24);
  solver->load(scene.start);
  const int steps = static_cast<int>(seconds / scene.dt);
  for (int n = 0; n < steps; ++n) solver->step(n * scene.dt, scene.dt);
  State state;
  solver->store(state);
  return state;
}

double share_touching(const Scene& scene, const State& state) {
  const auto touches = [&](const Vec3& x) {
    return std::ranges::any_of(scene.colliders, [&](const Collider& c) {
      return surface(c.shape, x).distance < 1.1 * scene.thickness;
    });
  };
  return static_cast<double>(std::ranges::count_if(state.x, touches)) /
         static_cast<double>(state.x.size());
}

/// Steps of one scene from one state, by a few sweeps and by many, without contact and with it.
class Subject {
 public:
  Subject(std::string name, std::string setting, int steps, const Scene& scene, const Scene& bare,
          std::shared_ptr<const State> start)
      : start_(std::move(start)), dt_(scene.dt) {
    row_ = {.scene = std::move(name),
            .setting = std::move(setting),
            .particles = start_->x.size(),
            .steps = steps,
            .touching = share_touching(scene, *start_)};
    for (std::size_t k = 0; k < 2; ++k) {
      solvers_[0][k] = make(bare, row_.setting, kSweeps[k]);
      solvers_[1][k] = make(scene, row_.setting, kSweeps[k]);
    }
  }

  void calibrate(double seconds) {
    repeats_ = times_within(seconds, time(1, 1) * row_.steps, 10000);
  }

  /// Adds one sample: every solver in alternating order (ABBA).
  void sample() {
    double t[2][2];
    for (std::size_t i = 0; i < 4; ++i) t[i / 2][i % 2] = time(i / 2, i % 2);
    for (std::size_t i = 4; i-- > 0;) t[i / 2][i % 2] = (t[i / 2][i % 2] + time(i / 2, i % 2)) / 2;
    constexpr double kMore = kSweeps[1] - kSweeps[0];
    const double unit = 1e9 / static_cast<double>(row_.particles);
    const double links = (t[0][1] - t[0][0]) / kMore, both = (t[1][1] - t[1][0]) / kMore;
    row_.sweep.push_back(unit * links);
    row_.bare.push_back(unit * (t[0][0] - (kSweeps[0] - 1) * links));
    row_.each_sweep.push_back(unit * (both - links));
    row_.each_step.push_back(unit * (t[1][0] - t[0][0] - kSweeps[0] * (both - links)));
  }

  ContactRow take() { return std::move(row_); }

 private:
  /// CPU seconds of one step.
  double time(std::size_t contact, std::size_t many) {
    Solver& solver = *solvers_[contact][many];
    double sum = 0;
    for (int r = 0; r < repeats_; ++r) {
      solver.load(*start_);
      const double begin = seconds_of(CLOCK_THREAD_CPUTIME_ID);
      for (int n = 0; n < row_.steps; ++n) solver.step(n * dt_, dt_);
      sum += seconds_of(CLOCK_THREAD_CPUTIME_ID) - begin;
    }
    return sum / (repeats_ * row_.steps);
  }

  ContactRow row_;
  std::shared_ptr<const State> start_;
  double dt_;
  std::array<std::array<std::unique_ptr<Solver>, 2>, 2> solvers_;  ///< [without, with][few, many]
  int repeats_ = 1;
};

std::vector<Subject> subjects_of(int side) {
  std::vector<Subject> all;
  for (const char* name : {"plane", "ball", "box"}) {
    Scene scene = load(name, side);
    const auto start = std::make_shared<const State>(settled(scene, 0.75));
    keep_structural(scene);
    Scene bare = scene;
    bare.colliders.clear();
    for (const char* setting : {"contact=continuous,order=mesh", "contact=discrete,order=mesh",
                                "contact=after,order=mesh", "contact=continuous,order=coloured",
                                "contact=discrete,order=coloured", "contact=after,order=coloured"})
      all.emplace_back(name, setting, 4, scene, bare, start);
  }
  for (const double seconds : {0.3, 0.6}) {  // its lower edge folds; all of it collapses
    Scene scene = load("crumple", side);
    const auto start = std::make_shared<const State>(settled(scene, seconds));
    keep_structural(scene);
    Scene bare = scene;
    bare.self_collision.reset();
    const std::string name = seconds < 0.5 ? "crumple, 0.3 s" : "crumple, 0.6 s";
    for (const char* setting : {"self=grid,order=mesh", "self=grid,order=coloured"})
      for (const int steps : {1, 8}) all.emplace_back(name, setting, steps, scene, bare, start);
    all.emplace_back(name, "self=octree,order=mesh", 1, scene, bare, start);
  }
  return all;
}

}  // namespace

Interval ContactRow::ratio(int sweeps) const {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < sweep.size(); ++r)
    ratios.push_back((each_step[r] + sweeps * each_sweep[r]) / sweep[r]);
  return bootstrap_median(ratios);
}

std::vector<ContactRow> bench_contact(const ContactBenchOptions& options) {
  std::vector<Subject> subjects = subjects_of(options.side);
  for (Subject& subject : subjects) subject.calibrate(options.seconds);
  for (int round = 0; round < options.rounds; ++round) {
    for (Subject& subject : subjects) subject.sample();
    options.progress(static_cast<std::size_t>(round) + 1, static_cast<std::size_t>(options.rounds));
  }
  std::vector<ContactRow> rows;
  for (Subject& subject : subjects) rows.push_back(subject.take());
  return rows;
}

}  // namespace taut
