#include "core/reference/dense.hpp"

#include <stdexcept>
#include <string>
#include <vector>

extern "C" {
void dgeev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda,
            double* wr, double* wi, double* vl, const int* ldvl, double* vr, const int* ldvr,
            double* work, const int* lwork, int* info);
void dsterf_(const int* n, double* d, double* e, int* info);
void dgesv_(const int* n, const int* nrhs, double* a, const int* lda, int* ipiv, double* b,
            const int* ldb, int* info);
}

namespace taut::reference {

namespace {

void succeeded(const char* routine, int info) {
  if (info != 0)
    throw std::runtime_error(std::string(routine) + " gave up (" + std::to_string(info) + ")");
}

/// Real and imaginary parts of the eigenvalues; real columns that hold the eigenvectors as dgeev
/// packs them, or none.
struct Packed {
  Eigen::VectorXd real, imaginary;
  Eigen::MatrixXd columns;
};

Packed dgeev(Eigen::MatrixXd a, bool vectors) {
  const int n = static_cast<int>(a.rows()), work_size = 4 * n + 1, one = 1;
  Packed packed{Eigen::VectorXd(n), Eigen::VectorXd(n),
                Eigen::MatrixXd(vectors ? n : 0, vectors ? n : 0)};
  std::vector<double> work(static_cast<std::size_t>(work_size));
  int info = 0;
  dgeev_("N", vectors ? "V" : "N", &n, a.data(), &n, packed.real.data(), packed.imaginary.data(),
         nullptr, &one, packed.columns.data(), vectors ? &n : &one, work.data(), &work_size, &info);
  succeeded("dgeev", info);
  return packed;
}

Eigen::VectorXcd joined(const Eigen::VectorXd& real, const Eigen::VectorXd& imaginary) {
  Eigen::VectorXcd z(real.size());
  for (Eigen::Index i = 0; i < real.size(); ++i) z[i] = {real[i], imaginary[i]};
  return z;
}

}  // namespace

Modes modes(const Eigen::MatrixXd& matrix) {
  const Packed packed = dgeev(matrix, true);
  const Eigen::Index n = matrix.rows();
  Modes result{joined(packed.real, packed.imaginary), Eigen::MatrixXcd(n, n)};
  for (Eigen::Index i = 0; i < n; ++i)
    if (packed.imaginary[i] == 0) {
      result.eigenvectors.col(i) = joined(packed.columns.col(i), Eigen::VectorXd::Zero(n));
    } else {  // a conjugate pair shares two columns
      result.eigenvectors.col(i) = joined(packed.columns.col(i), packed.columns.col(i + 1));
      result.eigenvectors.col(i + 1) = joined(packed.columns.col(i), -packed.columns.col(i + 1));
      ++i;
    }
  return result;
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  const Packed packed = dgeev(matrix, false);
  return joined(packed.real, packed.imaginary);
}

double spectral_radius(const Eigen::MatrixXd& matrix) {
  return eigenvalues(matrix).cwiseAbs().maxCoeff();
}

Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside) {
  Eigen::VectorXd d = diagonal, e = beside;
  const int n = static_cast<int>(d.size());
  int info = 0;
  dsterf_(&n, d.data(), e.data(), &info);
  succeeded("dsterf", info);
  return d;
}

Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXd x = right;
  const int n = static_cast<int>(a.rows()), one = 1;
  std::vector<int> pivots(static_cast<std::size_t>(n));
  int info = 0;
  dgesv_(&n, &one, a.data(), &n, pivots.data(), x.data(), &n, &info);
  succeeded("dgesv", info);
  return x;
}

}  // namespace taut::reference
