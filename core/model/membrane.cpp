#include "core/model/membrane.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace taut {

using Eigen::Matrix2d;
using Eigen::Matrix3d;

namespace {

/// The positive part of a symmetric matrix: without its negative eigenvalues.
Matrix2d positive_part(const Matrix2d& s) {
  const double mean = (s(0, 0) + s(1, 1)) / 2, half = (s(0, 0) - s(1, 1)) / 2, off = s(0, 1);
  const double radius = std::sqrt(half * half + off * off);
  if (mean >= radius) return s;
  if (mean <= -radius) return Matrix2d::Zero();
  Matrix2d larger;  // twice the projection on the larger eigenvalue's direction
  larger << 1 + half / radius, off / radius, off / radius, 1 - half / radius;
  return (mean + radius) / 2 * larger;
}

/// F = R T, with R the nearest rotation and T symmetric and not negative: for 2 x 2,
///
///     T = (F^T F + sqrt(det F^T F) I)/sqrt(tr F^T F + 2 sqrt(det F^T F))
struct Polar {
  Deformation rotation;
  Matrix2d inverse;  ///< T^-1
  double trace;      ///< of T
  Vec3 normal;
};
Polar polar(const Deformation& f) {
  const Matrix2d squared = f.transpose() * f;
  const Vec3 normal = f.col(0).cross(f.col(1));
  // a triangle without area is treated as one with this share of it
  const double size = squared.trace(), area = std::max(normal.norm(), 1e-12 * size);
  if (size == 0) return {Deformation::Identity(), Matrix2d::Identity(), 0, Vec3::UnitZ()};
  Polar p;
  p.trace = std::sqrt(size + 2 * area);
  const Matrix2d t = (squared + area * Matrix2d::Identity()) / p.trace;
  p.inverse << t(1, 1), -t(0, 1), -t(0, 1), t(0, 0);
  p.inverse /= area;
  p.rotation = f * p.inverse;
  p.normal = normal / area;
  return p;
}

/// Green's strain, in Voigt's order.
Vec3 green(const Deformation& f) {
  return {(f.col(0).squaredNorm() - 1) / 2, (f.col(1).squaredNorm() - 1) / 2,
          f.col(0).dot(f.col(1))};
}

}  // namespace

WarpAxes warp_axes(const std::array<Vec3, 3>& corners, const Vec3& warp) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  Vec3 along = warp - warp.dot(normal) / normal.squaredNorm() * normal;
  if (along.norm() < 1e-6) along = corners[1] - corners[0];
  along.normalize();
  return {along, normal.normalized().cross(along), normal.norm() / 2};
}

double most_poisson(const Membrane& m) { return std::sqrt(m.warp / m.weft); }

MembraneLaw::MembraneLaw(const Membrane& m, double stiffer)
    : law_(m.law), young_(stiffer * m.warp), stiffness_(Matrix3d::Zero()) {
  const double nu21 = m.poisson * m.weft / m.warp, rest = 1 - m.poisson * nu21;
  stiffness_.topLeftCorner<2, 2>() << m.warp / rest, nu21 * m.warp / rest, nu21 * m.warp / rest,
      m.weft / rest;
  stiffness_(2, 2) = m.shear;
  stiffness_ *= stiffer;
  if (law_ == Membrane::Law::arap) stiffness_ = young_ * Matrix3d::Identity();
}

MembraneLaw::Strain MembraneLaw::strain(const Deformation& f) const {
  Strain s;
  if (law_ == Membrane::Law::stvk) {
    s.value = green(f);
    s.by_f1 << f.col(0).transpose(), Vec3::Zero().transpose(), f.col(1).transpose();
    s.by_f2 << Vec3::Zero().transpose(), f.col(1).transpose(), f.col(0).transpose();
    return s;
  }
  // dT = R^T dF - w J T, with the turn w = (r1.df2 - r2.df1)/tr T that leaves it symmetric
  const Polar p = polar(f);
  const Matrix2d t = p.rotation.transpose() * f;
  const Eigen::RowVector3d r1 = p.rotation.col(0).transpose(), r2 = p.rotation.col(1).transpose();
  const double root = std::sqrt(2.0), off = t(0, 1) / p.trace;
  s.value = {t(0, 0) - 1, t(1, 1) - 1, root * t(0, 1)};
  s.by_f1 << r1 + off * r2, -off * r2, root * t(1, 1) / p.trace * r2;
  s.by_f2 << -off * r1, r2 + off * r1, root * t(0, 0) / p.trace * r1;
  return s;
}

double MembraneLaw::energy(const Deformation& f, const Vec3& rest) const {
  if (law_ == Membrane::Law::arap) return young_ / 2 * (f - polar(f).rotation).squaredNorm();
  const Vec3 e = green(f) - rest;
  return e.dot(stiffness_ * e) / 2;
}

Deformation MembraneLaw::stress(const Deformation& f, const Vec3& rest) const {
  if (law_ == Membrane::Law::arap) return young_ * (f - polar(f).rotation);
  const Vec3 s = stiffness_ * (green(f) - rest);
  Deformation p;
  p << s[0] * f.col(0) + s[2] * f.col(1), s[2] * f.col(0) + s[1] * f.col(1);
  return p;
}

MembraneLaw::Second MembraneLaw::second(const Deformation& f, bool positive,
                                        const Vec3& rest) const {
  const Vec3 f1 = f.col(0), f2 = f.col(1);
  const Matrix3d one = Matrix3d::Identity();
  if (law_ == Membrane::Law::arap) {
    // R does not follow a strain; it follows a turn in the plane, t = (r2, -r1)/sqrt 2, by
    // 2/tr T, and one out of the plane by T^-1
    const Polar p = polar(f);
    const Vec3 r1 = p.rotation.col(0), r2 = p.rotation.col(1);
    const Matrix3d out = p.normal * p.normal.transpose();
    const double turn = positive && p.trace < 2 ? 0.5 : 1 / p.trace;
    Matrix2d across = Matrix2d::Identity() - p.inverse;
    if (positive) across = positive_part(across);
    return {young_ * (one - out - turn * r2 * r2.transpose() + across(0, 0) * out),
            young_ * (turn * r2 * r1.transpose() + across(0, 1) * out),
            young_ * (one - out - turn * r1 * r1.transpose() + across(1, 1) * out)};
  }
  const Matrix3d& c = stiffness_;
  const Vec3 s = c * (green(f) - rest);
  Matrix2d stress;
  stress << s[0], s[2], s[2], s[1];
  if (positive) stress = positive_part(stress);
  return {c(0, 0) * f1 * f1.transpose() + c(2, 2) * f2 * f2.transpose() + stress(0, 0) * one,
          c(0, 1) * f1 * f2.transpose() + c(2, 2) * f2 * f1.transpose() + stress(0, 1) * one,
          c(1, 1) * f2 * f2.transpose() + c(2, 2) * f1 * f1.transpose() + stress(1, 1) * one};
}

double MembraneLaw::stiffest() const {
  const Matrix3d& c = stiffness_;
  const double half = (c(0, 0) - c(1, 1)) / 2;
  const double plane = (c(0, 0) + c(1, 1)) / 2 + std::sqrt(half * half + c(0, 1) * c(0, 1));
  const double shear = law_ == Membrane::Law::arap ? young_ : 2 * c(2, 2);
  return std::max(plane, shear);  // f1.f2 counts both sides
}

MembraneModel make_membrane(const Scene& scene) {
  MembraneModel model{MembraneLaw(scene.membrane.value_or(Membrane{.warp = 1, .weft = 1})), {}};
  if (!scene.membrane) return model;
  for (const Triangle& t : scene.mesh.triangles) {
    if (std::ranges::all_of(t, [&](int v) { return is_pinned(scene, v); })) continue;
    const std::array<Vec3, 3> corners{scene.mesh.rest[to_index(t[0])],
                                      scene.mesh.rest[to_index(t[1])],
                                      scene.mesh.rest[to_index(t[2])]};
    const WarpAxes axes = warp_axes(corners, scene.membrane->direction);
    Matrix2d sides;
    for (int k = 0; k < 2; ++k) {
      const Vec3 side = corners[to_index(k) + 1] - corners[0];
      sides.col(k) << axes.along.dot(side), axes.across.dot(side);
    }
    const Matrix2d rows = sides.inverse();
    MembraneElement& e = model.elements.emplace_back();
    e.vertex = t;
    e.area = axes.area;
    e.gradient[1] = rows.row(0);
    e.gradient[2] = rows.row(1);
    e.gradient[0] = -(e.gradient[1] + e.gradient[2]);
  }
  return model;
}

MembraneModel make_membrane(const Scene& scene, double h) {
  MembraneModel model = make_membrane(scene);
  if (!scene.membrane || scene.membrane->damping == 0) return model;
  const double q = scene.membrane->damping / h;
  model.law = MembraneLaw(*scene.membrane, 1 + q);
  model.share = q / (1 + q);
  model.rests.assign(model.elements.size(), Vec3::Zero());
  return model;
}

void MembraneModel::add_stiffness(std::vector<double>& at_vertex) const {
  for (const MembraneElement& e : elements) {
    double sum = 0;
    for (const Eigen::Vector2d& g : e.gradient) sum += g.norm();
    for (std::size_t a = 0; a < 3; ++a)
      at_vertex[to_index(e.vertex[a])] += e.area * law.stiffest() * e.gradient[a].norm() * sum;
  }
}

double MembraneModel::energy(const std::vector<Vec3>& x) const {
  double sum = 0;
  for (const MembraneElement& e : elements)
    sum += e.area * law.energy(e.deformation([&](std::size_t v) { return x[v]; }), rest(e));
  return sum;
}

std::optional<Membrane> membrane_of_links(const Scene& scene,
                                          const std::array<double, kFamilies.size()>& stiffness) {
  const auto& grid = scene.mesh.grid;
  if (!grid || grid->nu < 2 || grid->nv < 2) return {};
  const Vec3 u = scene.mesh.rest[1] - scene.mesh.rest[0],
             v = scene.mesh.rest[to_index(grid->nu)] - scene.mesh.rest[0];
  const double a = u.norm(), b = v.norm(), square = a * a + b * b;
  if (std::abs(u.dot(v)) > 1e-9 * a * b) return {};
  std::array<std::size_t, kFamilies.size()> own{}, whole{};
  std::array<double, kFamilies.size()> k{};
  for (const Link& l : scene.links) ++own[static_cast<std::size_t>(l.family)];
  for (const Link& l : grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true}))
    ++whole[static_cast<std::size_t>(l.family)];
  for (std::size_t f = 0; f < k.size(); ++f) {
    if (own[f] != 0 && own[f] != whole[f]) return {};
    k[f] = own[f] == 0 ? 0 : stiffness[f];
    if (std::isinf(k[f])) return {};
  }
  const auto [structural, shear, bend] = k;
  const double along_u =
      structural * a / b + 2 * shear * a * a * a / (b * square) + 4 * bend * a / b;
  const double along_v =
      structural * b / a + 2 * shear * b * b * b / (a * square) + 4 * bend * b / a;
  const double both = 2 * shear * a * b / square;
  if (both == 0) return {};
  return Membrane{.warp = along_v - both * both / along_u,
                  .weft = along_u - both * both / along_v,
                  .poisson = both / along_u,
                  .shear = both,
                  .direction = v / b};
}

}  // namespace taut
