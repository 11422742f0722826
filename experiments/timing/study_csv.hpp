#pragma once

#include <cstdint>
#include <string>

#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

class Database;

/// Exports a study's cases, as this build would run them, as CSV in SI units. A case that is not
/// stored or does not match its digest has a row without values, whose status says so.
class StudyCsv {
 public:
  /// Precondition: store.reading() is not null. The store has to outlive this object.
  StudyCsv(const Study&, const Store&);

  std::int64_t stored();
  std::int64_t not_run();
  std::int64_t damaged();

  /// A row for each case: its settings, how it ended, every value, and its cost on this host, or if
  /// it was not timed here on another host.
  std::string wide();
  std::string tidy();    ///< a row for each value of each case
  std::string series();  ///< a row for each value over time of each case

 private:
  Database& database_;
};

}  // namespace taut
