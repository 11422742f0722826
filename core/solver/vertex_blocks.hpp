#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/model/adjacency.hpp"
#include "core/model/bending.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"

namespace taut {

/// x of a x = b for a symmetric positive definite matrix, by Cramer's rule.
inline Vec3 solve_symmetric(const Eigen::Matrix3d& a, const Vec3& b) {
  const Vec3 r0 = a.col(0), r1 = a.col(1), r2 = a.col(2);
  const auto cross = [](const Vec3& p, const Vec3& q) {
    return Vec3(p.y() * q.z() - p.z() * q.y(), p.z() * q.x() - p.x() * q.z(),
                p.x() * q.y() - p.y() * q.x());
  };
  const Vec3 c = cross(r1, r2);
  const double determinant = r0.dot(c);
  return Vec3(b.dot(c), r0.dot(cross(b, r2)), r0.dot(cross(r1, b))) / determinant;
}

/// Sweeps of solvers that move one vertex at a time to the minimum of a quadratic model in its own
/// three coordinates, all others held: colour after colour, no two vertices of a colour linked or
/// in one bending element, so that threads divide a colour and any number of them computes the same
/// bits.
class VertexBlocks {
 public:
  /// By the parameter `order`: colours, or the scene's order, one vertex after the other.
  VertexBlocks(const loop::Setup& s, const std::vector<Spring>& springs)
      : springs_(springs),
        bending_(make_bending(s.scene)),
        contacts_(make_contacts(s.scene, s.params)),
        bent_(bending_.empty() ? 0 : s.w.size()),
        ends_(links_of(springs), static_cast<int>(s.w.size())),
        pool_(s.pool) {
    const std::span<const double> w = s.w;
    const bool coloured = s.params.is("order", "coloured");
    for (std::size_t k = 0; k < bending_.size(); ++k)
      for (std::size_t i = 0; i < bending_[k].size; ++i)
        bent_[to_index(bending_[k].vertex[i])].push_back({k, i});
    std::vector<int> colour_of(w.size(), -1);
    for (std::size_t i = 0; i < w.size(); ++i) {
      if (w[i] == 0) continue;
      std::size_t colour = 0;
      if (coloured) {
        const auto taken = [&](std::size_t c) {
          const auto has = [&](int v) { return colour_of[to_index(v)] == static_cast<int>(c); };
          return std::ranges::any_of(ends_.of(static_cast<int>(i)), has, &Adjacency::End::vertex) ||
                 (!bent_.empty() && std::ranges::any_of(bent_[i], [&](const Bent& b) {
                   const auto& [n, vertices, unused, stiffness] = bending_[b.element];
                   return std::any_of(vertices.begin(), vertices.begin() + static_cast<long>(n),
                                      has);
                 }));
        };
        while (taken(colour)) ++colour;
      } else {
        colour = colours_.size();
      }
      colour_of[i] = static_cast<int>(colour);
      if (colour == colours_.size()) colours_.emplace_back();
      colours_[colour].push_back(i);
    }
  }

  std::size_t colours() const { return colours_.size(); }

  void restart() {
    if (contacts_) contacts_->restart();
  }
  /// p.x is where the sweeps start; what touches a collider starts where contact alone would leave
  /// it (Contacts::predict). Sweeps would bring that about slowly, against stiff links.
  void begin(Particles<double>& p, const std::vector<Vec3>& y, double t, double h) {
    if (!contacts_) return;
    contacts_->begin(t, h);
    contacts_->predict(p, y, h);
  }

  /// One sweep: solve(i, x_i, links) returns where vertex i goes, links(visit) calls visit(j, u, C)
  /// for each of its links j, u the unit vector from i towards the other end, C [m] its stretch.
  template <class Solve>
  void sweep(Particles<double>& p, const Solve& solve) {
    for (const std::vector<std::size_t>& colour : colours_)
      pool_.run(
          colour.size(),
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = begin; c < end; ++c) {
              const std::size_t i = colour[c];
              const Vec3 x = p.x[i];
              p.x.set(i, solve(i, x, [&](const auto& visit) {
                        for (const Adjacency::End& e : ends_.of(static_cast<int>(i))) {
                          const Vec3 d = p.x[to_index(e.vertex)] - x;
                          const double length = d.norm();
                          if (length == 0) continue;  // no direction to pull in
                          const std::size_t j = to_index(e.link);
                          visit(j, Vec3(d / length), length - springs_[j].rest, length);
                        }
                      }));
            }
          },
          colour.size() >= ThreadPool::kWorthSharing / 8);
  }

  /// Adds the bending of vertex i at x: what it pulls with [N], and its part of the Hessian [N/m],
  /// which is that number times unity.
  void add_bending(const Particles<double>& p, std::size_t i, Vec3& force,
                   Eigen::Matrix3d& hessian) const {
    if (bent_.empty()) return;
    for (const Bent& b : bent_[i]) {
      const BendingElement& e = bending_[b.element];
      const double pull = e.stiffness * e.weight[b.place];
      force -= pull * e.value([&](std::size_t v) { return p.x[v]; });
      hessian.diagonal().array() += pull * e.weight[b.place];
    }
  }

  /// Where vertex i at x goes by `force` [N] and its `hessian` [N/m], kept out of the colliders:
  /// the minimum of the quadratic model on their outer side, with friction.
  Vec3 minimum(const Particles<double>& p, std::size_t i, const Vec3& x, const Vec3& force,
               const Eigen::Matrix3d& hessian) {
    if (!contacts_) return x + solve_symmetric(hessian, force);
    const Vec3 previous = p.previous[i];
    Vec3 to = x + solve_symmetric(hessian, force + contacts_->force_at(i, x, previous));
    contacts_->settle_vertex(i, hessian, previous, to);
    return to;
  }

  std::size_t bytes() const {
    return bending_.size() * sizeof(BendingElement) + (contacts_ ? contacts_->bytes() : 0) +
           springs_.size() * (sizeof(Spring) + 2 * sizeof(Adjacency::End)) +
           ends_.size() * (sizeof(int) + sizeof(std::size_t));
  }

 private:
  static std::vector<Link> links_of(const std::vector<Spring>& springs) {
    std::vector<Link> links;
    for (const Spring& s : springs)
      links.push_back({static_cast<int>(s.a), static_cast<int>(s.b), s.rest, Family::structural});
    return links;
  }
  struct Bent {
    std::size_t element, place;  ///< the vertex is its place-th
  };
  const std::vector<Spring>& springs_;
  std::vector<BendingElement> bending_;
  std::unique_ptr<Contacts> contacts_;   ///< null: none
  std::vector<std::vector<Bent>> bent_;  ///< [n] elements of each vertex; empty: no bending
  Adjacency ends_;
  std::vector<std::vector<std::size_t>> colours_;
  ThreadPool& pool_;
};

/// Where a substep's iterations start (VBD, section 3.7): y without that part of gravity that did
/// not act in the last substep because something held the vertex, which then fell short of its y.
class AdaptiveStart {
 public:
  AdaptiveStart(const Scene& scene, bool on)
      : gravity_(scene.gravity), on_(on && gravity_.norm() > 0) {}
  void restart() { y_.clear(); }

  /// p.x is y, p.previous x_t.
  void begin(Particles<double>& p, double h) {
    if (!on_) return;
    const double g = gravity_.norm();
    const Vec3 down = gravity_ / g;
    const std::vector<Vec3> before = std::exchange(y_, positions(p));
    for (std::size_t i = 0; i < before.size(); ++i)
      if (p.w[i] > 0)
        p.x.add(i, std::clamp((p.previous[i] - before[i]).dot(down), -g * h * h, 0.0) * down);
  }
  std::size_t bytes() const { return y_.size() * sizeof(Vec3); }

 private:
  Vec3 gravity_;
  bool on_;
  std::vector<Vec3> y_;  ///< m, of the last substep; empty: there was none
};

inline constexpr ParamSpec kVertexOrder =
    ParamSpec::choice("order", "coloured", "coloured|mesh",
                      "vertices colour after colour, which threads can divide, or in the scene's "
                      "order");
inline constexpr ParamSpec kAdaptiveStart = ParamSpec::choice(
    "start", "adaptive", "adaptive|inertia",
    "where iterations start: without the part of gravity that did not act in the "
    "last substep, as published, so that what too few sweeps lose of a fall stays "
    "lost; or where the vertices would go without links");

}  // namespace taut
