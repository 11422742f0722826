#pragma once

#include <nlohmann/json.hpp>

namespace taut {

/// The one kind of JSON in the program: keys stay in the order in which they were written. Include
/// this from sources only; the library is large.
using Json = nlohmann::ordered_json;

}  // namespace taut
