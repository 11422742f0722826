// avbd-demo3d: augmented vertex block descent of rigid bodies, which turn, joined by its springs.
#include <solver.h>

#include <algorithm>
#include <vector>

#include "beside.hpp"

namespace {

class Sheet {
 public:
  explicit Sheet(const beside::Net& net) {
    solver_.dt = static_cast<float>(beside::Net::kStep);
    solver_.gravity = -static_cast<float>(beside::Net::kGravity);
    const float side = 0.002F;  // m: cubes that do not touch
    const float density = static_cast<float>(net.mass) / (side * side * side);
    for (std::size_t i = 0; i < net.points.size(); ++i) {
      const auto& p = net.points[i];
      const bool held =
          std::find(net.pins.begin(), net.pins.end(), static_cast<int>(i)) != net.pins.end();
      // Its z axis points up.
      bodies_.push_back(
          new Rigid(&solver_, {side, side, side}, held ? 0 : density, 0.5F,
                    {static_cast<float>(p.x), static_cast<float>(-p.z), static_cast<float>(p.y)}));
    }
    for (const auto& link : net.links)
      new Spring(&solver_, bodies_[static_cast<std::size_t>(link.a)],
                 bodies_[static_cast<std::size_t>(link.b)], {0, 0, 0}, {0, 0, 0},
                 static_cast<float>(beside::Net::kStiffness), static_cast<float>(link.rest));
  }

  void step(int iterations) {
    solver_.iterations = iterations;
    solver_.step();
  }
  double lowest() const {
    double least = 0;
    for (const Rigid* body : bodies_)
      least = std::fmin(least, static_cast<double>(body->positionLin.z));
    return least;
  }

 private:
  Solver solver_;  // deletes its bodies and springs
  std::vector<Rigid*> bodies_;
};

}  // namespace

int main() { return beside::serve<Sheet>(); }
