// A toy solver for taut-solver/2 that is sound, or has one of the errors of planted.hpp: position-
// based dynamics with compliance (XPBD) in substeps, contact at the end of each, Coulomb friction.
#include "tests/conformance/planted.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "taut_solver.hpp"

namespace {

using taut_solver::Json;

struct V {
  double x = 0, y = 0, z = 0;
};
V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
V operator*(double s, V a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double norm(V a) { return std::sqrt(dot(a, a)); }
V vec(const Json& j) { return {j[0].number, j[1].number, j[2].number}; }
/// Turned by the angle |spin| about spin.
V turned(V a, V spin) {
  const double angle = norm(spin);
  if (angle == 0) return a;
  const V n = 1 / angle * spin;
  return std::cos(angle) * a + std::sin(angle) * cross(n, a) +
         (1 - std::cos(angle)) * dot(n, a) * n;
}
/// Turned by the unit quaternion (w, u).
V turned(V a, double w, V u) { return a + 2 * w * cross(u, a) + 2.0 * cross(u, cross(u, a)); }

std::string g_fault;  // "" or the name of one error
bool has(const char* fault) { return g_fault == fault; }

struct Motion {
  V velocity, spin, pivot;
  std::vector<std::pair<double, V>> path;

  static Motion read(const Json& j) {
    Motion m;
    if (!j.something()) return m;
    m.velocity = vec(j["velocity"]);
    m.spin = vec(j["spin"]);
    m.pivot = vec(j["pivot"]);
    for (const Json& key : j["path"].items)
      m.path.emplace_back(key["t"].number, vec(key["displacement"]));
    return m;
  }
  V displacement(double t) const {
    V d = t * velocity;
    if (path.empty()) return d;
    if (t <= path.front().first) return d + path.front().second;
    for (std::size_t k = 1; k < path.size(); ++k)
      if (t <= path[k].first) {
        const double s = (t - path[k - 1].first) / (path[k].first - path[k - 1].first);
        return d + (1 - s) * path[k - 1].second + s * path[k].second;
      }
    return d + path.back().second;
  }
  V moved(V p, double t) const { return pivot + turned(p - pivot, t * spin) + displacement(t); }
  /// Where the point of the body was that is at p at time t.
  V back(V p, double t) const { return pivot + turned(p - displacement(t) - pivot, -t * spin); }
  V turn(V direction, double t) const { return turned(direction, t * spin); }
};

struct Body {
  std::string type;
  V a, b;               // plane: normal; ball, box: centre, half extents; capsule: ends
  double r = 0, w = 1;  // offset or radius; the box's rotation
  V u;
  double friction = 0;
  Motion motion;

  static Body read(const Json& j) {
    Body c;
    c.type = j["type"].text;
    c.friction = j["friction"].number;
    c.motion = Motion::read(j["motion"]);
    if (c.type == "plane") {
      c.a = vec(j["normal"]);
      c.r = has("plane-offset-ignored") ? 0 : j["offset"].number;
    } else if (c.type == "ball") {
      c.a = vec(j["center"]);
      c.r = j["radius"].number * (has("ball-radius-is-diameter") ? 0.5 : 1);
    } else if (c.type == "box") {
      c.a = vec(j["center"]);
      c.b = (has("box-extents-are-whole") ? 0.5 : 1) * vec(j["half_extents"]);
      const Json& q = j["rotation"];
      c.w = q[0].number;
      c.u = {q[1].number, q[2].number, q[3].number};
      if (has("box-not-turned")) c.w = 1, c.u = {};
      if (has("quaternion-order")) c.w = q[3].number, c.u = vec(q);
    } else {
      c.a = vec(j["from"]);
      c.b = vec(j["to"]);
      c.r = j["radius"].number;
    }
    return c;
  }
  /// Distance from p to the surface at rest, and the normal.
  double distance(V p, V& n) const {
    if (type == "plane") {
      n = a;
      return dot(a, p) - r;
    }
    if (type == "box") {
      const V l = turned(p - a, w, -1 * u);
      const double q[] = {std::abs(l.x) - b.x, std::abs(l.y) - b.y, std::abs(l.z) - b.z};
      const double s[] = {std::copysign(1.0, l.x), std::copysign(1.0, l.y),
                          std::copysign(1.0, l.z)};
      if (q[0] <= 0 && q[1] <= 0 && q[2] <= 0) {
        const int k = static_cast<int>(std::max_element(q, q + 3) - q);
        n = turned(V{k == 0 ? s[0] : 0, k == 1 ? s[1] : 0, k == 2 ? s[2] : 0}, w, u);
        return q[k];
      }
      const V out{std::max(q[0], 0.0) * s[0], std::max(q[1], 0.0) * s[1],
                  std::max(q[2], 0.0) * s[2]};
      n = turned(1 / norm(out) * out, w, u);
      return norm(out);
    }
    V at = a;
    if (type == "capsule") {
      const V along = b - a;
      double s = dot(p - a, along) / dot(along, along);
      if (!has("capsule-without-caps")) s = std::clamp(s, 0.0, 1.0);
      if (s < 0 || s > 1) {
        n = V{0, 1, 0};
        return 1;
      }
      at = a + s * along;
    }
    const double d = norm(p - at);
    n = d > 0 ? 1 / d * (p - at) : V{0, 1, 0};
    return d - r;
  }
};

class Planted {
 public:
  static constexpr const char* kProtocol = "taut-solver/2";
  static constexpr const char* kAbout = R"("name": "planted", "version": "1", "params": {
      "fault": {"type": "text", "default": "", "doc": "The error that it has"},
      "iterations": {"type": "integer", "min": 1, "max": 1000, "default": 8, "doc": "Sweeps"},
      "substeps": {"type": "integer", "min": 1, "max": 1000, "default": 4, "doc": "Substeps"}})";

  static std::vector<std::string> cannot(const Json& scene, const Json&) {
    std::vector<std::string> all;
    if (scene.members.contains("bending")) all.emplace_back("bending");
    for (const Json& c : scene["colliders"].items)
      if (c["type"].text == "mesh") all.emplace_back("bodies of triangles");
    return all;
  }

  Planted(const Json& scene, const Json& params)
      : w_(scene["inverse_mass"].numbers()),
        gravity_(vec(scene["gravity"])),
        damping_(scene["damping"].number),
        thickness_(scene["thickness"].number),
        scene_dt_(scene["dt"].number),
        sweeps_(params["iterations"].integer()),
        substeps_(params["substeps"].integer()) {
    g_fault = params["fault"].text;
    for (const Json& x : scene["x"].items) start_.push_back(vec(x));
    const auto rest_of = [&](const Json& l) {
      const V d = start_[index(l[1])] - start_[index(l[0])];
      double rest = has("rest-length-from-the-start") ? norm(d) : l[2].number;
      if (has("rest-length-a-hundredth-long")) rest *= 1.01;
      if (has("rest-length-of-diagonals") && l[3].text == "shear") rest /= std::sqrt(2.0);
      return rest;
    };
    for (const Json& l : scene["links"].items) {
      double k = 0;  // N/m; 0: rigid
      if (scene.members.contains("stiffness")) {
        const char* family = l[3].text.c_str();
        if (has("one-stiffness-for-all")) family = "structural";
        k = scene["stiffness"][family].number;
        if (has("stiffness-halved")) k /= 2;
        if (has("stiffness-doubled")) k *= 2;
        if (has("stiffness-ignored")) k = 0;
        if (has("stiffness-per-length")) k /= l[2].number;
      }
      links_.push_back({index(l[0]), index(l[1]), rest_of(l), k});
    }
    if (has("only-the-first-eight-links") && links_.size() > 8) links_.resize(8);
    if (has("last-link-missing") && links_.size() > 2) links_.pop_back();
    for (const Json& p : scene["pins"].items) pins_.push_back({index(p), {}});
    if (has("first-pin-alone") && pins_.size() > 1) pins_.resize(1);
    for (const Json& m : scene["pin_motions"].items)
      for (const Json& p : m["vertices"].items)
        for (auto& [pin, motion] : pins_)
          if (pin == index(p)) motion = Motion::read(m["motion"]);
    for (auto& [pin, motion] : pins_) {
      if (has("pins-stay-where-they-start")) motion = {};
      if (has("spin-turned-round")) motion.spin = -1 * motion.spin;
      if (has("pivot-ignored")) motion.pivot = {};
      if (has("path-ignored")) motion.path.clear();
    }
    for (const Json& c : scene["colliders"].items) {
      bodies_.push_back(Body::read(c));
      if (has("bodies-stay-where-they-start")) bodies_.back().motion = {};
      if (has("spin-of-bodies-ignored")) bodies_.back().motion.spin = {};
      if (has("friction-of-the-first-body")) bodies_.back().friction = bodies_[0].friction;
    }
    if (scene["wind"].something()) {
      if (has("dies-in-wind")) std::abort();
      while (has("hangs-in-wind")) std::this_thread::sleep_for(std::chrono::seconds(1));
      wind_ = vec(scene["wind"]["velocity"]);
      strength_ = has("wind-ignored") ? 0 : scene["wind"]["strength"].number;
      relative_ = scene["wind"]["law"].text == "relative" && !has("wind-without-own-speed");
      for (const Json& f : scene["triangles"].items)
        faces_.push_back({index(f[0]), index(f[1]), index(f[2])});
    }
    if (scene["self_collision"].something()) radius_ = scene["self_collision"]["radius"].number;
    pinned_ = std::vector<bool>(w_.size());
    for (const auto& pin : pins_) pinned_[pin.first] = true;
    if (has("pins-fall"))
      for (std::size_t i = 0; i < w_.size(); ++i)
        if (pinned_[i]) w_[i] = 1, pinned_[i] = false;
    if (has("first-pin-alone"))
      for (std::size_t i = 0; i < w_.size(); ++i)
        if (w_[i] == 0 && !pinned_[i]) w_[i] = 1;
    lambda_.assign(links_.size(), 0);
  }

  void load(const double* x, const double* v) {
    const std::size_t n = w_.size();
    x_.resize(n);
    v_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      x_[i] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
      v_[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
      if (has("velocity-not-loaded")) v_[i] = {};
      if (has("velocity-loaded-halved")) v_[i] = 0.5 * v_[i];
      if (has("y-and-z-swapped")) std::swap(v_[i].y, v_[i].z);
      if (has("velocity-kept-from-before") && loads_ > 0) v_[i] = v_[i] + 0.01 * kept_;
    }
    kept_ = {1, 0, 0};
    ++loads_;
    own_t_ = 0;
  }

  void step(double t, double dt) {
    if (has("frame-of-a-sixtieth")) dt = 1.0 / 60;
    if (has("own-clock")) t = own_t_;
    if (has("gains-a-thousandth-in-a-step"))
      for (V& v : v_) v = 1.001 * v;
    if (has("loses-a-thousandth-in-a-step"))
      for (V& v : v_) v = 0.999 * v;
    const double h = dt / substeps_;
    const int made = has("last-substep-missing") ? substeps_ - 1 : substeps_;
    for (int s = 0; s < made; ++s) substep(t + s * h, h, dt);
    own_t_ += dt;
    if (has("by-chance"))
      for (V& x : x_) x.x += 1e-12 * (std::rand() % 100) * (std::rand() % 100);
  }

  void store(double* x, double* v) const {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      V p = x_[i], u = v_[i];
      if (has("velocity-in-mm")) u = 1000 * u;
      if (has("velocity-turned-round")) u = -1 * u;
      if (has("pins-have-no-velocity") && pinned_[i]) u = {};
      if (has("positions-in-half-precision")) {
        p = {half(p.x), half(p.y), half(p.z)};
      }
      if (has("lies-in-wind") && !faces_.empty()) p.x = std::nan("");
      const std::size_t at = has("vertices-reversed") ? x_.size() - 1 - i : i;
      const double all[] = {p.x, p.y, p.z, u.x, u.y, u.z};
      std::copy(all, all + 3, x + 3 * at);
      std::copy(all + 3, all + 6, v + 3 * at);
    }
  }
  std::string extras() const { return ""; }

 private:
  struct Link {
    std::size_t a, b;
    double rest, k;
  };
  static std::size_t index(const Json& j) { return static_cast<std::size_t>(j.integer()); }
  /// Rounded to eleven bits.
  static double half(double a) {
    int e;
    const double m = std::frexp(a, &e);
    return std::ldexp(std::round(std::ldexp(m, 11)), e - 11);
  }

  V acceleration(std::size_t i) const {
    V g = gravity_;
    if (has("gravity-halved")) g = 0.5 * g;
    if (has("gravity-doubled")) g = 2 * g;
    if (has("gravity-turned-round")) g = -1 * g;
    if (has("gravity-ignored")) g = {};
    if (has("gravity-is-9.80")) g = 9.80 / 9.81 * g;
    if (has("gravity-along-minus-y")) g = {0, -norm(g), 0};
    if (has("gravity-as-a-force")) g = w_[i] * g;
    return g;
  }

  void push_by_wind(double h) {
    for (const auto& f : faces_) {
      const V area = cross(x_[f[1]] - x_[f[0]], x_[f[2]] - x_[f[0]]);  // twice the area
      const double twice = norm(area);
      if (twice == 0) continue;
      const V n = 1 / twice * area;
      V d = wind_;
      if (relative_) d = d - 1.0 / 3 * (v_[f[0]] + v_[f[1]] + v_[f[2]]);
      double c = strength_ * twice / 2;
      if (has("wind-on-twice-the-area")) c *= 2;
      if (has("wind-whole-at-each-corner")) c *= 3;
      if (has("wind-turned-round")) c = -c;
      const V force = c * dot(n, d) * n;
      for (const std::size_t i : f) v_[i] = v_[i] + h * w_[i] / 3 * force;
    }
  }

  void solve_link(std::size_t j, double h) {
    const auto& [a, b, rest, k] = links_[j];
    double wa = w_[a], wb = w_[b];
    if (has("equal-masses")) wa = wa > 0, wb = wb > 0;
    if (has("mass-for-inverse-mass")) wa = wa > 0 ? 1 / wa : 0, wb = wb > 0 ? 1 / wb : 0;
    const V d = x_[b] - x_[a];
    const double length = norm(d);
    if (wa + wb == 0 || length == 0) return;
    double c = length - rest;
    if (has("pulls-and-never-pushes") && c < 0) return;
    if (has("links-ignored")) return;
    if (has("links-pushed-apart")) c = -c;
    double alpha = k > 0 ? 1 / (k * h * h) : 0;
    if (has("compliance-without-the-step") && k > 0) alpha = 1 / k;
    const double held = has("multiplier-forgotten") ? 0 : lambda_[j];
    const double change = (-c - alpha * held) / (wa + wb + alpha);
    lambda_[j] += change;
    const V way = change / length * d;
    if (w_[a] > 0 && !has("moves-one-end-alone")) x_[a] = x_[a] - wa * way;
    if (w_[b] > 0) x_[b] = x_[b] + wb * way;
  }

  void keep_apart() {
    double least = 2 * radius_;
    if (has("self-collision-ignored")) return;
    if (has("self-collision-at-one-radius")) least /= 2;
    for (std::size_t i = 0; i < x_.size(); ++i)
      for (std::size_t j = i + 1; j < x_.size(); ++j) {
        const V d = x_[j] - x_[i];
        const double l = norm(d), w = w_[i] + w_[j];
        if (l >= least || l == 0 || w == 0) continue;
        const V way = (least - l) / (l * w) * d;
        x_[i] = x_[i] - w_[i] * way;
        x_[j] = x_[j] + w_[j] * way;
      }
  }

  void contact(std::size_t i, const Body& body, double t, double h) {
    if (has("planes-ignored") && body.type == "plane") return;
    if (has("capsules-ignored") && body.type == "capsule") return;
    V n;
    const V at = body.motion.back(x_[i], t + h);
    const double thickness = has("thickness-ignored") ? 0 : thickness_;
    const double depth = thickness - body.distance(at, n);
    if (depth <= 0) return;
    if (has("deep-ones-left-inside") && depth > 0.01) return;
    n = body.motion.turn(n, t + h);
    x_[i] = x_[i] + depth * n;
    if (has("bounces")) bounced_[i] = true;
    double mu = body.friction;
    if (has("friction-ignored")) mu = 0;
    if (has("friction-halved")) mu /= 2;
    if (has("friction-doubled")) mu *= 2;
    if (has("friction-sticks")) mu = 1e9;
    if (has("friction-of-upper-sides-alone") && dot(n, gravity_) > 0) mu = 0;
    V carried = body.motion.moved(body.motion.back(before_[i], t), t + h) - before_[i];
    if (has("friction-against-the-world")) carried = {};
    V slip = x_[i] - before_[i] - carried;
    slip = slip - dot(slip, n) * n;
    const double way = norm(slip);
    if (way == 0) return;
    double share = std::min(1.0, mu * depth / way);
    if (has("friction-viscous")) share = std::min(1.0, mu * 0.02);
    x_[i] = x_[i] - share * slip;
  }

  void substep(double t, double h, double dt) {
    const std::size_t n = w_.size();
    before_ = x_;
    bounced_.assign(n, false);
    if (!has("multiplier-kept-from-step-to-step")) lambda_.assign(links_.size(), 0);
    push_by_wind(h);
    for (std::size_t i = 0; i < n; ++i) {
      if (w_[i] == 0) continue;
      v_[i] = v_[i] + (has("gravity-of-the-whole-step") ? dt : h) * acceleration(i);
      double damping = damping_;
      if (has("damping-ignored")) damping = 0;
      if (has("damping-doubled")) damping *= 2;
      if (has("damping-as-a-force")) damping *= w_[i];
      if (has("drag-undeclared")) damping += 0.05;
      v_[i] = std::exp(-damping * h) * v_[i];
      if (has("speed-limit") && norm(v_[i]) > 2) v_[i] = 2 / norm(v_[i]) * v_[i];
      x_[i] = x_[i] + h * v_[i];
    }
    for (const auto& [pin, motion] : pins_)
      if (pinned_[pin])
        x_[pin] = motion.moved(start_[pin], has("pins-a-step-late") ? t + h - dt : t + h);
    const std::vector<V> free = x_;
    for (int k = 0; k < (has("one-sweep-of-a-tenth") ? 1 : sweeps_); ++k) {
      for (std::size_t j = 0; j < links_.size(); ++j) solve_link(j, h);
      if (radius_ > 0) keep_apart();
      for (std::size_t i = 0; i < n; ++i)
        if (w_[i] > 0)
          for (const Body& body : bodies_) contact(i, body, t, h);
    }
    if (has("world-ends-at-two-metres"))
      for (V& x : x_)
        x = {std::clamp(x.x, -2.0, 2.0), std::clamp(x.y, -2.0, 2.0), std::clamp(x.z, -2.0, 2.0)};
    for (std::size_t i = 0; i < n; ++i) {
      if (has("links-leave-velocities")) {
        if (w_[i] > 0 && bodies_.empty()) continue;
      }
      const V was = v_[i];
      v_[i] = 1 / h * (x_[i] - before_[i]);
      if (bounced_[i]) v_[i] = v_[i] - 0.5 * (was - v_[i]);
    }
  }

  std::vector<double> w_, lambda_;
  V gravity_, wind_, kept_;
  double damping_, thickness_, scene_dt_, strength_ = 0, radius_ = 0, own_t_ = 0;
  int sweeps_, substeps_, loads_ = 0;
  bool relative_ = true;
  std::vector<V> x_, v_, before_, start_;
  std::vector<bool> pinned_, bounced_;
  std::vector<Link> links_;
  std::vector<Body> bodies_;
  std::vector<std::pair<std::size_t, Motion>> pins_;
  std::vector<std::array<std::size_t, 3>> faces_;
};

}  // namespace

int main() { return taut_solver::serve<Planted>(); }
