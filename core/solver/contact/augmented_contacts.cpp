#include "core/solver/contact/augmented_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

using Eigen::Matrix3d;

void AugmentedContacts::forget() {
  if (contacts_) contacts_->restart();
}

void AugmentedContacts::begin(double t, double h) {
  if (contacts_) contacts_->begin(t, h);
}

template <class Real>
void AugmentedContacts::set_stiffness(const Particles<Real>& p, std::span<const double> elastic,
                                      double h) {
  for (std::size_t i = 0; i < stiffness_.size(); ++i)
    if (const auto w = static_cast<double>(p.w[i]); w > 0)
      stiffness_[i] = kOfElsewhere * (elastic[i] + 1 / (w * h * h));
  pieces_.stiffness = stiffness_;
}
template void AugmentedContacts::set_stiffness(const Particles<float>&, std::span<const double>,
                                               double);
template void AugmentedContacts::set_stiffness(const Particles<double>&, std::span<const double>,
                                               double);

AugmentedContacts::Part AugmentedContacts::part(const TouchingVertex& at, const ContactForce& held,
                                                double k, const Vec3& x) {
  const double push = held.push - k * at.gap(x);
  const Matrix3d along = at.normal * at.normal.transpose();
  Part out;
  if (push > 0) out = {push * push / (2 * k), push * at.normal, k * along};
  const Vec3 rub = held.rub - k * at.slip(x);
  const FrictionCone cone = at.cone(rub, held.push);
  const auto [length, most] = cone;
  if (most == 0) return out;
  const Matrix3d across = Matrix3d::Identity() - along;
  if (cone.sticks()) {
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

template <class Real>
bool AugmentedContacts::update(const Particles<Real>& p, const std::vector<Vec3>& x, double h,
                               double left, double rounding) {
  if (!contacts_) return false;
  pieces_.changed = false;
  pieces_.left = left;
  pieces_.rounding = rounding;
  contacts_->find(p, touching_);
  acting_.clear();
  double change2 = 0;
  for (const TouchingVertex& at : touching_) {
    ContactForce& held = contacts_->force(at.vertex, at.collider);
    const double gap = at.gap(x[at.vertex]);
    ContactForce now = held;
    if (!held.holds()) {
      held.push = now.push = std::max(0.0, -gap) / (static_cast<double>(p.w[at.vertex]) * h * h);
      change2 += now.push * now.push;
    } else {
      now = augmented(at, held, stiffness_[at.vertex], x[at.vertex]);
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
template bool AugmentedContacts::update(const Particles<float>&, const std::vector<Vec3>&, double,
                                        double, double);
template bool AugmentedContacts::update(const Particles<double>&, const std::vector<Vec3>&, double,
                                        double, double);

}  // namespace taut
