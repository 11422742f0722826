#pragma once

#include <string>
#include <vector>

namespace taut {

/// PRAGMA user_version of a results file. Files with another version are not read.
inline constexpr int kSchemaVersion = 9;

/// The SQL statements that create the tables of a results file.
std::string tables();

/// The columns of the table cases that hold a record, in the order of record_columns(). Beside them
/// the table has case_id, is_result, result_digest and errors.
std::vector<std::string> case_columns();

}  // namespace taut
