#include "core/solver/newton/hessian.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace taut::solver::implicit {

using Eigen::Matrix3d;

Hessian::Hessian(const std::vector<Spring>& springs, const std::vector<BendingElement>& bending,
                 std::span<const double> w, bool factored, Simd simd,
                 std::span<const std::pair<int, int>> beside)
    : springs_(springs), bending_(bending), column_(w.size(), kPinned), blocks_(springs.size()) {
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) {
      column_[i] = 3 * static_cast<int>(mass_.size());
      mass_.push_back(1 / w[i]);
    }
  if (factored) analyse(simd, beside);
}

/// Calls add(row, column, k [N/m]) for every entry of the bending elements, whose Hessian is
/// constant, in the lower triangle.
template <class Add>
void Hessian::each_bending(const Add& add) const {
  for (const BendingElement& e : bending_)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < e.size; ++j) {
        const int row = column_[to_index(e.vertex[i])], column = column_[to_index(e.vertex[j])];
        for (int c = 0; c < 3 && row >= column && column >= 0; ++c)
          add(row + c, column + c, e.stiffness * e.weight[i] * e.weight[j]);
      }
}

bool Hessian::solve(double h, const Vector& right, Vector& p) {
  if (!factored()) return conjugate_gradients(h, right, p);
  fill(h);
  if (!factor_.factor()) return false;
  for (std::size_t k = 0; k < mass_.size(); ++k)
    in_order_.segment<3>(3 * static_cast<Eigen::Index>(k)) =
        right.segment<3>(3 * factor_.order()[k]);
  factor_.solve_one(in_order_.data());
  p.resize(right.size());
  for (std::size_t k = 0; k < mass_.size(); ++k)
    p.segment<3>(3 * factor_.order()[k]) = in_order_.segment<3>(3 * static_cast<Eigen::Index>(k));
  return true;
}

std::size_t Hessian::bytes() const {
  return factor_.bytes() + bent_.size() * sizeof bent_[0] + blocks_.size() * sizeof blocks_[0] +
         stretched_.size() * sizeof(PairBlock) +
         (diagonal_.size() + beside_.size()) * sizeof diagonal_[0] +
         static_cast<std::size_t>(in_order_.size()) * sizeof(double);
}

Hessian::Block Hessian::place(int column, int other) {
  if (column < 0 || other < 0) return {};
  const auto [low, high] = std::minmax({rank_[to_index(column) / 3], rank_[to_index(other) / 3]});
  double* const first = factor_.at(high, low);
  return {first, static_cast<std::size_t>(factor_.at(high, low, 1) - first)};
}

void Hessian::analyse(Simd simd, std::span<const std::pair<int, int>> beside) {
  std::vector<PanelFactor::Pair> pairs;
  const auto join = [&](std::size_t a, std::size_t b) {
    if (a != b && column_[a] >= 0 && column_[b] >= 0)
      pairs.push_back({column_[a] / 3, column_[b] / 3});
  };
  for (const Spring& s : springs_) join(s.a, s.b);
  for (const BendingElement& e : bending_)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < i; ++j) join(to_index(e.vertex[i]), to_index(e.vertex[j]));
  for (const auto& [a, b] : beside) join(to_index(a), to_index(b));
  factor_ = PanelFactor(mass_.size(), pairs, 3, simd);
  in_order_.resize(size());
  rank_.resize(mass_.size());
  for (std::size_t k = 0; k < rank_.size(); ++k) rank_[to_index(factor_.order()[k])] = k;
  for (int i = 0; i < size(); i += 3) diagonal_.push_back(place(i, i));
  for (const Spring& s : springs_) beside_.push_back(place(column_[s.a], column_[s.b]));
  each_bending([&](int row, int column, double k) {
    if (row % 3 == 0) bent_.emplace_back(place(row, column), k);
  });
}

void Hessian::add_diagonal(int column, const Matrix3d& block) {
  const Block& at = diagonal_[to_index(column) / 3];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) at(r, c) += block(r, c);
}

void Hessian::fill(double h) {
  factor_.clear();
  for (const auto& [at, k] : bent_)
    for (int c = 0; c < 3; ++c) at(c, c) += k;
  for (std::size_t i = 0; i < mass_.size(); ++i)
    for (int c = 0; c < 3; ++c) diagonal_[i](c, c) += mass_[i] / (h * h);
  for (std::size_t j = 0; j < springs_.size(); ++j) {
    const Matrix3d block = blocks_[j].matrix();
    for (const std::size_t v : {springs_[j].a, springs_[j].b})
      if (column_[v] >= 0) add_diagonal(column_[v], block);
    if (const Block& at = beside_[j]; at.first)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) at(r, c) -= block(r, c);
  }
  for (const auto& [a, b, block] : stretched_) {
    if (column_[a] < 0 || column_[b] < 0) continue;
    if (a == b) {
      add_diagonal(column_[a], block);
      continue;
    }
    const Block at = place(column_[a], column_[b]);
    const bool in_order = rank_[to_index(column_[a]) / 3] > rank_[to_index(column_[b]) / 3];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) at(r, c) += in_order ? block(r, c) : block(c, r);
  }
  for (const auto& [a, b, block] : contacts_) {
    if (column_[a] < 0 || column_[b] < 0) continue;
    if (a == b) {
      add_diagonal(column_[a], block);
      continue;
    }
    const Block at = place(column_[a], column_[b]);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) at(r, c) += block(r, c);
  }
}

Vector Hessian::times(double h, const Vector& v) const {
  Vector out = elastic_times(v);
  for (std::size_t i = 0; i < mass_.size(); ++i)
    out.segment<3>(3 * static_cast<int>(i)) +=
        mass_[i] / (h * h) * v.segment<3>(3 * static_cast<int>(i));
  return out;
}

/// Conjugate gradients to a residual of 1e-6 of the right-hand side, preconditioned by the inverse
/// blocks of the vertices. Returns false if it meets a direction along which the energy curves
/// down.
bool Hessian::conjugate_gradients(double h, const Vector& right, Vector& p) const {
  std::vector<Matrix3d> inverse(mass_.size());
  for (std::size_t i = 0; i < mass_.size(); ++i)
    inverse[i] = mass_[i] / (h * h) * Matrix3d::Identity();
  for (std::size_t j = 0; j < springs_.size(); ++j)
    for (const std::size_t v : {springs_[j].a, springs_[j].b})
      if (column_[v] >= 0) inverse[to_index(column_[v]) / 3] += blocks_[j].matrix();
  each_bending([&](int row, int column, double k) {
    if (row == column) inverse[to_index(row) / 3](row % 3, row % 3) += k;
  });
  for (const auto& [a, b, block] : stretched_)
    if (a == b && column_[a] >= 0) inverse[to_index(column_[a]) / 3] += block;
  for (const auto& [a, b, block] : contacts_)
    if (a == b && column_[a] >= 0) inverse[to_index(column_[a]) / 3] += block;
  for (Matrix3d& m : inverse) m = Matrix3d(m.inverse());
  const auto preconditioned = [&](const Vector& r) {
    Vector z(r.size());
    for (std::size_t i = 0; i < inverse.size(); ++i)
      z.segment<3>(3 * static_cast<int>(i)) = inverse[i] * r.segment<3>(3 * static_cast<int>(i));
    return z;
  };
  p = Vector::Zero(right.size());
  Vector r = right, z = preconditioned(r), d = z;
  double rz = r.dot(z);
  const double enough = 1e-6 * right.norm();
  for (Eigen::Index k = 0; k < 2 * right.size() && r.norm() > enough; ++k) {
    const Vector hd = times(h, d);
    const double curvature = d.dot(hd);
    if (!(curvature > 0) || !(rz > 0)) return false;
    const double step = rz / curvature;
    p += step * d;
    r -= step * hd;
    z = preconditioned(r);
    const double before = rz;
    rz = r.dot(z);
    d = z + rz / before * d;
  }
  return true;
}

}  // namespace taut::solver::implicit
