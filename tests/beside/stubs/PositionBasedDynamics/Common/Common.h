// Our stand-in for PositionBasedDynamics: the names that our adapter uses.
#pragma once
#include <Eigen/Dense>

using Real = float;
using Vector3r = Eigen::Matrix<Real, 3, 1, Eigen::DontAlign>;
