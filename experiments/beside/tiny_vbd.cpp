// TinyVBD: its strand, whose edges we replace by the links of the net, and its sweep.
#include <array>
#include <cassert>
#include <cstdint>
#include <functional>
#include <vector>

#define main main_of_tiny_vbd
#include <main.cpp>
#undef main

#include "beside.hpp"

namespace {

class Sheet {
 public:
  explicit Sheet(const beside::Net& net) {
    using VBD::Vec3;
    const std::size_t vertices = net.points.size(), links = net.links.size();
    std::vector<Vec3> points;
    for (const auto& p : net.points)
      points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y),
                          static_cast<float>(p.z));
    const std::vector<float> masses(vertices, static_cast<float>(net.mass));
    VBD::VBDStrand& strand = sim_.strand;
    strand.from(points, masses, std::vector<float>(vertices - 1, 1), 0);
    strand.edges.resize(links);
    strand.edgesStiffness.assign(links, static_cast<float>(beside::Net::kStiffness));
    strand.orgLengths.resize(static_cast<int>(links));
    strand.vertAdjacentEdges.assign(vertices, {});
    for (std::size_t i = 0; i < links; ++i) {
      strand.edges[i] << net.links[i].a, net.links[i].b;
      strand.orgLengths[static_cast<int>(i)] = static_cast<float>(net.links[i].rest);
      for (const int end : {net.links[i].a, net.links[i].b})
        strand.vertAdjacentEdges[static_cast<std::size_t>(end)].push_back(static_cast<int>(i));
    }
    sim_.params.dt = static_cast<float>(beside::Net::kStep);
    sim_.params.gravity << 0, static_cast<float>(-beside::Net::kGravity), 0;
  }

  void step(int iterations) {
    sim_.forwardStep();
    for (int i = 0; i < iterations; ++i) sim_.solve();
    sim_.updateVelocity();
  }
  double lowest() const { return sim_.strand.mVertPos.row(1).minCoeff(); }

 private:
  StrandSim sim_;
};

}  // namespace

int main() { return beside::serve<Sheet>(); }
