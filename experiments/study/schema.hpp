#pragma once

namespace taut {

/// What PRAGMA user_version of a results file says; files of another one are not read.
inline constexpr int kSchemaVersion = 3;

/// The statements that make the tables of a results file.
extern const char* const kTables;

}  // namespace taut
