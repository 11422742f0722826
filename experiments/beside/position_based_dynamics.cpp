// PositionBasedDynamics: its XPBD projection of a distance, called in our own loop over the links
// in their order; its own controller needs the libraries that its build fetches.
#include <Common/Common.h>
#include <PositionBasedDynamics/XPBD.h>

#include <cassert>

#include "beside.hpp"

namespace {

class Sheet {
 public:
  explicit Sheet(const beside::Net& net) : net_(net), lambda_(net.links.size()) {
    for (const auto& p : net.points)
      x_.emplace_back(static_cast<Real>(p.x), static_cast<Real>(p.y), static_cast<Real>(p.z));
    before_ = x_;
    w_.assign(x_.size(), static_cast<Real>(1 / net.mass));
    for (const int pin : net.pins) w_[static_cast<std::size_t>(pin)] = 0;
  }

  void step(int iterations) {
    const Real h = static_cast<Real>(beside::Net::kStep);
    const Vector3r fall(0, static_cast<Real>(-beside::Net::kGravity) * h * h, 0);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (w_[i] == 0) continue;
      const Vector3r now = x_[i];
      x_[i] = now + (now - before_[i]) + fall;
      before_[i] = now;
    }
    lambda_.assign(lambda_.size(), 0);
    for (int k = 0; k < iterations; ++k) sweep(h);
  }
  double lowest() const {
    Real least = x_[0].y();
    for (const Vector3r& x : x_) least = std::fmin(least, x.y());
    return least;
  }

 private:
  void sweep(Real h) {
    const Real stiffness = static_cast<Real>(beside::Net::kStiffness);
    for (std::size_t i = 0; i < net_.links.size(); ++i) {
      const auto& link = net_.links[i];
      const auto a = static_cast<std::size_t>(link.a), b = static_cast<std::size_t>(link.b);
      Vector3r move_a, move_b;
      if (!PBD::XPBD::solve_DistanceConstraint(x_[a], w_[a], x_[b], w_[b],
                                               static_cast<Real>(link.rest), stiffness, h,
                                               lambda_[i], move_a, move_b))
        continue;
      x_[a] += move_a;
      x_[b] += move_b;
    }
  }

  beside::Net net_;
  std::vector<Vector3r> x_, before_;
  std::vector<Real> w_, lambda_;
};

}  // namespace

int main() { return beside::serve<Sheet>(); }
