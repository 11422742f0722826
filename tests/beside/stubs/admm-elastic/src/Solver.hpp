// Stand-in for admm-elastic: the names that our adapter uses, and nodes that fall.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <memory>
#include <vector>

namespace admm {
class EnergyTerm {
 public:
  virtual ~EnergyTerm() {}
  virtual int get_dim() const = 0;
  virtual double get_weight() const = 0;
  void update(Eigen::VectorXd& z) { prox(z); }

 protected:
  virtual void get_reduction(std::vector<Eigen::Triplet<double>>& triplets) = 0;
  virtual void prox(Eigen::VectorXd& z) = 0;
  virtual double energy(const Eigen::VectorXd& z) = 0;
  virtual double gradient(const Eigen::VectorXd& z, Eigen::VectorXd& gradient) = 0;
};

class Solver {
 public:
  struct Settings {
    double timestep_s = 1, gravity = 0;
    int verbose = 1, admm_iters = 1;
  };
  virtual ~Solver() {}
  template <class T>
  int add_nodes(T* x, T*, int nodes) {
    m_x = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>>(x, 3 * nodes);
    return nodes;
  }
  virtual bool initialize(const Settings& settings) {
    settings_ = settings;
    return true;
  }
  virtual void step();

  Eigen::VectorXd m_x;
  std::vector<std::shared_ptr<EnergyTerm>> energyterms;

 private:
  Settings settings_;
};
}  // namespace admm
