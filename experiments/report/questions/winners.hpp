#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/report/input.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/timing/judge.hpp"

namespace taut::report {

/// One timed setting that reaches an error.
struct Contender {
  std::string solver;
  Label setting;  ///< "1 × 10, coloured"
  Arithmetic arithmetic;
  std::string links;   ///< stiffness of its structural links, if they are not rigid: "1000 N/m"
  Interval cost;       ///< CPU s per simulated s
  double error = 0;    ///< by which it is judged
  double motion = 0;   ///< by kVerdict; NaN: not judged
  double stretch = 0;  ///< RMS; NaN: unknown
  double largest = 0;  ///< largest stretch of a link; NaN: unknown
  std::string key;     ///< of its case, short
  CaseSpec again;      ///< makes the case again; parameters at their defaults are left out
  bool bound = false;  ///< no cheaper setting of the solver was tried: its cost is at most this
};

/// Who reaches an error on a scene at the least cost.
struct WinnerCell {
  /// The cheapest contender, and those of other solvers that noise cannot tell from it; empty: no
  /// solver reaches the error.
  std::vector<Contender> cheapest;
  std::optional<Contender> next;  ///< the cheapest other contender, of another solver
  Interval times;                 ///< cost of `next`, if there is one, over that of the cheapest
  std::string why;                ///< why no solver reaches the error
  /// A solver beside the cheapest contender.
  struct Beside {
    Contender one;                  ///< its cheapest setting
    std::optional<Interval> times;  ///< its cost over the cheapest; nothing: not comparable
  };
  std::optional<Beside> bullet;  ///< btSoftBody, with which most readers compare, if it gets there
  std::optional<Beside> own;     ///< Jakobsen, the solver of this project
  /// Solvers that reach the error at less cost with settings that do not count, and why; they have
  /// none that does.
  std::vector<std::pair<std::string, std::string>> excluded;

  bool won() const { return cheapest.size() == 1 && next; }
};

struct WinnerRow {
  std::string scene, title;
  JudgedBy by = JudgedBy::nothing;
  std::vector<WinnerCell> cells;  ///< of each level of the map
  bool has_bullet = false;        ///< btSoftBody was timed here, or says why it cannot run
  std::string bullet_refused;     ///< why btSoftBody cannot run the scene; "" if it can
};

/// A piece of a sentence, and the case or map that it leads to.
struct Said {
  std::string text;
  std::string key = {};  ///< of a case; "": it leads nowhere
  bool of_map = false;   ///< it counts cells of the map
};

/// Who wins where: a row for each scene of a bench.
struct WinnerMap {
  std::string metric;  ///< by which errors are judged; its levels: levels_of()
  std::vector<WinnerRow> rows;
  std::vector<std::string> solvers;  ///< all that were timed, in order of appearance
  double noise = 0;  ///< how far identical code differed from itself, at most, as a share
};
WinnerMap winners_of(const ReportInput&, CaseList&, const std::string& metric = kVerdict);

/// At most two sentences about the whole map, each true of all its scenes; none if it has no rows.
std::vector<std::vector<Said>> sentences_of(const WinnerMap&);
/// Their text.
std::string text_of(const std::vector<Said>&);

/// One cell as a line: "Hang at 1 %: XPBD 1 × 8, ...: 0.07 ms a frame; 2.3 (2.1 to 2.5) times
/// cheaper than Jakobsen", or "Hang at 1 %: nobody, ..." with the reason.
std::string line_of(const WinnerRow&, std::size_t level);

/// Which of the timed solvers this project's authors wrote, and which are others' code.
std::string authors_text(const WinnerMap&);

/// Where Jakobsen, the solver of this project, loses: cells of the map in which noise does not make
/// it one of the cheapest, and questions of the answer in which another solver has the better
/// number over all scenes.
Table losses_of(const WinnerMap&, const Answer&);

/// What a cell of the map says and which settings count, sentence by sentence, for the page.
std::vector<std::string> rules_of(const WinnerMap&);
/// How sure a ratio of costs is: one statement for the page.
std::string certainty_text(double noise);

/// Terms that stand in settings and in arithmetics of these cases (LabelPart::term,
/// Arithmetic::brief()), and what they mean.
std::vector<std::pair<std::string, std::string>> terms_of(const std::vector<const Record*>&,
                                                          const std::string& vectors);

}  // namespace taut::report
