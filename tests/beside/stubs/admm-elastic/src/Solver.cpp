#include "Solver.hpp"

void admm::Solver::step() {
  Eigen::VectorXd z = Eigen::VectorXd::Ones(3);
  for (int i = 0; i < settings_.admm_iters; ++i)
    for (const auto& term : energyterms) term->update(z);
  for (int i = 1; i < m_x.size(); i += 3)
    m_x[i] += settings_.timestep_s * settings_.timestep_s * settings_.gravity;
}
