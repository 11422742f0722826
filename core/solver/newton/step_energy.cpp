#include "core/solver/newton/step_energy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/solver/contact/body_features.hpp"

namespace taut::solver::implicit {

namespace {

/// Calls visit(corner, weight) for the corners whose weight is not 0.
template <class Visit>
void each_corner(const TouchingPiece& piece, const Visit& visit) {
  for (std::size_t c = 0; c < 3; ++c)
    if (const double weight = piece.weights[static_cast<Eigen::Index>(c)]; weight != 0)
      visit(c, weight);
}

/// An edge that turns at a round collider rolls on it. Its gap is the least over its points, f(s):
/// the gap's Hessian has -v v^T / f'' for that, where v is the derivative of f' by the corners.
/// Returns push / f'' [N/m^2]; 0 if the piece does not roll.
double rolling_stiffness(const TouchingPiece& piece, const Vec3& along, double push) {
  if (!is_edge(piece.corners) || push <= 0) return 0;
  const double bends =
      along.dot(piece.turning * along) + 1e-3 * along.squaredNorm() * piece.turning.trace();
  return bends > 0 ? push / bends : 0;
}

/// Pairs of vertices between which the membrane, or contact of faces and edges, acts; empty if the
/// scene has neither.
std::vector<std::pair<int, int>> sides_of_faces(const loop::Setup& s) {
  std::vector<std::pair<int, int>> sides;
  const bool contact = !s.scene.colliders.empty() && !s.params.is("faces", "off");
  if (!contact && !s.scene.membrane) return sides;
  for (const Triangle& face : s.scene.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(face[k], face[(k + 1) % 3]);
  return sides;
}

}  // namespace

StepEnergy::StepEnergy(const loop::Setup& s, bool factored)
    : springs(
          stiffened(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params)), link_damping(s))),
      damped(link_damping(s), springs),
      bending(make_bending(s.scene)),
      membrane(make_membrane(s.scene, s.scene.dt / s.params.integer("substeps"))),
      hessian(springs, bending, s.w, factored, s.simd, sides_of_faces(s)),
      stiffness(s.w.size()),
      contacts(s.scene, s.params) {
  for (const Spring& spring : springs) {
    stiffness[spring.a] += spring.stiffness;
    stiffness[spring.b] += spring.stiffness;
  }
  for (const BendingElement& e : bending)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < e.size; ++j)
        stiffness[to_index(e.vertex[i])] += e.stiffness * std::abs(e.weight[i] * e.weight[j]);
  membrane.add_stiffness(stiffness);
}

double StepEnergy::energy(const std::vector<Vec3>& x, double h) const {
  double sum = bending_energy(bending, x) + membrane.energy(x);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (hessian.column(i) >= 0) sum += hessian.mass(i) / (2 * h * h) * (x[i] - y[i]).squaredNorm();
  for (const auto& [a, b, rest, k] : springs) {
    const double c = (x[b] - x[a]).norm() - rest;
    sum += k / 2 * c * c;
  }
  contacts.each(x, [&](std::size_t, const AugmentedContacts::Part& part) { sum += part.energy; });
  contacts.each_piece(
      x, [&](const TouchingPiece&, const AugmentedContacts::Part& part) { sum += part.energy; });
  return sum;
}

Vector StepEnergy::gradient(const std::vector<Vec3>& x, double h) const {
  Vector g = elastic(x);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (const int c = hessian.column(i); c >= 0)
      g.segment<3>(c) += hessian.mass(i) / (h * h) * (x[i] - y[i]);
  return g;
}

Vector StepEnergy::elastic(const std::vector<Vec3>& x) const {
  Vector g = Vector::Zero(hessian.size());
  for (const auto& [a, b, rest, k] : springs) {
    const Vec3 d = x[b] - x[a];
    const double length = d.norm();
    if (length == 0) continue;  // there is no direction to push in
    const Vec3 pull = k * (length - rest) / length * d;
    if (hessian.column(a) >= 0) g.segment<3>(hessian.column(a)) -= pull;
    if (hessian.column(b) >= 0) g.segment<3>(hessian.column(b)) += pull;
  }
  for (const BendingElement& e : bending) {
    const Vec3 pull = e.stiffness * e.value([&](std::size_t v) { return x[v]; });
    for (std::size_t i = 0; i < e.size; ++i)
      if (const int c = hessian.column(to_index(e.vertex[i])); c >= 0)
        g.segment<3>(c) += e.weight[i] * pull;
  }
  for (const MembraneElement& e : membrane.elements)
    membrane.add_forces(
        e, [&](std::size_t v) { return x[v]; },
        [&](std::size_t v, const Vec3& force) {
          if (const int c = hessian.column(v); c >= 0) g.segment<3>(c) -= force;
        });
  contacts.each(x, [&](std::size_t vertex, const AugmentedContacts::Part& part) {
    g.segment<3>(hessian.column(vertex)) -= part.force;
  });
  contacts.each_piece(x, [&](const TouchingPiece& piece, const AugmentedContacts::Part& part) {
    each_corner(piece, [&](std::size_t c, double weight) {
      if (const int column = hessian.column(to_index(piece.corners[c])); column >= 0)
        g.segment<3>(column) -= weight * part.force;
    });
  });
  return g;
}

double StepEnergy::in_norm_of_masses(const Vector& g) const {
  double sum = 0;
  for (std::size_t i = 0; i < stiffness.size(); ++i)
    if (const int c = hessian.column(i); c >= 0)
      sum += g.segment<3>(c).squaredNorm() / hessian.mass(i);
  return std::sqrt(sum);
}

void StepEnergy::linearise(const std::vector<Vec3>& x, bool clamped) {
  for (std::size_t j = 0; j < springs.size(); ++j) {
    const auto& [a, b, rest, k] = springs[j];
    const Vec3 d = x[b] - x[a];
    const double length = d.norm();
    if (length == 0) {
      hessian.block(j) = {k, 0, Vec3::UnitX()};
      continue;
    }
    const double across = 1 - rest / length;
    const double c = clamped ? std::max(0.0, across) : across;
    hessian.block(j) = {k * c, k * (1 - c), d / length};
  }
  hessian.clear_membrane();
  hessian.clear_contacts();
  for (const MembraneElement& e : membrane.elements)
    membrane.add_second(
        e, [&](std::size_t v) { return x[v]; }, clamped,
        [&](std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
          hessian.add_membrane(a, b, block);
        });
  contacts.each(x, [&](std::size_t vertex, const AugmentedContacts::Part& part) {
    hessian.add_contact(vertex, part.hessian);
  });
  if (!clamped)
    contacts.each_turning(x, [&](std::size_t vertex, const Eigen::Matrix3d& turning) {
      hessian.add_contact(vertex, turning);
    });
  contacts.each_piece(x, [&](const TouchingPiece& piece, const AugmentedContacts::Part& part) {
    const double push = part.force.dot(piece.at.normal);
    const Vec3 along = x[to_index(piece.corners[1])] - x[to_index(piece.corners[0])];
    const double rolls = rolling_stiffness(piece, along, push);
    const Vec3 turn = piece.turning * along;
    each_corner(piece, [&](std::size_t c, double weight) {
      each_corner(piece, [&](std::size_t d, double other) {
        const std::size_t a = to_index(piece.corners[c]), b = to_index(piece.corners[d]);
        if (d > c) return;
        Eigen::Matrix3d block = weight * other * part.hessian;
        if (!clamped) block -= push * weight * other * piece.turning;
        if (rolls > 0) {
          const Vec3 u = (c == 0 ? -1 : 1) * piece.at.normal + weight * turn,
                     v = (d == 0 ? -1 : 1) * piece.at.normal + other * turn;
          block += rolls * u * v.transpose();
        }
        hessian.add_contact(a, b, block);
      });
    });
  });
}

Vector StepEnergy::way_to_y(const std::vector<Vec3>& x) const {
  Vector way(hessian.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (const int c = hessian.column(i); c >= 0) way.segment<3>(c) = y[i] - x[i];
  return way;
}

std::vector<Vec3> StepEnergy::moved(std::vector<Vec3> x, const Vector& direction,
                                    double step) const {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (const int c = hessian.column(i); c >= 0) x[i] += step * direction.segment<3>(c);
  return x;
}

}  // namespace taut::solver::implicit
