// Our stand-in for FastMassSpring: the names that our adapter uses.
#pragma once
#include <Eigen/Dense>
#include <utility>
#include <vector>

struct mass_spring_system {
  using EdgeList = std::vector<std::pair<unsigned int, unsigned int>>;
  mass_spring_system(unsigned int points, unsigned int springs, float time_step, EdgeList edges,
                     Eigen::VectorXf rest, Eigen::VectorXf stiffness, Eigen::VectorXf masses,
                     Eigen::VectorXf force, float damping);
  unsigned int n_points;
  EdgeList spring_list;
  float time_step;
};

class MassSpringSolver {
 public:
  MassSpringSolver(mass_spring_system* system, float* places);
  void solve(unsigned int iterations);

 private:
  mass_spring_system* system_;
  float* places_;
};
