#pragma once

// Numbers, quantities, solvers and their settings in words for people.

#include <compare>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/model/params.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut::report {

/// Plain text with the signs that a keyboard lacks: "dt^2 >= 2e-5, mu x 2" ->
/// "dt² ≥ 2×10⁻⁵, μ × 2".
std::string typeset(std::string_view);
/// The text with a capital first letter if that is an ASCII letter, for headings.
std::string capitalised(std::string);

/// "ball, box and plane"
std::string joined(const std::vector<std::string>& names);

/// The names of sweeps per substep and of substeps per step, whatever a solver's own parameters for
/// them are called.
inline constexpr const char *kSweeps = "iterations", *kSubsteps = "substeps";

/// What a record holds under `name`: a field that may be an axis ("dt", record_columns.hpp),
/// kSweeps, any numeric parameter of its solver ("omega", "xpbd:omega"), any metric value
/// ("stretch.rms"), kStrainFloor, any scene key that its case sets to a number ("wind.strength").
/// NaN if it holds no such thing.
double value_of(const Record&, std::string_view name);

/// The parameter that an axis of this solver alone varies: "structural" for "xpbd:structural". Any
/// other name is returned unchanged.
std::string own_parameter(std::string_view solver, std::string_view name);

/// A quantity in words for people.
struct Quantity {
  std::string name;
  std::string title;  ///< "RMS stretch"
  Unit unit = kNumber;
  std::string help = {};         ///< its definition; "" of most settings
  Window window = Window::none;  ///< Window::none of settings

  /// "RMS stretch [%]"
  std::string label() const;
  std::string text(double si, int digits = 2) const { return taut::shown(unit, si, digits); }
};
/// The quantity of this name, as the metric's file or the row of a parameter declares it: the row
/// of `solver`, or what the rows of all solvers agree on. Unknown names are shown unchanged.
Quantity quantity(std::string_view name, std::string_view solver = "");

/// "4 ms" for one value, "4 ms to 17 ms" for several. Precondition: at least one value.
std::string range_text(const std::set<double>& values, const Quantity&);

/// Names for which quantity() has a title, besides the axes of a study.
std::vector<std::string> quantity_names();

/// Records that live elsewhere, in the order of the study.
struct Records : std::vector<const Record*> {
  Records() = default;
  Records(std::span<const Record> all) {
    for (const Record& r : all) push_back(&r);
  }
  Records(const std::vector<Record>& all) : Records(std::span(all)) {}
  Records(std::vector<Record>&&) = delete;  // would point to what is gone
};

/// The title in the solver's entry, or its name in words: "bullet-deformable" -> "Bullet
/// deformable".
std::string solver_title(std::string_view solver);

/// Whether an iteration of the solver solves for all links at once, and so is no sweep.
bool solves_all_at_once(const std::string& solver);

/// The record's parameters but for those that are its substeps and sweeps.
std::map<std::string, std::string> other_settings(const Record&);

/// The parameters that labels of this solver name besides substeps and sweeps, by its entry; empty
/// for a solver that this program lacks.
std::vector<std::string> labelled_parameters(const std::string& solver);
/// The parameter that sets the solver's link order; "": there is no such parameter.
std::string link_order_parameter(const std::string& solver);
/// The parameters that are the stiffness of its springs.
std::vector<std::string> stiffness_parameters(const std::string& solver);
/// Name of the parameter with that role; its usual name for a solver that this program lacks.
std::string parameter_of(std::string_view solver, ParamSpec::Role);
/// The term that explains a labelled parameter: its name, or "method of XPBD" if the parameter of
/// that name means something else in labels of another solver.
std::string parameter_term(const std::string& solver, const std::string& name);
/// What the term means, with the parameter's unit or its choices; "" for a solver or a parameter
/// that this program lacks.
std::string parameter_meaning(const std::string& solver, const std::string& name);
/// The parameters that a search may vary, the labelled ones included: cases that differ in these
/// alone are settings of one solver.
std::vector<std::string> searched_parameters(const std::string& solver);

/// Accelerators that this case uses and that a solver with these parameters lacks ("tethers").
std::vector<std::string> extras(const Record&, const std::map<std::string, std::string>& others);

/// Work of a step; -1 where the solver has no such setting.
struct Work {
  int substeps = -1, sweeps = -1;
  auto operator<=>(const Work&) const = default;
  std::string text() const;  ///< "1 × 16": substeps × sweeps
};
Work work_of(const Record&);

/// The time step [s] and the work at which solvers are quoted if the cases leave a choice:
/// published comparisons come nearest to this work.
inline constexpr double kQuotedStep = 1.0 / 64;
inline constexpr Work kQuotedWork{.substeps = 1, .sweeps = 16};

/// "1 × 16, order=mesh": the work, and whatever differs from the defaults.
std::string brief_settings(const SolverChoice&);
/// The same for a record, with all parameters of a solver that this program lacks.
std::string brief_settings(const Record&);

/// "Jakobsen 1 × 16, order=mesh"; the title alone if there are no settings.
std::string titled(const std::string& solver, const std::string& settings);

/// The work of each solver with sweeps, "Jakobsen 5 × 1 to 64, Bullet 1 × 1 to 64" (substeps ×
/// sweeps), if they have none in common; "" if they have.
std::string unequal_work(const Records&);

/// The setting in a label: "mesh", a value that speaks for itself; "levels=4" and "tethers=on",
/// whose values do not; "8 sweeps" for kSweeps.
std::string named_setting(const std::string& name, const std::string& value);

/// A part of a label.
struct LabelPart {
  std::string text;  ///< "tethers=on"
  std::string term;  ///< the term of a page that explains it, "tethers"; "": it needs none
};
struct Label : std::vector<LabelPart> {
  std::string text() const;                ///< "2 × 8, tethers=on"
  std::vector<std::string> terms() const;  ///< of the parts that need one
};

/// The term of every work that has substeps and sweeps.
inline constexpr const char* kWorkTerm = "2 × 8";
LabelPart label_part(const Work&);

/// Labels of records by those accuracy parameters that take several values among their solver's.
class SettingLabels {
 public:
  explicit SettingLabels(const Records&);
  /// "2 × 8, mesh": what varies, first the work, then what differs from the solver's defaults; if
  /// nothing does, the work. "" if nothing varies. Without the parameters that are shown beside it.
  std::string of(const Record&, const std::vector<std::string>& beside = {}) const;
  /// The same, a part for each: the work, then a part for every other parameter.
  Label parts(const Record&, const std::vector<std::string>& beside = {}) const;

 private:
  std::map<std::pair<std::string, std::string>, std::set<std::string>> seen_;  ///< solver, name
};

}  // namespace taut::report
