#pragma once

#include <vector>

#include "core/solver/distance.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// One Gauss-Seidel sweep over the links of a family, in the order in which the scene lists them.
template <class Real, Projection kind>
class LinkPass final : public Pass<Real> {
 public:
  LinkPass(std::string name, std::vector<Link> links) : name_(std::move(name)) {
    links_.reserve(links.size());
    for (const Link& l : links) {
      const Real rest = static_cast<Real>(l.rest);
      links_.push_back({l.a, l.b, rest, rest * rest});
    }
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Stick& stick : links_) {
      Vec4<Real>&x1 = p.x[static_cast<std::size_t>(stick.a)],
      &x2 = p.x[static_cast<std::size_t>(stick.b)];
      const Real dx = x2.x - x1.x, dy = x2.y - x1.y, dz = x2.z - x1.z;
      const Real f =
          excess<kind>(dx * dx + dy * dy + dz * dz, stick.rest, stick.rest2) / (x1.w + x2.w);
      const Real f1 = x1.w * f, f2 = x2.w * f;
      x1.x += f1 * dx, x1.y += f1 * dy, x1.z += f1 * dz;
      x2.x -= f2 * dx, x2.y -= f2 * dy, x2.z -= f2 * dz;
    }
  }

  PassCost cost() const override {
    return {.pass = name_,
            .items = links_.size(),
            .bytes = links_.size() * sizeof(Stick),
            .projections = true};
  }

 private:
  struct Stick {
    int a, b;
    Real rest, rest2;
  };
  std::string name_;
  std::vector<Stick> links_;
};

}  // namespace taut
