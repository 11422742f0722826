#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/solver.hpp"
#include "experiments/case/comparison.hpp"
#include "experiments/case/record.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

/// How the case or frontier of a row ended.
struct RowStatus {
  std::string kind;         ///< "ok", "exploded", "bracketed"
  std::string reason = {};  ///< "energy"; "" for unsupported, whose reason is a sentence
  std::string text() const { return reason.empty() ? kind : kind + " (" + reason + ")"; }
  bool operator==(const RowStatus&) const = default;
};

/// One row of a baseline: a case (or frontier) and its results.
struct BaselineRow {
  std::string id;  ///< id of the case in its study
  CaseSpec spec;
  std::string scene;  ///< digest of the scene's content; another digest means another task
  RowStatus status;
  std::size_t projections = 0;           ///< constraint projections per step
  std::map<std::string, double> values;  ///< by metric value; NaN: meaningless for this case
  std::string frontier;                  ///< options of `taut frontier`; "": the row is a case
  bool flaky = false;  ///< two runs differed in some bit: only its status is compared

  std::string solver() const { return solver_name(spec.solver); }
};
/// Sorted by id.
using Baseline = std::vector<BaselineRow>;
const BaselineRow* find_row(const Baseline&, const std::string& id);  ///< nullptr: no such row

/// Row for a record. `scene` is digest(Scene) of the scene that the record's spec names. The solver
/// keeps only parameters that differ from their defaults, so that a new parameter changes no row.
BaselineRow baseline_row(const Record&, const std::string& scene);

/// Name under which changes of a row's number of projections are reported, beside its values.
inline constexpr const char* kProjections = "projections";

/// A difference between a baseline and the results of a run.
struct Change {
  enum class Kind {
    // The same task, but another result:
    value_moved,
    status_changed,
    // Another task, so that the baseline does not match the study:
    case_missing,      ///< in the baseline, not in the study
    case_new,          ///< in the study, not in the baseline
    case_renamed,      ///< the same scene and solver under another id
    scene_changed,     ///< the same id, other content
    solver_missing,    ///< the baseline has a solver that the study does not run
    solver_new,        ///< the study runs a solver that has no baseline
    value_missing,     ///< the baseline has a metric value that no longer exists
    value_unrecorded,  ///< the baseline lacks a value in this row that other rows have
    // For information only, not a failure:
    value_new  ///< a value of a new metric, which no row of the baseline has
  };
  Kind kind = Kind::value_moved;
  std::string id;      ///< id of the case; empty for a solver
  std::string solver;  ///< name
  std::string text;    ///< one line: old -> new
  /// Of a moved value: the scene's name and the value's name, kProjections or "status".
  std::string scene = {}, value = {};
  double before = 0, now = 0;  ///< of a moved value, in its unit; NaN: meaningless
  bool is_regression() const { return kind <= Kind::status_changed; }
  bool is_mismatch() const { return !is_regression() && kind != Kind::value_new; }
};

/// "value moved", "case new", ...
std::string_view to_string(Change::Kind);
Change::Kind change_kind(std::string_view);  ///< inverse of to_string(); throws InputError

struct Comparison {
  std::vector<Change> findings;  ///< sorted by solver and id
  std::size_t cases = 0;         ///< number compared
  std::size_t values = 0;        ///< number compared, without statuses

  bool regressed() const;
  bool mismatched() const;
};

/// Group in which a regression is counted.
struct MovedGroup {
  enum class Kind { status, projections, titled, others };
  Kind kind = Kind::others;
  std::string value_title = {};  ///< of the kind `titled`, whose values have a title of their own

  /// The name of the group for people: "status", "projections", "RMS stretch", "other values".
  std::string title() const;
  bool operator==(const MovedGroup&) const = default;
};
/// The group of a regression. `title_of` returns a value's own title; "" if it counts among the
/// other values.
MovedGroup group_of(const Change&, const std::function<std::string(const std::string&)>& title_of);

/// How a group of values moved, over all cases of a solver.
struct MovedValue {
  std::string solver;
  MovedGroup group;
  std::size_t cases = 0;
  std::size_t less = 0, more = 0;   ///< how many are now below, above the old value
  const Change* largest = nullptr;  ///< by relative change; points into the comparison

  /// (now - before) / |before| of the largest change; infinite for a status, and where `before` is
  /// 0 or there is no number.
  double relative() const;
};

/// Counts changed statuses and moved values by solver and group, in the order of their first
/// change. For `title_of` see group_of().
std::vector<MovedValue> roll_up(const Comparison&,
                                const std::function<std::string(const std::string&)>& title_of);

/// Command that runs a case in the foreground: "taut case hang jakobsen:iterations=8 --set ...".
std::string reproduce(const CaseSpec&);
/// Command that runs the case or frontier of a row: "taut case ..." or "taut frontier ...".
std::string reproduce(const BaselineRow&);

/// The comparison as a JUnit <testsuite>, with a test case for each row and for each finding
/// without a row.
std::string junit(const std::string& study, const Baseline& now, const Comparison&);

/// Compares `now` with `before`. Rows whose scene, solver or id do not match are reported, not
/// compared.
Comparison compare(const Baseline& before, const Baseline& now, const Tolerances&);

/// The new baseline. Values within the tolerance of the old ones keep the old digits; others come
/// from `now`, rounded to a hundredth of the tolerance.
Baseline updated(const Baseline& before, const Baseline& now, const Tolerances&);

/// Reads every <solver>.jsonl in a study's folder; empty without such a file. Throws InputError
/// with file and line.
Baseline read_baseline(const std::filesystem::path& folder);

/// Writes <solver>.jsonl with one row per line, sorted by id. Leaves unchanged files alone and
/// removes files of solvers without rows. Replaces each file in one step.
void write_baseline(const std::filesystem::path& folder, const Baseline&);

/// Reads tolerances.toml in a study's folder. Each table is named after a value, a metric or
/// "default" and has absolute, relative or ignored, and a reason. Without the file, returns the
/// built-in default. Throws InputError.
Tolerances read_tolerances(const std::filesystem::path& folder);

/// Reads the frontiers of a study's baseline from frontiers.toml in its folder: tables [[frontier]]
/// with scene, solver, of, from, to, tolerance and set (settings of the scene). Without the file,
/// returns none. Throws InputError with file and line.
std::vector<FrontierQuestion> read_frontiers(const std::filesystem::path& folder);

/// The row of a frontier: its status is the kind of the frontier, and its values are the ends of
/// the bracket and the number of stable values above it.
BaselineRow frontier_row(const FrontierQuestion&, const CaseFrontier&);

/// Id of a question's row.
std::string frontier_id(const FrontierQuestion&);

}  // namespace taut
