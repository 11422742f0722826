#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/mesh.hpp"

namespace taut {

/// State at a step boundary, which solvers, metrics and the renderer share. The whole cloth, in
/// mesh order.
struct State {
  std::vector<Vec3> x;  ///< [n] m
  std::vector<Vec3> v;  ///< [n] m/s
};

/// Moving air. The force on a face is F = c (n . d) n A, Vasilovici's law (section 3) times the
/// area.
struct Wind {
  enum class Law {
    relative,  ///< d = wind velocity - face velocity; has a terminal speed
    literal    ///< d = wind velocity alone, as printed; accelerates without end
  };
  Vec3 velocity = Vec3::Zero();  ///< m/s
  /// c [N s/m^3]; n is the unit normal, A the face's area; each corner takes F/3.
  double strength = 0.1;
  Law law = Law::relative;
};

/// Collision of the cloth with itself: every particle is a ball of this radius (Vasilovici, 4.2.4).
struct SelfCollision {
  double radius = 0;  ///< m
};

/// Bending stiffness of the cloth (core/model/bending.hpp).
struct Bending {
  double warp = 0;                  ///< N m, > 0: stiffness of a strip along the warp
  double weft = 0;                  ///< N m, > 0: stiffness of a strip across the warp
  Vec3 direction = -Vec3::UnitY();  ///< unit vector along the warp of the rest shape
};

/// Stretching of the cloth as a membrane (core/model/membrane.hpp).
struct Membrane {
  enum class Law {
    stvk,  ///< St Venant-Kirchhoff, plane stress, orthotropic
    arap   ///< distance from the nearest rotation: isotropic, without Poisson's effect
  };
  Law law = Law::stvk;
  double warp = 0;                  ///< N/m, > 0: Y1, force per width and strain along the warp
  double weft = 0;                  ///< N/m, > 0: Y2, the same along the weft
  double poisson = 0;               ///< nu12: what a strip along the warp narrows by its strain
  double shear = 0;                 ///< N/m, > 0: G, shear force per width and angle
  Vec3 direction = -Vec3::UnitY();  ///< unit vector along the warp of the rest shape
  double damping = 0;               ///< s, in proportion to stiffness; stvk alone has it
};

/// Pins that follow one prescribed motion.
struct PinMotion {
  std::vector<int> vertices;  ///< each of them in Scene::pins
  Motion motion;              ///< of the position where each vertex starts
};

/// Release of pins: they are free from a step boundary on, with the velocity that they had there.
struct Release {
  int step = 0;               ///< > 0: number of steps after which they are free
  std::vector<int> vertices;  ///< sorted; each is in Scene::pins, and in no other release
};

inline constexpr std::array<double, kFamilies.size()> kRigid{
    std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::infinity()};

/// Everything to simulate: plain data in SI units, without behaviour. Every solver gets this same
/// object. A member that a file gives as a single value has a row in scene_keys.cpp. An empty
/// vector or optional means that the effect is absent, and an absent effect costs neither memory
/// nor time (tests/solver/absent_is_free_test.cpp).
struct Scene {
  std::string name;     ///< file stem; a label, not part of the content
  std::string summary;  ///< one sentence; a label, not part of the content
  Mesh mesh;
  State start;                         ///< may differ from the rest shape
  std::vector<int> pins;               ///< sorted, unique: vertices that no solver may integrate
  std::vector<PinMotion> pin_motions;  ///< empty: pins stay where they start
  std::vector<Release> releases;       ///< in ascending order of steps; empty: pins hold to the end
  std::vector<Link> links;             ///< Gauss-Seidel order, families contiguous
  /// Stiffness of the links of each family [N/m], > 0; infinite: rigid.
  std::array<double, kFamilies.size()> stiffness = kRigid;
  double link_damping = 0;  ///< s, of links that are not rigid (core/model/link_damping.hpp)
  std::optional<Bending> bending;
  std::optional<Membrane> membrane;
  std::vector<Collider> colliders;
  std::optional<Wind> wind;
  std::optional<SelfCollision> self_collision;
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  double damping = 0;         ///< 1/s: a free particle's velocity decays as exp(-damping t)
  double thickness = 0;       ///< m: cloth keeps this distance from colliders
  double dt = 0;              ///< s, exact in binary32, so that every solver has the same
  int steps = 0;              ///< duration / dt, rounded up

  double duration() const { return dt * steps; }  ///< s
};

/// Whether the vertex is pinned from start to end, so that the scene alone decides where it is.
bool is_pinned(const Scene&, int vertex);

/// The vertices that are pinned at time t [s], including those that are released at that time.
std::vector<int> pins_at(const Scene&, double t);

/// The scene cut at its releases, into scenes without releases: the first with all pins, then one
/// after each release with the pins that are left. The start of each is that of the run.
std::vector<Scene> stages(const Scene&);

/// Inverse masses [n] in 1/kg; 0 for vertices that are pinned at the start.
std::vector<double> inverse_masses(const Scene&);

/// The reason why a solver with rigid links does not support the scene: "links of 500 N/m", the
/// softest; empty if the links are rigid.
std::vector<std::string> elastic_links(const Scene&);

/// Length scale of the scene [m]: the diagonal of the rest shape's bounding box.
double extent(const Scene&);

/// Position of pin `vertex` at time t [s]. Precondition: vertex is pinned.
Vec3 pin_position(const Scene&, int vertex, double t);

/// Content of a scene as bytes, which are equal exactly if the scenes are the same simulation.
std::string content(const Scene&);

/// A key that was added to the scene file in this version.
struct LaterKey {
  std::string path;
  int since;
};
/// The keys of scene_keys.hpp that were added later and are not at their defaults.
std::vector<LaterKey> later_keys(const Scene&);

}  // namespace taut
