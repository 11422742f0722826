#include "core/reference/shake.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/model/bending.hpp"
#include "core/model/index.hpp"
#include "core/model/membrane.hpp"
#include "core/model/text.hpp"
#include "core/model/wind.hpp"

namespace taut::reference {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;
using Triplet = Eigen::Triplet<double>;

/// Least step of converged_motion(): two seconds take about a million such steps.
constexpr double kLeastStep = 0x1p-19;  ///< s

double stiffness_of(const Scene& scene, const Link& l) {
  return scene.stiffness[static_cast<std::size_t>(l.family)];
}
bool is_rigid(const Scene& scene, const Link& l) { return std::isinf(stiffness_of(scene, l)); }

bool has_springs(const Scene& scene) {
  return scene.bending || scene.membrane ||
         std::ranges::any_of(scene.links, [&](const Link& l) { return !is_rigid(scene, l); });
}

std::vector<Vec3> wind_forces(const Scene& scene, const std::vector<Vec3>& x,
                              const std::vector<Vec3>& v) {
  std::vector<Vec3> f(x.size(), Vec3::Zero());
  if (!scene.wind) return f;
  for (const auto& [a, b, c] : scene.mesh.triangles) {
    const Vec3 corner = wind_on_corner(*scene.wind, x[to_index(a)], x[to_index(b)], x[to_index(c)],
                                       (v[to_index(a)] + v[to_index(b)] + v[to_index(c)]) / 3);
    for (const int i : {a, b, c}) f[to_index(i)] += corner;
  }
  return f;
}

/// States at `times`; empty if a projection failed.
std::vector<State> run(const Scene& scene, const std::vector<double>& times, double dt) {
  Shake shake(scene, dt);
  std::vector<State> states;
  for (const double t : times) {
    while (shake.time() < t - dt / 2)
      if (!shake.step()) return {};
    states.push_back(shake.state());
  }
  return states;
}

State extrapolate(const State& coarse, const State& fine) {
  State s = fine;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    s.x[i] += (fine.x[i] - coarse.x[i]) / 3;
    s.v[i] += (fine.v[i] - coarse.v[i]) / 3;
  }
  return s;
}

}  // namespace

struct Shake::Impl {
  Scene scene;
  double dt;
  int n = 0;  ///< steps taken
  std::vector<double> w;
  std::vector<Link> links, springs;  ///< rigid and elastic, with an end that moves
  std::vector<BendingElement> bending;
  MembraneModel membrane;
  std::vector<Vec3> x, previous, before_previous;
  Eigen::SimplicialLDLT<Matrix> ldlt;
  bool analysed = false;

  Impl(const Scene& s, double h)
      : scene(s),
        dt(h),
        w(inverse_masses(s)),
        bending(make_bending(s)),
        membrane(make_membrane(s)),
        x(s.start.x) {
    for (const Link& l : s.links)
      if (w[to_index(l.a)] + w[to_index(l.b)] > 0) (is_rigid(s, l) ? links : springs).push_back(l);
  }

  /// Factors J M^-1 J^T at x. J are the gradients d of (|d|^2 - r^2)/2: links that share a vertex
  /// couple.
  bool factor() {
    std::vector<std::vector<std::pair<int, double>>> beside(x.size());  // link, sign at the vertex
    for (int j = 0; j < static_cast<int>(links.size()); ++j) {
      beside[to_index(links[to_index(j)].a)].emplace_back(j, -1.0);
      beside[to_index(links[to_index(j)].b)].emplace_back(j, 1.0);
    }
    std::vector<Triplet> entries;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (const auto& [p, sp] : beside[i])
        for (const auto& [q, sq] : beside[i])
          if (w[i] > 0 && p >= q)
            entries.emplace_back(p, q, w[i] * sp * sq * delta(x, p).dot(delta(x, q)));
    const int m = static_cast<int>(links.size());
    Matrix a(m, m);
    a.setFromTriplets(entries.begin(), entries.end());
    if (!analysed) ldlt.analyzePattern(a);
    analysed = true;
    ldlt.factorize(a);
    return ldlt.info() == Eigen::Success &&
           ldlt.vectorD().minCoeff() > 1e-12 * ldlt.vectorD().maxCoeff();
  }

  Vec3 delta(const std::vector<Vec3>& y, int j) const {
    return y[to_index(links[to_index(j)].b)] - y[to_index(links[to_index(j)].a)];
  }

  /// Corrects y along the directions at x until every link has its length.
  bool project(std::vector<Vec3>& y) {
    if (links.empty()) return true;
    if (!factor()) return false;
    const int m = static_cast<int>(links.size());
    Vector violation(m);
    double before = 1e300;
    for (int iteration = 0; iteration < 200; ++iteration) {
      double worst = 0;
      for (int j = 0; j < m; ++j) {
        const double r = links[to_index(j)].rest;
        violation[j] = (delta(y, j).squaredNorm() - r * r) / 2;
        worst = std::max(worst, std::abs(violation[j]) / (r * r));
      }
      // Only rounding is left.
      if (worst < 1e-15 || (worst < 1e-13 && worst >= before)) return true;
      if (!(worst < 1e3)) return false;
      before = worst;
      const Vector lambda = ldlt.solve(violation);
      for (int j = 0; j < m; ++j) {
        const Vec3 d = lambda[j] * delta(x, j);
        const Link& l = links[to_index(j)];
        y[to_index(l.a)] += w[to_index(l.a)] * d;
        y[to_index(l.b)] -= w[to_index(l.b)] * d;
      }
    }
    return false;
  }

  /// Velocity at x from past positions alone, of order 2 once there are two earlier steps.
  std::vector<Vec3> velocity_now() const {
    if (n == 0) return scene.start.v;
    std::vector<Vec3> v(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      v[i] = n == 1 ? Vec3(2 * (x[i] - previous[i]) / dt - scene.start.v[i])
                    : Vec3((3 * x[i] - 4 * previous[i] + before_previous[i]) / (2 * dt));
    return v;
  }

  std::vector<Vec3> forces(const std::vector<Vec3>& v) const {
    std::vector<Vec3> f = wind_forces(scene, x, v);
    for (const Link& l : springs) {
      const Vec3 d = x[to_index(l.b)] - x[to_index(l.a)];
      const double length = d.norm();
      if (length == 0) continue;  // there is no direction to pull in
      const Vec3 pull = stiffness_of(scene, l) * (length - l.rest) / length * d;
      f[to_index(l.a)] += pull;
      f[to_index(l.b)] -= pull;
    }
    for (const BendingElement& e : bending) {
      const Vec3 push = e.stiffness * e.value([&](std::size_t i) { return x[i]; });
      for (std::size_t i = 0; i < e.size; ++i) f[to_index(e.vertex[i])] -= e.weight[i] * push;
    }
    for (const MembraneElement& e : membrane.elements)
      membrane.add_forces(
          e, [&](std::size_t i) { return x[i]; },
          [&](std::size_t i, const Vec3& force) { f[i] += force; });
    return f;
  }

  bool step() {
    const std::vector<Vec3> v = velocity_now(), f = forces(v);
    const double half = scene.damping * dt / 2;
    std::vector<Vec3> y = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w[i] == 0) {
        y[i] = pin_position(scene, static_cast<int>(i), (n + 1) * dt);
        continue;
      }
      const Vec3 a = scene.gravity + w[i] * f[i];
      if (n == 0)  // x_1 = x_0 + v dt + (a - damping v) dt^2/2: order 2 from the start
        y[i] += dt * v[i] + dt * dt / 2 * (a - scene.damping * v[i]);
      else
        y[i] += ((1 - half) * (x[i] - previous[i]) + dt * dt * a) / (1 + half);
    }
    if (!project(y)) return false;
    before_previous = std::exchange(previous, std::exchange(x, std::move(y)));
    ++n;
    return true;
  }
};

Shake::Shake(const Scene& scene, double dt) : impl_(std::make_unique<Impl>(scene, dt)) {}
Shake::~Shake() = default;
bool Shake::step() { return impl_->step(); }
double Shake::time() const { return impl_->n * impl_->dt; }
State Shake::state() const { return {impl_->x, impl_->velocity_now()}; }

std::vector<std::string> refuse_dynamic(const Scene& scene) {
  std::vector<std::string> reasons;
  const auto refuse = [&](bool it, const char* why) {
    if (it) reasons.emplace_back(why);
  };
  refuse(!scene.colliders.empty(), "contact: impacts have no unique limit");
  refuse(scene.self_collision.has_value(), "self-collision: impacts have no unique limit");
  refuse(std::ranges::any_of(scene.links, is_seam), "a seam: its length is 0");
  refuse(!scene.releases.empty(), "its pins let go");
  refuse(scene.link_damping > 0, "damping of links");
  refuse(scene.membrane && scene.membrane->damping > 0, "damping of the membrane");
  refuse(std::any_of(
             scene.links.begin(), scene.links.end(),
             [&](const Link& l) { return l.family != Family::structural && is_rigid(scene, l); }),
         "rigid shear or bending links lock: J M^-1 J^T is singular in the plane");
  const std::vector<double> w = inverse_masses(scene);
  for (const Link& l : scene.links) {
    const double d = (scene.start.x[to_index(l.b)] - scene.start.x[to_index(l.a)]).norm();
    if (is_rigid(scene, l) && w[to_index(l.a)] + w[to_index(l.b)] > 0 &&
        std::abs(d - l.rest) > 1e-6 * l.rest) {
      refuse(true, "a slack or stretched start is ill-posed: start on the constraints");
      break;
    }
  }
  if (const double rate = fastest_vibration(scene); rate * kLeastStep > 0.5)
    reasons.push_back("springs vibrate with up to " + shortest(std::round(rate)) +
                      " rad/s: steps would be shorter than 2 us");
  return reasons;
}

double fastest_vibration(const Scene& scene) {
  // Sum |k| of each row of the stiffness matrix [N/m].
  std::vector<double> row(scene.start.x.size(), 0.0);
  for (const Link& l : scene.links)
    if (!is_rigid(scene, l))
      for (const int end : {l.a, l.b}) row[to_index(end)] += 2 * stiffness_of(scene, l);
  for (const BendingElement& e : make_bending(scene)) {
    double sum = 0;
    for (std::size_t i = 0; i < e.size; ++i) sum += std::abs(e.weight[i]);
    for (std::size_t i = 0; i < e.size; ++i)
      row[to_index(e.vertex[i])] += e.stiffness * std::abs(e.weight[i]) * sum;
  }
  make_membrane(scene).add_stiffness(row);
  double most = 0;
  const std::vector<double> w = inverse_masses(scene);
  for (std::size_t i = 0; i < row.size(); ++i) most = std::max(most, w[i] * row[i]);
  return std::sqrt(most);
}

namespace {

/// Whether every row of a flat rigid grid stays straight, so that it swings as one column of rods.
/// The grid has all structural and shear links, hangs by its first row and is released with
/// straight rows. Proof, row by row: a vertex is at the distances l and sqrt(l^2 + s^2) from the
/// vertex above it and from that one's neighbour, which is s away. Its displacement from the vertex
/// above is thus at a right angle to the row, and the links along the row make these displacements
/// equal.
bool rows_stay_straight(const Scene& scene) {
  const auto& grid = scene.mesh.grid;
  if (!grid || grid->nu < 2 || grid->nv < 2 || !scene.pin_motions.empty() || scene.wind ||
      !scene.colliders.empty() || scene.self_collision || has_springs(scene))
    return false;
  const std::vector<Vec3>& x = scene.start.x;
  const auto at = [&](int i, int j) { return to_index(grid->index(i, j)); };
  const Vec3 row = scene.mesh.rest[1] - scene.mesh.rest[0],
             column = scene.mesh.rest[at(0, 1)] - scene.mesh.rest[0];
  const double tiny = 1e-9 * row.norm();
  std::vector<int> first(to_index(grid->nu));
  std::iota(first.begin(), first.end(), 0);
  const std::vector<Link> all = grid_links(scene.mesh, {.shear = true});
  if (scene.pins != first || std::abs(row.dot(column)) > tiny * column.norm() ||
      std::abs(row.dot(scene.gravity)) > tiny * scene.gravity.norm() ||
      !std::ranges::equal(scene.links, all, [&](const Link& a, const Link& b) {
        return a.a == b.a && a.b == b.b && std::abs(a.rest - b.rest) < tiny;
      }))
    return false;
  for (int j = 0; j < grid->nv; ++j)
    for (int i = 0; i < grid->nu; ++i)
      if ((x[at(i, j)] - x[at(0, j)] - i * row).norm() > tiny * grid->nu ||
          std::abs(row.dot(x[at(i, j)] - x[at(i, 0)])) > tiny * row.norm() ||
          scene.start.v[at(i, j)].norm() > 0)
        return false;
  return true;
}

/// The scene's first column, with the masses of whole rows.
Scene first_column(const Scene& scene) {
  const Grid& grid = *scene.mesh.grid;
  Scene column = scene;
  column.mesh = {};
  column.start = {};
  column.pins = {0};
  column.mesh.grid = Grid{1, grid.nv};
  for (int j = 0; j < grid.nv; ++j) {
    const auto at = to_index(grid.index(0, j));
    double mass = 0;
    for (int i = 0; i < grid.nu; ++i) mass += scene.mesh.mass[to_index(grid.index(i, j))];
    column.mesh.rest.push_back(scene.mesh.rest[at]);
    column.mesh.mass.push_back(mass);
    column.start.x.push_back(scene.start.x[at]);
    column.start.v.push_back(scene.start.v[at]);
  }
  column.links = grid_links(column.mesh, {});
  return column;
}

Trajectory motion_of_rows(const Scene& scene, const std::vector<double>& times, double dt) {
  const Grid& grid = *scene.mesh.grid;
  Trajectory m = converged_motion(first_column(scene), times, dt);
  m.derivation += "; of one column with the masses of the rows, which stay straight";
  for (State& state : m.states) {
    const State column = std::move(state);
    state = scene.start;
    for (int j = 0; j < grid.nv; ++j)
      for (int i = 0; i < grid.nu; ++i) {
        const auto at = to_index(grid.index(i, j));
        state.x[at] = column.x[to_index(j)] + scene.start.x[to_index(i)] - scene.start.x[0];
        state.v[at] = column.v[to_index(j)];
      }
  }
  return m;
}

}  // namespace

Trajectory converged_motion(const Scene& scene, const std::vector<double>& times, double dt) {
  if (rows_stay_straight(scene)) return motion_of_rows(scene, times, dt);
  Trajectory m;
  if (const auto reasons = refuse_dynamic(scene); !reasons.empty()) {
    m.reason = reasons.front();
    return m;
  }
  const double rate = fastest_vibration(scene);
  while (dt * rate > 0.5) dt /= 2;
  m.dt = dt;
  std::vector<State> runs[3];
  for (int r = 0; r < 3; ++r) {
    runs[r] = run(scene, times, dt / (1 << r));
    if (runs[r].empty()) {
      m.reason =
          "the projection does not converge: the constraints are redundant or dt is too long";
      return m;
    }
  }
  m.unique = true;
  m.derivation = "SHAKE at dt, dt/2 and dt/4, Richardson-extrapolated";
  if (rate > 0)
    m.derivation +=
        "; elastic links, bending and membrane as forces, dt = 1/" + shortest(1 / dt) + " s";
  for (std::size_t k = 0; k < times.size(); ++k) {
    const State coarse = extrapolate(runs[0][k], runs[1][k]);
    m.states.push_back(extrapolate(runs[1][k], runs[2][k]));
    double worst = 0;
    for (std::size_t i = 0; i < coarse.x.size(); ++i)
      worst = std::max(worst, (coarse.x[i] - m.states.back().x[i]).norm());
    m.floor.push_back(worst);
  }
  return m;
}

}  // namespace taut::reference
