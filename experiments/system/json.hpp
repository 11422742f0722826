#pragma once

#include <nlohmann/json.hpp>

namespace taut {

/// The one kind of JSON in the program: keys stay in the order in which they were written. Include
/// this from sources only; the library is large.
using Json = nlohmann::ordered_json;

// Its writer and its parser are compiled once, in json.cpp.

/// indent < 0: one line. What is not UTF-8 in strings is replaced by U+FFFD.
std::string to_text(const Json&, int indent = -1);
/// Throws Json::exception.
Json parse_json(std::string_view);
/// is_discarded() if the text is not JSON.
Json try_parse_json(std::string_view);

}  // namespace taut
