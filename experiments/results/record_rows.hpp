#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/results/database.hpp"

// Conversions between a record and its row in the table cases.

namespace taut {

/// The record in a row of case_columns(), without its values. Returns nothing and sets `why` if a
/// column holds what no record has.
std::optional<Record> record_of_row(const Database::Rows&, std::string& why);

/// The values of case_columns() for a record.
std::vector<Database::Value> row_of(const Record&);

}  // namespace taut
