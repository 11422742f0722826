// Section 7: bodies of triangles that deform, and a body in a frame that moves.
#include <cmath>
#include <numbers>

#include "core/model/body_frames.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

constexpr int kQuarterSecond = 16;

/// A ring about the y axis with a hexagonal section.
std::shared_ptr<const TriangleMesh> ring() {
  constexpr int kAround = 10, kAcross = 6;
  std::vector<Vec3> x;
  std::vector<Triangle> triangles;
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double u = 2 * std::numbers::pi * i / kAround, v = 2 * std::numbers::pi * j / kAcross;
      const double r = 0.3 + 0.12 * std::cos(v);
      x.emplace_back(r * std::cos(u), 0.12 * std::sin(v), r * std::sin(u));
      const auto at = [&](int a, int b) { return (i + a) % kAround * kAcross + (j + b) % kAcross; };
      triangles.push_back({at(0, 0), at(0, 1), at(1, 0)});
      triangles.push_back({at(1, 0), at(0, 1), at(1, 1)});
    }
  return std::make_shared<const TriangleMesh>(std::move(x), std::move(triangles));
}

/// A level sheet that falls on a ring, which moves by `motion`.
Scene sheet_on_ring(const Motion& motion) {
  Scene s = under_gravity(bare::sheet(13, 13, {.structural = true, .shear = true}));
  for (Vec3& x : s.start.x) x = {x.x() - 0.47, 0.2, x.y() + 0.52};
  for (Vec3& v : s.start.v) v = {0.1, -0.4, 0.05};
  s.thickness = 0.005;
  s.colliders = {
      {.shape = MeshBody{ring(), {0.02, 0.05, 0.01}}, .motion = motion, .friction = 0.3}};
  return s;
}

/// Frames in which the body grows by a fifth in a quarter of a second.
std::shared_ptr<const BodyFrames> swelling(const Collider& collider) {
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 20;
  for (int k = 0; k <= 5; ++k) {
    auto& places = frames->places.emplace_back(std::get<MeshBody>(collider.shape).mesh->vertices());
    for (Vec3& x : places) x *= 1 + 0.04 * k;
  }
  return frames;
}

/// The same scene with the collider's motion given by frames.
Scene by_frames(Scene s, double fps) {
  Collider& collider = s.colliders[0];
  auto& body = std::get<MeshBody>(collider.shape);
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = fps;
  for (int k = 0; k <= std::ceil(fps * kQuarterSecond * s.dt); ++k) {
    auto& places = frames->places.emplace_back();
    for (const Vec3& x : body.mesh->vertices())
      places.push_back(collider.motion.moved(body.center + x, k / fps) - body.center);
  }
  collider.motion = {};
  body.mesh = std::make_shared<const TriangleMesh>(frames->places[0], body.mesh->triangles());
  collider.frames = std::move(frames);
  return s;
}

/// A setting of every solver, whose substeps divide a step into 1, 2, 4, ..., 64. `implicit` needs
/// 200 iterations to converge in contact: after 30, rounding still decides which vertices touch,
/// and turns 1e-15 m into 1e-4.
std::vector<std::string> every_solver() {
  return {jakobsen(8),
          "xpbd:substeps=4,iterations=2,precision=double",
          "mass-spring:substeps=64",
          "implicit:substeps=1,iterations=200",
          "vbd:substeps=1,iterations=40,precision=double",
          "avbd:substeps=1,iterations=10,precision=double",
          "pd:substeps=1,iterations=10,precision=double",
          "admm:substeps=1,iterations=10,precision=double"};
}

Scene with_links_for(const std::string& solver, Scene s) {
  for (const char* elastic : {"implicit", "vbd", "pd", "mass-spring"})
    if (solver_name(solver) == elastic) s.stiffness = {1000, 1000, 1000};
  return s;
}

double farthest(const State& a, const State& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) most = std::max(most, (a.x[i] - b.x[i]).norm());
  return most;
}

State after(const Scene& s, const std::string& solver) {
  return Simulation(s, solver, kQuarterSecond).state();
}

}  // namespace

TAUT_TRUTH(body_in_a_moving_frame, 7, 15,
           "a body with a velocity acts like one at rest seen from a moving frame, even if it "
           "deforms",
           "Galileo; without damping and wind") {
  const Vec3 speed(0.7, -0.3, 0.4);
  for (const bool swells : {false, true})
    for (const std::string& solver : every_solver()) {
      Scene at_rest = with_links_for(solver, sheet_on_ring({}));
      if (swells) at_rest.colliders[0].frames = swelling(at_rest.colliders[0]);
      if (!can_run(findings, solver, at_rest)) continue;
      Scene moves = at_rest;
      moves.colliders[0].motion.velocity = speed;
      for (Vec3& v : moves.start.v) v += speed;
      // While the ring swells, 200 iterations do not converge, either.
      const int steps = swells && solver_name(solver) == "implicit" ? 3 : kQuarterSecond;
      State seen = Simulation(moves, solver, steps).state();
      for (Vec3& x : seen.x) x -= steps * moves.dt * speed;
      findings.below(
          solver,
          std::string("distance of a vertex from its place in that frame, on a ring that ") +
              (swells ? "swells" : "is rigid") + ", after " + std::to_string(steps) + " steps",
          "m", farthest(seen, Simulation(at_rest, solver, steps).state()), 1e-9);
    }
}

TAUT_TRUTH(frames_of_a_rigid_motion, 7, 16,
           "a body whose frames move and turn it as a whole acts like a rigid one",
           "two descriptions of one motion") {
  struct Told {
    const char* how;
    Motion motion;
    double fps;
  };
  for (const Told& told :
       {Told{"moves", {.velocity = {0.3, 0.5, -0.2}}, 64},
        Told{"turns", {.velocity = {0.1, 0.5, 0}, .spin = {0.3, 1, 2}}, 64 * 64}})
    for (const std::string& solver : every_solver()) {
      const Scene rigid = with_links_for(solver, sheet_on_ring(told.motion));
      if (!can_run(findings, solver, rigid)) continue;
      findings.below(solver, std::string("distance of a vertex after 0.25 s, the body ") + told.how,
                     "m", farthest(after(by_frames(rigid, told.fps), solver), after(rigid, solver)),
                     1e-9);
    }
}

}  // namespace taut
