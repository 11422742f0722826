// admm-elastic: its solver, factor and dual variables, with energy terms for our links and pins.
#include <omp.h>

#include <Solver.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "beside.hpp"

namespace {

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

void add_vertex(Triplets& triplets, int vertex, double factor) {
  for (int axis = 0; axis < 3; ++axis) triplets.emplace_back(axis, 3 * vertex + axis, factor);
}

/// The energy k/2 (|d| - r)^2 of a link; the weight is the root of k, as in the paper's springs.
class Link : public admm::EnergyTerm {
 public:
  Link(int a, int b, double rest) : a_(a), b_(b), rest_(rest) {}
  int get_dim() const override { return 3; }
  double get_weight() const override { return std::sqrt(beside::Net::kStiffness); }

 protected:
  void get_reduction(Triplets& triplets) override {
    add_vertex(triplets, a_, -1);
    add_vertex(triplets, b_, 1);
  }
  void prox(Vector& z) override {
    const double length = z.norm();
    z *= 0.5 * (length + rest_) / length;
  }
  double energy(const Vector&) override { return 0; }
  double gradient(const Vector&, Vector&) override { return 0; }

 private:
  int a_, b_;
  double rest_;
};

/// A stiff pin; the library's own pin writes three values into six.
class Pin : public admm::EnergyTerm {
 public:
  Pin(int vertex, const Eigen::Vector3d& place) : vertex_(vertex), place_(place) {}
  int get_dim() const override { return 3; }
  double get_weight() const override { return 100 * std::sqrt(beside::Net::kStiffness); }

 protected:
  void get_reduction(Triplets& triplets) override { add_vertex(triplets, vertex_, 1); }
  void prox(Vector& z) override { z = place_; }
  double energy(const Vector&) override { return 0; }
  double gradient(const Vector&, Vector&) override { return 0; }

 private:
  int vertex_;
  Eigen::Vector3d place_;
};

class Sheet {
 public:
  explicit Sheet(const beside::Net& net) : few_(net, beside::kFew), many_(net, beside::kMany) {}

  /// The solver's number of iterations is fixed at its construction.
  void step(int iterations) {
    last_ = iterations == beside::kFew ? &few_ : &many_;
    last_->step();
  }
  double lowest() const { return last_->lowest(); }

 private:
  class Fixed : public admm::Solver {
   public:
    Fixed(const beside::Net& net, int iterations) {
      std::vector<double> x, masses(3 * net.points.size(), net.mass);
      for (const auto& p : net.points) x.insert(x.end(), {p.x, p.y, p.z});
      add_nodes(x.data(), masses.data(), static_cast<int>(net.points.size()));
      for (const auto& link : net.links)
        energyterms.push_back(std::make_shared<Link>(link.a, link.b, link.rest));
      for (const int pin : net.pins)
        energyterms.push_back(std::make_shared<Pin>(pin, m_x.segment<3>(3 * pin)));
      Settings settings;
      settings.timestep_s = beside::Net::kStep;
      settings.gravity = -beside::Net::kGravity;
      settings.verbose = 0;
      settings.admm_iters = iterations;
      initialize(settings);
    }
    double lowest() const {
      double least = 0;
      for (int i = 1; i < m_x.size(); i += 3) least = std::fmin(least, m_x[i]);
      return least;
    }
  };

  Fixed few_, many_;
  Fixed* last_ = &few_;
};

}  // namespace

int main() {
  omp_set_num_threads(1);
  return beside::serve<Sheet>();
}
