// A bench: what was timed, and the cost of an error that follows.
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/case.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::bench_test {
namespace {

BenchedCase benched(const std::string& solver, double stretch, double cost_per_step,
                    double dt = 0.5) {
  BenchedCase c;
  c.record.key = std::string(64, 'a');
  c.record.id = "sheet " + solver;
  c.record.spec = {"sheet", {}, solver};
  c.record.scene = "sheet";
  c.record.solver = solver_name(solver);
  c.record.dt = dt;
  c.record.steps = 10;
  c.record.values["stretch.rms"] = stretch;
  const double t = cost_per_step;  // the median; the mean differs
  c.timing = {.samples = {t, t / 2, t, 5 * t},
              .wall = {7 * t, 7 * t, 7 * t, 7 * t},
              .peak_bytes = 1000,
              .failure = ""};
  return c;
}

SceneBench sheet() {
  return {"sheet",
          {0.99, 1, 1.01},
          {benched("a:k=1", 0.2, 1e-3), benched("a:k=4", 0.009, 4e-3),
           benched("b:k=1", 0.008, 12e-3), benched("c:k=1", 0.0001, 1e-6)}};
}

TEST(Bench, CostIsPerSimulatedSecond) {
  EXPECT_DOUBLE_EQ(benched("a", 0.1, 1e-3, 0.25).cost().mid, 4e-3);
}

TEST(Bench, ARatioAccountsForDifferentTimeSteps) {
  SceneBench bench{
      "sheet", {1, 1, 1}, {benched("a", 0.1, 1e-3, 0.5), benched("b", 0.1, 1e-3, 0.25)}};
  EXPECT_NEAR(bench.ratio(1, 0)->mid, 2, 1e-12);
}

TEST(Bench, RecordsCarryTheirCost) {
  const auto records = StudyBench{"trade", "", {sheet()}}.records();
  EXPECT_DOUBLE_EQ(records[1].values.at("cpu.per_step"), 4e-3);
  EXPECT_DOUBLE_EQ(records[1].values.at("cpu.per_second"), 8e-3);
}

TEST(Bench, OnlyStepIsInsideTheClock) {
  /// Burns as much CPU time outside of step() as inside.
  class Burner final : public Solver {
   public:
    void load(const State&) override { burn(0.02); }
    void step(double, double) override { burn(0.002); }
    void store(State&) const override { burn(0.02); }
    std::vector<PassCost> step_cost() const override { return {}; }

   private:
    static void burn(double seconds) {
      const auto end = clock() + static_cast<clock_t>(seconds * CLOCKS_PER_SEC);
      while (clock() < end) {
      }
    }
  } solver;
  Scene scene;
  scene.dt = 0.1;
  EXPECT_NEAR(CheckpointedRun(scene, solver, 10).whole().cpu, 0.002, 0.0005);
}

TEST(Bench, AProcessStaysOnTheCoresThatItIsBoundTo) {
  std::thread([] {  // a thread of its own, as the set of cores belongs to a thread
    cpu_set_t before, after;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    bind_to_cores(CPU_COUNT(&before) + 1);
    ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
    EXPECT_TRUE(CPU_EQUAL(&before, &after)) << "it has fewer";
    bind_to_cores(1);
    ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
    EXPECT_EQ(CPU_COUNT(&after), 1);
    CPU_AND(&before, &before, &after);
    EXPECT_EQ(CPU_COUNT(&before), 1) << "one of its own";
  })
      .join();
}

TEST(BenchFiles, AJobOnSeveralNodesOrASharedOneDoesNotTime) {
  const auto with = [](const char* name, const char* value) {
    setenv(name, value, 1);
    std::string said;
    try {
      require_one_quiet_host();
    } catch (const InputError& error) {
      said = error.what();
    }
    unsetenv(name);
    return said;
  };
  EXPECT_NO_THROW(require_one_quiet_host());
  EXPECT_NE(with("SLURM_JOB_NUM_NODES", "2").find("this Slurm job has 2 nodes"), std::string::npos);
  EXPECT_EQ(with("SLURM_JOB_NUM_NODES", "1"), "");
  EXPECT_EQ(with("SLURM_CPUS_ON_NODE", "100000"), "");
  if (sysconf(_SC_NPROCESSORS_ONLN) > 1) {
    EXPECT_NE(with("SLURM_CPUS_ON_NODE", "1").find("sbatch --exclusive"), std::string::npos);
  }
}

}  // namespace
}  // namespace taut::bench_test
