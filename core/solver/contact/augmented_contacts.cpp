#include "core/solver/newton/augmented_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace taut::solver::implicit {

namespace {

/// Of the stiffness of all else at a vertex, that of its contact; and of a change of the forces of
/// contact, the gradient that is left before they take it.
constexpr double kStiffness = 3, kSettled = 0.3;

}  // namespace

using Eigen::Matrix3d;

void AugmentedContacts::forget() {
  if (contacts_) contacts_->restart();
}

void AugmentedContacts::begin(double t, double h) {
  if (contacts_) contacts_->begin(t, h);
}

void AugmentedContacts::set_stiffness(const Particles<double>& p, std::span<const double> elastic,
                                      double h) {
  for (std::size_t i = 0; i < stiffness_.size(); ++i)
    if (p.w[i] > 0) stiffness_[i] = kStiffness * (elastic[i] + 1 / (p.w[i] * h * h));
}

AugmentedContacts::Part AugmentedContacts::part(const TouchingVertex& at, const Vec3& x) const {
  const ContactForce& held = contacts_->force(at.vertex, at.collider);
  const double k = stiffness_[at.vertex], push = held.push - k * at.gap(x);
  const Matrix3d along = at.normal * at.normal.transpose();
  Part out;
  if (push > 0) out = {push * push / (2 * k), push * at.normal, k * along};
  const Vec3 rub = held.rub - k * at.slip(x);
  const double length = rub.norm(), most = at.friction * held.push;
  if (most == 0) return out;
  const Matrix3d across = Matrix3d::Identity() - along;
  if (length <= most) {
    out.energy += length * length / (2 * k);
    out.force += rub;
    out.hessian += k * across;
  } else {
    const Vec3 u = rub / length;
    out.energy += most / k * (length - most / 2);
    out.force += most * u;
    out.hessian += k * most / length * (across - u * u.transpose());
  }
  return out;
}

void AugmentedContacts::add_energy(const std::vector<Vec3>& x, double& sum) const {
  for (const TouchingVertex& at : touching_) sum += part(at, x[at.vertex]).energy;
}

void AugmentedContacts::add_gradient(const std::vector<Vec3>& x, const Hessian& hessian,
                                     Vector& g) const {
  for (const TouchingVertex& at : touching_)
    g.segment<3>(hessian.column(at.vertex)) -= part(at, x[at.vertex]).force;
}

void AugmentedContacts::add_hessian(const std::vector<Vec3>& x, Hessian& hessian) const {
  hessian.clear_contacts();
  for (const TouchingVertex& at : touching_)
    hessian.add_contact(at.vertex, part(at, x[at.vertex]).hessian);
}

bool AugmentedContacts::update(const Particles<double>& p, double h, double left, double rounding) {
  if (!contacts_) return false;
  contacts_->find(p, touching_);
  acting_.clear();
  double change2 = 0;
  for (const TouchingVertex& at : touching_) {
    ContactForce& held = contacts_->force(at.vertex, at.collider);
    const Vec3 x = p.x[at.vertex];
    const double gap = at.gap(x);
    ContactForce now = held;
    if (!held.holds()) {
      held.push = now.push = std::max(0.0, -gap) / (p.w[at.vertex] * h * h);
      change2 += now.push * now.push;
    } else {
      const double k = stiffness_[at.vertex];
      now.push = std::max(0.0, held.push - k * gap);
      now.rub -= k * at.slip(x);
      const double length = now.rub.norm(), most = at.friction * now.push;
      if (length > most) now.rub *= most / length;
      change2 += (at.total(now) - at.total(held)).squaredNorm();
    }
    acting_.push_back(now);
  }
  const double change = std::sqrt(change2);
  if (left <= kSettled * change)
    for (std::size_t c = 0; c < acting_.size(); ++c)
      contacts_->force(touching_[c].vertex, touching_[c].collider) = acting_[c];
  return change > rounding;
}

}  // namespace taut::solver::implicit
