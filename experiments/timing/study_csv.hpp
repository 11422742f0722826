#pragma once

#include <cstdint>
#include <string>

#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

class Database;

/// A study's cases, as this build would run them, as CSV in SI units: what is not stored, or does
/// not match its digest, has a row without values whose status says so.
class StudyCsv {
 public:
  /// Precondition: store.reading(). The store outlives this.
  StudyCsv(const Study&, const Store&);

  std::int64_t stored();
  std::int64_t not_run();
  std::int64_t damaged();

  /// A row for each case: what it was asked for, how it ended, every value, and what it cost here
  /// or, if nothing was timed here, on another host.
  std::string wide();
  std::string tidy();    ///< a row for each value of each case
  std::string series();  ///< a row for each value over time of each case

 private:
  Database& database_;
};

}  // namespace taut
