#pragma once

#include <string>

#include "experiments/study/database.hpp"
#include "experiments/study/store.hpp"

namespace taut {

/// What nobody but a test does to a results file: one statement of SQL.
template <class... Values>
void change(const Store& store, const std::string& sql, const Values&... values) {
  Database(store.file(), Database::Access::write).run(sql, values...);
}

inline void forget(const Store& store, const std::string& key) {
  change(store, "DELETE FROM cases WHERE key = ?", key);
}

}  // namespace taut
