#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/results/database.hpp"

// A record and its row in the table cases.

namespace taut {

/// A whole number; -1 where the column is NULL.
int whole_or_none(const Database::Rows&, int column);

/// Of a row of case_columns() all but the values; nothing, and why, if a text is not what it has to
/// be.
std::optional<Record> record_of_row(const Database::Rows&, std::string& why);

/// What stands in case_columns() of a record.
std::vector<Database::Value> row_of(const Record&);

}  // namespace taut
