// Section 11, what a computed motion has to be: without gain, the same in every frame, convergent,
// repeatable.
#include <cmath>
#include <numbers>

#include "core/model/angle.hpp"
#include "core/model/solver.hpp"
#include "core/reference/closed_forms.hpp"
#include "experiments/truths/conformance/conformance.hpp"

namespace taut {

namespace {

using conformance::first_passage;
using conformance::for_each_solver;
using conformance::kFine;
using conformance::own_stiffness;

/// Three rods that start level, from a pin at the origin.
Scene level_chain() {
  Scene s = under_gravity(bare::chain(3, 1, 0.02, Vec3::UnitX()));
  s.dt = kFine;
  return s;
}

double quarter(const std::string& solver, double dt) {
  const double amplitude = 60 * kDegree;
  Scene s = under_gravity(bare::chain(1, 1, 0.02, {std::sin(amplitude), -std::cos(amplitude), 0}));
  s.dt = dt;
  Simulation sim(s, solver);
  return first_passage(sim, 2, [&] { return sim.x(1).x(); });
}

/// The solver's text without this parameter, which is a number.
std::string without(std::string text, std::string_view parameter) {
  const std::string key = std::string(parameter) + "=";
  for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    if (at == 0 || (text[at - 1] != ':' && text[at - 1] != ',')) continue;
    const std::size_t end = std::min(text.find(',', at), text.size() - 1);
    text.erase(at, end - at + 1);
    if (text.back() == ',' || text.back() == ':') text.pop_back();
    break;
  }
  return text;
}

/// Mean strain of the top rod of a damped chain of 16, over its last half second.
double strain_of(const std::string& solver, const Scene& s) {
  Simulation sim(s, solver, 192);
  double sum = 0;
  for (const double e : sim.record(64, [&] { return strains(s, sim.state())[0]; })) sum += e / 64;
  return sum;
}

}  // namespace

TAUT_TRUTH(any_energy, 11, 25, "without forcing a swinging chain gains no energy",
           "conservation of energy", "energy", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    const Scene s = level_chain();
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const std::vector<double> energies = sim.record(512, [&] {
      double energy = 0;
      for (int i = 1; i <= 3; ++i) energy += sim.v(i).squaredNorm() / 2 + kG * sim.x(i).y();
      return energy / (3 * kG);
    });
    findings.equal(
        solver, "highest energy in 2 s, from 0 at the start, over m g L", "1",
        *std::ranges::max_element(energies, {}, [](double e) { return std::isnan(e) ? 1e300 : e; }),
        0, 0.02);
  });
}

TAUT_TRUTH(any_frame, 11, 26, "the same motion turned, somewhere else and from a moving frame",
           "Galilei's invariance", "frames", "links, gravity, moving pins") {
  for_each_solver(findings, [&](const std::string& solver) {
    const Scene s = level_chain();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.2, Vec3(1, -1, 2).normalized()));
    const Vec3 shift(0.5, -0.3, 0.4), velocity(0.7, -0.4, 0.3);
    if (!can_run(findings, solver, s)) return;
    const Simulation here(s, solver, 128);
    const auto compare = [&](const char* what, const Vec3& moving) {
      Scene other = s;
      other.gravity = turn * s.gravity;
      for (std::size_t i = 0; i < s.start.x.size(); ++i) {
        other.start.x[i] = other.mesh.rest[i] = turn * s.start.x[i] + shift;
        other.start.v[i] = moving;
      }
      if (!moving.isZero(0)) other.pin_motions = {{{0}, {.velocity = moving}}};
      if (!can_run(findings, solver, other)) return;
      const Simulation there(other, solver, 128);
      std::vector<Vec3> expected = here.state().x;
      for (Vec3& x : expected) x = turn * x + shift + 128 * s.dt * moving;
      findings.below(solver, what, "m", max_distance(there.state().x, expected), 0.01);
    };
    compare("distance after 0.5 s of the motion that is turned and shifted", Vec3::Zero());
    compare("distance after 0.5 s of the motion in a moving frame", velocity);
  });
}

TAUT_TRUTH(any_order, 11, 27, "a pendulum's period converges at least as the time step",
           "definition of a consistent integrator", "order in time", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = under_gravity(bare::chain(1, 1, 0.02));
    if (!can_run(findings, solver, s)) return;
    const double coarse = quarter(solver, 1.0 / 32), middle = quarter(solver, 1.0 / 64),
                 fine = quarter(solver, 1.0 / 128);
    // Below 0.1 % there is no order: float32 rounds what gravity adds in a substep by that.
    const double last = std::abs(middle - fine),
                 order = last < 5e-4 ? 1 : std::log2(std::abs(coarse - middle) / last);
    findings.equal(solver, "order, of steps of 1/32, 1/64 and 1/128 s; more counts as 1", "1",
                   std::min(order, 1.0), 1, 0.3);
  });
}

TAUT_TRUTH(any_iterations, 11, 28,
           "the strain of a hanging chain falls with the sweeps k as (I - G^k)^-1 G^k a delta_1",
           "relaxation of a chain link by link", "strain over iterations",
           "rigid links, gravity, damping, a parameter iterations") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = under_gravity(bare::chain(16, 1, 0.01));
    s.damping = 4;
    const SolverEntry* const entry = parse_solver(solver).entry;
    if (entry->accuracy.sweeps.empty() || entry->accuracy.all_at_once) {
      findings.not_applicable(solver, "it has no sweeps");
      return;
    }
    if (!can_run(findings, solver, s)) return;
    if (own_stiffness(solver, s) < kRigid[0]) {
      findings.not_applicable(solver, "its links are springs of its own");
      return;
    }
    const auto with_sweeps = [&](int k) {
      return with(without(solver, entry->accuracy.sweeps),
                  std::string(entry->accuracy.sweeps) + "=" + std::to_string(k));
    };
    const double few = strain_of(with_sweeps(2), s), more = strain_of(with_sweeps(8), s);
    if (few < 1e-6) {
      findings.not_applicable(solver, "its links are exact with two sweeps");
      return;
    }
    const Eigen::MatrixXd sweep = reference::chain_sweep(16, reference::Sweep::gauss_seidel);
    const double law =
        reference::steady_strain(sweep, 2, 1)[0] / reference::steady_strain(sweep, 8, 1)[0];
    findings.equal(solver, "strain with 2 sweeps over that with 8", "1", few / more, law,
                   0.4 * law);
  });
}

TAUT_TRUTH(any_repeat, 11, 29, "the same start gives the same bits; a run goes on from its state",
           "a solver is a function of state, time and scene", "determinism", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    const auto compare = [&](const Scene& s, const char* repeated, const char* continued) {
      if (!can_run(findings, solver, s)) return;
      const SolverChoice choice = parse_solver(solver);
      const std::unique_ptr<Solver> live = choice.entry->make(s, choice.params);
      const auto run = [&](const State& from, int first, int steps) {
        live->load(from);
        for (int n = first; n < first + steps; ++n) live->step(n * s.dt, s.dt);
        State state;
        live->store(state);
        return state;
      };
      const State once = run(s.start, 0, 128), again = run(s.start, 0, 128);
      const State half = run(s.start, 0, 64), on = run(half, 64, 64);
      findings.below(solver, repeated, "m", max_distance(once.x, again.x), 0);
      findings.below(solver, continued, "m", max_distance(once.x, on.x), 2e-3);
    };
    Scene s = level_chain();
    compare(s, "distance of a second run from the same start",
            "distance of a run that goes on from its state after 0.25 s");
    s.pin_motions = {{{0}, {.path = {{0, {0, 0, 0}}, {0.5, {0.1, 0, 0}}, {1, {0, 0.2, 0}}}}}};
    compare(s, "the same of runs with a moving pin, from the same start",
            "the same of runs with a moving pin, after 0.25 s");
  });
}

}  // namespace taut
