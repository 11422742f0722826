// A million steps in which energy, jitter and memory must not grow. Not part of the default run:
//     ctest -C long -L long
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::long_run_test {
namespace {

constexpr int kSteps = 1'000'000;

/// Resident memory of this process [pages].
long resident_pages() {
  long all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident;
}

/// Measurements of a tenth of the run.
struct Tenth {
  double fastest = 0;                  ///< m/s
  double lowest = 1e300, highest = 0;  ///< kinetic energy plus potential energy above -1 m [J]
  long pages = 0;
};

struct LongRun {
  Status status;
  std::array<Tenth, 10> tenths;
};

LongRun million(Scene scene, const std::string& solver) {
  scene.steps = kSteps;
  LongRun run;
  const auto watch = [&](const Snapshot& m) {
    Tenth& tenth = run.tenths[static_cast<std::size_t>(std::min(9, m.step / (kSteps / 10)))];
    double energy = 0;
    for (std::size_t i = 0; i < m.state.x.size(); ++i) {
      const double mass = scene.mesh.mass[i];
      energy += mass * (m.state.v[i].squaredNorm() / 2 + 9.81 * (m.state.x[i].y() + 1));
      tenth.fastest = std::max(tenth.fastest, m.state.v[i].norm());
    }
    tenth.lowest = std::min(tenth.lowest, energy);
    tenth.highest = std::max(tenth.highest, energy);
    if (m.step % 1000 == 0) tenth.pages = resident_pages();
  };
  run.status =
      run_case(scene, parse_solver(solver), {.measure = false, .watch = watch}).record.status;
  return run;
}

void expect_flat_memory(const LongRun& run) {
  EXPECT_LE(run.tenths[9].pages - run.tenths[0].pages, 64) << "pages of 4 kB";
}

TEST(DISABLED_LongRun, HangRestsForAMillionSteps) {
  for (const char* precision : {"float", "double"}) {
    const LongRun run =
        million(hanging_sheet(6, 6), std::string("jakobsen:precision=") + precision);
    EXPECT_EQ(run.status.kind, Status::Kind::ok) << precision;
    for (std::size_t k = 2; k < 10; ++k) {
      EXPECT_LE(run.tenths[k].fastest, 1e-3) << precision << ", tenth " << k;
      EXPECT_NEAR(run.tenths[k].highest, run.tenths[1].highest, 1e-5)
          << precision << ", tenth " << k;
      EXPECT_NEAR(run.tenths[k].lowest, run.tenths[1].lowest, 1e-5) << precision << ", tenth " << k;
    }
    expect_flat_memory(run);
  }
}

TEST(DISABLED_LongRun, FlagFliesForAMillionSteps) {
  Scene flag = hanging_sheet(8, 6);
  flag.pins.clear();
  for (int j = 0; j < 6; ++j) flag.pins.push_back(flag.mesh.grid->index(0, j));
  flag.wind = Wind{.velocity = {8, 0, 2}, .strength = 0.5};
  const LongRun run = million(flag, "jakobsen");
  EXPECT_EQ(run.status.kind, Status::Kind::ok);
  for (std::size_t k = 2; k < 10; ++k) {
    EXPECT_LE(run.tenths[k].highest, 2 * run.tenths[1].highest) << "tenth " << k;
    EXPECT_LE(run.tenths[k].fastest, 2 * run.tenths[1].fastest + 0.1) << "tenth " << k;
  }
  expect_flat_memory(run);
}

}  // namespace
}  // namespace taut::long_run_test
