// FastMassSpring: projective dynamics of springs after Liu et al. 2013, its own solver and factor.
#include <ClothApp/MassSpringSolver.h>

#include <cassert>

#include "beside.hpp"

namespace {

class Sheet {
 public:
  explicit Sheet(const beside::Net& net)
      : net_(net), at_(places(net)), system_(system_of(net)), solver_(&system_, at_.data()) {}

  void step(int iterations) {
    solver_.solve(static_cast<unsigned>(iterations));
    for (const int pin : net_.pins) {  // after each step, as its own point constraints do
      const auto i = static_cast<std::size_t>(pin);
      at_[3 * i] = static_cast<float>(net_.points[i].x);
      at_[3 * i + 1] = static_cast<float>(net_.points[i].y);
      at_[3 * i + 2] = static_cast<float>(net_.points[i].z);
    }
  }
  double lowest() const {
    float least = at_[1];
    for (std::size_t i = 1; i < at_.size(); i += 3) least = std::fmin(least, at_[i]);
    return least;
  }

 private:
  static std::vector<float> places(const beside::Net& net) {
    std::vector<float> at;
    for (const auto& p : net.points)
      for (const double x : {p.x, p.y, p.z}) at.push_back(static_cast<float>(x));
    return at;
  }
  static mass_spring_system system_of(const beside::Net& net) {
    const auto vertices = static_cast<int>(net.points.size());
    const auto links = static_cast<int>(net.links.size());
    mass_spring_system::EdgeList edges;
    Eigen::VectorXf rest(links), force = Eigen::VectorXf::Zero(3 * vertices);
    for (int i = 0; i < links; ++i) {
      const auto& link = net.links[static_cast<std::size_t>(i)];
      edges.emplace_back(link.a, link.b);
      rest[i] = static_cast<float>(link.rest);
    }
    for (int i = 0; i < vertices; ++i)
      force[3 * i + 1] = static_cast<float>(-net.mass * beside::Net::kGravity);
    return mass_spring_system(
        static_cast<unsigned>(vertices), static_cast<unsigned>(links),
        static_cast<float>(beside::Net::kStep), edges, rest,
        Eigen::VectorXf::Constant(links, static_cast<float>(beside::Net::kStiffness)),
        Eigen::VectorXf::Constant(vertices, static_cast<float>(net.mass)), force, 1);
  }

  beside::Net net_;
  std::vector<float> at_;
  mass_spring_system system_;
  MassSpringSolver solver_;
};

}  // namespace

int main() { return beside::serve<Sheet>(); }
