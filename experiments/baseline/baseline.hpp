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

/// How the case or the frontier of a row ended.
struct RowStatus {
  std::string kind;         ///< "ok", "exploded", "bracketed"
  std::string reason = {};  ///< "energy"; "" if unsupported, whose reason is a sentence
  std::string text() const { return reason.empty() ? kind : kind + " (" + reason + ")"; }
  bool operator==(const RowStatus&) const = default;
};

/// One case of a baseline: what was run and what came out of it.
struct BaselineRow {
  std::string id;  ///< of the case in its study
  CaseSpec spec;
  std::string scene;  ///< digest of the scene's content: another digest is another task
  RowStatus status;
  std::size_t projections = 0;           ///< constraint projections per step
  std::map<std::string, double> values;  ///< by metric value; NaN: no meaning for this case
  std::string frontier;                  ///< options of `taut frontier`; "": the row is a case
  bool flaky = false;  ///< two runs differed in a bit: only its status is compared

  std::string solver() const { return solver_name(spec.solver); }
};
/// Sorted by id.
using Baseline = std::vector<BaselineRow>;
const BaselineRow* find_row(const Baseline&, const std::string& id);  ///< nullptr: there is none

/// `scene` is digest(Scene) of the scene that the record's spec names. The solver is kept with only
/// those parameters that differ from their defaults, so that a new parameter changes no row.
BaselineRow baseline_row(const Record&, const std::string& scene);

/// One difference between a baseline and what was run.
struct Change {
  enum class Kind {
    // the same task, another result
    value_moved,
    status_changed,
    // another task: the baseline does not match the study
    case_missing,      ///< in the baseline, not in the study
    case_new,          ///< in the study, not in the baseline
    case_renamed,      ///< the same scene and solver under another id
    scene_changed,     ///< same id, other content
    solver_missing,    ///< the baseline has a solver that the study does not run
    solver_new,        ///< the study runs a solver that has no baseline
    value_missing,     ///< the baseline has a metric value that no longer exists
    value_unrecorded,  ///< the baseline lacks a value in this row that it has in others
    // for information: no failure
    value_new  ///< a new metric: the baseline has it in no row
  };
  Kind kind = Kind::value_moved;
  std::string id;                      ///< of the case; empty for a solver
  std::string solver;                  ///< name
  std::string text;                    ///< one line: what it was -> what it is
  std::string scene = {}, value = {};  ///< of a moved value: its scene's and the metric value's
                                       ///< name, or "status"
  double before = 0, now = 0;          ///< of a moved value, in its unit; NaN: no meaning
  bool is_regression() const { return kind <= Kind::status_changed; }
  bool is_mismatch() const { return !is_regression() && kind != Kind::value_new; }
};

/// "value moved", "case new", ...
std::string_view to_string(Change::Kind);
Change::Kind change_kind(std::string_view);  ///< the inverse; throws InputError

struct Comparison {
  std::vector<Change> findings;  ///< sorted by solver and id
  std::size_t cases = 0;         ///< compared
  std::size_t values = 0;        ///< compared, statuses apart

  bool regressed() const;
  bool mismatched() const;
};

/// How values moved, over all cases of a solver.
struct MovedValue {
  std::string solver, group;  ///< the name of a value or of several; "status"
  std::size_t cases = 0;
  std::size_t less = 0, more = 0;   ///< of these: now below, above what it was
  const Change* largest = nullptr;  ///< by relative change; points into the comparison

  /// (now - before) / |before| of the largest; infinite where there was 0 or no number, and
  /// for a status.
  double relative() const;
};

/// Statuses that changed and values that moved, by solver and by group, which `group_of` gives for
/// a value's name; in the order of their first change.
std::vector<MovedValue> roll_up(const Comparison&,
                                const std::function<std::string(const std::string&)>& group_of);

/// The command that runs a case in the foreground: "taut case hang jakobsen:iterations=8 --set
/// ...".
std::string reproduce(const CaseSpec&);
/// The same for a row: a case, or "taut frontier ...".
std::string reproduce(const BaselineRow&);

/// A comparison as a JUnit <testsuite>: a test case for every row, and for every finding without a
/// row.
std::string junit(const std::string& study, const Baseline& now, const Comparison&);

/// The differences in `now`. Rows whose scene, solver or id do not match are not compared.
Comparison compare(const Baseline& before, const Baseline& now, const Tolerances&);

/// The new baseline: values that moved by no more than the tolerance stay as they are, to the
/// digit; the others are those of `now`, rounded to a hundredth of the tolerance.
Baseline updated(const Baseline& before, const Baseline& now, const Tolerances&);

/// Reads every <solver>.jsonl of a study's folder. Empty if there is none. Throws InputError with
/// file and line.
Baseline read_baseline(const std::filesystem::path& folder);

/// Writes <solver>.jsonl, one row a line, sorted by id; leaves files alone that would not change
/// and removes those of solvers that have no row. Each file is replaced in one step.
void write_baseline(const std::filesystem::path& folder, const Baseline&);

/// Reads tolerances.toml of a study's folder: tables with absolute, relative or ignored, and a
/// reason, each named by a value, a metric or "default". No file: the built-in default. Throws
/// InputError.
Tolerances read_tolerances(const std::filesystem::path& folder);

/// Which frontiers belong to a study's baseline: frontiers.toml of its folder, tables [[frontier]]
/// with scene, solver, of, from, to, tolerance and set (settings of the scene). No file: none.
/// Throws InputError with file and line.
std::vector<FrontierQuestion> read_frontiers(const std::filesystem::path& folder);

/// A frontier that was found, as a row: its status is the kind of frontier, its values are the ends
/// of the bracket and the number of stable values above it.
BaselineRow frontier_row(const FrontierQuestion&, const CaseFrontier&);

/// Id of the row of a question.
std::string frontier_id(const FrontierQuestion&);

}  // namespace taut
