#include "core/solver/contact/augmented_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

using Eigen::Matrix3d;

void AugmentedContacts::forget() {
  if (contacts_) contacts_->restart();
}

void AugmentedContacts::begin(double t, double h) {
  if (!contacts_) return;
  contacts_->begin(t, h);
  pace_ = {};
  met_.assign(stiffness_.size() * contacts_->colliders(), {});
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

Matrix3d AugmentedContacts::turning(const TouchingVertex& at, const Vec3& x) const {
  constexpr double kWay = 1e-6;  // m
  Matrix3d out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vec3 way = kWay * Vec3::Unit(axis);
    out.col(axis) = (laid(at, x + way).normal - laid(at, x - way).normal) / (2 * kWay);
  }
  return (out + out.transpose()) / 2;
}

AugmentedContacts::Part AugmentedContacts::push_of(const TouchingVertex& at,
                                                   const ContactForce& held, double k,
                                                   const Vec3& x) {
  const double push = held.push - k * at.gap(x);
  if (push <= 0) return {};
  const Matrix3d along = at.normal * at.normal.transpose();
  return {push * push / (2 * k), push * at.normal, k * along};
}

AugmentedContacts::Part AugmentedContacts::rub_of(const TouchingVertex& at,
                                                  const ContactForce& held, double k,
                                                  const Vec3& x) {
  const Vec3 rub = held.rub - k * at.slip(x);
  const FrictionCone cone = at.cone(rub, held.push);
  const auto [length, most] = cone;
  if (most == 0) return {};
  const Matrix3d across = Matrix3d::Identity() - at.normal * at.normal.transpose();
  if (cone.sticks()) return {length * length / (2 * k), rub, k * across};
  const Vec3 u = rub / length;
  return {most / k * (length - most / 2), most * u,
          k * most / length * (across - u * u.transpose())};
}

template <class Real>
bool AugmentedContacts::update(const Particles<Real>& p, const std::vector<Vec3>& x, double h,
                               double left, double rounding) {
  if (!contacts_) return false;
  pieces_.changed = false;
  pieces_.left = left;
  pieces_.rounding = rounding;
  find(p);
  acting_.clear();
  double change2 = 0;
  for (const TouchingVertex& at : touching_) {
    ContactForce& held = contacts_->force(at.vertex, at.collider);
    const double gap = at.gap(x[at.vertex]);
    ContactForce now = held;
    bool& pushed = met_[at.vertex * contacts_->colliders() + at.collider].pushed;
    if (!held.holds() && !std::exchange(pushed, true)) {
      held.push = now.push = std::max(0.0, -gap) / (static_cast<double>(p.w[at.vertex]) * h * h);
      change2 += now.push * now.push;
    } else {
      now = augmented(at, held, stiffness_[at.vertex], x[at.vertex]);
      change2 += (at.total(now) - at.total(held)).squaredNorm();
    }
    acting_.push_back(now);
  }
  const double change = std::sqrt(change2);
  if (left <= kSettled * change) {
    const double share = pace_.share(change);
    for (std::size_t c = 0; c < acting_.size(); ++c) {
      ContactForce& held = contacts_->force(touching_[c].vertex, touching_[c].collider);
      held.push += share * (acting_[c].push - held.push);
      held.rub += share * (acting_[c].rub - held.rub);
    }
  }
  return change > rounding;
}
template bool AugmentedContacts::update(const Particles<float>&, const std::vector<Vec3>&, double,
                                        double, double);
template bool AugmentedContacts::update(const Particles<double>&, const std::vector<Vec3>&, double,
                                        double, double);

template <class Real>
void AugmentedContacts::leave(Particles<Real>& p) {
  find(p);
  for (TouchingVertex at : touching_) {
    Vec3 x = p.x[at.vertex].template cast<double>();
    contacts_->lay(at, x);
    const double depth = -at.gap(x);
    if (depth <= 0) continue;
    x += depth * at.normal;
    const Vec3 slip = at.slip(x);
    x -= at.cone(slip, depth).share() * slip;
    p.x.set(at.vertex, x.cast<Real>());
  }
}
template void AugmentedContacts::leave(Particles<float>&);
template void AugmentedContacts::leave(Particles<double>&);

}  // namespace taut
