#include "MassSpringSolver.h"

mass_spring_system::mass_spring_system(unsigned int points, unsigned int, float step,
                                       EdgeList edges, Eigen::VectorXf, Eigen::VectorXf,
                                       Eigen::VectorXf, Eigen::VectorXf, float)
    : n_points(points), spring_list(std::move(edges)), time_step(step) {}

MassSpringSolver::MassSpringSolver(mass_spring_system* system, float* places)
    : system_(system), places_(places) {}

void MassSpringSolver::solve(unsigned int iterations) {
  for (unsigned int i = 0; i < system_->n_points; ++i)
    places_[3 * i + 1] -= 9.81f * system_->time_step * system_->time_step;
  for (unsigned int k = 0; k < iterations; ++k)
    for (const auto& edge : system_->spring_list)
      places_[3 * edge.first] += 1e-9f * places_[3 * edge.second];
}
