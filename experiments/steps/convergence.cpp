#include "experiments/steps/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include "core/model/input_error.hpp"

namespace taut {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Solver text without the parameters `left_out`.
std::string without(const SolverChoice& choice, std::initializer_list<std::string_view> left_out) {
  std::string text;
  for (const ParamItem& item : param_items(choice.params.brief()))
    if (std::ranges::find(left_out, item.key) == left_out.end())
      text +=
          (text.empty() ? "" : ",") + item.key + '=' + std::string(choice.params.value(item.key));
  return with(choice.entry->name, text);
}

std::vector<int> ladder(int most) {
  std::vector<int> all;
  for (int k = 1; k <= most; k *= 2) {
    all.push_back(k);
    if (k > 1 && k + k / 2 <= most) all.push_back(k + k / 2);
  }
  return all;
}

struct Stepped {
  State state;
  double milliseconds;
};

Stepped step_once(Solver& solver, const State& from, double at, double dt) {
  Stepped result{{}, std::numeric_limits<double>::infinity()};
  for (int sample = 0; sample < 3; ++sample) {
    solver.load(from);
    const double before = solver.cpu_seconds();
    solver.step(at, dt);
    result.milliseconds = std::min(result.milliseconds, 1e3 * (solver.cpu_seconds() - before));
  }
  solver.store(result.state);
  return result;
}

/// Contraction per iteration, from an exponential fit to the last third of the points that are
/// above twice the floor and above rounding.
double contraction(const std::vector<ConvergencePoint>& points, double floor) {
  // Number of iterations, logarithm of the distance.
  std::vector<std::pair<double, double>> falling;
  for (const ConvergencePoint& p : points)
    if (p.distance > std::max(2 * floor, 1e-12))
      falling.emplace_back(p.iterations, std::log(p.distance));
    else
      break;
  const std::size_t last = std::max<std::size_t>(2, falling.size() / 3);
  if (falling.size() < last + 1) return kUnknown;
  double k = 0, y = 0, kk = 0, ky = 0;
  for (const auto& [at, log_distance] : std::span(falling).last(last)) {
    k += at;
    y += log_distance;
    kk += at * at;
    ky += at * log_distance;
  }
  const auto n = static_cast<double>(last);
  return std::exp((n * ky - k * y) / (n * kk - k * k));
}

/// RMS distance between the iterates after two numbers of iterations [m].
using Way = std::function<double(int, int)>;

/// Iterates rest if doubling their number moves them by at most this share of the distance.
constexpr double kRests = 1e-3;

/// The final distance, if the last third of the points is within a tenth of it and the iterates
/// rest; 0 otherwise. Iterates that creep would move further with more iterations, so they have no
/// floor. `moved` is how far the last round of the exact step moved it.
double floor_of(const std::vector<ConvergencePoint>& points, double moved, const Way& way) {
  const double end = points.empty() ? 0 : points.back().distance;
  if (points.size() < 6 || !(end > std::max(2 * moved, 1e-12))) return 0;  // rounding
  if (end > points.front().distance) return 0;  // the path bends: the distance first grows
  for (std::size_t i = points.size() - points.size() / 3; i < points.size(); ++i)
    if (!(std::abs(points[i].distance - end) <= 0.1 * end)) return 0;
  int last = 1;
  while (2 * last <= points.back().iterations) last *= 2;
  const double way_of_last = way(last / 2, last);
  return way_of_last <= kRests * end && way_of_last <= 1.2 * way(last / 4, last / 2) ? end : 0;
}

/// A step and its minimum, shared by all solvers with this stiffness.
struct ExactStep {
  reference::ImplicitStep step;
  reference::ImplicitStep::Minimum minimum;

  ExactStep(const Scene& scene, const State& from, double at, const Stiffness& k)
      : step(scene, from, at, k), minimum(step.minimum(from.x)) {}
};

ConvergencePoint point_of(const ExactStep& exact, int iterations, const Stepped& got) {
  const auto& [step, minimum] = exact;
  const std::vector<Vec3>& x = got.state.x;
  ConvergencePoint p{iterations, kUnknown, step.stretch(x), kUnknown, kUnknown, got.milliseconds};
  if (!step.rigid() && !step.in_contact()) p.residual = step.residual(x);
  if (!minimum.problem.empty()) return p;
  p.distance = step.distance(x, minimum.x);
  if (step.in_contact()) return p;  // inside a collider, the energy does not measure anything
  p.gap = step.rigid() ? step.square_distance(x, minimum.x) /
                             step.square_distance(step.prediction(), minimum.x)
                       : (step.energy(x) - step.energy(minimum.x)) /
                             (step.energy(step.prediction()) - step.energy(minimum.x));
  return p;
}

/// Fills in the solver's iterates, compared with the exact step.
void follow(Convergence& all, const Scene& scene, const State& from, double at, int most,
            const ExactStep& exact) {
  all.problem = exact.minimum.problem;
  all.exact_residual = exact.minimum.residual;
  all.moved = exact.minimum.moved;
  const AccuracyParameters& accuracy = parse_solver(all.solver).entry->accuracy;
  const std::string one =
      accuracy.substeps.empty() ? "" : "," + std::string(accuracy.substeps) + "=1";
  std::map<int, std::vector<Vec3>> iterates;
  for (const int k : ladder(most)) {
    const SolverChoice at_k = parse_solver(
        with(all.solver, std::string(accuracy.sweeps) + '=' + std::to_string(k) + one));
    const Stepped got = step_once(*at_k.entry->make(scene, at_k.params), from, at, scene.dt);
    iterates[k] = got.state.x;
    all.points.push_back(point_of(exact, k, got));
  }
  const Way way = [&](int k, int l) { return exact.step.distance(iterates.at(k), iterates.at(l)); };
  all.floor = all.problem.empty() ? floor_of(all.points, all.moved, way) : 0;
  all.contraction =
      all.problem.empty() ? contraction(all.points, std::max(all.floor, all.moved)) : kUnknown;
}

std::vector<std::string> refuse(const Scene& scene, const SolverChoice& choice) {
  std::vector<std::string> reasons = choice.entry->unsupported(scene, choice.params);
  if (scene.bending) reasons.emplace_back("bending: the exact step has links alone");
  if (choice.entry->accuracy.sweeps.empty()) reasons.emplace_back("it has no iterations");
  return reasons;
}

}  // namespace

State state_at(const Scene& scene, const SolverChoice& from, double at) {
  State state = scene.start;
  const auto steps = static_cast<int>(std::lround(at / scene.dt));
  if (steps == 0) return state;
  if (const auto reasons = from.entry->unsupported(scene, from.params); !reasons.empty())
    throw InputError(from.brief() + ": " + reasons.front());
  const std::unique_ptr<Solver> solver = from.entry->make(scene, from.params);
  solver->load(state);
  for (int n = 0; n < steps; ++n) solver->step(n * scene.dt, scene.dt);
  solver->store(state);
  for (const Vec3& x : state.x)
    if (!x.allFinite()) throw InputError(from.brief() + ": no finite state at that time");
  return state;
}

std::vector<Convergence> converge(const Scene& scene, const State& state, double at,
                                  const std::vector<std::string>& solvers, int most) {
  std::map<Stiffness, ExactStep> steps;  // most solvers share the step of rigid links
  std::vector<Convergence> all;
  for (const std::string& solver : solvers) {
    const SolverChoice choice = parse_solver(solver);
    Convergence& one = all.emplace_back();
    one.solver = without(choice, {choice.entry->accuracy.sweeps, choice.entry->accuracy.substeps});
    one.refused = refuse(scene, choice);
    if (!one.refused.empty()) continue;
    one.stiffness = stiffness_of(scene, choice.params);
    const auto known = steps.find(one.stiffness);
    follow(one, scene, state, at, most,
           known != steps.end()
               ? known->second
               : steps.emplace(one.stiffness, ExactStep(scene, state, at, one.stiffness))
                     .first->second);
  }
  return all;
}

int reached(const Convergence& all, double gap) {
  int first = -1;
  for (int i = static_cast<int>(all.points.size()) - 1; i >= 0; --i) {
    if (!(all.points[static_cast<std::size_t>(i)].gap <= gap)) break;
    first = i;
  }
  return first;
}

}  // namespace taut
