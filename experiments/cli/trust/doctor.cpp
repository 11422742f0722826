#include <sys/utsname.h>
#include <unistd.h>

#include <cfloat>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/timing.hpp"

namespace taut::verb::doctor {

namespace {

namespace fs = std::filesystem;

struct Check {
  std::string name, value;
  bool good = true;
  bool of_timing = false;  ///< timing can be trusted only if it is good
};

constexpr bool kOfTiming = true;

/// CPU time of a fixed amount of arithmetic, about 5 ms [s].
double fixed_work() {
  const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  volatile double sink = 1;
  for (int i = 0; i < 1'000'000; ++i) sink = sink * 1.0000001 + 1e-9;
  return seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
}

/// Half the interquartile range of the time of identical code, relative to its median.
double noise() {
  std::vector<double> times(21);
  for (double& time : times) time = fixed_work();
  std::sort(times.begin(), times.end());
  return (times[15] - times[5]) / 2 / times[10];
}

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

Check writable(const fs::path& results) {
  fs::path there = fs::absolute(results);
  while (!fs::exists(there)) there = there.parent_path();
  const bool good = access(there.c_str(), W_OK) == 0;
  return {"results folder", results.string() + (good ? ", writable" : ", not writable"), good};
}

Check arithmetic() {
  // With extended precision or contraction the result would not be 0.
  volatile double a = 1 + DBL_EPSILON, b = 1 - DBL_EPSILON;
  const double product = a * b - 1;
  const bool exact = FLT_EVAL_METHOD == 0 && product == 0;
  return {"arithmetic", exact ? "IEEE 754 double, not contracted" : "extended or contracted",
          exact};
}

std::vector<Check> examine() {
  utsname system{};
  uname(&system);
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  double load = 0;
  getloadavg(&load, 1);
  const double spread = noise();
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  std::vector<Check> all{
      {"toolchain", std::string(toolchain())},
      {"system", std::string(system.sysname) + " " + system.release + " " + system.machine},
      {"processor", machine_name()},
      arithmetic(),
      {"scenes and studies", data_folder().string(), !shipped("scenes").empty()},
      writable(default_results())};
  for (const std::string_view name : {kProgram, kFloatProgram}) {
    const std::string program(name);
    const bool there = access(sibling_program(program).c_str(), X_OK) == 0;
    all.push_back({program, there ? "beside this program" : "missing beside this program", there});
  }
  for (const char* program : {"gnuplot", "ffmpeg"})
    all.push_back({program, on_path(program) ? "found" : "missing: its pictures are left out",
                   on_path(program)});
  all.push_back({"load", decimal(load, 2) + " on " + std::to_string(cores) + " cores",
                 load < 0.5 * cores, kOfTiming});
  if (!governor.empty()) all.push_back({"clock", governor, governor == "performance", kOfTiming});
  all.push_back(
      {"same code, twice", number_text(spread, kShare, 2) + " apart", spread < 0.02, kOfTiming});
  return all;
}

/// The digests of each solver that keys of stored results contain. A solver that is a program of
/// its own belongs to no layer of this one.
Table fingerprints() {
  Table table{"fingerprints",
              "what solvers are made of",
              {{"solver"}, {"digest"}, {"layer", "of its layer"}}};
  for (const SolverEntry* entry : all_solvers()) {
    const std::string_view own = entry->implementation;
    table.rows.push_back(
        {entry->name, own.empty() ? implementation(entry->name) : own, layer_digest(entry->name)});
  }
  table.detail = true;
  return table;
}

int run(const Format& format) {
  Answer answer{"doctor"};
  Table table{"findings", "", {{"name", "what"}, {"value", "found"}, {"good"}}};
  bool trusted = true;
  for (const Check& f : examine()) {
    table.rows.push_back({f.name, f.value, f.good});
    if (f.of_timing) trusted = trusted && f.good;
  }
  answer.add({"timing_trusted", "timing can be trusted here"},
             Cell(trusted).with(trusted ? "" : "it is for display only: the machine is not quiet"));
  answer.add(std::move(table));
  answer.add(fingerprints());
  print(answer, format);
  return kPass;
}

void add_options(Arguments& args, Format& format) {
  add_format(args, format, "Print the digests of solvers and of their layers, too");
}

}  // namespace
}  // namespace taut::verb::doctor

TAUT_VERB(doctor) = {
    .name = "doctor",
    .group = VerbGroup::trust,
    .summary = "Shows versions, precision, cores and load: what can be trusted here?",
    .example = "taut doctor",
    .answer = {{"facts", "timing_trusted"},
               {"findings", "name value good"},
               {"fingerprints", "solver digest layer"}},
    .bind = taut::bind_verb<taut::verb::doctor::add_options, taut::verb::doctor::run>};
