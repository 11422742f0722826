#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/model/text.hpp"

namespace taut {

/// The number with which a text begins, after blanks.
inline double number_at(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (const auto number = take_number(text)) return *number;
  throw std::invalid_argument("no number: " + std::string(text));
}

}  // namespace taut
