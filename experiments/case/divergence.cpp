#include "experiments/case/divergence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "core/model/bending.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"
#include "core/model/membrane.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

double square(double value) { return value * value; }

/// What holds the cloth together: its links and, as structural ones, the sides of a membrane's
/// triangles, each once.
std::vector<Link> ties(const Scene& scene) {
  std::vector<Link> all = scene.links;
  if (!scene.membrane) return all;
  std::set<std::pair<int, int>> sides;
  for (const Triangle& t : scene.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) sides.insert(std::minmax(t[k], t[(k + 1) % 3]));
  for (const auto& [a, b] : sides) {
    const double rest = (scene.mesh.rest[to_index(b)] - scene.mesh.rest[to_index(a)]).norm();
    all.push_back({a, b, rest, Family::structural});
  }
  return all;
}

/// The cloth as seen from its pins: breadth first along its ties.
struct Hanging {
  std::vector<int> hops;    ///< [n] links to the nearest pin; -1: no way to any
  std::vector<double> way;  ///< [n] m along that way at rest
  int depth() const { return std::max(0, *std::max_element(hops.begin(), hops.end())); }
  double longest() const { return *std::max_element(way.begin(), way.end()); }
};

Hanging hang(const Scene& scene) {
  const std::size_t n = scene.mesh.rest.size();
  const std::vector<Link> all = ties(scene);
  std::vector<std::vector<const Link*>> links_of(n);
  for (const Link& link : all) {
    links_of[to_index(link.a)].push_back(&link);
    links_of[to_index(link.b)].push_back(&link);
  }
  Hanging result{std::vector<int>(n, -1), std::vector<double>(n, 0)};
  std::vector<int> queue = scene.pins;
  for (const int pin : scene.pins) result.hops[to_index(pin)] = 0;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const int i = queue[next];
    for (const Link* link : links_of[to_index(i)]) {
      const int j = link->a == i ? link->b : link->a;
      if (result.hops[to_index(j)] >= 0) continue;
      result.hops[to_index(j)] = result.hops[to_index(i)] + 1;
      result.way[to_index(j)] = result.way[to_index(i)] + link->rest;
      queue.push_back(j);
    }
  }
  return result;
}

/// The softest relaxation, one sweep a step, where every cut between neighbouring hop counts
/// carries all that hangs below it.
struct Softest {
  double extension = 0;  ///< m, of all cuts together
  double strain = 0;     ///< largest of a cut, over its shortest link
};

/// `dt` is that of the step that is computed [s], here and below.
Softest softest(const Scene& scene, const Hanging& hanging, double dt) {
  const std::size_t cuts = to_index(hanging.depth()) + 1;
  std::vector<double> mass(cuts, 0), yielding(cuts, 0), links(cuts, 0), shortest(cuts, 0);
  const std::vector<double> w = inverse_masses(scene);
  for (std::size_t i = 0; i < w.size(); ++i)
    if (hanging.hops[i] > 0) mass[to_index(hanging.hops[i])] += scene.mesh.mass[i];
  for (const auto& [a, b, rest, family] : ties(scene)) {
    const int from = hanging.hops[to_index(a)], to = hanging.hops[to_index(b)];
    if (from == to || from < 0) continue;
    const std::size_t cut = to_index(std::max(from, to));
    if (rest != kSeamRest)
      shortest[cut] = shortest[cut] == 0 ? rest : std::min(shortest[cut], rest);
    links[cut] += 1;
    yielding[cut] += w[to_index(a)] + w[to_index(b)];
  }
  Softest all;
  double below = 0;
  for (std::size_t cut = cuts - 1; cut > 0; --cut) {
    below += mass[cut];
    if (links[cut] == 0) continue;
    const double opening =
        below * yielding[cut] / (links[cut] * links[cut]) * scene.gravity.norm() * dt * dt;
    all.extension += opening;
    if (shortest[cut] > 0) all.strain = std::max(all.strain, opening / shortest[cut]);
  }
  return all;
}

/// Strain of a structural or shear link that is no seam and not between two pins; 0 for other
/// links.
double strain_in_plane(const Scene& scene, const Link& link, const std::vector<Vec3>& x) {
  if (link.family == Family::bend || is_seam(link) ||
      (is_pinned(scene, link.a) && is_pinned(scene, link.b)))
    return 0;
  return (x[to_index(link.b)] - x[to_index(link.a)]).norm() / link.rest - 1;
}

/// Speeds [m/s] that a motion can impart: every change of its velocity counts.
double imparted(const Motion& motion, double reach) {
  double speed = motion.velocity.norm() + motion.spin.norm() * reach;
  Vec3 before = Vec3::Zero();
  for (std::size_t k = 0; k < motion.path.size(); ++k) {
    Vec3 after = Vec3::Zero();
    if (k + 1 < motion.path.size())
      after = (motion.path[k + 1].displacement - motion.path[k].displacement) /
              (motion.path[k + 1].t - motion.path[k].t);
    speed += (after - before).norm();
    before = after;
  }
  return speed;
}

/// The same of a body that deforms.
double imparted(const BodyFrames& frames) {
  const auto& places = frames.places;
  double sum = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    double most = 0;
    for (std::size_t i = 0; i < places[k].size(); ++i) {
      const Vec3 before = k > 0 ? Vec3(places[k][i] - places[k - 1][i]) : Vec3(Vec3::Zero());
      const Vec3 after =
          k + 1 < places.size() ? Vec3(places[k + 1][i] - places[k][i]) : Vec3(Vec3::Zero());
      most = std::max(most, (after - before).norm() * frames.fps);
    }
    sum += most;
  }
  return sum;
}

double diameter(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  return box.diagonal().norm();
}

double motion_speed(const Scene& scene) {
  const double size = extent(scene) + diameter(scene.start.x);
  double speed = 0;
  const auto add = [&](const Motion& motion) {
    double reach = size;
    for (const Vec3& x : scene.start.x) reach = std::max(reach, (x - motion.pivot).norm() + size);
    speed += imparted(motion, reach);
  };
  for (const auto& [vertices, motion] : scene.pin_motions) add(motion);
  for (const Collider& collider : scene.colliders) {
    add(collider.motion);
    if (collider.frames) speed += imparted(*collider.frames);
  }
  return speed;
}

/// Longest way [m] of a face or an edge out of a solid shape, to the thickness above its surface:
/// from below the surface it may lead over an edge or a corner. At most 0: none.
double way_out(const Shape& shape, const Corners& piece, double thickness) {
  const auto below = [&](auto round) {
    round.radius += thickness;
    return deepest_in(round, piece).depth;
  };
  if (const Ball* ball = std::get_if<Ball>(&shape)) return below(*ball);
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return below(*capsule);
  double depth = -thickness;
  if (const Box* box = std::get_if<Box>(&shape)) {
    Box larger = *box;
    larger.half_extents.array() += thickness;
    depth = deepest_in(larger, piece).depth - thickness;
  }
  const MeshBody* body = std::get_if<MeshBody>(&shape);
  if (body && body->sides == MeshBody::Sides::out) {
    Corners local;
    for (std::size_t c = 0; c < 3; ++c)
      local[c] = body->rotation.conjugate() * (piece[c] - body->center);
    depth = deepest_in(*body->mesh, local, depth);
  }
  return thickness + (depth > 0 ? kDetour * depth : depth);
}

/// Faces, and edges (faces whose last two corners are one vertex).
std::vector<Triangle> pieces(const Scene& scene) {
  std::vector<Triangle> all = scene.mesh.triangles;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && !is_seam(link))
      all.push_back({link.a, link.b, link.b});
  return all;
}

/// Longest way [m] of a vertex, an edge or a face out of the colliders at the start.
double longest_way_out(const Scene& scene) {
  const auto& x = scene.start.x;
  const std::vector<Triangle> all =
      scene.colliders.empty() ? std::vector<Triangle>{} : pieces(scene);
  double longest = 0;
  for (const Collider& collider : scene.colliders) {
    const Shape shape = shape_at(collider, 0);
    for (const Vec3& p : x)
      longest = std::max(longest, scene.thickness - surface(shape, p).distance);
    if (std::holds_alternative<Plane>(shape)) continue;  // a vertex is the deepest
    for (const auto& [a, b, c] : all)
      longest = std::max(longest, way_out(shape, {x[to_index(a)], x[to_index(b)], x[to_index(c)]},
                                          scene.thickness));
  }
  return longest;
}

/// What the start of a scene holds besides its height.
struct Held {
  double kinetic = 0;  ///< J
  double elastic = 0;  ///< J, of bending and membrane
  double links = 0;    ///< J, if they are the stiffest springs that a step can hold
  double way = 0;      ///< m, of a vertex in one step because the start breaks constraints
};
/// w: inverse masses [1/kg].
Held held_at_start(const Scene& scene, const std::vector<double>& w, double dt) {
  const auto& x = scene.start.x;
  Held held{.elastic = bending_energy(make_bending(scene), x) + make_membrane(scene).energy(x)};
  double excess = 0;
  for (const auto& [a, b, rest, family] : ties(scene)) {
    const double longer = (x[to_index(b)] - x[to_index(a)]).norm() - rest,
                 yielding = w[to_index(a)] + w[to_index(b)];
    excess += std::abs(longer);
    if (yielding > 0) held.links += 2 * square(longer) / (yielding * square(dt));
  }
  held.way = std::min(excess, extent(scene) + diameter(x)) + longest_way_out(scene) +
             (scene.self_collision ? 2 * scene.self_collision->radius : 0);
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) held.kinetic += scene.mesh.mass[i] * scene.start.v[i].squaredNorm() / 2;
  return held;
}

double area(const Scene& scene) {
  double sum = 0;
  for (const auto& [a, b, c] : scene.mesh.triangles) {
    const Vec3& p = scene.mesh.rest[to_index(a)];
    sum += (scene.mesh.rest[to_index(b)] - p).cross(scene.mesh.rest[to_index(c)] - p).norm() / 2;
  }
  return sum;
}

}  // namespace

EnergyBudget::EnergyBudget(const Scene& scene, int substeps)
    : gravity_(scene.gravity.norm()), dt_(scene.dt / substeps) {
  const Scene last = stages(scene).back();  // what a pin that lets go held may fall from the start
  const Hanging hanging = hang(last);
  const std::vector<double> w = inverse_masses(last);
  double mass = 0, lightest = 0, farthest = 0, fastest = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    farthest = std::max(farthest, scene.start.x[i].norm());
    fastest = std::max(fastest, scene.start.v[i].norm());
    if (w[i] == 0) continue;
    const double m = scene.mesh.mass[i];
    mass += m;
    lightest = lightest == 0 ? m : std::min(lightest, m);
    (hanging.hops[i] < 0 ? free_mass_ : hung_mass_) += m;
  }
  reach_ = 2 * (hanging.longest() + softest(last, hanging, dt_).extension);
  const double rounding = 1e-6 * (farthest + extent(scene));
  const Held held = held_at_start(last, w, dt_);
  constant_ =
      held.kinetic + held.elastic +
      mass / 2 *
          (square(2 * motion_speed(scene)) + (square(held.way) + square(rounding)) / square(dt_));
  stored_ = held.links;
  size_ = farthest + extent(scene);
  speed_ = fastest + motion_speed(scene);
  if (!scene.wind) return;
  const double speed = scene.wind->velocity.norm();
  speed_ += speed;
  if (scene.wind->law == Wind::Law::relative) {
    wind_power_ = scene.wind->strength * area(scene) * square(speed) / 4;
  } else {
    // A vertex takes a third of each face around it; the whole area is more than any can take.
    wind_mass_ = mass;
    if (lightest > 0) wind_acceleration_ = scene.wind->strength * area(scene) * speed / lightest;
  }
}

double EnergyBudget::available(double t) const {
  const double fall = gravity_ * t * (t + dt_) / 2;
  return constant_ + square(2 * t / dt_ + 1) * stored_ +
         gravity_ * (free_mass_ * fall + hung_mass_ * std::min(fall, reach_)) + wind_power_ * t +
         wind_mass_ / 2 * square(wind_acceleration_ * t);
}

double EnergyBudget::farthest(double t) const {
  const double way = speed_ * t + (gravity_ + wind_acceleration_) * t * (t + dt_) / 2;
  return std::min(1e6, 1e3 * size_ + 10 * way);
}

double legitimate_strain(const Scene& scene, int substeps) {
  double strain = 0;
  for (const Scene& stage : stages(scene))
    strain = std::max(strain, softest(stage, hang(stage), scene.dt / substeps).strain);
  return std::clamp(2 * strain, 2.0, 30.0);
}

std::optional<double> settling_time(const Scene& scene, const std::vector<PassCost>& step_cost,
                                    int substeps) {
  const bool moved = std::any_of(scene.pin_motions.begin(), scene.pin_motions.end(),
                                 [](const PinMotion& pins) { return !pins.motion.at_rest(); });
  std::size_t sweeps = 0;
  for (const PassCost& cost : step_cost)
    if (cost.projections) sweeps = std::max(sweeps, cost.repeats);
  const Hanging hanging = hang(scene);
  const bool pinned =
      std::none_of(hanging.hops.begin(), hanging.hops.end(), [](int hops) { return hops < 0; });
  const double gravity = scene.gravity.norm();
  if (moved || !scene.releases.empty() || scene.wind || scene.self_collision ||
      !scene.colliders.empty() || gravity == 0 || !pinned || sweeps == 0 || hanging.depth() == 0)
    return {};
  const double links = hanging.depth(), pi = std::numbers::pi;
  const double relaxing = 8 * links * links * scene.dt / (pi * pi * static_cast<double>(sweeps));
  const double w = 1.2024 * std::sqrt(gravity / hanging.longest());
  const double h = scene.dt / substeps;
  const double swinging = 1 / (std::log1p(square(w * h)) / (2 * h) + scene.damping / 2);
  return relaxing + swinging;
}

DivergenceDetector::DivergenceDetector(const Scene& scene, const std::vector<PassCost>& step_cost,
                                       int substeps)
    : scene_(scene),
      ties_(ties(scene)),
      budget_(scene, substeps),
      legitimate_strain_(legitimate_strain(scene, substeps)),
      free_mass_(scene.mesh.mass),
      settling_(settling_time(scene, step_cost, substeps)),
      duration_(scene.duration()),
      slow_(1e-3 * std::sqrt(scene.gravity.norm() * extent(scene))) {
  for (const int pin : scene.pins)
    if (is_pinned(scene, pin)) free_mass_[to_index(pin)] = 0;
}

bool DivergenceDetector::explode(Reason reason, int step, std::size_t vertex) {
  status_ = {Status::Kind::exploded, reason, step, static_cast<int>(vertex)};
  return false;
}

void DivergenceDetector::judge_stretch(int step, const State& state) {
  for (const Link& link : ties_) {
    const double most = (1 + legitimate_strain_) * link.rest;
    if ((state.x[to_index(link.b)] - state.x[to_index(link.a)]).squaredNorm() > square(most) &&
        strain_in_plane(scene_, link, state.x) > 0) {
      status_ = {Status::Kind::extreme, Reason::stretch, step, link.a};
      return;
    }
  }
}

bool DivergenceDetector::observe(int step, double t, const State& state) {
  const std::size_t all = free_mass_.size();
  if (state.x.size() != all || state.v.size() != all) {
    status_ = {Status::Kind::error,
               "stored " + std::to_string(state.x.size()) + " positions and " +
                   std::to_string(state.v.size()) + " velocities of " + std::to_string(all) +
                   " vertices",
               step, -1};
    return false;
  }
  const double box = budget_.farthest(t);
  double energy = 0, fastest = 0;
  std::size_t fastest_vertex = 0;
  for (std::size_t i = 0; i < free_mass_.size(); ++i) {
    if (!state.x[i].allFinite() || !state.v[i].allFinite())
      return explode(Reason::nonfinite, step, i);
    if (state.x[i].lpNorm<Eigen::Infinity>() > box) return explode(Reason::box, step, i);
    if (free_mass_[i] == 0) continue;
    const double v2 = state.v[i].squaredNorm();
    energy += free_mass_[i] * v2 / 2;
    if (v2 > fastest) {
      fastest = v2;
      fastest_vertex = i;
    }
  }
  if (energy > 10 * budget_.available(t)) return explode(Reason::energy, step, fastest_vertex);
  if (status_.kind != Status::Kind::extreme) judge_stretch(step, state);
  fastest = std::sqrt(fastest);
  peak_ = std::max(peak_, fastest);
  if (settling_ && t > duration_ - *settling_ && fastest > late_) {
    late_ = fastest;
    late_vertex_ = static_cast<int>(fastest_vertex);
  }
  return true;
}

void DivergenceDetector::finish() {
  if (!settling_ || duration_ < kSettlingTimes * *settling_) return;
  const double decayed = peak_ * std::exp(-(duration_ - *settling_) / *settling_);
  if (late_ <= std::max(slow_, decayed)) return;
  if (status_.kind == Status::Kind::extreme)
    status_.reason = Reason::stretch_and_unsettled;
  else
    status_ = {Status::Kind::unsettled, Reason::unsettled, -1, late_vertex_};
}

}  // namespace taut
