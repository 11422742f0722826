#include "experiments/timing/two_builds.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

bool is_program(const fs::path& file) {
  std::error_code none;
  return fs::is_regular_file(file, none) && access(file.c_str(), X_OK) == 0;
}

std::string failure_of(const TimingSession& session) {
  constexpr const char* kWhich[] = {"before: ", "now: "};
  for (std::size_t i = 0; i < 2; ++i)
    if (!session.timings[i].failure.empty()) return kWhich[i] + session.timings[i].failure;
  return std::isnan(session.control.mid) ? "the same code could not be timed against itself" : "";
}

TwoBuilds time_once(const CaseOfTwo& one, TimingOptions options) {
  options.progress = {};
  const TimingSession session = time_cases({one.before, one.now}, options);
  TwoBuilds found{one.id, failure_of(session), {}, {}, {}, {}};
  if (!found.failure.empty()) return found;
  found.cpu = session.ratio(1, 0);
  found.cpu_control = session.control;
  found.wall = interleaved_ratio(session.timings[1].wall, session.timings[0].wall);
  found.wall_control = session.wall_control;
  return found;
}

std::string verdict_of(const TwoBuilds& one) {
  if (!one.failure.empty()) return "not timed: " + one.failure;
  if (!one.differs())
    return spread(one.cpu_control) > kTolerance ? "no measurable difference" : "no difference";
  const Interval& ratio = one.by_wall() ? one.wall : one.cpu;
  return std::string(ratio.mid > 1 ? "dearer" : "cheaper") +
         (one.by_wall() ? " in wall time alone" : "");
}

}  // namespace

bool TwoBuilds::by_wall() const {
  return failure.empty() && !beyond_both(cpu, cpu_control) && beyond_both(wall, wall_control);
}

bool TwoBuilds::differs() const {
  return failure.empty() && (beyond_both(cpu, cpu_control) || beyond_both(wall, wall_control));
}

bool TwoBuilds::slower() const { return differs() && (by_wall() ? wall : cpu).mid > 1; }

std::vector<TwoBuilds> time_two_builds(const std::vector<CaseOfTwo>& cases,
                                       const TimingOptions& options) {
  setenv("TAUT_DATA", data_folder().c_str(), 0);  // the other build then uses this one's scenes
  std::vector<TwoBuilds> all;
  for (const CaseOfTwo& one : cases) {
    all.push_back(time_once(one, options));
    if (all.back().differs()) {
      const bool was_slower = all.back().slower();
      TwoBuilds again = time_once(one, options);
      if (again.differs() && again.slower() != was_slower) again.failure = "too noisy to be timed";
      all.back() = std::move(again);
    }
    if (options.progress) options.progress(all.size(), cases.size());
  }
  return all;
}

fs::path keep_build(const fs::path& results, const std::string& id, const fs::path& taut) {
  const fs::path folder = results / "builds" / slug(build_named(id).id);
  make_folder(folder);
  for (const std::string_view name : {kProgram, kFloatProgram}) {
    const fs::path program =
        taut.empty() ? sibling_program(std::string(name)) : taut.parent_path() / name;
    std::error_code error;
    if (!is_program(program)) continue;
    fs::copy_file(program, folder / (std::string(name) + ".new"),
                  fs::copy_options::overwrite_existing, error);
    if (!error) fs::rename(folder / (std::string(name) + ".new"), folder / name, error);
    if (error) throw InputError((folder / name).string() + ": cannot write: " + error.message());
  }
  return folder;
}

fs::path folder_of_build(const fs::path& results, const std::string& text) {
  const fs::path kept = results / "builds" / slug(text);
  for (const fs::path& folder : {fs::path(text), kept})
    if (is_program(folder / kProgram)) return fs::absolute(folder);
  std::vector<std::string> known;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(results / "builds", none))
    known.push_back(entry.path().filename());
  std::ranges::sort(known);
  throw InputError("build '" + text + "': no program taut in " + fs::absolute(text).string() +
                   ", and none is kept in " + fs::absolute(kept).string() + "; " +
                   (known.empty() ? "taut bench --keep-build NAME keeps one before it is changed"
                                  : "kept are " + join(known, ", ")));
}

std::vector<CaseOfTwo> cases_of_two(const std::vector<Record>& records, const fs::path& before) {
  std::vector<CaseOfTwo> all;
  for (const Record& record : records) {
    if (record.status.kind == Status::Kind::unsupported || !record.status.is_result()) continue;
    CaseSpec brief = record.spec;  // the other build may not know all parameters
    brief.solver = parse_solver(record.spec.solver).brief();
    const int steps = steps_done(record);
    all.push_back({record.id,
                   {brief, steps, before / program_of(record.spec).filename()},
                   {brief, steps, {}}});
  }
  return all;
}

std::vector<BuildRatio> ratios_of(const std::vector<TwoBuilds>& all, const std::string& before,
                                  const std::string& now) {
  std::vector<BuildRatio> ratios;
  for (const TwoBuilds& one : all) {
    if (!one.failure.empty()) continue;
    const auto add = [&](const char* clock, const Interval& r, const Interval& c) {
      ratios.push_back(
          {one.id, before, now, host_name(), clock, r.low, r.mid, r.high, c.low, c.mid, c.high});
    };
    add("cpu", one.cpu, one.cpu_control);
    add("wall", one.wall, one.wall_control);
  }
  return ratios;
}

std::vector<TwoBuilds> compare_with_build(const std::string& study,
                                          const std::vector<Record>& records,
                                          const std::string& before, Store& store,
                                          const TimingOptions& options) {
  const fs::path folder = folder_of_build(store.root(), before);
  const std::vector<TwoBuilds> found = time_two_builds(cases_of_two(records, folder), options);
  for (const BuildRatio& one : ratios_of(found, before, build_named(this_build()).id))
    note_ratio(store, study, one);
  return found;
}

Table table_of(const std::vector<TwoBuilds>& all, const std::string& name,
               const std::string& before) {
  Table table{name,
              "CPU time of a step over that of " + before,
              {{"case"},
               {"ratio", "now over before"},
               {"control", "before over itself"},
               {"verdict"},
               Column("wall", "wall time, now over before").in_detail(),
               Column("wall_control", "wall time, before over itself").in_detail()},
              {},
              "Timed in turns in one session; apparent differences were timed twice."};
  for (const TwoBuilds& one : all)
    if (one.failure.empty())
      table.rows.push_back(
          {one.id, one.cpu, one.cpu_control, verdict_of(one), one.wall, one.wall_control});
    else
      table.rows.push_back({one.id, {}, {}, verdict_of(one), {}, {}});
  return table;
}

bool any_slower(const std::vector<TwoBuilds>& all) {
  return std::ranges::any_of(all, &TwoBuilds::slower);
}

}  // namespace taut
