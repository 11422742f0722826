#include "Strand.h"

struct StrandSim {
  struct {
    float dt;
    VBD::Vec3 gravity;
  } params;
  VBD::VBDStrand strand;

  void forwardStep() { strand.mVertPos.colwise() += params.dt * params.dt * params.gravity; }
  void solve() {
    for (const auto& edge : strand.edges)
      strand.mVertPos.col(edge[0]) += 1e-9f * strand.mVertPos.col(edge[1]);
  }
  void updateVelocity() {}
};

int main() { return 0; }
