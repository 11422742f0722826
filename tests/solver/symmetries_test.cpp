// Physical symmetries, for every registered solver: a scene described in other axes, from another
// origin, in a moving frame or in other units has the same motion, the same status and the same
// metric values. The scenes combine their features pairwise.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <regex>

#include "core/model/bending.hpp"
#include "core/model/text.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::symmetries_test {
namespace {

/// Change of description of a scene: x becomes turn (metre x) + away + t speed.
struct Change {
  const char* name;
  double kilogram = 1, metre = 1, second = 1;  ///< numbers of new units per old unit
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vec3 away = Vec3::Zero();   ///< new m
  Vec3 speed = Vec3::Zero();  ///< new m/s
  /// Tolerance of motions [old m], where 0 demands the same bits; of values, relative to their
  /// size.
  double within = 0;
};

/// Factor that converts a unit such as "N s/m^3" to new units.
double factor(const Change& c, std::string_view unit) {
  const std::map<std::string, double> factors{{"kg", c.kilogram},
                                              {"m", c.metre},
                                              {"s", c.second},
                                              {"N", c.kilogram * c.metre / (c.second * c.second)},
                                              {"rad", 1}};
  if (unit.empty() || unit == "1") return 1;
  const std::string text(unit);
  static const std::regex term("(/?) *([A-Za-z]+)(\\^[0-9])?");
  double product = 1;
  for (std::sregex_iterator t(text.begin(), text.end(), term), end; t != end; ++t) {
    const int power = (*t)[3].matched ? (*t)[3].str()[1] - '0' : 1;
    product *= std::pow(factors.at((*t)[2]), (*t)[1].length() > 0 ? -power : power);
  }
  return product;
}

/// The solver's text with its parameters in new units.
std::string changed(const std::string& solver, const Change& c) {
  const SolverChoice choice = parse_solver(solver);
  std::string text = std::string(choice.entry->name) + ":";
  for (const ParamSpec& p : choice.entry->params)
    text +=
        std::string(p.name) + "=" +
        (p.kind == ParamSpec::Kind::real ? shortest(factor(c, p.unit) * choice.params.real(p.name))
                                         : std::string(choice.params.value(p.name))) +
        ",";
  return text.substr(0, text.size() - 1);
}

Scene changed(Scene s, const Change& c) {
  const double speed = factor(c, "m/s"), stiffness = factor(c, "N/m");
  const auto vector = [&](Vec3& v, double by) { v = Vec3(c.turn * (by * v)); };
  const auto place = [&](Vec3& x) {
    vector(x, c.metre);
    x += c.away;
  };
  const auto motion = [&](Motion& m) {
    vector(m.velocity, speed);
    m.velocity += c.speed;
    vector(m.spin, c.turn.determinant() / c.second);
    place(m.pivot);
    for (Motion::Key& key : m.path) {
      key.t *= c.second;
      vector(key.displacement, c.metre);
    }
  };
  for (Vec3& x : s.mesh.rest) place(x);
  for (Vec3& x : s.start.x) place(x);
  for (Vec3& v : s.start.v) {
    vector(v, speed);
    v += c.speed;
  }
  for (double& m : s.mesh.mass) m *= c.kilogram;
  for (Link& l : s.links) l.rest *= c.metre;
  for (double& k : s.stiffness) k *= stiffness;
  if (!c.speed.isZero(0)) {  // pins at rest move with the frame
    PinMotion& resting = s.pin_motions.emplace_back();
    for (const int pin : s.pins)
      if (std::ranges::none_of(s.pin_motions, [&](const PinMotion& m) {
            return std::ranges::count(m.vertices, pin) > 0;
          }))
        resting.vertices.push_back(pin);
  }
  for (PinMotion& pins : s.pin_motions) motion(pins.motion);
  for (Collider& collider : s.colliders) {
    motion(collider.motion);
    if (Plane* p = std::get_if<Plane>(&collider.shape)) {
      vector(p->normal, 1);
      p->offset = c.metre * p->offset + p->normal.dot(c.away);
    } else if (Ball* b = std::get_if<Ball>(&collider.shape)) {
      place(b->center);
      b->radius *= c.metre;
    } else if (Capsule* d = std::get_if<Capsule>(&collider.shape)) {
      place(d->from);
      place(d->to);
      d->radius *= c.metre;
    } else if (Box* q = std::get_if<Box>(&collider.shape)) {
      place(q->center);
      q->half_extents *= c.metre;
      // a box is its own mirror image
      if (const Eigen::Matrix3d turn = c.turn * c.turn.determinant(); !turn.isIdentity(0))
        q->rotation = Eigen::Quaterniond(turn * q->rotation.toRotationMatrix());
    }
  }
  if (s.wind) {
    vector(s.wind->velocity, speed);
    s.wind->velocity += c.speed;
    s.wind->strength *= factor(c, "N s/m^3");
  }
  if (s.bending) {
    s.bending->warp *= factor(c, "N m");
    s.bending->weft *= factor(c, "N m");
    vector(s.bending->direction, 1);
  }
  if (s.membrane) {
    for (double* one : {&s.membrane->warp, &s.membrane->weft, &s.membrane->shear})
      *one *= factor(c, "N/m");
    vector(s.membrane->direction, 1);
    s.membrane->damping *= c.second;
  }
  if (s.self_collision) s.self_collision->radius *= c.metre;
  vector(s.gravity, factor(c, "m/s^2"));
  s.damping /= c.second;
  s.link_damping *= c.second;
  s.thickness *= c.metre;
  s.dt *= c.second;
  return s;
}

/// Noise in [-1, 1] from integers, the same on every machine.
double noise(std::size_t i, std::size_t k) {
  return static_cast<double>((i * 7919 + k * 104729 + i * i * 31) % 2001) / 1000 - 1;
}

void add_cloth(Scene& s, const SheetShape& shape) {
  Mesh mesh = make_sheet(shape);
  const int first = s.mesh.size();
  for (Link link : grid_links(mesh, {true, true, true})) {
    link.a += first;
    link.b += first;
    s.links.push_back(link);
  }
  std::ranges::stable_sort(s.links, {}, &Link::family);
  for (const auto& [a, b, c] : mesh.triangles)
    s.mesh.triangles.push_back({a + first, b + first, c + first});
  s.mesh.rest.insert(s.mesh.rest.end(), mesh.rest.begin(), mesh.rest.end());
  s.mesh.mass.insert(s.mesh.mass.end(), mesh.mass.begin(), mesh.mass.end());
  s.mesh.grid = first == 0 ? mesh.grid : std::nullopt;
  s.start.x = s.mesh.rest;
  s.start.v.assign(s.start.x.size(), Vec3::Zero());
}

/// Feature that is added to the rest shape or to the whole scene, in this order.
struct Feature {
  const char* name;
  void (*add)(Scene&);
};
const Feature kFeatures[] = {
    {"second cloth",
     [](Scene& s) {
       add_cloth(s, {.nu = 4,
                     .nv = 4,
                     .width = 0.7,
                     .height = 0.6,
                     .origin = Vec3(0.1, 0.07, 0.2),
                     .v = Vec3::UnitZ(),
                     .mass = 0.1});
     }},
    {"irregular mesh",
     [](Scene& s) {
       s.mesh.grid.reset();
       for (std::size_t i = 0; i < s.mesh.rest.size(); ++i) {
         s.mesh.rest[i] += 0.02 * Vec3(noise(i, 3), 0, noise(i, 4));
         s.mesh.mass[i] *= 1 + 0.3 * noise(i, 5);
       }
       for (Link& l : s.links)
         l.rest = (s.mesh.rest[to_index(l.a)] - s.mesh.rest[to_index(l.b)]).norm();
       s.start.x = s.mesh.rest;
     }},
    {"start",
     [](Scene& s) {
       for (std::size_t i = 0; i < s.start.x.size(); ++i) {
         s.start.x[i] += 0.01 * Vec3(noise(i, 0), noise(i, 1), noise(i, 2));
         s.start.v[i] = Vec3(0.2, -0.5, 0.1) + 0.2 * Vec3(noise(i, 6), noise(i, 7), noise(i, 8));
       }
     }},
    {"pins",
     [](Scene& s) {
       s.pins = {0, 4};
     }},
    {"moving pin",
     [](Scene& s) {
       s.pins.push_back(22);
       PinMotion& pin = s.pin_motions.emplace_back();
       pin.vertices = {22};
       pin.motion = {Vec3(0.1, 0.2, -0.1),
                     Vec3(0.3, 1, 0.2),
                     Vec3(0.5, 0.1, 0.5),
                     {{0.05, Vec3::Zero()}, {0.2, Vec3(0, 0.05, 0.02)}}};
     }},
    {"wind",
     [](Scene& s) {
       s.wind = Wind{.velocity = {2, 1.5, -1}, .strength = 0.3};
     }},
    {"damping", [](Scene& s) { s.damping = 0.7; }},
    {"bending",
     [](Scene& s) {
       s.bending = Bending{2e-3, 1e-3, Vec3(0.8, 0, 0.6)};
     }},
    {"elastic",
     [](Scene& s) {
       s.stiffness = {900, 300, 20};
     }},
    {"plane",
     [](Scene& s) {
       s.colliders.push_back({Plane{Vec3(0.48, 0.8, 0.36), -0.05}, {}, 0.4});
     }},
    {"ball",
     [](Scene& s) {
       s.colliders.push_back({Ball{Vec3(0.4, -0.3, 0.3), 0.25}, {}, 0.3});
     }},
    {"box",
     [](Scene& s) {
       Box box{Vec3(0.7, -0.2, 0.7), Vec3(0.15, 0.12, 0.1)};
       box.rotation = Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized());
       Motion motion;
       motion.velocity = {0, 0.3, 0.1};
       motion.spin = {0, 2, 0.5};
       motion.pivot = box.center;
       s.colliders.push_back({box, motion, 0.5});
     }},
    {"capsule",
     [](Scene& s) {
       s.colliders.push_back({Capsule{Vec3(-0.1, -0.2, 0.6), Vec3(0.5, -0.25, 0.9), 0.1}, {}, 0});
     }},
    {"self-collision", [](Scene& s) { s.self_collision = SelfCollision{.radius = 0.05}; }},
    {"thickness", [](Scene& s) { s.thickness = 0.01; }},
};

constexpr unsigned kScenes = 16;

/// Scene n has feature f if f + 1 and n have an odd number of common bits. Any two features then
/// occur together, each without the other, and not at all, in a quarter of the scenes each
/// (Sylvester, 1867).
Scene scene_of(unsigned n) {
  Scene s;
  add_cloth(s, {.nu = 5, .nv = 5, .width = 1, .height = 1, .v = Vec3::UnitZ(), .mass = 0.3});
  for (unsigned f = 0; f < std::size(kFeatures); ++f)
    if (std::popcount((f + 1) & n) % 2 == 1) {
      s.summary += std::string(s.summary.empty() ? "" : ", ") + kFeatures[f].name;
      kFeatures[f].add(s);
    }
  std::ranges::sort(s.pins);
  s.name = "scene " + std::to_string(n);
  s.dt = 1.0 / 64;
  s.steps = 12;
  return s;
}

/// Every registered solver with its default settings and with further ones.
std::vector<std::string> texts() {
  std::vector<std::string> all{
      "jakobsen:order=mesh,substeps=1,projection=exact,faces=on",
      "jakobsen:tethers=on,levels=2,omega=1.3,contact=after",
      "jakobsen:method=jacobi-averaged,chebyshev=0.5,contact=discrete",
      "xpbd:structural=1e-4,shear=1e-3,iterations=3,tethers=on",
      "xpbd:structural=1e-4,shear=1e-3,bend=1e-2,iterations=3,method=global",
      "mass-spring:drag=0.002,drag-at=central,bend=0",
      "mass-spring:integrator=symplectic-euler,drag=0.002",
      "pd:anderson=3",
      "pd:chebyshev=0.5",
      "admm:links=elastic,multipliers=keep,penalty-ratio=2",
      "vbd:start=inertia,chebyshev=0.5,damping=1e-3",
      "avbd:start=inertia,order=mesh",
      "bullet:reorder=on,faces=off",
      "bullet-deformable:implicit=false,substeps=16,spring-damping=0.01"};
  for (const SolverEntry* entry : solvers()) all.emplace_back(entry->name);
  // 50 iterations would take as long as all other solvers together
  std::ranges::replace(all, "implicit", "implicit:iterations=6");
  return all;
}

CaseRun run(const Scene& scene, const std::string& solver) {
  return run_case(scene, parse_solver(solver));
}

/// Largest difference between the second run and the first one in the new description. Positions
/// count in old m, velocities in old m/s times the duration.
double apart(const CaseRun& was, const CaseRun& is, const Change& c, const Scene& scene) {
  const double duration = is.record.dt * is.record.steps;
  double most = 0;
  for (std::size_t i = 0; i < was.last.x.size(); ++i) {
    const Vec3 x = c.turn * (c.metre * was.last.x[i]) + c.away + duration * c.speed,
               v = c.turn * (factor(c, "m/s") * was.last.v[i]) + c.speed;
    most = std::max({most, (is.last.x[i] - x).norm() / c.metre,
                     (is.last.v[i] - v).norm() / factor(c, "m/s") * scene.dt});
  }
  return most;
}

/// Whether a metric has to return the same value. Speeds are relative to the frame, the thresholds
/// of settle.time are in m and s, and rounding decides which vertices are below a surface that all
/// of them lie on.
bool sees_no(const Change& c, const std::string& metric) {
  const auto is = [&](const char* name) { return metric.rfind(name, 0) == 0; };
  if (is("penetration.share")) return c.within == 0;
  if (is("settle.")) return c.metre == 1 && c.second == 1 && c.speed.isZero(0);
  return c.speed.isZero(0) || !(is("drift.") || is("energy.") || is("jitter."));
}

/// Whether the solver has this parameter, of which 0 switches something off, and does not switch it
/// off.
bool uses(const SolverChoice& choice, std::string_view parameter) {
  return choice.params.has(parameter) && choice.params.real(parameter) > 0;
}

bool is_bullets(const std::string& solver) {
  const std::string name = solver_name(solver);
  return name == "bullet" || name == "bullet-deformable";
}

/// Whether a solver is known to break the symmetry; the reason stands at each case.
bool sees(const std::string& solver, const Scene& scene, const Change& c) {
  const SolverChoice choice = parse_solver(solver);
  const bool touches = !scene.colliders.empty(), moves = !c.speed.isZero(0);
  // mass-spring's drag and VBD's damping act on a vertex' absolute velocity, as published
  if (moves && (scene.damping > 0 || uses(choice, "drag") || uses(choice, "damping"))) return true;
  // Anderson acceleration falls back if the energy grew after contact; rounding chooses between
  // equally good iterates
  if (uses(choice, "anderson") && touches) return true;
  // Bullet compares with its own constants in m, kg and s, and contact of its deformable body is
  // unstable
  return choice.entry->name == "bullet-deformable" && touches;
}

double tolerance(const std::string& solver, const Change& c) {
  return is_bullets(solver) ? std::max(1e-9, c.within) : c.within;
}

/// Number of steps for which solvers with contact constraints are compared. They decide in every
/// iteration which vertices touch, stick and slip; before convergence rounding takes that decision
/// sooner or later, and at once where two colliders hold a vertex.
constexpr int kStepsInContact = 3;
/// Tolerance of positions where several colliders can hold a vertex [m].
constexpr double kWithinSeveral = 1e-3;
bool decides_who_touches(const std::string& solver) {
  return std::ranges::any_of(std::array{"implicit", "pd", "admm", "vbd", "avbd"},
                             [&](auto name) { return solver_name(solver) == name; });
}

void compare(Scene scene, const std::string& solver, const Change& c) {
  if (!scene.colliders.empty() && decides_who_touches(solver)) scene.steps = kStepsInContact;
  const CaseRun was = run(scene, solver), is = run(changed(scene, c), changed(solver, c));
  const std::string where =
      std::string(c.name) + ", " + scene.name + " (" + scene.summary + "), " + solver;
  EXPECT_EQ(to_string(was.record.status.kind), to_string(is.record.status.kind)) << where;
  if (was.record.status.kind != Status::Kind::ok || is.record.status.kind != Status::Kind::ok)
    return;
  double within = tolerance(solver, c);
  if (within > 0 && scene.colliders.size() > 1 && decides_who_touches(solver))
    within = std::max(within, kWithinSeveral);
  const double far = apart(was, is, c, scene);
  EXPECT_LE(far, within) << where;
  if (!(far <= within)) return;
  for (const auto& [name, value] : was.record.values) {
    if (!sees_no(c, name)) continue;
    // Rounding decides whether an edge that lies on an edge of a box passes through it, and whether
    // the last iteration of a step meets the criterion.
    if (within > 0 && (name == "edge.passages" || name == "steps.unconverged")) continue;
    const double now = is.record.value(name);
    const double want = value * factor(c, find_value(name).second->unit.si);
    if (std::isnan(want) && std::isnan(now)) continue;
    EXPECT_LE(std::abs(now - want), 100 * within * std::max(1.0, std::abs(want)))
        << name << ", " << where;
  }
}

class Symmetries : public testing::TestWithParam<Change> {};

const Eigen::Matrix3d kQuarter = (Eigen::Matrix3d() << 0, 0, 1, 0, 1, 0, -1, 0, 0).finished();
const Eigen::Matrix3d kMirror = Vec3(-1, 1, 1).asDiagonal();

void PrintTo(const Change& c, std::ostream* out) { *out << c.name; }

TEST_P(Symmetries, Hold) {
  const Change& c = GetParam();
  for (unsigned n = 0; n < kScenes; ++n) {
    const Scene scene = scene_of(n);
    for (std::string solver : texts()) {
      if (sees(solver, scene, c)) continue;
      if (c.within > 0 && parse_solver(solver).params.has("precision"))
        solver = with(solver, "precision=double");
      compare(scene, solver, c);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Symmetries,
    testing::Values(
        Change{.name = "turned_and_mirrored", .turn = kQuarter * kMirror, .within = 1e-9},
        Change{.name = "moved", .away = Vec3(8, 4, -2), .within = 1e-8},
        Change{.name = "far", .away = Vec3(1e4, 1e4, -1e4), .within = 1e-5},
        Change{.name = "from_a_train", .speed = Vec3(3, -1, 2), .within = 1e-8},
        Change{.name = "in_small_units", .kilogram = 0x1p16, .metre = 0x1p6, .second = 0x1p2},
        Change{.name = "in_large_units", .kilogram = 0x1p-16, .metre = 0x1p-5, .second = 0x1p-5}),
    [](const auto& change) { return std::string(change.param.name); });

/// Solvers with a float path lose only the rounding of positions within half a second.
TEST(Symmetries, FloatIsDoubleButForRounding) {
  for (unsigned n = 0; n < kScenes; ++n) {
    for (const std::string& solver : texts()) {
      const SolverEntry& entry = *parse_solver(solver).entry;
      if (entry.program || !parse_solver(solver).params.has("precision")) continue;
      Scene scene = scene_of(n);
      if (!scene.colliders.empty() && decides_who_touches(solver)) scene.steps = kStepsInContact;
      const CaseRun in_double = run(scene, with(solver, "precision=double")),
                    in_float = run(scene, with(solver, "precision=float"));
      const std::string where = scene.name + " (" + scene.summary + "), " + solver;
      EXPECT_EQ(to_string(in_double.record.status.kind), to_string(in_float.record.status.kind))
          << where;
      EXPECT_LE(apart(in_double, in_float, {}, scene), 2e-3) << where;
    }
  }
}

/// The solvers that core/README.md lists as breaking a symmetry break it by much.
TEST(Symmetries, AreBrokenWhereItIsSaid) {
  const Change train{.name = "from a train", .speed = Vec3(3, -1, 2)};
  const auto gap = [&](unsigned n, const std::string& solver) {
    const Scene scene = scene_of(n);
    return apart(run(scene, solver), run(changed(scene, train), solver), train, scene);
  };
  EXPECT_GT(gap(0, "vbd:damping=1e-3"), 0.1);
  EXPECT_LT(gap(0, "vbd"), 1e-9);
  const auto exempt = [&](const std::string& solver) { return sees(solver, scene_of(0), train); };
  EXPECT_EQ(std::ranges::count_if(texts(), exempt), 3) << "two with drag, one with damping";
}

}  // namespace
}  // namespace taut::symmetries_test
