// An effect that a scene lacks costs `jakobsen` neither memory nor time: no pass, no bytes on the
// heap, and no branch executed for each item. The tests use no clock and so hold on any machine.
// They cannot detect a flag that a kernel tests once for a whole vector or turns into a mask or a
// factor; cost that the hardware adds, such as displaced caches; and branches of the interleaved
// layout, whose kernels loop over lanes at the seams.
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <optional>
#include <set>

#include "tests/support/cloths.hpp"

namespace taut::absent_is_free_test {
namespace {

/// Order in which links are swept. The coloured order uses the layout that suits the mesh.
struct Way {
  const char* order;
  /// whether the sheet is known to be regular: interleaved columns if so, else colour batches
  bool grid;
};
constexpr Way kWays[] = {{"coloured", true}, {"coloured", false}, {"mesh", true}};

std::string solver_of(const Way& way) { return std::string("jakobsen:order=") + way.order; }

std::unique_ptr<Solver> make(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  return choice.entry->make(scene, choice.params);
}

std::set<std::string> passes(const Scene& scene, const std::string& solver) {
  std::set<std::string> names;
  for (const PassCost& cost : make(scene, solver)->step_cost()) names.insert(cost.pass);
  return names;
}

/// Optional effect of a scene, and the name of its pass.
struct Effect {
  const char* pass;
  std::function<void(Scene&)> add;
};

const std::vector<Effect> kEffects{
    {"pins", [](Scene& s) { s.pins = {0}; }},
    {"wind",
     [](Scene& s) {
       s.wind = Wind{.velocity = {1, 0, 0}, .strength = 1};
     }},
    {"collide", [](Scene& s) { s.colliders = {{.shape = Plane{.offset = -9}}}; }},
    {"self-collide", [](Scene& s) { s.self_collision = SelfCollision{.radius = 1e-3}; }},
    {"bending",
     [](Scene& s) {
       s.bending = Bending{1e-5, 1e-5};
     }},
    {"membrane", [](Scene& s) { s.membrane = Membrane{.warp = 100, .weft = 100, .shear = 50}; }},
    {"shear",
     [](Scene& s) {
       s.links = hanging_sheet(20, 20, {true, true, false}).links;
     }},
    {"bend", [](Scene& s) {
       s.links = hanging_sheet(20, 20, {true, false, true}).links;
     }}};

/// Sheet with structural links alone: no pins, no colliders.
Scene bare_sheet(int nu, int nv, const Way& way) {
  Scene scene = hanging_sheet(nu, nv, {.structural = true});
  scene.pins.clear();
  if (!way.grid) scene.mesh.grid.reset();
  return scene;
}

TEST(AbsentIsFree, EachEffectHasAPassOfItsOwnAndNoneWithoutIt) {
  for (const Way& way : kWays) {
    const std::string solver = solver_of(way);
    const Scene bare = bare_sheet(20, 20, way);
    const std::set<std::string> plain = passes(bare, solver);
    EXPECT_EQ(plain.size(), 2u) << solver << ": integration and links";
    for (const Effect& effect : kEffects) {
      Scene scene = bare;
      effect.add(scene);
      std::set<std::string> added = passes(scene, solver);
      for (const std::string& name : plain) EXPECT_EQ(added.erase(name), 1u) << name;
      ASSERT_EQ(added.size(), 1u) << solver << ", " << effect.pass;
      EXPECT_TRUE(added.begin()->starts_with(effect.pass)) << *added.begin();
    }
  }
}

/// Bytes on the heap of this process.
double heap() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

struct Memory {
  double held = 0, reported = 0;  ///< bytes on the heap, and bytes by step_cost()
};

Memory memory(const Scene& scene, const std::string& solver) {
  const double before = heap();
  const auto made = make(scene, solver);
  Memory memory{heap() - before, 0};
  for (const PassCost& cost : made->step_cost()) memory.reported += static_cast<double>(cost.bytes);
  return memory;
}

// The heap of a larger sheet grows by the bytes that its passes report, and by nothing else.
TEST(AbsentIsFree, TheHeapHoldsWhatThePassesReportAndNoMore) {
  if (heap() == 0) GTEST_SKIP() << "this allocator does not say what it holds (sanitizers)";
  for (const Way& way : kWays)
    for (const char* precision : {"float", "double"}) {
      const std::string solver = solver_of(way) + ",precision=" + precision;
      const Scene small = bare_sheet(64, 64, way), large = bare_sheet(128, 128, way);
      make(small, solver);  // allocates what is made only once per process
      const Memory a = memory(small, solver), b = memory(large, solver);
      const double held = b.held - a.held, reported = b.reported - a.reported;
      EXPECT_GT(reported, 12.0 * (128 * 128 - 64 * 64)) << solver << ": a position at least";
      EXPECT_NEAR(held / reported, 1, 0.05) << solver << ": " << held << " against " << reported;
    }
}

/// Number of conditional branches that `work` executes, counted by single-stepping a copy of this
/// process; nothing where that is not possible. It is reproducible up to a constant.
std::optional<long> branches([[maybe_unused]] const std::function<void()>& work) {
#if !defined(__x86_64__) || defined(TAUT_SANITIZED)
  return {};  // other architectures have other instructions; sanitizers add branches of their own
#else
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    raise(SIGSTOP);
    work();
    raise(SIGSTOP);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFSTOPPED(status)) return {};
  long count = 0;
  while (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) == 0 &&
         waitpid(child, &status, 0) == child && WIFSTOPPED(status) && WSTOPSIG(status) == SIGTRAP) {
    user_regs_struct registers{};
    ptrace(PTRACE_GETREGS, child, nullptr, &registers);
    // the child has the same code at the same address
    const auto* code = reinterpret_cast<const unsigned char*>(registers.rip);
    count += (code[0] & 0xF0) == 0x70 || (code[0] == 0x0F && (code[1] & 0xF0) == 0x80);
  }
  const bool whole = WIFSTOPPED(status) && WSTOPSIG(status) == SIGSTOP;
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return whole ? std::optional(count) : std::nullopt;
#endif
}

std::optional<long> branches_of_step(const Scene& scene, const std::string& solver) {
  const auto made = make(scene, solver);
  made->load(scene.start);
  made->step(0, scene.dt);  // resolves library functions on their first call
  return branches([&] { made->step(scene.dt, scene.dt); });
}

/// Branches per link of one more sweep.
double branches_per_link(const Way& way) {
  const Scene scene = bare_sheet(18, 12, way);
  const std::string solver = solver_of(way) + ",substeps=1";
  const long one = branches_of_step(scene, solver + ",iterations=1").value(),
             two = branches_of_step(scene, solver + ",iterations=2").value();
  return static_cast<double>(two - one) / static_cast<double>(scene.links.size());
}

// A loop needs one branch per item, a vector kernel fewer. A flag tested for each item adds one.
TEST(AbsentIsFree, NoFlagIsTestedForEachLink) {
  if (!branches([] {})) GTEST_SKIP() << "this machine does not let a process be traced";
  EXPECT_NEAR(branches_per_link({"mesh", false}), 1, 0.2);
  EXPECT_LT(branches_per_link({"coloured", false}), 1.2);
}

TEST(AbsentIsFree, NoFlagIsTestedForEachParticle) {
  if (!branches([] {})) GTEST_SKIP() << "this machine does not let a process be traced";
  const Way way{"coloured", false};
  const std::string solver = solver_of(way) + ",substeps=1,iterations=0";
  const long few = branches_of_step(bare_sheet(18, 8, way), solver).value(),
             many = branches_of_step(bare_sheet(18, 40, way), solver).value();
  EXPECT_LT(static_cast<double>(many - few), 1.2 * 18 * (40 - 8));
  EXPECT_GT(many, few) << "does it count at all?";
}

}  // namespace
}  // namespace taut::absent_is_free_test
