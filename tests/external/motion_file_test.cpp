// Positions from a file as a motion of the scene's cloth: place, order of vertices, time, and the
// error of rounding.
#include "experiments/external/motion_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <locale>
#include <random>
#include <set>

#include "core/io/positions/positions.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/run_case.hpp"

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

  /// Writes frames of the falling cloth as `place` maps their vertices into the file.
  template <class Place>
  MotionOptions write(const char* name, const Scene& scene, const Place& place,
                      int frames = 4) const {
    const auto writer = create_positions(folder_ / name, scene.mesh);
    for (int k = 0; k < frames; ++k) writer->append(k * scene.dt, place(moved(scene, k)));
    return {.file = folder_ / name};
  }
  static std::vector<Vec3> moved(const Scene& scene, int k) {
    std::vector<Vec3> x = scene.start.x;
    for (Vec3& v : x) v += Vec3(0.01 * k * v.y(), -0.003 * k, 0.004 * k * v.x());
    return x;
  }
  static std::string misfit(const Scene& scene, const MotionOptions& options) {
    const ComputedMotion motion(scene, opened(options));
    return motion.misfits().empty() ? "" : motion.misfits().front();
  }
  fs::path folder_;
};

const auto kAsIs = [](std::vector<Vec3> x) { return x; };

TEST_F(MotionFiles, UnitAndAxisAreSaidAndTheOrderIsFound) {
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
      file.scale = unit;
      file.z_up = z_up;
      ComputedMotion motion(scene, opened(file));
      ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
      for (int k = 0; k < 4; ++k) {
        const std::vector<Vec3> x = motion.frame(k), want = moved(scene, k);
        for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - want[i]).norm(), 1e-14);
      }
      if (unit != 1) {
        EXPECT_NE(misfit(scene, {.file = file.file, .z_up = z_up}).find("on none of the"),
                  std::string::npos);
      }
      if (z_up) {
        EXPECT_NE(misfit(scene, {.file = file.file, .scale = unit}).find("on none of the"),
                  std::string::npos);
      }
    }
}

TEST_F(MotionFiles, WhatIsNotTheSceneIsRefused) {
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

TEST_F(MotionFiles, AVertexThatLeavesItsPinRefusesTheFile) {
  Scene scene = sheet();
  scene.pins = {0, 8};
  scene.pin_motions = {{.vertices = {8}, .motion = {.velocity = Vec3(0, 0.5, 0)}}};
  const auto held = [&](double off) {
    int k = 0;
    return write("pins.npy", scene, [&](std::vector<Vec3> x) {
      x[0] = scene.start.x[0];
      x[8] = scene.start.x[8] + Vec3(k == 2 ? off : 0, 0.5 * k * scene.dt, 0);
      ++k;
      return x;
    });
  };
  EXPECT_EQ(misfit(scene, held(0)), "");
  EXPECT_EQ(misfit(scene, held(0.9e-4 * extent(scene))), "");
  EXPECT_NE(misfit(scene, held(0.3)).find("does not hold the scene's pins: vertex 8 is 0.3 m from"),
            std::string::npos);
}

// FILES.md: a non-finite coordinate is a result, also for a pin.
TEST_F(MotionFiles, WhatIsNotFiniteExplodesWhereItStands) {
  Scene scene = sheet();
  scene.pins = {0, 8};
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const std::size_t vertex : {std::size_t{8}, std::size_t{20}}) {
      int k = 0;
      const MotionOptions file = write("pins.npy", scene, [&](std::vector<Vec3> x) {
        x[0] = scene.start.x[0];
        x[8] = scene.start.x[8];
        if (k >= 2) x[vertex].y() = value;
        ++k;
        return x;
      });
      const Params params("positions", kPositions.params, solver_text(file).substr(10));
      const CaseRun run = run_case(scene, {&kPositions, params});
      EXPECT_EQ(run.record.status.kind, Status::Kind::exploded) << run.record.status.reason.text();
      EXPECT_EQ(run.record.status.reason, Reason::nonfinite);
      EXPECT_EQ(run.record.status.step, 2);
      EXPECT_EQ(run.record.status.vertex, static_cast<int>(vertex));
    }
}

/// The scene starts crumpled, and the file does not begin at the scene's start.
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
  ComputedMotion motion(scene, opened(file));
  ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
  EXPECT_LT((motion.frame(0)[3] - crumpled[3] - Vec3(0, -0.05, 0)).norm(), 1e-14);
}

double strain_rms(const Scene& scene, const std::vector<Vec3>& x) {
  double sum = 0;
  for (const Link& link : scene.links)
    sum += std::pow((x[to_index(link.b)] - x[to_index(link.a)]).norm() / link.rest - 1, 2);
  return std::sqrt(sum / static_cast<double>(scene.links.size()));
}

/// A rigid motion has no strain, so that strain in its file is rounding alone.
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
  for (const char* name : {"a.pc2", "a.npy"}) {
    ComputedMotion motion(turned, opened(write(name, turned, rigid)));
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
    out.imbue(std::locale::classic());
    out.setf(std::ios::fixed);
    out.precision(6);
    for (const Vec3& v : rigid({})) out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  ComputedMotion six(turned, opened({.file = folder_ / "six0.obj"}));
  const double seen = strain_rms(turned, six.frame(3)), floor = six.floor(turned).rms;
  EXPECT_GT(seen, floor / 2);
  EXPECT_LT(seen, floor * 2);
}

/// Value of a setting by its name.
std::string setting(const Scene& scene, const MotionOptions& options, const std::string& name) {
  const ResolvedSettings all = ComputedMotion(scene, opened(options)).settings(scene);
  const ResolvedSetting* one = find_setting(all, name);
  return one ? one->text : "";
}

TEST_F(MotionFiles, WhatWasSaidReadOrDerivedIsInTheSettings) {
  const Scene scene = sheet();
  const MotionOptions plain = write("a.npy", scene, kAsIs);
  EXPECT_EQ(setting(scene, plain, "frames"), "4 of 63 vertices, float64");
  Scene shorter = scene;
  shorter.steps = 2;
  EXPECT_EQ(setting(shorter, plain, "frames"),
            "4 of 63 vertices, float64; scored are the first 3, with which the scene ends");
  EXPECT_EQ(setting(scene, plain, "time step"),
            "0.015625 s a frame, assumed: the scene's; fps says otherwise");
  EXPECT_EQ(setting(scene, plain, "unit"), "1 unit is 1 m, y up");
  EXPECT_EQ(setting(scene, plain, "vertex order"), "as in the scene, at the start at most 0 m off");
  EXPECT_EQ(setting(scene, {.file = plain.file, .fps = 64}, "time step"),
            "0.015625 s a frame, as said");
  MotionOptions turned = write("b.npy", scene, [](std::vector<Vec3> x) {
    std::swap(x[3], x[60]);
    for (Vec3& v : x) v = Vec3(v.x(), -v.z(), v.y()) * 100;
    return x;
  });
  EXPECT_EQ(misfit(scene, turned).substr(folder_.string().size(), 54),
            "/b.npy does not begin as sheet does, at 1 unit is 1 m,");
  EXPECT_EQ(
      misfit(scene, {.file = plain.file, .rest = turned.file}).substr(folder_.string().size(), 46),
      "/b.npy is not sheet at rest, at 1 unit is 1 m,");
  turned.scale = 0.01;
  turned.z_up = true;
  EXPECT_EQ(setting(scene, turned, "unit"), "1 unit is 0.01 m, z up");
  EXPECT_TRUE(
      setting(scene, turned, "vertex order").starts_with("matched by position, at the start"));
  EXPECT_EQ(ComputedMotion(scene, opened({.file = plain.file, .fps = 50})).frame_dt(), 0.02);
  EXPECT_EQ(ComputedMotion(scene, opened({.file = plain.file, .fps = 0.5})).frame_dt(), 2);
}

TEST_F(MotionFiles, AVertexMayBeginSlightlyOffItsPlace) {
  const Scene scene = sheet();
  const double tolerance = 1e-4 * extent(scene);
  for (const auto& [share, good] : {std::pair{0.98, true}, {1.02, false}}) {
    for (const bool shuffled : {false, true}) {
      const MotionOptions file = write("a.npy", scene, [&, share = share](std::vector<Vec3> x) {
        x[20] += share * tolerance * Vec3(0.6, 0, 0.8);
        if (shuffled) std::swap(x[20], x[40]);
        return x;
      });
      EXPECT_EQ(misfit(scene, file).empty(), good) << share << shuffled;
      if (!good) continue;
      ComputedMotion motion(scene, opened(file));
      EXPECT_NEAR((motion.frame(0)[20] - scene.start.x[20]).norm(), share * tolerance, 1e-12);
      EXPECT_NEAR((motion.frame(0)[40] - scene.start.x[40]).norm(), 0, 1e-12);
    }
  }
}

// Rounding to a step q is uniformly distributed and has the variance q^2/12. A link's length has
// the variance 2 q^2/12 in any direction, and its error is at most q (|x| + |y| + |z|) of the
// link's direction.
TEST_F(MotionFiles, TheFloorOfAStepIsItsVarianceOverTheRestLength) {
  Scene scene = sheet();
  scene.mesh = make_sheet({.nu = 9, .nv = 5, .width = 0.4, .height = 0.32, .mass = 1});
  scene.links = grid_links(scene.mesh, {.shear = true});
  const auto check = [&](const char* name, double z, double step, const std::string& text = "",
                         double unit = 1) {
    scene.start = {scene.mesh.rest, std::vector<Vec3>(45, Vec3::Zero())};
    for (Vec3& v : scene.start.x) v += Vec3(0.55, 0.95, z);  // all coordinates within 0.5 to 1
    MotionOptions options{.file = folder_ / name, .scale = unit};
    if (text.empty())
      options = write(name, scene, [&](const std::vector<Vec3>&) { return scene.start.x; });
    for (int k = 0; k < 4 && !text.empty(); ++k) {
      std::ofstream out(folder_ / (text + std::to_string(k) + ".obj"));
      out.imbue(std::locale::classic());
      out.precision(9);
      for (const Vec3& v : scene.start.x)
        out << "v " << v.x() / unit << ' ' << v.y() / unit << ' ' << v.z() / unit << '\n';
    }
    ComputedMotion motion(scene, opened(options));
    ASSERT_TRUE(motion.misfits().empty()) << motion.misfits().front();
    double sum = 0, most = 0;
    for (const Link& link : scene.links) {
      const Vec3 along =
          (scene.start.x[to_index(link.b)] - scene.start.x[to_index(link.a)]) / link.rest;
      sum += step * step / 6 / (link.rest * link.rest);
      most = std::max(most, step * along.lpNorm<1>() / link.rest);
    }
    const StrainFloor floor = motion.floor(scene);
    const double rms = std::sqrt(sum / static_cast<double>(scene.links.size()));
    EXPECT_NEAR(floor.rms, rms, 1e-3 * rms) << name;
    EXPECT_NEAR(floor.max, most, 1e-3 * most) << name;
  };
  check("a.npy", 0.6, std::ldexp(1, -53));
  check("a.pc2", 0.6, std::ldexp(1, -24));
  check("three0.obj", 0.551, 1e-3, "three");
  check("six0.obj", 0.551237, 1e-6, "six");
  check("cm0.obj", 0.551237, 1e-6, "cm", 0.01);  // four decimals of a centimetre
}

TEST_F(MotionFiles, ArePlayedWithDifferencesAsVelocities) {
  const Scene scene = sheet();
  const MotionOptions file = write("it's.npy", scene, kAsIs);
  const std::string text = solver_text(file);
  EXPECT_EQ(text, "positions:file='" + folder_.string() + "/it''s.npy',fps=0,scale=1,up=y");
  EXPECT_EQ(solver_text({.file = "a", .fps = 24, .scale = 0.01, .z_up = true, .rest = "r.obj"}),
            "positions:file='a',fps=24,scale=0.01,up=z,rest='r.obj'");
  const Params params("positions", kPositions.params, text.substr(10));
  EXPECT_TRUE(kPositions.unsupported(scene, params).empty());
  EXPECT_EQ(kPositions.unsupported(scene, Params("positions", kPositions.params, "")).size(), 1u);
  const auto solver = kPositions.make(scene, params);
  solver->load(scene.start);
  for (int k = 0; k < 3; ++k) {
    solver->step(k * scene.dt, scene.dt);
    State state;
    solver->store(state);
    const std::vector<Vec3> before = moved(scene, k), now = moved(scene, k + 1);
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_LT((state.x[i] - now[i]).norm(), 1e-15);
      EXPECT_LT((state.v[i] - (now[i] - before[i]) / scene.dt).norm(), 1e-12);
    }
  }
  EXPECT_TRUE(std::isnan(solver->cpu_seconds()));
  EXPECT_EQ(solver->peak_bytes(), 0u);
  EXPECT_TRUE(solver->step_cost().empty());
  Scene longer = scene;
  longer.steps = 4;
  EXPECT_THROW(kPositions.make(longer, params), InputError);
  const std::string other = solver_text(write("b.npy", scene, [](std::vector<Vec3> x) {
    x[0].z() += 1e-6;
    return x;
  }));
  const SolverEntry *one = recorded("positions", text.substr(10)),
                    *same = recorded("positions", text.substr(10)),
                    *two = recorded("positions", other.substr(10));
  EXPECT_EQ(one, same);
  EXPECT_NE(one->implementation, two->implementation) << "of all bytes";
  EXPECT_NE(one->name, two->name);
  std::set<std::string> digests;
  for (const double height : {0.0, 1e-6}) {
    Scene rest = scene;
    rest.start.x[5].y() += height;
    write("shape.npy", rest, kAsIs, 1);
    MotionOptions with_rest = file;
    with_rest.rest = folder_ / "shape.npy";
    digests.emplace(recorded("positions", solver_text(with_rest).substr(10))->implementation);
  }
  EXPECT_EQ(digests.size(), 2u) << "of the rest shape's, too";
  EXPECT_EQ(recorded("mine", text.substr(10))->name, "mine");
}

}  // namespace
}  // namespace taut::external::motion_file_test
