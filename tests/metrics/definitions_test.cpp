// Every metric against its definition, implemented a second time on all states at once: at each
// moment, over the last second and over the run. The cloth moves at random in every way that
// metrics see.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "core/io/scene_io.hpp"
#include "core/model/crossings.hpp"
#include "core/model/index.hpp"
#include "core/model/triangle.hpp"
#include "experiments/metrics/reference.hpp"
#include "tests/metrics/measured.hpp"

namespace taut::definitions_test {
namespace {

/// Scene with masses and rest lengths of every size, pins, and one moving collider of each kind;
/// 140 steps of 1/64 s.
Scene irregular(Draw& draw) {
  Scene scene = sheet(6);
  scene.gravity = {1, -9, 2};
  scene.pins = {0, 1, 5, 35};
  for (double& mass : scene.mesh.mass) mass *= draw.number(0.5, 2);
  for (Link& link : scene.links) link.rest *= draw.number(0.9, 1.1);
  scene.colliders = {
      {.shape = Plane{.normal = Vec3(0.1, 1, 0.3).normalized(), .offset = 0.1},
       .motion = {.velocity = {0, 0.03, 0}}},
      {.shape = Ball{.center = {0.52, -0.1, 0.47}, .radius = 0.25},
       .motion = {.velocity = {0.02, 0.05, 0.01}}},
      {.shape = Box{.center = {0.22, 0.013, 0.77}, .half_extents = {0.1, 0.2, 0.3}},
       .motion = {.velocity = {0.05, 0, -0.1}, .spin = {0, 0.3, 0.1}, .pivot = {0.2, 0, 0.7}}},
      {.shape = Capsule{.from = {0.7, 0, 0.1}, .to = {0.9, 0.1, 0.8}, .radius = 0.15},
       .motion = {.velocity = {0, 0.04, 0}, .spin = {0.2, 0, 0.1}, .pivot = {0.8, 0, 0.4}}}};
  scene.self_collision = SelfCollision{.radius = 0.07};
  scene.thickness = 0.013;
  scene.steps = 140;
  return scene;
}

/// States from the start on, with noise that decays: the cloth is at rest from step 100 on.
std::vector<State> noise(const Scene& scene, Draw& draw) {
  std::vector<State> states(static_cast<std::size_t>(scene.steps) + 1, scene.start);
  for (std::size_t step = 1; step < states.size(); ++step) {
    const double size = draw.number(0.05, 0.15);
    for (Vec3& x : states[step].x) x += draw.vector(size);
    for (Vec3& v : states[step].v) v = draw.vector(step < 100 ? 1 : 1e-3);
    if (step <= 100) continue;
    for (std::size_t i = 0; i < states[step].x.size(); ++i)
      states[step].x[i] = states[100].x[i] + draw.vector(2e-4);
  }
  return states;
}

/// Recorded motion, and the summaries that definitions form of it.
struct Recorded {
  Recorded()
      : scene(irregular(draw)),
        states(noise(scene, draw)),
        values(measure(scene, [&](int step) { return states[to_index(step)]; })) {
    for (int i = 0; i < scene.mesh.size(); ++i)
      if (!std::ranges::count(scene.pins, i)) free.push_back(to_index(i));
  }

  using At = std::function<double(const State&, double t)>;

  double at(const At& f, int step) const { return f(states[to_index(step)], step * scene.dt); }
  double mean(const At& f) const {
    double sum = 0;
    for (int step = 77; step <= 140; ++step) sum += at(f, step) / 64;
    return sum;
  }
  double largest(const At& f, int first, int stride = 1) const {
    double most = -std::numeric_limits<double>::infinity();
    for (int step = 140; step >= first; step -= stride) most = std::max(most, at(f, step));
    return most;
  }
  double rms(const At& f) const { return std::sqrt(mean(f)); }
  double max(const At& f) const { return largest(f, 77); }
  double peak(const At& f) const { return largest(f, 1); }

  void expect(const std::string& name, double value) const {
    ASSERT_TRUE(values.contains(name)) << name;
    EXPECT_NEAR(values.at(name), value, 1e-9 * std::max(1.0, std::abs(value))) << name;
  }
  /// Compares the value that is recorded over time at every step.
  void expect_now(const std::string& name, const At& f) const {
    const auto [entry, value] = find_value(name);
    ASSERT_TRUE(value && value->in_series) << name;
    const auto metric = entry->make(scene);
    const auto place = static_cast<std::size_t>(value - entry->values.data());
    for (int step = 0; step <= 140; ++step) {
      const Snapshot moment{step, step * scene.dt, states[to_index(step)]};
      metric->observe(moment);
      EXPECT_NEAR(metric->now(moment)[place], at(f, step), 1e-9 * std::max(1.0, at(f, step)))
          << name << " at step " << step;
    }
  }

  Draw draw{17};
  Scene scene;
  std::vector<State> states;
  Values values;
  std::vector<std::size_t> free;
};

TEST(Definitions, Stretch) {
  const Recorded r;
  const auto strains = [&](const std::vector<Family>& families, const State& s) {
    std::vector<double> e;
    for (const Link& l : r.scene.links)
      if (std::ranges::count(families, l.family) &&
          !(std::ranges::count(r.scene.pins, l.a) && std::ranges::count(r.scene.pins, l.b)))
        e.push_back((s.x[to_index(l.a)] - s.x[to_index(l.b)]).norm() / l.rest - 1);
    return e;
  };
  const std::pair<std::string, std::vector<Family>> groups[] = {
      {"stretch", {Family::structural, Family::shear}},
      {"structural", {Family::structural}},
      {"shear", {Family::shear}},
      {"bend", {Family::bend}}};
  for (const auto& [name, members] : groups) {
    const auto& families = members;  // a structured binding cannot be captured by clang++ 14
    const auto square = [&](const State& s, double) {
      double sum = 0;
      const auto all = strains(families, s);
      for (const double e : all) sum += e * e / static_cast<double>(all.size());
      return sum;
    };
    const auto longest = [&](const State& s, double) {
      return std::max(0.0, std::ranges::max(strains(families, s)));
    };
    const auto shortest = [&](const State& s, double) {
      return std::max(0.0, -std::ranges::min(strains(families, s)));
    };
    const auto p95 = [&](const State& s, double) {
      auto all = strains(families, s);
      for (double& e : all) e = std::abs(e);
      std::ranges::sort(all);
      std::size_t rank = 1;
      while (100 * rank < 95 * all.size()) ++rank;
      return all[rank - 1];
    };
    r.expect(name + ".rms", r.rms(square));
    r.expect(name + ".max", r.max(longest));
    double sum = 0;
    for (int k = 0; k < 10; ++k) sum += r.at(p95, 140 - 6 * k) / 10;
    r.expect(name + ".p95", sum);
    r.expect_now(name + ".rms", [&](const State& s, double t) { return std::sqrt(square(s, t)); });
    r.expect_now(name + ".max", longest);
    if (name != "stretch") {
      r.expect(name + ".compression", r.max(shortest));
      continue;
    }
    r.expect("stretch.peak", r.peak(longest));
    r.expect("stretch.rms.peak", std::sqrt(r.peak(square)));
    r.expect("compression.max", r.max(shortest));
    r.expect("compression.peak", r.peak(shortest));
    r.expect_now("compression.max", shortest);
  }
}

TEST(Definitions, Area) {
  const Recorded r;
  const auto area = [](const Triangle& t, const std::vector<Vec3>& x) {  // Heron's formula
    const double a = (x[to_index(t[0])] - x[to_index(t[1])]).norm(),
                 b = (x[to_index(t[1])] - x[to_index(t[2])]).norm(),
                 c = (x[to_index(t[2])] - x[to_index(t[0])]).norm(), s = (a + b + c) / 2;
    return std::sqrt(s * (s - a) * (s - b) * (s - c));
  };
  const auto& faces = r.scene.mesh.triangles;
  const auto strain = [&](const Triangle& t, const State& s) {
    return area(t, s.x) / area(t, r.scene.mesh.rest) - 1;
  };
  const auto square = [&](const State& s, double) {
    double sum = 0;
    for (const Triangle& t : faces)
      sum += std::pow(strain(t, s), 2) / static_cast<double>(faces.size());
    return sum;
  };
  const auto growth = [&](const State& s, double) {
    double most = 0;
    for (const Triangle& t : faces) most = std::max(most, strain(t, s));
    return most;
  };
  const auto loss = [&](const State& s, double) {
    double most = 0;
    for (const Triangle& t : faces) most = std::max(most, -strain(t, s));
    return most;
  };
  const auto total = [&](const State& s, double) {
    double now = 0, rest = 0;
    for (const Triangle& t : faces) {
      now += area(t, s.x);
      rest += area(t, r.scene.mesh.rest);
    }
    return now / rest - 1;
  };
  r.expect("area.rms", r.rms(square));
  r.expect("area.max", r.max(growth));
  r.expect("area.loss", r.max(loss));
  r.expect("area.total", r.mean(total));
  r.expect_now("area.rms", [&](const State& s, double t) { return std::sqrt(square(s, t)); });
  r.expect_now("area.max", growth);
  r.expect_now("area.loss", loss);
  r.expect_now("area.total", total);
}

TEST(Definitions, EnergyAndTheCentreOfMass) {
  const Recorded r;
  const auto& mass = r.scene.mesh.mass;
  double total = 0;
  for (const double m : mass) total += m;
  const double unit = total * std::sqrt(86.0) * std::sqrt(2.0);  // m g L of a square of 1 m
  const auto kinetic = [&](const State& s, double) {
    double sum = 0;
    for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * s.v[i].dot(s.v[i]) / (2 * unit);
    return sum;
  };
  const auto center = [&](const State& s) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] / total * s.x[i];
    return sum;
  };
  const Vec3 start = center(r.scene.start);
  const auto energy = [&](const State& s, double t) {
    return kinetic(s, t) - total * Vec3(1, -9, 2).dot(center(s) - start) / unit;
  };
  const auto drift = [&](const State& s, double) { return (center(s) - start).norm(); };
  r.expect("energy.mean", r.mean(energy));
  r.expect("energy.kinetic", r.mean(kinetic));
  r.expect("energy.peak", r.peak(energy));
  r.expect_now("energy.mean", energy);
  r.expect_now("energy.kinetic", kinetic);
  r.expect("drift.max", r.peak(drift));
  r.expect("drift.mean", r.mean(drift));
  r.expect_now("drift.mean", drift);
}

TEST(Definitions, SpeedsRestAndJumps) {
  const Recorded r;
  const auto square = [&](const State& s, double) {
    double sum = 0;
    for (const std::size_t i : r.free)
      sum += s.v[i].squaredNorm() / static_cast<double>(r.free.size());
    return sum;
  };
  const auto fastest = [&](const State& s, double) {
    double most = 0;
    for (const std::size_t i : r.free) most = std::max(most, s.v[i].norm());
    return most;
  };
  r.expect("jitter.rms", r.rms(square));
  r.expect("jitter.max", r.max(fastest));
  r.expect_now("jitter.rms", [&](const State& s, double t) { return std::sqrt(square(s, t)); });
  r.expect_now("jitter.max", fastest);
  int last = 0;  // step at which the final rest begins
  for (int step = 1; step <= 140; ++step)
    for (const std::size_t i : r.free) {
      const State &now = r.states[to_index(step)], &then = r.states[to_index(last)];
      if (now.v[i].norm() > 0.005 || (now.x[i] - then.x[i]).norm() > 0.0005) last = step;
    }
  EXPECT_EQ(last, 100);
  r.expect("settle.time", last * r.scene.dt);
  double max = 0, peak = 0;
  for (std::size_t n = 2; n <= 140; ++n)
    for (const std::size_t i : r.free) {
      const Vec3 a = r.states[n].x[i] - 2 * r.states[n - 1].x[i] + r.states[n - 2].x[i];
      const double pop = a.norm() * 64 * 64 - std::sqrt(86.0);
      peak = std::max(peak, pop);
      if (n >= 77) max = std::max(max, pop);
    }
  r.expect("popping.max", max);
  r.expect("popping.peak", peak);
}

TEST(Definitions, Penetration) {
  const Recorded r;
  const auto depths = [&](const State& s, double t, int kind) {  // kind -1: in any collider
    std::vector<double> all;
    for (const std::size_t i : r.free) {
      double depth = 0;
      for (int c = 0; c < 4; ++c)
        if (kind < 0 || kind == c)
          depth = std::max(depth,
                           -signed_distance(shape_at(r.scene.colliders[to_index(c)], t), s.x[i]));
      if (depth > 0) all.push_back(depth);
    }
    return all;
  };
  int kind = -1;
  for (const std::string name : {"penetration", "penetration.plane", "penetration.ball",
                                 "penetration.box", "penetration.capsule"}) {
    const auto deepest = [&](const State& s, double t) {
      const auto all = depths(s, t, kind);
      return all.empty() ? 0 : std::ranges::max(all);
    };
    const auto mean = [&](const State& s, double t) {
      const auto all = depths(s, t, kind);
      double sum = 0;
      for (const double depth : all) sum += depth / static_cast<double>(all.size());
      return sum;
    };
    r.expect(name + ".max", r.max(deepest));
    r.expect(name + ".peak", r.peak(deepest));
    r.expect(name + ".mean", r.mean(mean));
    r.expect_now(name + ".max", deepest);
    ++kind;
  }
  const auto share = [&](const State& s, double t) {
    return static_cast<double>(depths(s, t, -1).size()) / static_cast<double>(r.free.size());
  };
  const auto gap = [&](const State& s, double t) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : r.free)
      for (const Collider& c : r.scene.colliders)
        least = std::min(least, signed_distance(shape_at(c, t), s.x[i]));
    return least - 0.013;
  };
  r.expect("penetration.share", r.mean(share));
  r.expect("penetration.gap", r.mean(gap));
  r.expect_now("penetration.share", share);
  r.expect_now("penetration.gap", gap);
}

TEST(Definitions, Faces) {
  const Recorded r;
  struct Depths {
    double ball = 0, box = 0, capsule = 0, geometry = 0, excess = 0;
  };
  const auto depths = [&](const State& s, double t) {
    Depths d;
    const Shape ball = shape_at(r.scene.colliders[1], t), box = shape_at(r.scene.colliders[2], t);
    const Shape capsule = shape_at(r.scene.colliders[3], t);
    for (const Triangle& f : r.scene.mesh.triangles) {
      if (std::ranges::all_of(f, [&](int i) { return std::ranges::count(r.scene.pins, i) > 0; }))
        continue;
      const Corners c{s.x[to_index(f[0])], s.x[to_index(f[1])], s.x[to_index(f[2])]};
      d.box = std::max(d.box, deepest_in(std::get<Box>(box), c).depth);
      const auto round = [&](double depth, double radius, double& deepest) {
        if (depth <= 0) return;
        deepest = std::max(deepest, depth);
        const double hover = radius + 0.013, wide = std::min(enclosing_radius(c), hover),
                     geometry = std::max(0.0, radius - std::sqrt(hover * hover - wide * wide));
        d.geometry = std::max(d.geometry, std::min(depth, geometry));
        d.excess = std::max(d.excess, depth - geometry);
      };
      round(deepest_in(std::get<Ball>(ball), c).depth, 0.25, d.ball);
      round(deepest_in(std::get<Capsule>(capsule), c).depth, 0.15, d.capsule);
    }
    return d;
  };
  const auto any = [&](const State& s, double t) {
    const Depths d = depths(s, t);
    return std::max({d.ball, d.box, d.capsule});
  };
  const auto geometry = [&](const State& s, double t) { return depths(s, t).geometry; };
  const auto excess = [&](const State& s, double t) { return depths(s, t).excess; };
  r.expect("face.max", r.max(any));
  r.expect("face.peak", r.peak(any));
  r.expect("face.ball", r.max([&](const State& s, double t) { return depths(s, t).ball; }));
  r.expect("face.box", r.max([&](const State& s, double t) { return depths(s, t).box; }));
  r.expect("face.capsule", r.max([&](const State& s, double t) { return depths(s, t).capsule; }));
  r.expect("face.geometry", r.max(geometry));
  r.expect("face.excess", r.max(excess));
  r.expect_now("face.max", any);
  r.expect_now("face.geometry", geometry);
  r.expect_now("face.excess", excess);
}

TEST(Definitions, SelfIntersection) {
  const Recorded r;
  const auto& faces = r.scene.mesh.triangles;
  const auto count = [&](const State& s, double) {
    const auto at = [&](std::size_t f) {
      const Triangle& t = faces[f];
      return Corners{s.x[to_index(t[0])], s.x[to_index(t[1])], s.x[to_index(t[2])]};
    };
    int pairs = 0;
    for (std::size_t a = 0; a < faces.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const bool apart = std::ranges::none_of(
            faces[a], [&](int i) { return std::ranges::count(faces[b], i) > 0; });
        pairs += apart && (cross(at(a), at(b)) || distance(at(a), at(b)) < 0.0007);
      }
    return static_cast<double>(pairs);
  };
  const auto gap = [&](const State& s, double) {
    double least = 0;
    for (std::size_t i = 0; i < s.x.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        least = std::min(least,
                         (s.x[i] - s.x[j]).norm() -
                             std::min(0.14, (r.scene.mesh.rest[i] - r.scene.mesh.rest[j]).norm()));
    return least;
  };
  r.expect("self.crossings", r.at(count, 140));
  r.expect("self.crossings.max", r.largest(count, 86, 6));
  r.expect("self.crossings.peak", std::max(r.largest(count, 86, 6), r.largest(count, 1, 7)));
  double worst = 0;
  for (int k = 0; k < 10; ++k) worst = std::min(worst, r.at(gap, 140 - 6 * k));
  r.expect("self.gap", worst);
  r.expect_now("self.gap", gap);
}

TEST(Definitions, DistanceFromTheReferences) {
  Scene scene =
      load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/drape.toml");
  const References known = known_references(scene);
  ASSERT_TRUE(known.rest);
  Draw draw(23);
  scene.dt = 0.02;
  scene.steps = 60;  // both differ from the reference's, which does not matter
  std::vector<State> states(61, scene.start);
  for (State& state : states)
    for (Vec3& x : state.x) x += draw.vector(0.1);
  const auto square = [&](int step, const std::vector<Vec3>& from, double& most) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (std::ranges::count(scene.pins, static_cast<int>(i))) continue;
      const double distance = (states[to_index(step)].x[i] - from[i]).norm();
      sum += distance * distance;
      ++count;
      most = std::max(most, distance);
    }
    return sum / count;
  };
  double sum = 0, most = 0;
  for (int step = 11; step <= 60; ++step) sum += square(step, known.rest->x, most) / 50;
  const Values v = measure(scene, [&](int step) { return states[to_index(step)]; });
  EXPECT_NEAR(v.at("reference.rms"), std::sqrt(sum), 1e-12);
  EXPECT_NEAR(v.at("reference.max"), most, 1e-12);
  double strain = 0;
  for (const Link& l : scene.links)
    if (l.family != Family::bend)
      strain = std::max(
          strain,
          std::abs((known.rest->x[to_index(l.a)] - known.rest->x[to_index(l.b)]).norm() / l.rest -
                   1));
  EXPECT_NEAR(v.at("reference.strain"), strain, 1e-15);
}

}  // namespace
}  // namespace taut::definitions_test
