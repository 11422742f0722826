#pragma once

#include <string>

#include "experiments/results/database.hpp"
#include "experiments/results/store.hpp"

namespace taut {

/// Changes a results file by one SQL statement, as no program but a test does.
template <class... Values>
void change(Store& store, const std::string& sql, const Values&... values) {
  Database(store.file(), Database::Access::write).run(sql, values...);
}

inline void forget(Store& store, const std::string& key) {
  change(store, "DELETE FROM cases WHERE key = ?", key);
}

}  // namespace taut
