#include "experiments/history/walk.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/params.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/history/history_answer.hpp"
#include "experiments/results/store.hpp"
#include "experiments/results/store_error.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/signals.hpp"
#include "experiments/timing/two_builds.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

/// Quotes a text for a solver's parameters, where '' stands for a quote.
std::string in_solver_quotes(const std::string& text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("''") : std::string(1, c);
  return all + "'";
}

/// The solver text that runs a checkout in `folder` under this build's name.
std::string solver_in(const std::string& solver, const fs::path& folder, const std::string& build) {
  const std::size_t colon = solver.find(':');
  const std::vector<ParamItem> items =
      param_items(colon == solver.npos ? "" : std::string_view(solver).substr(colon + 1));
  const bool named = std::ranges::find(items, "cmd", &ParamItem::key) != items.end() &&
                     solver.find_first_of(" '\"/") > colon;
  return (named ? solver : "solver:cmd=" + in_solver_quotes(solver)) +
         ",folder=" + in_solver_quotes(folder.string()) + ",build=" + build;
}

/// A checkout and the commit that is built in it.
struct Slot {
  std::unique_ptr<Checkout> checkout;
  std::string commit;  ///< "" if none is built
};

class Walker {
 public:
  Walker(const Walk& asked, Store& store)
      : asked_(asked),
        store_(store),
        repository_(asked.repository),
        line_(repository_.line(asked.range)),
        file_(find_study(asked.study)),
        name_(study_name(asked.study)),
        bisected_(changing(asked.bisect)) {
    walked_.study = name_;
    digest_ = sha256(join(std::vector<std::string>{file_.string(), asked.preset, asked.build,
                                                   asked.solver, asked.taut, read_text(file_)},
                          "\n"));
    for (const Build& known : builds_of(store, name_)) known_[known.id] = known;
    // Report errors in the study at once.
    if (!of_solver()) load_study(asked.study, asked.preset);
  }

  Walked run() {
    if (asked_.bisect.empty())
      run_all_commits();
    else
      bisect();
    std::ranges::sort(walked_.builds, {}, &Build::place);
    return std::move(walked_);
  }

 private:
  bool of_solver() const { return !asked_.solver.empty(); }
  bool of_cost() const { return bisected_.is_cost(); }
  bool timed() const { return asked_.speed || of_cost(); }
  fs::path kept_program(const Build& commit) const {
    return store_.root() / "builds" / commit.id / kProgram;
  }

  // ---- one commit

  /// Checkout n. Timing a solver takes two checkouts side by side. taut itself needs only one,
  /// since a copy of each built program is kept.
  Slot& slot(std::size_t n) {
    if (!of_solver()) n = 0;

    if (!slots_[n].checkout)
      slots_[n].checkout = std::make_unique<Checkout>(
          repository_,
          store_.root() / "checkouts" /
              (sha256(repository_.folder().string()).substr(0, 8) + "-" + std::to_string(n)));
    return slots_[n];
  }

  /// Builds the commit. Returns why that failed; "" on success.
  std::string built_in(Slot& s, const Build& commit) {
    if (s.commit == commit.id) return {};
    s.commit.clear();
    asked_.say("building " + short_build(commit.id) + " " + commit.subject);
    ++walked_.built;
    std::string why = s.checkout->build(commit.id, asked_.build, asked_.limits);
    if (GracefulStop::requested()) throw Interrupted();
    if (why.empty() && !of_solver() && !fs::exists(s.checkout->folder() / asked_.taut))
      why = "its build leaves no " + asked_.taut;
    if (!why.empty()) return why;
    if (!of_solver() && timed())
      keep_build(store_.root(), commit.id, s.checkout->folder() / asked_.taut);
    s.commit = commit.id;
    return {};
  }

  std::vector<Case> cases_in(const Slot& s, const Build& commit) const {
    std::vector<Case> cases = cases_of(load_study(
        asked_.study, asked_.preset, {solver_in(asked_.solver, s.checkout->folder(), commit.id)}));
    for (Case& one : cases) one.build = commit.id + "@" + commit.made;
    if (!only_.empty()) std::erase_if(cases, [&](const Case& one) { return one.id != only_; });
    return cases;
  }

  /// Runs the study on the commit. Returns why that failed; "" on success.
  std::string ran_in(Slot& s, const Build& commit) {
    if (!of_solver()) return ran_by_itself(s, commit);
    try {
      const std::string why = silent(solver_in(asked_.solver, s.checkout->folder(), commit.id));
      if (!why.empty()) return why;
      const CampaignProgress campaign =
          asked_.run({{name_, cases_in(s, commit)}}, store_, "taut history " + name_,
                     {.jobs = asked_.jobs, .limits = asked_.case_limits});
      if (campaign.interrupted) throw Interrupted();
    } catch (const EndedFromOutside&) {
      throw;
    } catch (const StoreError&) {
      throw;
    } catch (const InputError& error) {
      if (of_study(error)) throw;
      return error.what();
    }
    any_ran_ = true;
    return s.checkout->changed();
  }
  std::string silent(const std::string& solver) const {
    admit_solver(solver);
    const std::string why = asked_.silence(*parse_solver(solver).entry);
    return why.empty() ? "" : "its solver does not answer: " + why;
  }
  /// Whether an error is not the commit's fault: no commit has run the study so far, and the error
  /// lies in the study or the study is gone.
  bool of_study(const InputError& error) const {
    const auto lies_there = [&](const Diagnostic& d) { return d.file == file_.string(); };
    return !any_ran_ &&
           (!fs::is_regular_file(file_) || std::ranges::any_of(error.diagnostics(), lies_there));
  }

  /// Runs the study with the commit's own taut, into the same results folder.
  std::string ran_by_itself(Slot& s, const Build& commit) {
    std::vector<std::string> words{"env",         "-u",
                                   "TAUT_DATA",   "-u",
                                   "TAUT_COMMIT", s.checkout->folder() / asked_.taut,
                                   "run",         asked_.study,
                                   "--out",       fs::absolute(store_.root()),
                                   "--build-id",  commit.id + "@" + commit.made,
                                   "-j",          std::to_string(asked_.jobs)};
    if (!asked_.preset.empty()) words.insert(words.end(), {"--preset", asked_.preset});
    const Scratch scratch;
    Process process(words, {.errors_file = scratch.path() / "errors", .folder = {}, .limits = {}});
    std::optional<ProcessEnd> end;
    while (!(end = process.poll())) {
      if (GracefulStop::requested()) throw Interrupted();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    if (end->good()) return s.checkout->changed();
    return "its taut run ends with " + end->text() + ": " +
           printable(last_line(std::ifstream(scratch.path() / "errors")), 300);
  }

  /// Whether the store has everything that was asked of the commit, or a reason why it is a gap.
  bool is_known(const Build& commit) const {
    const auto at = known_.find(commit.id);
    if (at == known_.end() || at->second.asked != digest_) return false;
    return at->second.gap.empty() ? has_all_results(store_, name_, commit.id) : !asked_.again;
  }

  /// Makes sure that the store has the commit's results; checkout `where` is used if a build is
  /// needed. With `stands`, builds the commit even if its results are known. Returns whether the
  /// commit has results.
  bool ensure(Build& commit, std::size_t where, bool stands = false) {
    const bool known = is_known(commit);
    if (known) commit.gap = known_.at(commit.id).gap;
    if (!of_solver() && fs::exists(kept_program(commit))) stands = false;
    if (!known || (stands && commit.gap.empty())) {
      Slot& s = slot(where);
      // Records its time and place in case this is interrupted.
      if (!known) note_build(store_, name_, commit);
      commit.gap = built_in(s, commit);
      if (commit.gap.empty() && !known) commit.gap = ran_in(s, commit);
      commit.asked = only_.empty() ? digest_ : "";
      note_build(store_, name_, commit);
      known_[commit.id] = commit;
    }
    if (!commit.gap.empty()) asked_.say("gap: " + short_build(commit.id) + ": " + commit.gap);
    if (std::ranges::find(walked_.builds, commit.id, &Build::id) == walked_.builds.end())
      walked_.builds.push_back(commit);
    return commit.gap.empty();
  }

  // ---- costs

  /// The cases of a commit that can be timed, by id.
  std::map<std::string, CaseToTime> to_time(Slot& s, const Build& commit) const {
    std::map<std::string, CaseToTime> all;
    const auto add = [&](const std::string& id, const Record& record, CaseSpec spec,
                         const fs::path& program) {
      if (record.status.kind != Status::Kind::unsupported && record.status.is_result())
        all[id] = {std::move(spec), steps_done(record), program};
    };
    if (of_solver()) {
      for (const Case& one : cases_in(s, commit))
        if (const auto record = store_.find(one)) add(one.id, *record, one.spec, {});
      return all;
    }
    const fs::path program = kept_program(commit);
    for (const auto& [id, key] : ran_by(store_, name_, commit.id))
      if (const auto record = store_.find(key)) add(id, *record, record->spec, program);
    return all;
  }

  /// Times the cases that both commits have, and stores the ratios.
  std::vector<TwoBuilds> time(std::size_t a, const Build& before, std::size_t b, const Build& now) {
    std::vector<CaseOfTwo> cases;
    const auto were = to_time(slot(a), before), are = to_time(slot(b), now);
    for (const auto& [id, one] : are)
      if (const auto was = were.find(id); was != were.end() && (timed_.empty() || timed_ == id))
        cases.push_back({id, was->second, one});
    asked_.say("timing " + std::to_string(cases.size()) + " cases of " + short_build(now.id) +
               " beside " + short_build(before.id));
    const std::vector<TwoBuilds> found = time_two_builds(cases, asked_.timing);
    if (GracefulStop::requested()) throw Interrupted();
    for (const BuildRatio& one : ratios_of(found, before.id, now.id))
      note_ratio(store_, name_, one);
    return found;
  }

  bool has_ratio(const Build& before, const Build& now) const {
    return std::ranges::any_of(taut::ratios_of(store_, name_), [&](const BuildRatio& r) {
      return r.before == before.id && r.now == now.id && r.host == host_name();
    });
  }

  // ---- all commits

  void run_all_commits() {
    std::size_t where = 0;
    Build* last = nullptr;
    for (Build& commit : line_) {
      const bool paired = asked_.speed && last && !has_ratio(*last, commit);
      if (!ensure(commit, asked_.speed ? 1 - where : 0, paired)) continue;
      if (paired) {
        if (of_solver()) built_in(slot(where), *last);
        time(where, *last, 1 - where, commit);
      }
      if (asked_.speed) where = 1 - where;
      last = &commit;
    }
  }

  // ---- bisection: the first commit that changed something

  void bisect() {
    const std::size_t last = line_.size() - 1;
    const std::size_t moving = of_cost() ? 1 : 0;  // the first commit stays built in slot 0
    if (!ensure(line_[0], 0, of_cost()) || !ensure(line_[last], moving, of_cost())) {
      walked_.named = "an end of the range has no results, so nothing can be bisected";
      return;
    }
    if (!(of_cost() ? choose_cost(line_[last]) : choose_value(line_[last]))) {
      walked_.named = asked_.bisect + " does not differ between " + short_build(line_[0].id) +
                      " and " + short_build(line_[last].id);
      return;
    }
    std::size_t low = 0, high = last;
    while (high - low > 1) {
      const std::optional<std::size_t> middle = between(low, high, moving);
      if (!middle) break;
      (is_as_last(line_[*middle]) ? high : low) = *middle;
    }
    walked_.found = high - low == 1;
    const std::string from = short_build(line_[low].id), to = short_build(line_[high].id);
    walked_.named = asked_.bisect + " of " + timed_ + " first changed at " + to + " (" +
                    line_[high].made.substr(0, 10) + ") " + line_[high].subject +
                    (walked_.found ? ""
                                   : ", or at one of the " + std::to_string(high - low - 1) +
                                         " commits after " + from + " that have no results");
  }

  /// The commit with results that is nearest to the middle.
  std::optional<std::size_t> between(std::size_t low, std::size_t high, std::size_t where) {
    const std::size_t middle = (low + high) / 2;
    for (std::size_t off = 0; off <= high - low; ++off)
      for (const std::size_t at : {middle - std::min(off, middle), middle + off})
        if (at > low && at < high && !tried_.contains(at)) {
          tried_.insert(at);
          if (ensure(line_[at], where, of_cost())) return at;
        }
    return {};
  }

  const HistoryPoint* point_of(const History& history, const std::string& build) const {
    const auto at = std::ranges::find(history.builds, build, &Build::id) - history.builds.begin();
    for (const HistoryRow& row : history.rows)
      if (row.id == timed_) return row.points[static_cast<std::size_t>(at)].get();
    return nullptr;
  }
  History ends(const Build& other) const {
    return history_of(store_, name_, tolerances_, {line_[0], other});
  }

  /// Chooses the case whose value differs most between the ends.
  bool choose_value(const Build& last) {
    const History history = ends(last);
    for (const HistoryStep& step : history.steps)
      if (step.what == bisected_ || (step.what.kind == Changing::Kind::status &&
                                     !completed(history.rows[step.row].points[step.now]->status))) {
        timed_ = history.rows[step.row].id;
        if (of_solver()) only_ = timed_;
        return true;
      }
    return false;
  }
  bool choose_cost(const Build& last) {
    const TwoBuilds* most = nullptr;
    const std::vector<TwoBuilds> found = time(0, line_[0], 1, last);
    for (const TwoBuilds& one : found) {
      if (!one.failure.empty() || !(of_wall() ? beyond_both(one.wall, one.wall_control)
                                              : beyond_both(one.cpu, one.cpu_control)))
        continue;
      if (!most || std::abs(cost_of(one)) > std::abs(cost_of(*most))) most = &one;
    }
    if (!most) return false;
    timed_ = most->id;
    end_ = cost_of(*most);
    if (of_solver()) only_ = timed_;
    return true;
  }
  bool of_wall() const { return bisected_.kind == Changing::Kind::wall; }
  /// Logarithm of a build's cost relative to the first one.
  double cost_of(const TwoBuilds& one) const {
    return std::log((of_wall() ? one.wall : one.cpu).mid);
  }

  /// Whether a commit already differs from the first one: its value by more than the tolerance, its
  /// cost by more than half of the (logarithmic) way to the last one's.
  bool is_as_last(const Build& commit) {
    if (of_cost()) {
      const std::vector<TwoBuilds> found = time(0, line_[0], 1, commit);
      return !found.empty() && found[0].failure.empty() && cost_of(found[0]) / end_ > 0.5;
    }
    const History history = ends(commit);
    const HistoryPoint *a = point_of(history, line_[0].id), *b = point_of(history, commit.id);
    if (!a || !b) return false;
    if (!ended_alike(*a, *b)) return true;
    return std::ranges::any_of(compare_values(a->values, b->values, tolerances_),
                               [&](const ComparedValue& one) {
                                 return Changing{Changing::Kind::value, one.value} == bisected_ &&
                                        one.kind == ComparedValue::Kind::moved;
                               });
  }

  const Walk& asked_;
  Store& store_;
  Repository repository_;
  std::vector<Build> line_;
  std::filesystem::path file_;  ///< file of the study
  std::string name_;            ///< name of the study
  Changing bisected_;           ///< what a bisection looks for
  bool any_ran_ = false;        ///< whether any commit has run the study

  Tolerances tolerances_;
  std::string digest_;                  ///< digest of what is asked
  std::map<std::string, Build> known_;  ///< by id
  Slot slots_[2];
  /// The case that a bisection follows; the only case to run, if not "".
  std::string timed_, only_;
  double end_ = 0;  ///< logarithm of the last commit's cost relative to the first
  std::set<std::size_t> tried_;
  Walked walked_;
};

}  // namespace

Walked walk(const Walk& asked, Store& store) {
  store.prepare();
  const GracefulStop stop;
  return Walker(asked, store).run();
}

}  // namespace taut
