#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut::report {

/// One case on a curve, in SI units.
struct Point {
  double x = 0, y = 0;
  double along = 0;  ///< the setting that orders the curve
  const Record* record = nullptr;
  /// Under "setting": the accuracy parameters, "16 × 2" for substeps x sweeps.
  std::string name = {};
  std::size_t parts =
      0;  ///< how many words `name` has: one for the work, one for each other parameter

  /// Whether it has a value that may be compared. If not, a glyph says what happened.
  bool measured() const;
};

/// One solver with one choice of its settings, ordered along one more setting.
struct Curve {
  std::string label;   ///< "Jakobsen sqrt-free"
  std::string solver;  ///< the entry's name
  int variant = 0;     ///< counts the curves of one solver in a figure
  std::vector<Point> points;
};

/// Groups records into curves of y over x: those that differ in nothing but `along` (kSweeps, "dt",
/// ...) and `also` share a curve. Labels name only the settings that vary among the records.
/// `along` = "setting" frees every accuracy parameter at once: one curve per solver, ordered by x.
std::vector<Curve> make_curves(const Records&, const std::string& x, const std::string& y,
                               const std::string& along, const std::string& also = "");

/// The records at the value of `setting` which most of them share (ties: nearest to `preferred`),
/// with that value in SI units. All records and NaN if none has the setting.
struct Slice {
  Records records;
  double value = 0;
};
inline double preferred(const std::string& setting) {
  return setting == "dt" ? kQuotedStep : kQuotedWork.sweeps;
}
Slice hold(const Records&, const std::string& setting, double preferred);
inline Slice hold(const Records& records, const std::string& setting) {
  return hold(records, setting, preferred(setting));
}

/// Curves over two quantities, in SI units: what a page or a plot draws.
struct Chart {
  std::string id, scene, kind, title;
  std::string caption = {}, held = {};  ///< "time step 15.6 ms"
  Quantity x, y;
  std::string along = {};  ///< the setting that orders a curve
  std::vector<Curve> curves = {};
  std::vector<TimeSeries> series = {};  ///< instead of curves: values over time
  std::vector<double> ticks = {};       ///< of x: the values of a study's setting, SI, ascending
  bool join = true;                     ///< the points of a curve by a line
  std::optional<double> slope = {};     ///< the theory's exponent
  /// c of its line c x^slope, which is drawn as it is; nothing: it is drawn below the curves.
  std::optional<double> factor = {};
  /// The value below which y says nothing, and the reason.
  struct Floor {
    double y = 0;
    std::string text;  ///< "the reference's own error"
  };
  std::optional<Floor> floor = {};
  bool front = false;                         ///< with the Pareto front
  std::map<std::string, Interval> cost = {};  ///< by case key: the interval of x
  /// Why a timed case does not count, by case key. Such a case is on no front.
  std::map<std::string, std::string> not_counted = {};
};

/// The curves of y over x for these records. "setting" as `along` frees every accuracy parameter.
/// Throws InputError if no record has both, or only failures have x.
Chart make_chart(std::string kind, const Records&, const std::string& x, const std::string& y,
                 const std::string& along);

/// Adds the line below which y says nothing (ValueSpec::floor), if y has one.
void add_floor(Chart&);

/// A sentence for each curve that lies within a hundredth of an earlier one at every point, since
/// one hides the other. Zeros are not compared: they stand side by side on the axis. No sentences
/// for a chart of more than a dozen curves.
std::vector<std::string> coincident_curves(const Chart&);

/// Whether the point has no value to be drawn: it failed. What a solver cannot run is no failure.
bool failed(const Point&);

/// c of a theory line y = c x^slope below the lowest curve; NaN: there is no line.
double theory_factor(const Chart&);

/// What the theory line is called: "theory of relaxation: 1/sweeps".
std::string theory_text(const Chart&);

/// The Pareto front, by ascending x: the measured points that count and that no other of them beats
/// in both x and y.
std::vector<Point> pareto_front(const Chart&);

/// How cases of one solver end over two settings.
struct StatusMap {
  std::string scene, solver, label, study;
  Quantity x, y;
  std::vector<double> columns, rows;  ///< SI, ascending
  struct Cell {
    std::size_t column = 0, row = 0;
    const Record* record = nullptr;
  };
  std::vector<Cell> cells;
};
/// One for each solver and choice on this scene; of two cases in one cell the worse. Throws
/// InputError if no case has both settings.
std::vector<StatusMap> make_maps(const Records&, const std::string& scene, const std::string& x,
                                 const std::string& y);

/// "1", "4.2", "33": a setting's value in its shown unit, for the edge of a map.
std::string tick_of(const Quantity&, double si);

/// Everything drawn of a scene that a study ran, in the order in which to show it.
std::vector<Chart> scene_charts(const ReportInput&, const std::string& scene);
std::vector<StatusMap> scene_maps(const ReportInput&, const std::string& scene);
/// The metric that decides on the scene over the cost of a bench.
Chart cost_chart(const SceneBench&, const Records&);

}  // namespace taut::report
