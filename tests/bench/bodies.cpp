// Cost of a body of triangles: reading, building, refitting, and queries with points and paths.
#include "tests/support/bodies.hpp"

#include <benchmark/benchmark.h>

#include <cstdio>
#include <random>
#include <string>

#include "core/io/mesh_io.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/deforming_body.hpp"
#include "tests/bench/bench.hpp"

namespace taut::bench {

namespace {

/// Ten thousand points within 1 cm of the surface of a ball of 1 m, and ten thousand in a cube
/// around the ball.
struct Questions {
  std::vector<Vec3> near, anywhere;
  Questions() {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<> within(-1, 1);
    const auto point = [&] {
      const double x = within(random), y = within(random), z = within(random);
      return Vec3(x, y, z);
    };
    for (int n = 0; n < 10000; ++n) {
      near.push_back((1 + 0.01 * within(random)) * point().normalized());
      anywhere.push_back(2 * point());
    }
  }
};

template <class F>
double seconds(const F& f) {
  const double begin = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  f();
  return seconds_of(CLOCK_THREAD_CPUTIME_ID) - begin;
}

std::string as_obj(const Triangles& body) {
  std::string text;
  char line[120];
  for (const Vec3& x : body.vertices) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", x.x(), x.y(), x.z());
    text += line;
  }
  for (const auto& [a, b, c] : body.triangles) {
    std::snprintf(line, sizeof line, "f %d %d %d\n", a + 1, b + 1, c + 1);
    text += line;
  }
  return text;
}

/// Body whose vertices move a few centimetres per second.
Collider leaning(const Triangles& body) {
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 1;
  frames->places = {body.vertices, body.vertices};
  for (Vec3& x : frames->places[1]) x += Vec3(0.02 * x.y(), 0.03, 0.01 * x.x());
  return {.shape = MeshBody{body.mesh()}, .frames = frames};
}

void body(benchmark::State& state) {
  const Triangles ball = ball_of_triangles(1, static_cast<int>(state.range(0)));
  const Questions questions;
  TriangleMesh mesh(ball.vertices, ball.triangles);
  const double count = static_cast<double>(ball.triangles.size()),
               asked = static_cast<double>(questions.near.size());
  const std::string text = as_obj(ball);
  DeformingBody deforming(leaning(ball));
  double read = 0, make = 0, refit = 0, near = 0, anywhere = 0, hit = 0, rounds = 0;
  double moving_hit = 0;
  for (auto _ : state) {
    read += seconds([&] { benchmark::DoNotOptimize(parse_body_obj("ball.obj", text)); });
    make += seconds([&] { benchmark::DoNotOptimize(TriangleMesh(ball.vertices, ball.triangles)); });
    refit += seconds([&] { mesh.refit(ball.vertices); });
    near += seconds([&] {
      for (const Vec3& p : questions.near) benchmark::DoNotOptimize(mesh.nearest(p));
    });
    anywhere += seconds([&] {
      for (const Vec3& p : questions.anywhere) benchmark::DoNotOptimize(mesh.nearest(p));
    });
    hit += seconds([&] {
      for (const Vec3& p : questions.near)
        benchmark::DoNotOptimize(mesh.first_hit(1.1 * p, 0.9 * p));
    });
    deforming.move(0, 0.1);
    moving_hit += seconds([&] {
      for (const Vec3& p : questions.near)
        benchmark::DoNotOptimize(deforming.first_hit(1.1 * p, 0.9 * p));
    });
    ++rounds;
  }
  state.counters["triangles"] = count;
  state.counters["read_s"] = read / rounds;
  state.counters["make_s"] = make / rounds;
  state.counters["refit_s"] = refit / rounds;
  state.counters["nearest_at_1cm_s"] = near / rounds / asked;
  state.counters["nearest_anywhere_s"] = anywhere / rounds / asked;
  state.counters["first_hit_s"] = hit / rounds / asked;
  state.counters["first_hit_deforming_s"] = moving_hit / rounds / asked;
  state.counters["bytes"] = static_cast<double>(mesh.bytes());
}

}  // namespace

void register_bodies() {
  benchmark::RegisterBenchmark("body", body)
      ->ArgName("cuts")
      ->Arg(3)
      ->Arg(5)
      ->Arg(7)
      ->Arg(9)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace taut::bench
