#pragma once

#include <Eigen/Core>
#include <stdexcept>

// The one place that instantiates Eigen's dense decompositions, which take long to compile.

namespace taut::reference {

/// Eigenvalues of a general real matrix and, as columns in the same order, its eigenvectors, each
/// of norm one.
struct Modes {
  Eigen::VectorXcd eigenvalues;
  Eigen::MatrixXcd eigenvectors;
};

/// What cannot be computed: a QR algorithm that does not converge, a matrix that is singular.
struct NotComputable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Precondition: square and finite. Accuracy: that of the QR algorithm. Throws NotComputable.
Modes modes(const Eigen::MatrixXd&);
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd&);

/// The largest |eigenvalue|.
double spectral_radius(const Eigen::MatrixXd&);

/// Eigenvalues, ascending, of the symmetric matrix with this diagonal and these values beside it.
/// Throws NotComputable.
Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside);

/// x of `matrix` x = `right`, by partial pivoting. Throws NotComputable if the matrix is exactly
/// singular.
Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace taut::reference
