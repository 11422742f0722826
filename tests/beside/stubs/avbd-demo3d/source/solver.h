// Our stand-in for avbd-demo3d: the names that our adapter uses, and bodies that fall.
#pragma once
#include <vector>

struct float3 {
  float x, y, z;
};
struct Solver;
struct Rigid {
  Rigid(Solver* solver, float3 size, float density, float friction, float3 position);
  float3 positionLin;
};
struct Spring {
  Spring(Solver* solver, Rigid* a, Rigid* b, float3 on_a, float3 on_b, float stiffness, float rest);
  float length;
};

struct Solver {
  float dt = 1, gravity = 0;
  int iterations = 1;
  std::vector<Rigid*> bodies;
  std::vector<Spring*> springs;

  ~Solver() {
    for (Rigid* one : bodies) delete one;
    for (Spring* one : springs) delete one;
  }
  void step() {
    for (Rigid* one : bodies) one->positionLin.z += dt * dt * gravity;
    for (int i = 0; i < iterations; ++i)
      for (Spring* one : springs) one->length *= 1.000001F;
  }
};

inline Rigid::Rigid(Solver* solver, float3, float, float, float3 position) : positionLin(position) {
  solver->bodies.push_back(this);
}
inline Spring::Spring(Solver* solver, Rigid*, Rigid*, float3, float3, float, float rest)
    : length(rest) {
  solver->springs.push_back(this);
}
