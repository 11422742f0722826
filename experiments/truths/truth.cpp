#include "experiments/truths/truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr Names<TruthVerdict::broken> kVerdicts{"passed", "deviates", "not applicable", "broken"};

}  // namespace

std::string_view to_string(TruthVerdict verdict) { return kVerdicts[verdict]; }

Cell cell_of(TruthVerdict verdict) {
  using enum Cell::Tone;
  const bool half = verdict == TruthVerdict::deviates || verdict == TruthVerdict::not_applicable;
  return Cell(to_string(verdict))
      .toned(verdict == TruthVerdict::passed ? good
             : half                          ? doubtful
                                             : bad);
}

TruthVerdict verdict_of(std::string_view text) {
  return kVerdicts.find(text).value_or(TruthVerdict::broken);
}

std::string_view section_title(int section) {
  constexpr std::array<std::string_view, 11> titles{"One constraint",
                                                    "The twin: Bullet is Jakobsen's algorithm",
                                                    "Motion without constraints",
                                                    "Pendulum, stick, chain",
                                                    "Stability of relaxation",
                                                    "Cloth",
                                                    "Contact",
                                                    "Published numbers",
                                                    "References",
                                                    "Metrics",
                                                    "Conformance: one test of each phenomenon"};
  return titles[static_cast<std::size_t>(section - 1)];
}

bool Findings::wants(std::string_view subject) const {
  if (only_.empty()) return true;
  const std::string name = solver_name(subject);
  return std::any_of(only_.begin(), only_.end(),
                     [&](const std::string& o) { return o == name || o == subject; });
}

void Findings::add(Finding f) {
  if (wants(f.subject)) findings_.push_back(std::move(f));
}

namespace {

/// Whether the number is within the tolerance; NaN never is.
bool within(double measured, double expected, double tolerance) {
  return std::abs(measured - expected) <= tolerance;
}

Finding finding(std::string_view subject, std::string_view quantity, std::string_view unit,
                double measured, double expected, double tolerance) {
  Finding f;
  f.subject = subject;
  f.quantity = quantity;
  f.unit = unit;
  f.measured = measured;
  f.expected = expected;
  f.tolerance = tolerance;
  f.verdict = within(measured, expected, tolerance) ? TruthVerdict::passed : TruthVerdict::broken;
  return f;
}

}  // namespace

void Findings::equal(std::string_view subject, std::string_view quantity, std::string_view unit,
                     double measured, double expected, double tolerance) {
  add(finding(subject, quantity, unit, measured, expected, tolerance));
}

void Findings::holds(std::string_view subject, std::string_view quantity, bool measured) {
  equal(subject, quantity, "1", measured, 1, 0);
}

void Findings::below(std::string_view subject, std::string_view quantity, std::string_view unit,
                     double measured, double limit) {
  equal(subject, quantity, unit, measured, 0, limit);
}

void Findings::slope(std::string_view subject, std::string_view quantity, const PowerLaw& fitted,
                     double expected, double tolerance) {
  Finding f = finding(subject, quantity, "1", fitted.exponent, expected, tolerance);
  f.uncertainty = fitted.error;
  add(std::move(f));
}

void Findings::deviates(std::string_view subject, std::string_view quantity, std::string_view unit,
                        double measured, double expected, double explained, double tolerance,
                        std::string_view why) {
  Finding f = finding(subject, quantity, unit, measured, expected, tolerance);
  const bool agrees = f.verdict == TruthVerdict::passed;
  if (!within(measured, explained, tolerance))
    f.verdict = TruthVerdict::broken;
  else if (!agrees)
    f.verdict = TruthVerdict::deviates;
  f.why = why;
  add(std::move(f));
}

void Findings::not_applicable(std::string_view subject, std::string_view why) {
  Finding f;
  f.subject = subject;
  f.verdict = TruthVerdict::not_applicable;
  f.why = why;
  f.measured = f.expected = std::nan("");
  add(std::move(f));
}

Simulation::Simulation(const Scene& scene, std::string_view solver, int steps)
    : scene_(scene), state_(scene.start) {
  const SolverChoice choice = parse_solver(solver);
  solver_ = choice.entry->make(scene_, choice.params);
  foreign_ = choice.entry->foreign();
  solver_->load(state_);
  if (steps > 0) step(steps);
}

void Simulation::step(int n) {
  for (int i = 0; i < n; ++i, ++n_) solver_->step(n_ * scene_.dt, scene_.dt);
  solver_->store(state_);
  const auto finite = [](const Vec3& a) { return a.allFinite(); };
  if (foreign_ && !(std::ranges::all_of(state_.x, finite) && std::ranges::all_of(state_.v, finite)))
    throw SolverFailure(Status::Kind::exploded, "a state that is not finite");
}

bool can_run(Findings& findings, std::string_view solver, const Scene& scene) {
  if (!findings.wants(solver)) return false;
  std::vector<std::string> reasons;
  try {
    const SolverChoice choice = parse_solver(solver);
    reasons = choice.entry->unsupported(scene, choice.params);
    if (reasons.empty()) choice.entry->make(scene, choice.params);
  } catch (const InputError& error) {  // the program does not have this solver or precision
    reasons = {error.what()};
  }
  if (!reasons.empty())
    findings.not_applicable(solver, reasons.front());
  else
    findings.saw(scene);
  return reasons.empty();
}

std::string jakobsen(int iterations, std::string_view projection, std::string_view more) {
  const auto open = [&](std::string_view key) { return more.find(key) == std::string_view::npos; };
  std::string text = "jakobsen:iterations=" + std::to_string(iterations);
  if (open("substeps=")) text += ",substeps=1";
  if (open("order=")) text += ",order=mesh";
  return with(text + ",projection=" + std::string(projection) + ",precision=double", more);
}

std::string bullet(int iterations) {
  return "bullet:iterations=" + std::to_string(iterations) + ",precision=double";
}

std::string xpbd(int substeps, std::string_view more) {
  return with(
      "xpbd:iterations=1,order=mesh,substeps=" + std::to_string(substeps) + ",precision=double",
      more);
}

std::string mass_spring(std::string_view integrator, double stiffness, double drag) {
  const std::string k = general(stiffness, 17);
  return "mass-spring:integrator=" + std::string(integrator) + ",structural=" + k + ",shear=" + k +
         ",bend=" + k + ",drag=" + general(drag, 17) + ",substeps=1,precision=double";
}

namespace bare {

Scene scene(std::vector<Vec3> x, std::vector<double> mass, std::vector<Link> links,
            std::vector<int> pins) {
  Scene s;
  s.name = "truth";
  s.mesh.rest = x;
  s.mesh.mass = std::move(mass);
  s.start = {std::move(x), std::vector<Vec3>(s.mesh.rest.size(), Vec3::Zero())};
  s.links = std::move(links);
  s.pins = std::move(pins);
  s.gravity = Vec3::Zero();
  s.dt = 1.0 / 64;
  s.steps = 64;
  return s;
}

Scene pair(double distance, double rest, double mass1, double mass2) {
  return scene({Vec3::Zero(), distance * Vec3(2, 1, -2) / 3}, {mass1, mass2}, {{0, 1, rest}});
}

Scene chain(int n, double length, double mass, const Vec3& direction) {
  std::vector<Vec3> x;
  std::vector<Link> links;
  for (int i = 0; i <= n; ++i) x.push_back(i * length / n * direction);
  for (int i = 0; i < n; ++i) links.push_back({i, i + 1, length / n});
  return scene(x, std::vector<double>(x.size(), mass), links, {0});
}

Scene sheet(int nu, int nv, const LinkChoice& choice, Lumping lumping, double width, double height,
            double mass) {
  const Mesh mesh = make_sheet(
      {.nu = nu, .nv = nv, .width = width, .height = height, .mass = mass, .lumping = lumping});
  Scene s = scene(mesh.rest, mesh.mass, grid_links(mesh, choice));
  s.mesh = mesh;
  return s;
}

}  // namespace bare

Scene under_gravity(Scene scene) {
  scene.gravity = {0, -kG, 0};
  return scene;
}

std::vector<double> strains(const Scene& scene, const State& state) {
  std::vector<double> e;
  for (const Link& l : scene.links)
    e.push_back((state.x[to_index(l.b)] - state.x[to_index(l.a)]).norm() - l.rest);
  return e;
}

double max_strain(const Scene& scene, const State& state) {
  const std::vector<double> e = strains(scene, state);
  double worst = 0;
  for (std::size_t j = 0; j < e.size(); ++j)
    worst = larger(worst, std::abs(e[j]) / scene.links[j].rest);
  return worst;
}

double rms_strain(const Scene& scene, const State& state) {
  const std::vector<double> e = strains(scene, state);
  double sum = 0;
  for (std::size_t j = 0; j < e.size(); ++j) sum += std::pow(e[j] / scene.links[j].rest, 2);
  return std::sqrt(sum / static_cast<double>(e.size()));
}

double max_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = larger(worst, (a[i] - b[i]).norm());
  return worst;
}

bool settle(Simulation& sim, double speed, int every, int limit) {
  int calm = 0;
  for (int n = 0; n < limit && calm < 10; n += every) {
    sim.step(every);
    double fastest = 0;
    for (const Vec3& v : sim.state().v) fastest = std::max(fastest, v.norm());
    calm = fastest < speed ? calm + 1 : 0;
  }
  return calm == 10;
}

}  // namespace taut
