// Our stand-in for TinyVBD: the names that our adapter uses, and a sweep that does nothing useful.
#pragma once
#include "Eigen/core"

namespace VBD {
using Vec3 = Eigen::Vector3f;

struct VBDStrand {
  std::vector<Eigen::Vector2i> edges;
  std::vector<float> edgesStiffness;
  std::vector<std::vector<int>> vertAdjacentEdges;
  Eigen::VectorXf orgLengths;
  Eigen::Matrix3Xf mVertPos;

  void from(const std::vector<Vec3>& points, const std::vector<float>&, const std::vector<float>&,
            float) {
    mVertPos.resize(3, static_cast<int>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) mVertPos.col(static_cast<int>(i)) = points[i];
  }
};
}  // namespace VBD
