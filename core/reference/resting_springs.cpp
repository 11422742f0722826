#include "core/reference/resting_springs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/model/index.hpp"
#include "core/solver/newton/hessian.hpp"

namespace taut::reference {

namespace {

using solver::implicit::Hessian;
using solver::implicit::Vector;
using Points = std::vector<Vec3>;

/// The solves end where this share of the weight is left, or where the last solve took away nearly
/// all that was left (kQuick) and changed the tensions by less than kSettled: the next one would
/// change them by far less. Tensions are those of the last linear system.
constexpr double kBalanced = 1e-4, kQuick = 0.1, kSettled = 2e-3;
constexpr int kMostSolves = 40;
/// First displacement by gravity alone that M/h^2 allows, as a share of the extent.
constexpr double kFirstWay = 0.1;
/// h is longer by this factor at first if tensions are known.
constexpr double kLater = 64;
/// h grows by this factor from solve to solve; if that does not lead to a rest, by the next.
constexpr double kLonger[] = {4, 1.5};
/// A grid of more vertices starts from the rest of a coarser one.
constexpr int kDirect = 100;

/// Where a grid's line of `count` vertices has the place of vertex `i` of a line of `of`.
double place(int i, int of, int count) {
  return of > 1 ? static_cast<double>(i) * (count - 1) / (of - 1) : 0;
}
int nearest(int i, int of, int count) { return static_cast<int>(std::lround(place(i, of, count))); }

/// The value of `at`, one for each vertex of grid `of`, at vertex (i, j) of grid `to`, by bilinear
/// interpolation.
Vec3 between(const Points& at, const Grid& of, int i, int j, const Grid& to) {
  const double u = place(i, to.nu, of.nu), v = place(j, to.nv, of.nv);
  const int iu = std::min(static_cast<int>(u), std::max(0, of.nu - 2)),
            jv = std::min(static_cast<int>(v), std::max(0, of.nv - 2));
  const double p = u - iu, q = v - jv;
  const auto value = [&](int a, int b) -> const Vec3& {
    return at[to_index(of.index(std::min(a, of.nu - 1), std::min(b, of.nv - 1)))];
  };
  return (1 - q) * ((1 - p) * value(iu, jv) + p * value(iu + 1, jv)) +
         q * ((1 - p) * value(iu, jv + 1) + p * value(iu + 1, jv + 1));
}

/// A link of a grid by its first vertex and its direction.
using Step = std::array<int, 4>;
Step step_of(const Link& l, const Grid& g) {
  const int i = l.a % g.nu, j = l.a / g.nu;
  return {i, j, l.b % g.nu - i, l.b / g.nu - j};
}

/// For each link of the grid `to`, the nearest link of the same direction of the grid `of`.
std::vector<std::size_t> links_between(const Scene& to, const Scene& of) {
  const Grid &fine = *to.mesh.grid, &coarse = *of.mesh.grid;
  std::map<Step, std::size_t> all;
  for (std::size_t j = 0; j < of.links.size(); ++j) all[step_of(of.links[j], coarse)] = j;
  std::vector<std::size_t> found;
  for (const Link& l : to.links) {
    const auto [i, j, di, dj] = step_of(l, fine);
    // both ends lie in the coarse grid
    const int low = std::max(0, -di), high = coarse.nu - 1 - std::max(0, di);
    const int a = std::clamp(nearest(i, fine.nu, coarse.nu), low, std::max(low, high)),
              b = std::clamp(nearest(j, fine.nv, coarse.nv), 0, std::max(0, coarse.nv - 1 - dj));
    const auto one = all.find({a, b, di, dj});
    found.push_back(one == all.end() ? of.links.size() : one->second);
  }
  return found;
}

}  // namespace

Scene coarse_sheet(const Scene& scene, int nu, int nv) {
  const Grid fine = *scene.mesh.grid, coarse{nu, nv};
  Scene out = scene;
  Mesh& mesh = out.mesh;
  mesh = {};
  mesh.grid = coarse;
  mesh.triangles = make_sheet({.nu = nu, .nv = nv}).triangles;  // they decide solvers' layouts
  out.start = {};
  double all = 0, sampled = 0;
  for (const double m : scene.mesh.mass) all += m;
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      mesh.rest.push_back(between(scene.mesh.rest, fine, i, j, coarse));
      out.start.x.push_back(between(scene.start.x, fine, i, j, coarse));
      mesh.mass.push_back(
          scene.mesh.mass[to_index(fine.index(nearest(i, nu, fine.nu), nearest(j, nv, fine.nv)))]);
      sampled += mesh.mass.back();
    }
  for (double& m : mesh.mass) m *= all / sampled;
  out.start.v.assign(mesh.rest.size(), Vec3::Zero());
  out.pins.clear();
  for (const int pin : scene.pins)
    out.pins.push_back(
        coarse.index(nearest(pin % fine.nu, fine.nu, nu), nearest(pin / fine.nu, fine.nv, nv)));
  std::ranges::sort(out.pins);
  out.pins.erase(std::unique(out.pins.begin(), out.pins.end()), out.pins.end());
  const auto has = [&](Family family) {
    return std::ranges::any_of(scene.links, [&](const Link& l) { return l.family == family; });
  };
  out.links = grid_links(mesh, {has(Family::structural), has(Family::shear), has(Family::bend)});
  return out;
}

struct RestingSprings::Work {
  explicit Work(const Scene& of)
      : scene(of),
        w(inverse_masses(of)),
        springs(springs_of(of, w, link_of)),
        hessian(springs, none, w, true, widest()) {
    const auto halved = [](int n) { return n > 2 ? std::max(2, (n - 1) / 2 + 1) : n; };
    if (!of.mesh.grid || of.mesh.grid->size() <= kDirect) return;
    coarse = std::make_unique<Work>(
        coarse_sheet(of, halved(of.mesh.grid->nu), halved(of.mesh.grid->nv)));
    from = links_between(scene, coarse->scene);
  }
  Work(const Work&) = delete;  // the Hessian refers to springs

  static std::vector<Spring> springs_of(const Scene& scene, const std::vector<double>& w,
                                        std::vector<std::size_t>& link_of) {
    std::vector<Spring> springs;
    for (std::size_t j = 0; j < scene.links.size(); ++j)
      if (const Link& l = scene.links[j]; w[to_index(l.a)] + w[to_index(l.b)] > 0) {
        springs.push_back({to_index(l.a), to_index(l.b), l.rest, 0});
        link_of.push_back(j);
      }
    return springs;
  }

  /// Forces [N] on the vertices that move, and the springs' `excess`.
  Vector forces(const Points& x) {
    Vector f = weight;
    for (std::size_t j = 0; j < springs.size(); ++j) {
      const auto& [a, b, rest, k] = springs[j];
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      excess[j] = length - rest;
      if (length == 0) continue;
      const Vec3 pull = k * excess[j] / length * d;
      if (const int c = hessian.column(a); c >= 0) f.segment<3>(c) += pull;
      if (const int c = hessian.column(b); c >= 0) f.segment<3>(c) -= pull;
    }
    return f;
  }

  void put_on(std::span<const double> load) {
    weight = Vector::Zero(hessian.size());
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] > 0)
        weight.segment<3>(hessian.column(i)) = (load.empty() ? 1 : load[i]) / w[i] * scene.gravity;
  }

  Rest rest(std::span<const double> stiffness, const Rest* near, std::span<const double> load) {
    put_on(load);
    for (std::size_t j = 0; j < springs.size(); ++j) springs[j].stiffness = stiffness[link_of[j]];
    excess.assign(springs.size(), 0);
    Rest now;
    if (near)
      now = *near;
    else if (coarse)
      now = prolonged(stiffness, load);
    else
      now = {scene.start.x, {}, 0, 0, false};
    const Rest first = now;
    int solves = 0;
    for (const double longer : kLonger) {
      now = first;
      approach(now, longer);
      solves += now.solves;
      if (now.found) break;
    }
    now.solves = solves;
    return now;
  }

  void approach(Rest& now, double longer) {
    const double soonest = std::sqrt(kFirstWay * extent(scene) / scene.gravity.norm());
    double h = now.tension.empty() ? soonest : soonest * kLater;
    now.tension.resize(scene.links.size());
    now.solves = 0;
    now.found = false;
    Vector f = forces(now.x);
    while (!now.found && now.solves < kMostSolves) {
      const double before = f.norm() / weight.norm(), tension = norm(now.tension);
      if (!solve(now, f, h)) break;
      f = forces(now.x);
      now.unbalanced = f.norm() / weight.norm();
      now.found = now.unbalanced <= kBalanced ||
                  (now.unbalanced <= kQuick * before &&
                   std::abs(norm(now.tension) - tension) <= kSettled * tension);
      h *= longer;
    }
  }
  static double norm(const std::vector<double>& all) {
    double sum = 0;
    for (const double one : all) sum += one * one;
    return std::sqrt(sum);
  }

  /// One linear system. Returns false if the matrix has no factor.
  bool solve(Rest& now, const Vector& f, double h) {
    for (std::size_t j = 0; j < springs.size(); ++j) {
      const Vec3 d = now.x[springs[j].b] - now.x[springs[j].a];
      const double length = d.norm();
      const double across = length > 0 ? std::max(0.0, now.tension[link_of[j]]) / length : 0;
      hessian.block(j) = {across, springs[j].stiffness - across,
                          length > 0 ? Vec3(d / length) : Vec3(Vec3::UnitX())};
    }
    ++now.solves;
    if (!hessian.solve(h, f, way) || !way.allFinite()) return false;
    const auto way_of = [&](std::size_t v) -> Vec3 {
      const int c = hessian.column(v);
      return c < 0 ? Vec3(Vec3::Zero()) : Vec3(way.segment<3>(c));
    };
    for (std::size_t j = 0; j < springs.size(); ++j)
      now.tension[link_of[j]] =
          springs[j].stiffness *
          (excess[j] + hessian.block(j).u.dot(way_of(springs[j].b) - way_of(springs[j].a)));
    for (std::size_t i = 0; i < w.size(); ++i) now.x[i] += way_of(i);
    return true;
  }

  /// The rest of the coarser sheet, brought to this one.
  Rest prolonged(std::span<const double> stiffness, std::span<const double> load) {
    std::vector<double> sum(from.size() ? coarse->scene.links.size() : 0), count(sum.size());
    std::vector<double> of_coarse(sum.size());
    double mean = 0;
    for (const double k : stiffness) mean += k / static_cast<double>(stiffness.size());
    for (std::size_t j = 0; j < from.size(); ++j)
      if (from[j] < sum.size()) {
        sum[from[j]] += stiffness[j];
        ++count[from[j]];
      }
    for (std::size_t j = 0; j < sum.size(); ++j)
      of_coarse[j] = count[j] > 0 ? sum[j] / count[j] : mean;
    const Grid &fine = *scene.mesh.grid, &grid = *coarse->scene.mesh.grid;
    std::vector<double> of_vertices;
    for (int j = 0; j < (load.empty() ? 0 : grid.nv); ++j)
      for (int i = 0; i < grid.nu; ++i)
        of_vertices.push_back(
            load[to_index(fine.index(nearest(i, grid.nu, fine.nu), nearest(j, grid.nv, fine.nv)))]);
    const Rest below = coarse->rest(of_coarse, nullptr, of_vertices);
    Points way_below = below.x;
    for (std::size_t i = 0; i < way_below.size(); ++i) way_below[i] -= coarse->scene.start.x[i];
    Rest out{scene.start.x, std::vector<double>(scene.links.size()), 0, 0, false};
    for (int j = 0; j < fine.nv; ++j)
      for (int i = 0; i < fine.nu; ++i)
        if (const std::size_t at = to_index(fine.index(i, j)); w[at] > 0)
          out.x[at] += between(way_below, grid, i, j, fine);
    for (std::size_t j = 0; j < from.size(); ++j)
      if (from[j] < sum.size())
        out.tension[j] =
            below.tension[from[j]] * scene.links[j].rest / coarse->scene.links[from[j]].rest;
    return out;
  }

  Scene scene;
  std::vector<double> w;             ///< 1/kg
  std::vector<std::size_t> link_of;  ///< [springs]
  std::vector<Spring> springs;       ///< links that can change their length
  std::vector<BendingElement> none;
  Hessian hessian;
  Vector weight, way;             ///< N, m
  std::vector<double> excess;     ///< m, at x
  std::unique_ptr<Work> coarse;   ///< null: the sheet is small, or no grid
  std::vector<std::size_t> from;  ///< [links] those of `coarse`; its number of links: none
};

RestingSprings::RestingSprings(const Scene& scene) : work_(std::make_unique<Work>(scene)) {}
RestingSprings::~RestingSprings() = default;
RestingSprings::Rest RestingSprings::rest(std::span<const double> stiffness, const Rest* near,
                                          std::span<const double> load) {
  return work_->rest(stiffness, near, load);
}

}  // namespace taut::reference
