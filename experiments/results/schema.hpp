#pragma once

#include <string>
#include <vector>

namespace taut {

/// What PRAGMA user_version of a results file says; files of another one are not read.
inline constexpr int kSchemaVersion = 8;

/// The statements that make the tables of a results file.
std::string tables();

/// The columns of the table cases that hold a record, in the order of record_columns(); of the
/// others it has case_id, is_result, result_digest and errors.
std::vector<std::string> case_columns();

}  // namespace taut
