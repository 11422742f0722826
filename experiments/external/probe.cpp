#include "experiments/external/probe.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/index.hpp"
#include "core/model/mesh.hpp"
#include "core/model/pin_places.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/reference/strain_at_rest.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/json.hpp"

namespace taut::external {

namespace {

using Verdict = Check::Verdict;

constexpr double kDt = 1.0 / 64;  ///< s
constexpr int kSteps = 32;

/// A sheet of `side` x `side` vertices, 1 m wide and in its rest shape, with links along its sides.
Scene sheet(int side, std::vector<int> pins) {
  Scene scene;
  scene.name = "probe";
  scene.mesh = make_sheet({.nu = side, .nv = side, .width = 1, .height = 1, .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.pins = std::move(pins);
  scene.links = grid_links(scene.mesh, {});
  scene.dt = kDt;
  scene.steps = kSteps;
  return scene;
}

std::string text(double value) { return general(value, 4); }

std::string text(const Vec3& v) {
  return "(" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + ")";
}

/// The vertex farthest from its expected position. NaN counts as farthest.
std::pair<std::size_t, double> farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::pair<std::size_t, double> worst{0, 0};
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = (a[i] - b[i]).norm();
    if (std::isnan(d)) return {i, d};
    if (d > worst.second) worst = {i, d};
  }
  return worst;
}

/// Thrown to end a check, with what is wrong.
struct CheckFailed {
  std::string said;
};
/// Thrown if the program refuses the scene.
struct Refused {
  std::string said;
};

class Prober {
 public:
  Prober(
      const Command& command, Json params,
      std::function<void(const Check&)> report = [](const Check&) {})
      : command_(command), params_(std::move(params)), report_(std::move(report)) {}

  /// Runs a check: `look` returns a sentence on success and throws otherwise.
  void check(const std::string& name, const std::function<std::string()>& look) {
    Check one{name, Verdict::passed, {}};
    try {
      one.said = look();
    } catch (const CheckFailed& wrong) {
      one.verdict = Verdict::failed;
      one.said = wrong.said;
    } catch (const Refused& refused) {
      one.verdict = Verdict::skipped;
      one.said = "says that it cannot: " + refused.said;
    } catch (const SolverFailure& failure) {
      one.verdict = Verdict::failed;
      one.said = std::string(to_string(failure.status)) + ": " + failure.what();
      one.status = failure.status;
      connection_.reset();
    }
    report_(one);
    checks_.push_back(one);
  }

  Connection& connection() {
    if (connection_) return *connection_;
    connection_ = std::make_unique<Connection>(command_);
    hello_ = say_hello(*connection_);
    if (params_.is_null()) params_ = own_params(*hello_, {hello_->name, hello_->params, ""});
    return *connection_;
  }
  void end_connection() { connection_.reset(); }
  const Hello& hello() {
    connection();
    return *hello_;
  }

  void give(const Scene& scene) {
    const SceneAnswer answer = give_scene(connection(), scene, params_);
    if (!answer.cannot.empty()) throw Refused{answer.cannot.front()};
  }

  /// Takes `steps` steps of the scene's dt, from its start or from the current state, and returns
  /// the state.
  State run(const Scene& scene, int steps, bool from_start = true) {
    if (from_start) {
      load_state(connection(), scene.start);
      step_ = 0;
    }
    State state;
    for (int n = 0; n < steps; ++n, ++step_)
      take_steps(connection(), step_ * scene.dt, scene.dt, 1);
    store_state(connection(), scene.mesh.size(), state);
    return state;
  }

  std::vector<Check> checks() const { return checks_; }

 private:
  Command command_;
  Json params_;
  std::function<void(const Check&)> report_;
  std::unique_ptr<Connection> connection_;
  std::unique_ptr<const Hello> hello_;
  std::vector<Check> checks_;
  int step_ = 0;
};

/// Checks free fall: x = x0 + v0 t + g t^2/2 (1 + c/n) and v = v0 + g (t + c dt/2) after n steps,
/// with -1 <= c <= 1 for every integrator (explicit Euler -1, exact 0, symplectic Euler and Verlet
/// 1; substeps lie between).
std::string falls(Prober& probe, double dt) {
  Scene scene = sheet(4, {});
  scene.dt = dt;
  scene.gravity = Vec3(2.25, -3, 9);  // |g| = 9.75 m/s^2, parallel to no axis
  const Vec3 v0(1, 2, -0.5);
  std::ranges::fill(scene.start.v, v0);
  probe.give(scene);
  const int steps = static_cast<int>(std::lround(0.5 / dt));
  const State end = probe.run(scene, steps);
  const double t = steps * dt;
  const Vec3 way = scene.gravity * t * t / 2, moved = end.x[0] - scene.start.x[0],
             fallen = moved - v0 * t;
  const std::string in = "in " + text(t) + " s of free fall in steps of " + text(dt) + " s ";
  if (!moved.allFinite()) throw CheckFailed{in + "a position is not a number"};
  if (moved.norm() < 0.01 * way.norm()) throw CheckFailed{in + "nothing moves"};
  if ((moved - way).norm() < 0.05 * way.norm())
    throw CheckFailed{in + "it forgets the velocities that 'load' gives"};
  const double age = (end.v[0] - v0).dot(scene.gravity) / scene.gravity.squaredNorm();  // s
  if (std::abs(age / t - 1) > 0.05 &&
      (moved - v0 * age - scene.gravity * age * age / 2).norm() < 0.05 * moved.norm())
    throw CheckFailed{in + "it advances by " + text(age) +
                      " s: a step is as long as its request says"};
  const double ratio = fallen.dot(way) / way.squaredNorm();
  if (fallen.norm() < 0.01 * way.norm()) throw CheckFailed{in + "gravity has no effect"};
  if ((fallen - ratio * way).norm() > 0.05 * fallen.norm() || ratio < 0)
    throw CheckFailed{in + "it falls along " + text(fallen.normalized()) +
                      ", but gravity points along " + text(way.normalized())};
  if (std::abs(ratio - 1) > 1.05 / steps + 1e-3)
    throw CheckFailed{in + "it falls " + text(ratio) +
                      " times as far as g t^2/2: units are m, s and " +
                      "m/s^2, and a step is as long as its request says"};
  const Vec3 v = v0 + scene.gravity * t;
  if (!((end.v[0] - v).norm() <= (1.05 / (2 * steps) + 1e-3) * scene.gravity.norm() * t))
    throw CheckFailed{in + "it reports the velocity " + text(end.v[0]) + " m/s, but v0 + g t is " +
                      text(v)};
  std::vector<Vec3> together = scene.start.x;
  for (Vec3& x : together) x += moved;
  if (const auto [i, off] = farthest(end.x, together); !(off <= 1e-3))
    throw CheckFailed{in +
                      "the sheet does not stay in shape, though its links are at rest: vertex " +
                      std::to_string(i) + " is " + text(off) + " m off"};
  return in + "it falls " + text(ratio) + " g t^2/2";
}

std::string holds_pins(Prober& probe) {
  const Scene scene = sheet(4, {0, 3});
  probe.give(scene);
  const State end = probe.run(scene, kSteps);
  const auto stray = PinPlaces(scene).farthest(kSteps, end.x, 1e-6, 0);
  if (stray.vertex >= 0)
    throw CheckFailed{"vertex " + std::to_string(stray.vertex) +
                      " is pinned (its inverse mass is 0), but after " + std::to_string(kSteps) +
                      " steps it is " + text(stray.distance) + " m away"};
  if (farthest(end.x, scene.start.x).second < 1e-6)
    throw CheckFailed{"a sheet on two pins does not sag at all: nothing moves"};
  return "two pinned vertices stay where they are";
}

/// One pin goes straight and by a path, the other turns.
std::string moves_pins(Prober& probe) {
  Scene scene = sheet(4, {0, 3});
  scene.pin_motions = {
      {{0}, {.velocity = {0.1, 0, 0.2}, .path = {{0.125, {0, 0, 0}}, {0.375, {0, 0.05, 0}}}}},
      {{3}, {.spin = {0, 1, 0.5}, .pivot = {0.5, 0, 0}}}};
  probe.give(scene);
  const PinPlaces pins(scene);
  for (int n = 1; n <= kSteps; ++n) {
    const State now = probe.run(scene, 1, n == 1);
    const auto stray = pins.farthest(n, now.x, 1e-6, 0);
    if (stray.vertex >= 0)
      throw CheckFailed{"vertex " + std::to_string(stray.vertex) +
                        " is a pin that moves, but after " + std::to_string(n) + " steps it is " +
                        text(stray.distance) + " m from " + text(stray.place)};
  }
  return "two pins follow their motions";
}

std::string repeats(Prober& probe) {
  const Scene scene = sheet(4, {0, 3});
  probe.give(scene);
  const std::string first = digest(probe.run(scene, kSteps));
  if (digest(probe.run(scene, kSteps)) != first)
    throw CheckFailed{
        "the same load and the same steps give other bits the second time: something " +
        std::string("survives 'load', or depends on chance, time or threads")};
  probe.give(scene);
  if (digest(probe.run(scene, kSteps)) != first)
    throw CheckFailed{"after the same scene is given again, other bits come out"};
  return "the same bits twice, and after a reload";
}

std::string restarts(Prober& probe) {
  const Scene scene = sheet(4, {0, 3});
  probe.give(scene);
  const State middle = probe.run(scene, kSteps / 2), end = probe.run(scene, kSteps / 2, false);
  load_state(probe.connection(), middle);
  State read;
  store_state(probe.connection(), scene.mesh.size(), read);
  if (const auto [i, off] = farthest(read.x, middle.x); !(off <= 1e-5))
    throw CheckFailed{"'store' right after 'load' gives another state: vertex " +
                      std::to_string(i) + " is " + text(off) + " m off"};
  if (const auto [i, off] = farthest(read.v, middle.v); !(off <= 1e-3))
    throw CheckFailed{"'store' right after 'load' gives another state: the velocity of vertex " +
                      std::to_string(i) + " is " + text(off) + " m/s off"};
  const State again = probe.run(scene, kSteps / 2, false);
  const auto [i, off] = farthest(again.x, end.x);
  if (!(off <= 1e-3))
    throw CheckFailed{
        "a run that goes on from a stored state leaves the uninterrupted one: vertex " +
        std::to_string(i) + " by " + text(off) + " m after " + std::to_string(kSteps / 2) +
        " steps"};
  return "a run that goes on from a stored state stays within " + text(off) + " m";
}

/// Nothing that a program could fail: what its sweeps are at rest, for its author to compare.
std::string acts_like_springs(Prober& probe) {
  constexpr int kSide = 9, kSettled = 256, kAveraged = 128;
  std::vector<int> upper;
  for (int i = 0; i < kSide; ++i) upper.push_back(i);
  Scene scene = sheet(kSide, upper);  // without damping, which a program may not know
  scene.steps = kSettled + kAveraged;
  probe.give(scene);
  probe.run(scene, kSettled);
  std::vector<Vec3> mean(scene.mesh.rest.size(),
                         Vec3::Zero());  // what still swings swings about it
  for (int n = 0; n < kAveraged; ++n) {
    const State now = probe.run(scene, 1, false);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += now.x[i] / kAveraged;
  }
  double square = 0, count = 0;
  for (const Link& l : scene.links) {
    if (l.b < kSide) continue;  // between pins
    const double e = (mean[to_index(l.b)] - mean[to_index(l.a)]).norm() / l.rest - 1;
    square += e * e;
    ++count;
  }
  const double rms = std::sqrt(square / count);
  const std::string hung = "a sheet that hangs by a row stretches by " + text(100 * rms) +
                           " % (RMS) in steps of " + text(kDt) + " s";
  if (!(rms > 1e-6 && rms < 1)) return hung;
  reference::StrainAtRest law(scene,
                              parse_solver("jakobsen:projection=exact,order=mesh,substeps=1"));
  double sweeps = 1;
  for (int round = 0; round < 4; ++round) sweeps *= law.at(sweeps, 1).rms / rms;
  return hung + ": its links act like springs of " + general(law.stiffness_of({.rms = rms}), 2) +
         " N/m, as " + general(sweeps, 2) + " sweeps of exact projections do";
}

std::string refuses_nonsense(Prober& probe) {
  for (const std::string line :
       {R"({"op": "juggle"})", R"({"op": "scene", "file": "/does/not/exist.json", "params": {}})",
        "this is no JSON", R"({"op": 7})"}) {
    const Json answer = probe.connection().ask_line(line);
    if (!answer.contains("error"))
      throw CheckFailed{"answers " + line + " with " + to_text(answer) +
                        ", not with {\"error\": \"...\"}"};
    say_hello(probe.connection());
  }
  return "four bad requests are answered with an error, and it goes on";
}

std::string ends_with_its_input(Prober& probe) {
  const auto end = probe.connection().close(5);
  probe.end_connection();
  if (!end)
    throw CheckFailed{
        "does not end within 5 s of the end of its input: it would outlive a taut that is killed"};
  return "ends when its input does, as if taut had been killed";
}

std::string tells_its_time(Prober& probe) {
  if (!probe.hello().unmeasurable.empty())
    throw Refused{"its time is not measurable: " + probe.hello().unmeasurable};
  const Scene scene = sheet(24, {0, 23});
  probe.give(scene);
  load_state(probe.connection(), scene.start);
  Connection& connection = probe.connection();
  constexpr int kBatch = 10;
  double said = 0, empty = 0;
  int steps = 0;
  for (int i = 0; i < 10; ++i) take_steps(connection, 0, scene.dt, 1);
  const double begin = connection.cpu_seconds();
  for (int i = 0; i < 30; ++i) take_steps(connection, 0, scene.dt, 0);
  const double before = connection.cpu_seconds();
  empty = (before - begin) / 30;
  while (steps < 400 && connection.cpu_seconds() - before < 0.3) {
    said += take_steps(connection, steps * scene.dt, scene.dt, kBatch);
    steps += kBatch;
  }
  const double took = (connection.cpu_seconds() - before - steps / kBatch * empty) / steps;
  const std::string clock = text(1e6 * took) + " us CPU a step of 576 vertices, beside " +
                            text(1e6 * empty) + " us for an empty exchange";
  if (connection.has_helpers())
    throw CheckFailed{
        "starts processes of its own, whose time its CPU clock does not hold: "
        "cost cannot be measured"};
  if (std::isnan(said)) return clock + "; it says nothing itself";
  const double word = said / steps;
  if (!agrees(word, took, empty))
    throw CheckFailed{"says " + text(1e6 * word) + " us a step, but its CPU clock says " + clock};
  return clock + "; it says " + text(1e6 * word) + " us";
}

void physics(Prober& probe) {
  probe.check("free fall", [&] { return falls(probe, kDt); });
  probe.check("time step", [&] { return falls(probe, kDt / 2); });
  probe.check("pins", [&] { return holds_pins(probe); });
  probe.check("moving pins", [&] { return moves_pins(probe); });
  probe.check("same bits", [&] { return repeats(probe); });
  probe.check("restart", [&] { return restarts(probe); });
}

}  // namespace

Cell cell_of(Check::Verdict verdict) {
  switch (verdict) {
    case Check::Verdict::passed:
      return Cell("passed").toned(Cell::Tone::good);
    case Check::Verdict::failed:
      return Cell("FAILED").toned(Cell::Tone::bad);
    case Check::Verdict::skipped:
      break;
  }
  return Cell("skipped").toned(Cell::Tone::doubtful);
}

std::vector<Check> quick_probe(const Command& command, const Json& params) {
  Prober probe(command, params);
  physics(probe);
  return probe.checks();
}

std::vector<Check> full_probe(const Command& command,
                              const std::function<void(const Check&)>& report) {
  Prober probe(command, nullptr, report);
  probe.check("hello", [&] {
    const Hello& hello = probe.hello();
    return hello.name + " " + hello.version + ", " + std::to_string(hello.params.size()) +
           " parameters";
  });
  if (probe.checks().front().verdict == Verdict::failed) return probe.checks();
  physics(probe);
  probe.check("stretch", [&] { return acts_like_springs(probe); });
  probe.check("bad requests", [&] { return refuses_nonsense(probe); });
  probe.check("end of input", [&] { return ends_with_its_input(probe); });
  probe.check("own word", [&] { return tells_its_time(probe); });
  return probe.checks();
}

}  // namespace taut::external
