// An effect that a scene lacks costs neither memory nor time: no pass, no bytes on the heap, and no
// branch for each item in what is executed. Shown without a clock, so on any machine. What this
// cannot show: a flag that a kernel turns into a mask or a factor instead of a branch, and cost
// that the hardware adds, such as displaced caches.
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <set>

#include "tests/support/cloths.hpp"

namespace taut {
namespace {

constexpr const char* kSolvers[] = {"jakobsen", "jakobsen:order=mesh", "jakobsen:layout=batches",
                                    "xpbd", "mass-spring"};

std::unique_ptr<Solver> make(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  return choice.entry->make(scene, choice.params);
}

std::set<std::string> passes(const Scene& scene, const std::string& solver) {
  std::set<std::string> names;
  for (const PassCost& cost : make(scene, solver)->step_cost()) names.insert(cost.pass);
  return names;
}

/// What a scene may have, and how its pass is called.
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
    {"shear", [](Scene& s) { s.links = grid_links(s.mesh, {.structural = true, .shear = true}); }},
    {"bend", [](Scene& s) { s.links = grid_links(s.mesh, {.structural = true, .bend = true}); }}};

/// A sheet that nothing holds and nothing meets, with structural links.
Scene bare_sheet(int n) {
  Scene scene = hanging_sheet(n, n, {.structural = true});
  scene.pins.clear();
  return scene;
}

TEST(AbsentIsFree, EachEffectHasPassesOfItsOwnAndNoneWithoutIt) {
  for (const std::string solver : kSolvers) {
    const std::set<std::string> plain = passes(bare_sheet(20), solver);
    EXPECT_EQ(plain.size(), 2u) << solver << ": integration and links";
    int tried = 0;
    for (const Effect& effect : kEffects) {
      Scene scene = bare_sheet(20);
      effect.add(scene);
      const SolverChoice choice = parse_solver(solver);
      if (!choice.entry->unsupported(scene, choice.params).empty()) continue;
      std::set<std::string> added = passes(scene, solver);
      for (const std::string& name : plain) EXPECT_EQ(added.erase(name), 1u) << name;
      EXPECT_EQ(added.size(), 1u) << solver << ", " << effect.pass;
      for (const std::string& name : added) EXPECT_TRUE(name.starts_with(effect.pass)) << name;
      ++tried;
    }
    EXPECT_GE(tried, 3) << solver;
  }
}

/// Bytes on the heap of this process.
double heap() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

struct Memory {
  double held = 0, reported = 0;  ///< bytes: on the heap, and by step_cost()
};

Memory memory(const Scene& scene, const std::string& solver) {
  const double before = heap();
  const auto made = make(scene, solver);
  Memory memory{heap() - before, 0};
  for (const PassCost& cost : made->step_cost()) memory.reported += static_cast<double>(cost.bytes);
  return memory;
}

// What no pass reports is on the heap neither: of a larger sheet exactly that much more.
TEST(AbsentIsFree, TheHeapHoldsWhatThePassesReportAndNoMore) {
  if (heap() == 0) GTEST_SKIP() << "this allocator does not say what it holds (sanitizers)";
  for (const std::string solver : kSolvers)
    for (const char* precision : {"float", "double"}) {
      const std::string text =
          solver + (solver.find(':') == solver.npos ? ":" : ",") + "precision=" + precision;
      make(bare_sheet(64), text);  // what is made once stays
      const Memory small = memory(bare_sheet(64), text), large = memory(bare_sheet(128), text);
      const double held = large.held - small.held, reported = large.reported - small.reported;
      EXPECT_GT(reported, 12.0 * (128 * 128 - 64 * 64)) << text << ": a position at least";
      EXPECT_NEAR(held / reported, 1, 0.05) << text << ": " << held << " against " << reported;
    }
}

/// Conditional branches that `work` executes, counted one instruction at a time in a copy of this
/// process; nothing where that is not possible. The same for the same work, but for a constant.
std::optional<long> branches(const std::function<void()>& work) {
#if !defined(__x86_64__) || defined(__SANITIZE_ADDRESS__)
  return {};  // other instructions; or branches of the sanitizer's own
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
    const auto* code = reinterpret_cast<const unsigned char*>(registers.rip);  // ours is the same
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
  made->step(0, scene.dt);  // the first call of a library function looks it up
  return branches([&] { made->step(scene.dt, scene.dt); });
}

/// Branches for each link that another sweep adds.
std::optional<double> branches_per_link(const Scene& scene, const std::string& solver) {
  const auto one = branches_of_step(scene, solver + ",iterations=1"),
             two = branches_of_step(scene, solver + ",iterations=2");
  if (!one || !two) return {};
  return static_cast<double>(*two - *one) / static_cast<double>(scene.links.size());
}

// A loop over items needs a branch for each of them, for each vector of them where it has several
// to a vector. A flag tested inside would add one.
TEST(AbsentIsFree, NoFlagIsTestedForEachLink) {
  const Scene scene = bare_sheet(24);
  if (!branches([] {})) GTEST_SKIP() << "this machine does not let a process be traced";
  for (const char* precision : {"float", "double"}) {
    const auto per_link = [&](const std::string& setting) {
      return *branches_per_link(scene, "jakobsen:substeps=1,precision=" + (precision + setting));
    };
    EXPECT_LE(per_link(",order=mesh"), 1.05) << precision;
    EXPECT_LE(per_link(",layout=batches"), 0.5) << precision;
    EXPECT_LE(per_link(",layout=interleaved"), 0.5) << precision;
    EXPECT_GE(per_link(",order=mesh"), 0.2) << precision << ": does it count at all?";
  }
}

TEST(AbsentIsFree, NoFlagIsTestedForEachParticle) {
  if (!branches([] {})) GTEST_SKIP() << "this machine does not let a process be traced";
  for (const char* solver : {"jakobsen:substeps=1,iterations=0,order=mesh",
                             "jakobsen:substeps=1,iterations=0,layout=interleaved"}) {
    const long small = *branches_of_step(bare_sheet(20), solver),
               large = *branches_of_step(bare_sheet(40), solver);
    EXPECT_LE(static_cast<double>(large - small), 0.5 * (40 * 40 - 20 * 20)) << solver;
    EXPECT_GT(large, small) << solver << ": does it count at all?";
  }
}

}  // namespace
}  // namespace taut
