#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/mesh.hpp"

namespace taut {

/// A step boundary: all that solvers, metrics and the renderer share. Mesh order, whole cloth.
struct State {
  std::vector<Vec3> x;  ///< [n] m
  std::vector<Vec3> v;  ///< [n] m/s
};

/// Air that moves past the cloth, with Vasilovici's face law (section 3): F = c (n . d) n.
struct Wind {
  enum class Law {
    relative,  ///< d = wind velocity - face velocity, F per m^2: c (n . d) n A; has a terminal
               ///< speed
    literal    ///< d = wind velocity alone, as printed; accelerates without end
  };
  Vec3 velocity = Vec3::Zero();  ///< m/s
  /// c [N s/m^3]; n is the unit normal, A the face's area; each corner takes F/3
  double strength = 0.1;
  Law law = Law::relative;
};

/// The cloth collides with itself: every particle is a ball of this radius (Vasilovici, 4.2.4).
struct SelfCollision {
  double radius = 0;  ///< m
};

/// The cloth resists bending out of its plane (core/model/bending.hpp).
struct Bending {
  double warp = 0;                  ///< N m, > 0: of a strip along the warp
  double weft = 0;                  ///< N m, > 0: of a strip across it
  Vec3 direction = -Vec3::UnitY();  ///< unit: of the warp, over the rest shape
};

/// Pins that move together along a prescribed motion.
struct PinMotion {
  std::vector<int> vertices;  ///< each of them in Scene::pins
  Motion motion;              ///< of the place where the vertex starts
};

/// Pins that let go: free from a step boundary on, with the velocity that they had there.
struct Release {
  int step = 0;               ///< > 0: the number of steps after which they are free
  std::vector<int> vertices;  ///< sorted; each of them in Scene::pins, and in no other release
};

inline constexpr std::array<double, kFamilies.size()> kRigid{
    std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::infinity()};

/// What to simulate: plain data in SI units, no behaviour. Every solver receives this same object.
/// A member that a file says in a single value has a row in scene_keys.cpp.
/// An empty vector or disengaged optional means that the effect is absent, and an absent effect
/// costs neither memory nor time (tests/solver/absent_is_free_test.cpp).
struct Scene {
  std::string name;     ///< file stem; a label, not part of the content
  std::string summary;  ///< one sentence; a label, not part of the content
  Mesh mesh;
  State start;                         ///< may differ from the rest shape
  std::vector<int> pins;               ///< sorted, unique: vertices that no solver may integrate
  std::vector<PinMotion> pin_motions;  ///< empty: pins stay where they start
  std::vector<Release> releases;       ///< by growing step; empty: pins hold to the end
  std::vector<Link> links;             ///< Gauss-Seidel order, families contiguous
  /// Of the links of each family [N/m], > 0; infinite: rigid.
  std::array<double, kFamilies.size()> stiffness = kRigid;
  std::optional<Bending> bending;
  std::vector<Collider> colliders;
  std::optional<Wind> wind;
  std::optional<SelfCollision> self_collision;
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  double damping = 0;         ///< 1/s: a free particle's velocity decays as exp(-damping t)
  double thickness = 0;       ///< m: cloth keeps this distance from colliders
  double dt = 0;              ///< s, exact in binary32 so that every solver has the same
  int steps = 0;              ///< duration / dt, rounded up

  double duration() const { return dt * steps; }  ///< s
};

/// Whether the scene says where the vertex is, and no solver, from the start to the end.
bool is_pinned(const Scene&, int vertex);

/// The vertices that are held at time t [s]; at that of their release they still are.
std::vector<int> pins_at(const Scene&, double t);

/// The scene between its releases, which it has no more: as it is until the first, then with the
/// pins that are left after each. Its start stays the run's.
std::vector<Scene> stages(const Scene&);

/// Inverse masses [n] in 1/kg; 0 for vertices that are pinned at the start.
std::vector<double> inverse_masses(const Scene&);

/// What a solver whose links are rigid says of a scene whose links are not: "links of 500 N/m", the
/// softest; nothing if they are rigid.
std::vector<std::string> elastic_links(const Scene&);

/// A unit of length for the scene [m]: the diagonal of the rest shape's bounding box.
double extent(const Scene&);

/// Where pin `vertex` has to be at time t [s]. Precondition: vertex is pinned.
Vec3 pin_position(const Scene&, int vertex, double t);

/// The content of a scene as bytes: equal exactly when the scenes are the same simulation.
std::string content(const Scene&);

/// The keys of scene_keys.hpp that came later and are not at their defaults.
std::vector<std::string> later_keys(const Scene&);

}  // namespace taut
