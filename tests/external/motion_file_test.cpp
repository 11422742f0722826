// Positions from a file as a motion of the scene's cloth: place, order, time, and what rounding
// costs.
#include "experiments/external/motion_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/io/positions/positions.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"

namespace taut::external::motion_file_test {
namespace {

namespace fs = std::filesystem;

Scene sheet() {
  Scene scene;
  scene.name = "sheet";
  scene.mesh = make_sheet({.nu = 9, .nv = 7, .width = 1, .height = 0.8, .mass = 1});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.shear = true});
  scene.dt = 1.0 / 64;
  scene.steps = 3;
  return scene;
}

class MotionFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("taut_motion_" + std::to_string(getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Frame k of the scene's cloth on its way down, as `place` puts it into a file.
  template <class Place>
  MotionOptions write(const char* name, const Scene& scene, const Place& place,
                      int frames = 4) const {
    const auto writer = create_positions(folder_ / name, scene.mesh);
    for (int k = 0; k < frames; ++k) writer->append(k * scene.dt, place(moved(scene, k)));
    writer->finish();
    return {.file = folder_ / name};
  }
  static std::vector<Vec3> moved(const Scene& scene, int k) {
    std::vector<Vec3> x = scene.start.x;
    for (Vec3& v : x) v += Vec3(0.01 * k * v.y(), -0.003 * k, 0);
    return x;
  }
  static std::string misfit(const Scene& scene, const MotionOptions& options) {
    const MotionFile motion(scene, options);
    return motion.misfits().empty() ? "" : motion.misfits().front();
  }
  fs::path folder_;
};

const auto kAsIs = [](std::vector<Vec3> x) { return x; };

TEST_F(MotionFiles, UnitAxesAndOrderAreFoundOut) {
  const Scene scene = sheet();
  std::vector<std::size_t> order(scene.mesh.rest.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  for (const double unit : {1.0, 0.01, 0.001, 0.0254})
    for (const bool z_up : {false, true}) {
      MotionOptions file = write("a.npy", scene, [&](const std::vector<Vec3>& x) {
        std::vector<Vec3> y;
        for (const std::size_t i : order)
          y.push_back((z_up ? Vec3(x[i].x(), -x[i].z(), x[i].y()) : x[i]) / unit);
        return y;
      });
      MotionFile motion(scene, file);
      ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
      for (int k = 0; k < 4; ++k) {
        const std::vector<Vec3> x = motion.frame(k), want = moved(scene, k);
        for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - want[i]).norm(), 1e-14);
      }
      if (unit != 1) {
        EXPECT_NE(misfit(scene, {.file = file.file, .scale = 1}).find("on none of the"),
                  std::string::npos);
      }
      if (z_up) {
        EXPECT_NE(misfit(scene, {.file = file.file, .up = "y"}).find("on none of the"),
                  std::string::npos);
      }
    }
}

TEST_F(MotionFiles, WhatIsNotTheSceneIsRefusedWithTheNearestMismatch) {
  const Scene scene = sheet();
  const MotionOptions other = write("a.npy", scene, [](std::vector<Vec3> x) {
    x[5].z() += 0.01;
    return x;
  });
  EXPECT_NE(misfit(scene, other)
                .find("1 of its 63 vertices lie on none of the scene: its vertex 5 is at "
                      "(0.625, 0, 0.01), 0.01 m from the nearest, the scene's vertex 5"),
            std::string::npos)
      << misfit(scene, other);
  const MotionOptions twice = write("b.npy", scene, [](std::vector<Vec3> x) {
    x[1] = x[7];
    return x;
  });
  EXPECT_NE(misfit(scene, twice).find("its vertices 1 and 7 both lie on the scene's vertex 7"),
            std::string::npos)
      << misfit(scene, twice);
  const MotionOptions fewer = write("c.npy", scene, [](std::vector<Vec3> x) {
    x.pop_back();
    return x;
  });
  EXPECT_NE(misfit(scene, fewer).find("62 vertices, the scene has 63"), std::string::npos);
  EXPECT_NE(misfit(scene, write("d.npy", scene, kAsIs, 3)).find("has 3 frames, the scene needs 4"),
            std::string::npos);
  EXPECT_NE(misfit(scene, {.file = write("e.npy", scene, kAsIs).file, .fps = 24})
                .find("has a frame each 0.0416"),
            std::string::npos);
  EXPECT_EQ(misfit(scene, {.file = folder_ / "e.npy", .fps = 64}), "");
}

/// A scene that does not start at rest, in a file that does not begin with its start.
TEST_F(MotionFiles, TheOrderMayComeFromARestShape) {
  Scene scene = sheet();
  std::vector<Vec3> crumpled;
  for (const Vec3& v : scene.mesh.rest) crumpled.emplace_back(0.1 * v.x(), 0, v.y());
  scene.start.x = crumpled;
  const auto reversed = [](std::vector<Vec3> x) {
    std::ranges::reverse(x);
    for (Vec3& v : x) v.y() -= 0.05;
    return x;
  };
  MotionOptions file = write("a.npy", scene, reversed);
  EXPECT_NE(misfit(scene, file), "");
  Scene flat = scene;
  flat.start.x = scene.mesh.rest;
  write("rest.obj", flat, [](std::vector<Vec3> x) {
    std::ranges::reverse(x);
    return x;
  });
  file.rest = folder_ / "rest_00000.obj";
  MotionFile motion(scene, file);
  ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
  EXPECT_LT((motion.frame(0)[3] - crumpled[3] - Vec3(0, -0.05, 0)).norm(), 1e-14);
}

TEST_F(MotionFiles, TimesThatAreNotEvenAreAnError) {
  const Scene scene = sheet();
  const auto writer = create_positions(folder_ / "a.mdd", scene.mesh);
  for (const double t : {0.0, 1.0 / 64, 1.0 / 16, 1.0 / 8}) writer->append(t, scene.start.x);
  writer->finish();
  EXPECT_THROW(MotionFile(scene, {.file = folder_ / "a.mdd"}), InputError);
}

double strain_rms(const Scene& scene, const std::vector<Vec3>& x) {
  double sum = 0;
  for (const Link& link : scene.links)
    sum += std::pow((x[to_index(link.b)] - x[to_index(link.a)]).norm() / link.rest - 1, 2);
  return std::sqrt(sum / static_cast<double>(scene.links.size()));
}

/// A rigid motion has no strain: what a file shows of it is its rounding alone.
TEST_F(MotionFiles, TheFloorIsWhatTheRoundingDoes) {
  const Scene scene = sheet();
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  const auto rigid = [&](const std::vector<Vec3>&) {
    std::vector<Vec3> x;
    for (const Vec3& v : scene.mesh.rest) x.push_back(turn * v + Vec3(0.3, 0.4, 0.5));
    return x;
  };
  Scene turned = scene;
  turned.start.x = rigid({});
  for (const char* name : {"a.pc2", "a.mdd", "a.npy"}) {
    MotionFile motion(turned, write(name, turned, rigid));
    ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
    const StrainFloor floor = motion.floor(turned);
    const double seen = strain_rms(turned, motion.frame(3));
    EXPECT_GT(seen, floor.rms / 2) << name;
    EXPECT_LT(seen, floor.rms * 2) << name;
    EXPECT_LT(seen, floor.max) << name;
  }
  // Six decimals, as Blender writes them.
  for (int k = 0; k < 4; ++k) {
    std::ofstream out(folder_ / ("six" + std::to_string(k) + ".obj"));
    out.setf(std::ios::fixed), out.precision(6);
    for (const Vec3& v : rigid({})) out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  MotionFile six(turned, {.file = folder_ / "six0.obj"});
  const double seen = strain_rms(turned, six.frame(3)), floor = six.floor(turned).rms;
  EXPECT_GT(seen, floor / 2);
  EXPECT_LT(seen, floor * 2);
}

}  // namespace
}  // namespace taut::external::motion_file_test
