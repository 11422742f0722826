#pragma once

#include <Eigen/Core>
#include <stdexcept>

// Eigen's dense decompositions take long to compile and are instantiated only here.

namespace taut::reference {

/// Eigenvalues of a general real matrix and its eigenvectors, as columns in the same order and of
/// norm one.
struct Modes {
  Eigen::VectorXcd eigenvalues;
  Eigen::MatrixXcd eigenvectors;
};

/// Thrown if a QR algorithm does not converge or a matrix is singular.
struct NotComputable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Precondition: square and finite. Accuracy: that of the QR algorithm. Throws NotComputable.
Modes modes(const Eigen::MatrixXd&);
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd&);

/// The largest |eigenvalue|.
double spectral_radius(const Eigen::MatrixXd&);

/// Eigenvalues, ascending, of the symmetric tridiagonal matrix with this diagonal and off-diagonal.
/// Throws NotComputable.
Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside);

/// Solves `matrix` x = `right` for x, by partial pivoting. Throws NotComputable if the matrix is
/// exactly singular.
Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace taut::reference
