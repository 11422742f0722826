#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/results/database.hpp"

// Conversions between a record and its row in the table cases.

namespace taut {

/// A whole number; -1 where the column is NULL.
int whole_or_none(const Database::Rows&, int column);

/// The record in a row of case_columns(), without its values. Returns nothing and sets `why` if a
/// text is invalid.
std::optional<Record> record_of_row(const Database::Rows&, std::string& why);

/// The values of case_columns() for a record.
std::vector<Database::Value> row_of(const Record&);

}  // namespace taut
