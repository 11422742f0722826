// order=jolt is the order in which Jolt's soft body visits its edges. In this order float32
// arithmetic reproduces Jolt's bits. experiments/external/README.md explains how to register Jolt
// itself.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "core/io/scene_io.hpp"
#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/solver/layout/order.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/external/external.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/json.hpp"

namespace taut::external::jolt_test {
namespace {

Scene scene_of(const std::string& name, const SceneSettings& settings = {}) {
  return load_scene(find_scene(name), settings);
}

Scene hanging(int side) {
  const std::string n = std::to_string(side);
  return scene_of("hang", {"cloth.grid=[" + n + "," + n + "]"});
}

/// The digests were taken of mEdgeConstraints in npm's jolt-physics 1.1.0 after Optimize().
TEST(JoltOrder, IsWhatJoltSays) {
  const auto read = [](const Scene& scene) {
    std::string text;
    for (const Link& link : jolt_order(scene))
      text += std::to_string(link.a) + " " + std::to_string(link.b) + "\n";
    return sha256(text).substr(0, 16);
  };
  EXPECT_EQ(read(hanging(16)), "0b90c17e351d0451");  // less than two batches of links
  EXPECT_EQ(read(hanging(32)), "2084215cb497754b");
  EXPECT_EQ(read(scene_of("hang", {"cloth.grid=[40, 37]"})), "c829ed698aac19f3");
  EXPECT_EQ(read(scene_of("drape")), "108c5f04af1ea90d");
  EXPECT_EQ(read(scene_of("swing")), "a00e262e3856403e");
  EXPECT_EQ(read(scene_of("fall")), "4a17ff3901fc92bb");  // a scene without pins
  EXPECT_EQ(read(scene_of("chain")), "1d9341fd8bf25c37");
  EXPECT_EQ(read(scene_of("disc")), "6b233fbdf59012e7");  // a mesh that is not a grid
}

using Point = std::array<float, 3>;

/// Jolt's step in float32, written out: substeps with one sweep and no compliance.
std::vector<Point> listing(const Scene& scene, int substeps, int steps) {
  std::vector<Point> x, v(scene.start.x.size());
  std::vector<float> w;
  for (const Vec3& p : scene.start.x)
    x.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  for (const double inverse : inverse_masses(scene)) w.push_back(static_cast<float>(inverse));
  const std::vector<Link> links = jolt_order(scene);
  const float h = static_cast<float>(scene.dt) / static_cast<float>(substeps);
  for (int n = 0; n < steps * substeps; ++n) {
    const std::vector<Point> before = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        if (w[i] > 0) v[i][k] += static_cast<float>(scene.gravity[static_cast<int>(k)]) * h;
        x[i][k] += v[i][k] * h;
      }
    for (const Link& link : links) {
      const std::size_t a = to_index(link.a), b = to_index(link.b);
      const Point d{x[b][0] - x[a][0], x[b][1] - x[a][1], x[b][2] - x[a][2]};
      const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      const float too_long = length - static_cast<float>(link.rest), share = length * (w[a] + w[b]);
      for (std::size_t k = 0; k < 3 && share > 0; ++k) {
        const float move = d[k] * too_long / share;
        x[a][k] += w[a] * move;
        x[b][k] -= w[b] * move;
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; k < 3 && w[i] > 0; ++k) v[i][k] = (x[i][k] - before[i][k]) / h;
  }
  return x;
}

std::vector<Vec3> run_jolt(const Scene& scene, int substeps, int steps) {
  Connection connection(command_of("jolt"));
  say_hello(connection);
  give_scene(connection, scene, {{"substeps", substeps}});
  load_state(connection, scene.start);
  for (int n = 0; n < steps; ++n) take_steps(connection, n * scene.dt, scene.dt, 1);
  State state;
  store_state(connection, scene.mesh.size(), state);
  return state.x;
}

double rms_stretch(const Scene& scene, const std::vector<Vec3>& x) {
  double sum = 0;
  for (const Link& l : scene.links)
    sum += std::pow((x[to_index(l.b)] - x[to_index(l.a)]).norm() / l.rest - 1, 2);
  return std::sqrt(sum / static_cast<double>(scene.links.size()));
}

class JoltTwin : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_regular_file(registered_folder() / "jolt.toml"))
      GTEST_SKIP() << "jolt is not registered: experiments/external/README.md";
  }
};

TEST_F(JoltTwin, BitForBitInFloat32) {
  for (const int side : {9, 16, 32}) {
    const Scene scene = hanging(side);
    const std::vector<Vec3> theirs = run_jolt(scene, 15, 60);
    const std::vector<Point> ours = listing(scene, 15, 60);
    int differ = 0;
    for (std::size_t i = 0; i < ours.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        differ += static_cast<float>(theirs[i][static_cast<int>(k)]) != ours[i][k];
    EXPECT_EQ(differ, 0) << side;
    EXPECT_GT(rms_stretch(scene, theirs), 1e-4) << "it does not move";
    if (side == 32) {
      EXPECT_NEAR(rms_stretch(scene, theirs), 0.439, 0.001);  // as stated in experiments/external
    }
  }
}

/// Verlet stores positions instead of velocities: the sweeps are the same, the rounding is not.
TEST_F(JoltTwin, JakobsenInItsOrderIsItsTwin) {
  const Scene scene = hanging(16);
  const std::vector<Vec3> theirs = run_jolt(scene, 15, 8);
  const auto distance = [&](const std::string& order) {
    const SolverChoice choice = parse_solver(
        "jakobsen:iterations=1,substeps=15,projection=exact,precision=double,order=" + order);
    const auto solver = choice.entry->make(scene, choice.params);
    solver->load(scene.start);
    State state;
    for (int n = 0; n < 8; ++n) solver->step(n * scene.dt, scene.dt);
    solver->store(state);
    double most = 0;
    for (std::size_t i = 0; i < theirs.size(); ++i)
      most = std::max(most, (state.x[i] - theirs[i]).norm());
    return most;
  };
  EXPECT_LT(distance("jolt"), 2e-5);
  EXPECT_GT(distance("mesh"), 1e-4);
}

}  // namespace
}  // namespace taut::external::jolt_test
