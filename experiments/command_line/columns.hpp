#pragma once

#include <string>
#include <vector>

namespace taut {

using Row = std::vector<std::string>;

/// Rows on stdout in columns, two blanks before each: the first `names` columns and the last are
/// flush left, the others flush right. All rows are as long as the first. Widths count characters
/// of UTF-8.
void print_columns(const std::vector<Row>&, std::size_t names);

}  // namespace taut
