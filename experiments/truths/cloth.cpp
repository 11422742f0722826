// Section 6: sheets whose shape at rest is known, and symmetries that a solver must keep.
#include <cmath>
#include <functional>

#include "core/model/index.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/fit.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "core/reference/strain_at_rest.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// A sheet of n x n vertices with unit sides, whose upper corners are `span` apart.
Scene two_corners(int n, double span, const LinkChoice& links = {}) {
  Scene s = under_gravity(bare::sheet(n, n, links));
  s.pins = {0, n - 1};
  for (int j = 0; j < n; ++j)  // planar, narrower, stretched downwards: towards the shape at rest
    for (int i = 0; i < n; ++i) s.start.x[to_index(s.mesh.grid->index(i, j))].x() *= span;
  return s;
}

/// Positions x(i, j) = top(i) - j l y, where top is the discrete catenary that carries a column at
/// every joint.
std::vector<Vec3> columns_below_a_catenary(const Scene& s, double span) {
  const Grid grid = *s.mesh.grid;
  const double l = s.links[0].rest;
  double column = 0;
  for (int j = 0; j < grid.nv; ++j) column += s.mesh.mass[to_index(grid.index(1, j))];
  const auto top = reference::discrete_catenary(grid.nu - 1, span, l, column * kG);
  std::vector<Vec3> x;
  for (int j = 0; j < grid.nv; ++j)
    for (int i = 0; i < grid.nu; ++i)
      x.emplace_back(top.x[to_index(i)], top.y[to_index(i)] - j * l, 0);
  return x;
}

/// Largest distance of a vertex of a sheet of width 1 from its mirror image in x = 1/2 [m].
double asymmetry_of(const Simulation& sim) {
  const Grid grid = *sim.scene().mesh.grid;
  double worst = 0;
  for (int j = 0; j < grid.nv; ++j)
    for (int i = 0; i < grid.nu; ++i) {
      Vec3 mirrored = sim.x(grid.index(grid.nu - 1 - i, j));
      mirrored.x() = 1 - mirrored.x();
      worst = std::max(worst, (sim.x(grid.index(i, j)) - mirrored).norm());
    }
  return worst;
}

/// Slopes in k, from 8 to 64 sweeps, for a sheet at rest on corners one width apart.
struct SquareSlopes {
  PowerLaw strain, distance, asymmetry;
};

SquareSlopes square_slopes(Scene s, const std::function<std::string(int)>& solver) {
  std::vector<double> sweeps, strain, distance, asymmetry;
  for (const int k : {8, 16, 32, 64}) {
    Simulation sim(s, solver(k));
    settle(sim, 1e-7, 32, 6000);
    sweeps.push_back(k);
    asymmetry.push_back(asymmetry_of(sim));
    strain.push_back(rms_strain(s, sim.state()));
    distance.push_back(max_distance(sim.state().x, s.mesh.rest));
  }
  return {fit_power_law(sweeps, strain), fit_power_law(sweeps, distance),
          fit_power_law(sweeps, asymmetry)};
}

Scene square(const LinkChoice& links) {
  Scene s = two_corners(16, 1, links);
  s.damping = 2;
  s.dt = 1.0 / 256;
  return s;
}

/// Predicted and measured largest strain of a draped sheet at rest under one sweep at 3840 Hz.
struct SmallStrain {
  double predicted = 0, measured = 0, worst = 0;
};

SmallStrain small_strain_of(Scene s, const std::string& solver) {
  const auto rest = reference::static_equilibrium(s);
  const auto w = inverse_masses(s);
  s.start.x = rest.x;
  const auto gradient = [&](const Link& l, int vertex) -> Vec3 {
    const Vec3 direction = (rest.x[to_index(l.b)] - rest.x[to_index(l.a)]).normalized();
    if (vertex == l.b) return direction;
    if (vertex == l.a) return -direction;
    return Vec3::Zero();
  };
  Simulation sim(s, solver);
  settle(sim, 1e-9, 500, 12000);
  const auto e = strains(s, sim.state());
  SmallStrain result;
  for (std::size_t i = 0; i < s.links.size(); ++i) {
    double sum = 0;
    for (std::size_t j = i + 1; j < s.links.size(); ++j)
      for (const int vertex : {s.links[i].a, s.links[i].b})
        sum += w[to_index(vertex)] *
               gradient(s.links[i], vertex).dot(gradient(s.links[j], vertex)) * rest.tension[j];
    const double expected = -sum * s.dt * s.dt / s.links[i].rest, here = e[i] / s.links[i].rest;
    result.predicted = std::max(result.predicted, std::abs(expected));
    result.measured = std::max(result.measured, std::abs(here));
    result.worst = std::max(result.worst, std::abs(here - expected));
  }
  return result;
}

}  // namespace

TAUT_TRUTH(draped_sheet, 6, 1,
           "two corners, structural links, D < width: columns below a discrete catenary",
           "global minimum of the potential energy; statics") {
  const double span = 0.8;
  if (findings.wants(kStatic)) {
    const Scene s = two_corners(20, span);
    const auto e = reference::static_equilibrium(s);
    findings.holds(kStatic, "has one answer, 20x20, D = 0.8", e.unique);
    if (e.unique) {
      findings.below(kStatic, "distance from the closed form, 20x20, D = 0.8", "m",
                     max_distance(e.x, columns_below_a_catenary(s, span)), 1e-14);
      double reaction = 0, weight = 0;
      for (std::size_t j = 0; j < s.links.size(); ++j)
        for (const int pin : s.pins)
          if (s.links[j].a == pin || s.links[j].b == pin) {
            const int other = s.links[j].a == pin ? s.links[j].b : s.links[j].a;
            reaction +=
                e.tension[j] * (s.start.x[to_index(pin)] - e.x[to_index(other)]).normalized().y();
          }
      const auto w = inverse_masses(s);
      for (std::size_t i = 0; i < w.size(); ++i)
        if (w[i] > 0) weight += s.mesh.mass[i] * kG;
      findings.equal(kStatic, "pin reactions over the free weight", "1", reaction / weight, 1,
                     1e-10);
    }
  }
  const int n = 8;
  for (const std::string& solver : {jakobsen(40), jakobsen(40, "sqrt-free"), bullet(40)}) {
    Scene s = two_corners(n, span);
    s.damping = 4;
    if (!can_run(findings, solver, s)) continue;
    const auto exact = columns_below_a_catenary(s, span);
    s.start.x = exact;  // other starts end in other shapes, in which links that must not buckle do
    double distance = 0;
    const PowerLaw order = fit_over({1.0 / 64, 1.0 / 128, 1.0 / 256}, [&](double dt) {
      s.dt = dt;
      Simulation sim(s, solver);
      settle(sim, 1e-7, 32, static_cast<int>(20 / dt));
      return distance = max_distance(sim.state().x, exact);
    });
    findings.slope(solver, "order in dt of the distance from the closed form, 8x8, 40 sweeps",
                   order, 2, 0.1);
    findings.below(solver, "distance from the closed form at 1/256 s", "m", distance, 1e-3);
  }
}

TAUT_TRUTH(two_edges, 6, 2,
           "two opposite edges pinned, no bending: the discrete catenary in every section",
           "statics of every section") {
  if (!findings.wants(kStatic)) return;
  const int n = 9;
  const double span = 0.8, l = 1.0 / (n - 1);
  Scene s = bare::sheet(n, n);
  s.pins.clear();
  for (int j = 0; j < n; ++j)
    for (const int i : {0, n - 1}) s.pins.push_back(s.mesh.grid->index(i, j));
  std::sort(s.pins.begin(), s.pins.end());
  for (Vec3& x : s.start.x) x = Vec3(span * x.x(), 0, x.y());  // flat, gravity across
  s.gravity = {0, -kG, 0};
  const auto e = reference::static_equilibrium(s);
  findings.holds(kStatic, "has one answer, 9x9", e.unique);
  if (!e.unique) return;
  const auto row = reference::discrete_catenary(n - 1, span, l, 1);
  double worst = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      worst = std::max(worst, (e.x[to_index(s.mesh.grid->index(i, j))] -
                               Vec3(row.x[to_index(i)], row.y[to_index(i)], -j * l))
                                  .norm());
  findings.below(kStatic, "distance of every section from the discrete catenary", "m", worst,
                 1e-13);
}

TAUT_TRUTH(top_edge, 6, 3,
           "top edge pinned, structural links: every column is the chain under k sweeps",
           "rows stay unstrained") {
  const int n = 8, rows = n + 1;
  const double g = 0.01;  // small, to keep the square-root-free form in its linear range
  for (const int k : {1, 4, 16})
    for (const auto& [solver, tolerance] :
         {std::pair(jakobsen(k), 1e-6), {jakobsen(k, "sqrt-free"), 1e-3}, {bullet(k), 1e-3}}) {
      Scene s = bare::sheet(6, rows, {}, Lumping::equal);
      for (int i = 0; i < 6; ++i) s.pins.push_back(i);
      s.gravity = {0, -g, 0};
      if (!can_run(findings, solver, s)) continue;
      Simulation sim(s, solver, 4000 / k + 100);
      const auto exact = reference::steady_strain(
          reference::chain_sweep(n, reference::Sweep::gauss_seidel), k, g * s.dt * s.dt);
      double worst = 0;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < 6; ++i) {
          const double e = sim.x(s.mesh.grid->index(i, j)).y() -
                           sim.x(s.mesh.grid->index(i, j + 1)).y() - 1.0 / n;
          worst = std::max(worst, std::abs(e - exact[j]));
        }
      findings.below(solver, "relative distance of every column from the chain's recurrence", "1",
                     worst / exact.maxCoeff(), tolerance);
    }
}

TAUT_TRUTH(flat_square, 6, 4,
           "structural + shear, corners one width apart: the flat square, strain and "
           "distance ~ 1/k",
           "linear relaxation; the diagonals carry the upper edge") {
  const Scene s = square({.shear = true});
  const std::function<std::string(int)> ours = [](int k) { return jakobsen(k); }, theirs = bullet;
  for (const auto& solver : {ours, theirs}) {
    if (!can_run(findings, solver(8), s)) continue;
    const SquareSlopes slopes = square_slopes(s, solver);
    findings.slope(solver(8), "slope in k of the RMS strain, 8 to 64 sweeps", slopes.strain, -1,
                   0.1);
    // Diagonals carry the middle of the upper edge, so it sags with the strain itself, k^-1. An
    // edge that only its own tension carries would sag with k^-1/2.
    findings.slope(solver(8), "slope in k of the distance from the flat square", slopes.distance,
                   -1, 0.1);
    findings.slope(solver(8), "slope in k of the asymmetry at rest", slopes.asymmetry, -1, 0.25);
  }
}

TAUT_TRUTH(locked_sheet, 6, 5,
           "structural + shear all hard with D < width lock: never a truth, so refused",
           "a grid of rigid diagonals folds along one direction only") {
  if (!findings.wants(kStatic)) return;
  const auto refused = [](const Scene& s) { return !reference::static_equilibrium(s).unique; };
  findings.holds(kStatic, "refuses structural + shear with D < width",
                 refused(two_corners(8, 0.8, {.shear = true})));
  findings.holds(kStatic, "refuses bending links", refused(two_corners(8, 0.8, {.bend = true})));
  Scene ball = two_corners(8, 0.8);
  ball.colliders.push_back({Ball{Vec3(0.5, -0.5, 0), 0.2}, {}, 0});
  findings.holds(kStatic, "refuses contact", refused(ball));
  findings.holds(kStatic, "accepts the flat square, D = width",
                 !refused(two_corners(8, 1, {.shear = true})));
}

TAUT_TRUTH(small_strain, 6, 6,
           "e = dt^2 U f, U the strict upper part of J M^-1 J^T in processing order",
           "one Gauss-Seidel sweep at rest, linearised") {
  // One sweep leaves in link i what the links after it undo: e = dt^2 U f.
  Scene s = two_corners(20, 0.8);
  s.mesh.mass.assign(s.mesh.mass.size(), 0.2 / 400);
  s.start.x = columns_below_a_catenary(s, 0.8);
  s.dt = 1.0 / 3840;
  s.damping = 12;
  const std::string solver = jakobsen(1);
  if (!can_run(findings, solver, s)) return;
  const SmallStrain strain = small_strain_of(s, solver);
  findings.equal(solver, "largest predicted strain, 20x20, 3840 Hz, k = 1", "1", strain.predicted,
                 2.79e-3, 1e-5);
  findings.equal(solver, "largest measured strain", "1", strain.measured, 2.77e-3, 1e-5);
  findings.below(solver, "largest distance of a link from dt^2 U f, relative", "1",
                 strain.worst / strain.predicted, 0.02);
}

TAUT_TRUTH(ball_drape, 6, 7,
           "vertices on a ball: an edge is R - sqrt(R^2 - l^2/4) deep, a face l^2/(4R)",
           "geometry; not solver error") {
  const double radius = 0.5, l = 0.05;
  const Ball ball{Vec3(1, 2, 3), radius};
  // Two vertices on the ball, l apart, are corners of a right triangle with legs l, whose deepest
  // point is the middle of the hypotenuse.
  const auto depth_of_middle = [&](double chord) {
    const double half = std::asin(chord / 2 / radius);
    const Vec3 a = ball.center + radius * Vec3(std::sin(half), std::cos(half), 0);
    const Vec3 b = ball.center + radius * Vec3(-std::sin(half), std::cos(half), 0);
    return -surface(Shape(ball), (a + b) / 2).distance;
  };
  findings.equal("model:surface", "depth of an edge, R = 0.5, l = 0.05", "m", depth_of_middle(l),
                 0.6254e-3, 5e-8);
  findings.equal("model:surface", "the same against R - sqrt(R^2 - l^2/4)", "m", depth_of_middle(l),
                 radius - std::sqrt(radius * radius - l * l / 4), 1e-15);
  findings.equal("model:surface", "depth of a face, about l^2/(4R)", "m",
                 depth_of_middle(l * std::sqrt(2.0)), 1.2516e-3, 5e-8);
}

TAUT_TRUTH(mirror_symmetry, 6, 8,
           "a symmetric scene stays symmetric under Jacobi; under "
           "Gauss-Seidel at rest as its residual",
           "the sweeps' own symmetry") {
  const int n = 9;
  Scene s = two_corners(n, 1, {.shear = true, .bend = true});
  for (std::size_t i = 0; i < s.start.v.size(); ++i)  // a symmetric push out of the plane
    s.start.v[i].z() = std::cos(6 * (s.mesh.rest[i].x() - 0.5)) + s.mesh.rest[i].y();
  for (const int pin : s.pins) s.start.v[to_index(pin)].setZero();
  const auto asymmetry = [&](const std::string& solver) {
    return asymmetry_of(Simulation(s, solver, 128));
  };
  for (const char* method : {"method=jacobi-averaged", "method=jacobi-underrelaxed"})
    if (const std::string solver = jakobsen(8, "exact", method); can_run(findings, solver, s))
      findings.below(solver, "asymmetry after 2 s", "m", asymmetry(solver), 1e-11);
  if (const std::string springs = mass_spring("verlet", 0.1); can_run(findings, springs, s))
    findings.below(springs, "asymmetry after 2 s", "m", asymmetry(springs), 1e-11);
  // With Gauss-Seidel at rest the asymmetry follows the residual (flat-square measures its slope).
  // In motion it does not: converged sweeps still pick one of many sets of redundant multipliers.
  if (const std::string many = jakobsen(1024); can_run(findings, many, s))
    findings.holds(many, "in motion converged Gauss-Seidel stays asymmetric",
                   asymmetry(many) > 1e-4);
}

TAUT_TRUTH(centre_of_mass, 6, 9,
           "without pins and contacts the centre of mass follows the discrete parabola",
           "pairwise projection conserves momentum; per-particle averaging does not") {
  Scene s = under_gravity(bare::sheet(8, 8, {.shear = true, .bend = true}));
  for (std::size_t i = 0; i < s.start.v.size(); ++i)
    s.start.v[i] =
        Vec3(std::sin(3.0 * static_cast<double>(i)), std::cos(5.0 * static_cast<double>(i)),
             std::sin(7.0 * static_cast<double>(i)));
  double total = 0;
  for (const double m : s.mesh.mass) total += m;
  const auto centre = [&](const std::vector<Vec3>& y) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < y.size(); ++i) sum += s.mesh.mass[i] / total * y[i];
    return sum;
  };
  const auto gap = [&](const std::string& solver) {
    Simulation sim(s, solver);
    return sim.worst(64, [&](int n) {
      const double t = n * s.dt;
      const Vec3 expected =
          centre(s.start.x) + centre(s.start.v) * t + s.gravity * (t * t / 2 + t * s.dt / 2);
      return (centre(sim.state().x) - expected).norm();
    });
  };
  for (const std::string& solver :
       {jakobsen(4), jakobsen(4, "sqrt-free"), jakobsen(4, "exact", "method=jacobi-underrelaxed"),
        jakobsen(4, "exact", "omega=1.3"), bullet(4), xpbd(1, "structural=0.1"),
        mass_spring("verlet", 0.1)})
    if (can_run(findings, solver, s))
      findings.below(solver, "distance of the centre of mass from the parabola over 1 s", "m",
                     gap(solver), 1e-11);
  const std::string averaged = jakobsen(4, "exact", "method=jacobi-averaged");
  if (can_run(findings, averaged, s))
    findings.holds(averaged, "averaging per particle does not conserve momentum",
                   gap(averaged) > 1e-6);
}

TAUT_TRUTH(sweeps_are_springs, 6, 16,
           "at rest k sweeps in steps of h leave the stretch of springs c k/(h^2 (w_a + w_b))",
           "a step's corrections are the impulse of the tensions; c of a small twin") {
  const Scene s = square({.shear = true});
  // no run is the twin's: it has 13 x 13 vertices, four sweeps in a step of 1/530 s and rigid links
  for (const std::string& solver :
       {jakobsen(8), jakobsen(32), jakobsen(8, "exact", "order=coloured"),
        jakobsen(2, "exact", "order=coloured,substeps=2"), jakobsen(32, "sqrt-free"),
        jakobsen(16, "exact", "method=jacobi-underrelaxed"),
        std::string("xpbd:order=coloured,substeps=1,precision=double,iterations=8,"
                    "structural=0.01,shear=0.01"),
        std::string("vbd:start=inertia,order=coloured,iterations=10")}) {
    if (!can_run(findings, solver, s)) continue;
    const SolverChoice choice = parse_solver(solver);
    reference::StrainAtRest law(s, choice);
    const auto strain = law.at(choice.sweeps(), choice.substeps());
    const Simulation sim(s, solver, 700);
    findings.equal(solver, "RMS stretch predicted, over that of the run", "1",
                   strain.rms / rms_strain(s, sim.state()), 1, 0.05);
    findings.equal(solver, "largest stretch predicted, over that of the run", "1",
                   strain.largest / max_strain(s, sim.state()), 1, 0.15);
  }
}

}  // namespace taut
