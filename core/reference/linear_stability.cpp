#include "core/reference/linear_stability.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/model/bending.hpp"
#include "core/model/index.hpp"
#include "core/model/membrane.hpp"
#include "core/reference/dense.hpp"

namespace taut {

namespace {

/// Most links of a dense sweep, whose eigenvalues cost n^3.
constexpr std::size_t kMostLinks = 128;

/// A link between two particles in linear theory.
struct Bar {
  int a, b;
  Eigen::Vector3d along;  ///< unit vector
  double stiffness;       ///< N/m
};

std::vector<Bar> bars(const Scene& scene, const std::vector<double>& w,
                      const std::array<double, kFamilies.size()>& stiffness) {
  std::vector<Bar> result;
  for (const Link& link : scene.links) {
    const Vec3 delta = scene.start.x[to_index(link.b)] - scene.start.x[to_index(link.a)];
    const double k = stiffness[static_cast<std::size_t>(link.family)];
    if (k > 0 && delta.norm() > 0 && w[to_index(link.a)] + w[to_index(link.b)] > 0)
      result.push_back({link.a, link.b, delta.normalized(), k});
  }
  return result;
}

/// Largest eigenvalue of a symmetric operator y = A x on R^n: Lanczos with full reorthogonalisation
/// (Golub & Van Loan, 10.3).
template <class Apply>
double largest_eigenvalue(Eigen::Index n, const Apply& apply) {
  const Eigen::Index most = std::min<Eigen::Index>(n, 100);
  Eigen::MatrixXd basis(n, most);
  Eigen::VectorXd diagonal(most), off(most);
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = std::sin(1.7 * static_cast<double>(i) + 0.3);
  x.normalize();
  Eigen::Index size = 0;
  while (size < most) {
    basis.col(size) = x;
    Eigen::VectorXd y = apply(x);
    diagonal[size++] = x.dot(y);
    const auto spanned = basis.leftCols(size);
    for (int pass = 0; pass < 2; ++pass) y -= spanned * (spanned.transpose() * y);
    off[size - 1] = y.norm();
    if (off[size - 1] < 1e-13 * std::abs(diagonal[0])) break;
    x = y / off[size - 1];
  }
  return reference::tridiagonal_eigenvalues(diagonal.head(size), off.head(size - 1))[size - 1];
}

/// A block of the membrane's second derivative at the start.
struct PairBlock {
  int a, b;
  Eigen::Matrix3d block;  ///< N/m
};

/// stiffer: by what all of it is multiplied.
std::vector<PairBlock> membrane_blocks(const Scene& scene, double stiffer) {
  std::vector<PairBlock> blocks;
  const MembraneModel membrane = make_membrane(scene);
  for (const MembraneElement& e : membrane.elements)
    membrane.add_second(
        e, [&](std::size_t v) { return scene.start.x[v]; }, true,
        [&](std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
          blocks.push_back({static_cast<int>(a), static_cast<int>(b), stiffer * block});
        });
  return blocks;
}

struct Elastic {
  std::vector<Bar> springs;
  std::vector<BendingElement> bending;
  std::vector<PairBlock> membrane;
};

/// Largest eigenvalue of M^-1/2 (stiff K + damped C) M^-1/2, where C is drag times the identity on
/// free particles.
double spring_eigenvalue(const Elastic& parts, const std::vector<double>& w, double stiff,
                         double damped) {
  const auto n = static_cast<Eigen::Index>(3 * w.size());
  return largest_eigenvalue(n, [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd y(n);
    for (std::size_t i = 0; i < w.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(3 * i);
      y.segment<3>(k) = damped * w[i] * x.segment<3>(k);
    }
    for (const Bar& s : parts.springs) {
      const double ra = std::sqrt(w[to_index(s.a)]), rb = std::sqrt(w[to_index(s.b)]);
      const double stretch = s.along.dot(rb * x.segment<3>(3 * s.b) - ra * x.segment<3>(3 * s.a));
      y.segment<3>(3 * s.b) += stiff * s.stiffness * stretch * rb * s.along;
      y.segment<3>(3 * s.a) -= stiff * s.stiffness * stretch * ra * s.along;
    }
    for (const BendingElement& e : parts.bending) {
      const Vec3 pull = stiff * e.stiffness * e.value([&](std::size_t v) {
        return Vec3(std::sqrt(w[v]) * x.segment<3>(3 * static_cast<Eigen::Index>(v)));
      });
      for (std::size_t i = 0; i < e.size; ++i)
        y.segment<3>(3 * e.vertex[i]) += std::sqrt(w[to_index(e.vertex[i])]) * e.weight[i] * pull;
    }
    for (const auto& [a, b, block] : parts.membrane) {
      const double both = stiff * std::sqrt(w[to_index(a)] * w[to_index(b)]);
      y.segment<3>(3 * a) += both * block * x.segment<3>(3 * b);
      if (a != b) y.segment<3>(3 * b) += both * block.transpose() * x.segment<3>(3 * a);
    }
    return y;
  });
}

/// Stability of explicit Euler with drag. A mode of x' = v, v' = -w^2 x - y v, with y = c/m, has
/// the multipliers 1 + h l, l^2 + y l + w^2 = 0; a complex pair has |z|^2 = 1 - y h + w^2 h^2.
/// Empty with unequal masses, whose modes drag couples.
std::optional<LinearStability> dragged_explicit_euler(const std::vector<double>& w,
                                                      const Elastic& all, double h, double drag) {
  double inverse_mass = 0;
  for (const double one : w) {
    if (one == 0) continue;
    if (inverse_mass > 0 && std::abs(one / inverse_mass - 1) > 1e-9) return {};
    inverse_mass = one;
  }
  const double y = drag * inverse_mass, w2 = spring_eigenvalue(all, w, 1, 0);
  const bool swings = 4 * w2 > y * y;
  const double swinging = swings ? std::sqrt(1 - y * h + w2 * h * h) : 0;
  const double margin = std::max(swings ? h * w2 / y : 0, y * h / 2);
  return LinearStability{
      margin, std::max({1.0, std::abs(1 - y * h), swinging}),
      "explicit Euler with drag: dt < c/(m w^2) of the fastest mode, and dt < 2 m/c"};
}

std::optional<LinearStability> stability(const Scene& scene, const LinearSprings& model) {
  if (scene.wind) return {};
  const std::vector<double> w = inverse_masses(scene);
  const double h = scene.dt / model.substeps, drag = model.drag;
  const double q = std::exp(-scene.damping * h);
  // Lagged damping takes 2 b/h times the stiffness from the limit 2 (1 + q).
  Stiffness stiffness = model.stiffness;
  for (double& k : stiffness) k *= 1 + 2 * scene.link_damping / h;
  const double of_membrane = scene.membrane ? scene.membrane->damping : 0;
  const Elastic all{bars(scene, w, stiffness), make_bending(scene),
                    membrane_blocks(scene, 1 + 2 * of_membrane / h)};
  if (all.springs.empty() && all.bending.empty() && all.membrane.empty()) return {};
  if (model.explicit_euler) {
    if (scene.damping > 0 || scene.link_damping > 0 || of_membrane > 0) return {};
    if (drag > 0) return dragged_explicit_euler(w, all, h, drag);
    const double growth = std::sqrt(1 + spring_eigenvalue(all, w, h * h, 0));
    return LinearStability{growth, growth, "explicit Euler grows by sqrt(1 + w^2 dt^2) at any dt"};
  }
  const double damped = model.central_drag ? -(1 - q) * h * drag : 2 * h * drag;
  const double margin = spring_eigenvalue(all, w, h * h, damped) / (2 * (1 + q));
  const bool shrunk =
      (drag > 0 && !model.central_drag) || scene.link_damping > 0 || of_membrane > 0;
  return LinearStability{
      margin, 0,
      shrunk ? "substep < (2/w)(sqrt(1 + zeta^2) - zeta), w the fastest mode of the springs"
             : "substep < 2/w, w the fastest mode of the springs"};
}

/// Matrix of one sweep in strain space: correcting link j by its strain e_j changes all strains by
/// -omega e_j A_:j / A_jj, with A = J M^-1 J^T.
Eigen::MatrixXd sweep(const std::vector<Bar>& links, const std::vector<double>& w, double omega,
                      bool jacobi) {
  const auto n = static_cast<Eigen::Index>(links.size());
  Eigen::MatrixXd coupling(n, n);
  const auto side = [&](const Bar& s, int vertex) {
    return vertex == s.b ? 1.0 : vertex == s.a ? -1.0 : 0.0;
  };
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const Bar &p = links[static_cast<std::size_t>(i)], &q = links[static_cast<std::size_t>(j)];
      coupling(i, j) = p.along.dot(q.along) * (w[to_index(p.a)] * side(p, p.a) * side(q, p.a) +
                                               w[to_index(p.b)] * side(p, p.b) * side(q, p.b));
    }
  Eigen::MatrixXd g = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::VectorXd push = omega * coupling.col(j) / coupling(j, j);
    if (jacobi)
      g.col(j) -= push;
    else
      g -= push * g.row(j).eval();
  }
  return g;
}

/// Largest |z| of z^2 - (1 + q) mu z + q mu over the eigenvalues mu of G^k.
double growth(const Eigen::MatrixXd& g, int k, double q) {
  double most = 0;
  for (const std::complex<double>& one : reference::eigenvalues(g)) {
    const std::complex<double> mu = std::pow(one, k), half = (1 + q) * mu / 2.0;
    const std::complex<double> root = std::sqrt(half * half - q * mu);
    most = std::max({most, std::abs(half + root), std::abs(half - root)});
  }
  return most;
}

std::optional<LinearStability> stability(const Scene& scene, const LinearSweeps& model) {
  const std::vector<double> w = inverse_masses(scene);
  const std::vector<Bar> links = bars(scene, w, {1, 1, 1});
  if (links.empty() || links.size() > kMostLinks || scene.bending) return {};
  const double q = std::exp(-scene.damping * scene.dt / model.substeps);
  const double fastest = growth(sweep(links, w, model.omega, model.jacobi), model.sweeps, q);
  return LinearStability{fastest, fastest,
                         "z^2 - 2 mu z + mu = 0, mu the eigenvalues of " +
                             std::to_string(model.sweeps) +
                             (model.jacobi ? " Jacobi sweeps" : " Gauss-Seidel sweeps")};
}

std::optional<LinearStability> stability(const Scene&, std::monostate) { return {}; }

}  // namespace

std::optional<LinearStability> linear_stability(const Scene& scene,
                                                const SolverChoice& choice) try {
  if (!choice.entry->linear_model) return {};
  return std::visit([&](const auto& model) { return stability(scene, model); },
                    choice.entry->linear_model(scene, choice.params));
} catch (const reference::NotComputable&) {
  return {};
}

}  // namespace taut
