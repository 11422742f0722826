#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/reference/fit.hpp"

namespace taut {

/// How a measured number compares with what is known.
enum class TruthVerdict {
  passed,          ///< agrees within the tolerance
  deviates,        ///< differs for a known reason, by as much as that reason explains
  not_applicable,  ///< the solver does not offer what the truth is about
  broken           ///< differs: the testbed or the solver is wrong
};
std::string_view to_string(TruthVerdict);

/// One number of one subject against the truth.
struct Finding {
  std::string subject;   ///< "jakobsen:projection=exact,...", "static reference", "closed form"
  std::string quantity;  ///< what was measured
  std::string unit;      ///< "1" if dimensionless
  double measured = 0;
  double expected = 0;     ///< what the truth says
  double tolerance = 0;    ///< |measured - expected| may be this large; for `deviates` too
  double uncertainty = 0;  ///< one standard error of a fitted slope; 0: not fitted
  TruthVerdict verdict = TruthVerdict::passed;
  std::string why;  ///< of a deviation or of what the solver does not offer
};

/// Collects the findings of one truth and knows which solvers were asked for.
class Findings {
 public:
  /// `only`: names or texts of solvers; empty: all subjects. References count as "reference".
  explicit Findings(std::vector<std::string> only = {}) : only_(std::move(only)) {}

  /// Whether this subject's solver was asked for: spares the work if not.
  bool wants(std::string_view subject) const;
  /// What was asked for: names, and whole texts of solvers from outside. Empty: all.
  const std::vector<std::string>& asked() const { return only_; }

  /// |measured - expected| <= tolerance (absolute, in the quantity's unit).
  void equal(std::string_view subject, std::string_view quantity, std::string_view unit,
             double measured, double expected, double tolerance);
  /// What is so or not.
  void holds(std::string_view subject, std::string_view quantity, bool measured);
  /// 0 <= measured <= limit: an error that has to be small.
  void below(std::string_view subject, std::string_view quantity, std::string_view unit,
             double measured, double limit);
  /// A fitted exponent with its standard error.
  void slope(std::string_view subject, std::string_view quantity, const PowerLaw& fitted,
             double expected, double tolerance);
  /// The truth says `expected`; this subject legitimately gives `explained` (within tolerance).
  /// Where both are within the tolerance it passes: nobody could tell them apart.
  void deviates(std::string_view subject, std::string_view quantity, std::string_view unit,
                double measured, double expected, double explained, double tolerance,
                std::string_view why);
  void not_applicable(std::string_view subject, std::string_view why);

  const std::vector<Finding>& all() const { return findings_; }

 private:
  void add(Finding);
  std::vector<std::string> only_;
  std::vector<Finding> findings_;
};

/// How a truth introduces itself: found by its TAUT_TRUTH line.
struct TruthEntry {
  std::string_view name;  ///< "hanging-chain-sweeps"
  int section = 0;        ///< 1 constraint, 2 twin, 3 free motion, 4 pendulum and chain,
                    ///< 5 stability, 6 cloth, 7 contact, 8 published, 9 references, 10 metrics
  int row = 0;                 ///< within the section, from 1
  std::string_view statement;  ///< what must hold, one sentence with the formula
  std::string_view source;     ///< paper, book or derivation
  void (*check)(Findings&);
};

/// "hanging-chain-sweeps" of hanging_chain_sweeps.
template <std::size_t length>
struct Hyphenated {
  consteval Hyphenated(const char (&id)[length]) {
    for (std::size_t i = 0; i < length; ++i) text[i] = id[i] == '_' ? '-' : id[i];
  }
  char text[length];
};

/// All truths (generated; see cmake/registry.cmake).
std::span<const TruthEntry* const> truths();

/// The title of a section of the list.
std::string_view section_title(int section);

}  // namespace taut

/// A truth within namespace taut: its name with underscores, section and row of the list (as in
/// `taut verify --section 4`), what must hold, and its source; then the function that checks it:
///     TAUT_TRUTH(weightless, 3, 99, "Without forces ...", "Newton") { findings.below(...); }
#define TAUT_TRUTH(id, section, row, statement, source)                                     \
  static void check_##id(Findings&);                                                        \
  static constexpr Hyphenated name_##id(#id);                                               \
  extern const TruthEntry truth_##id;                                                       \
  const TruthEntry truth_##id{name_##id.text, section, row, statement, source, check_##id}; \
  static void check_##id(Findings& findings)
