#pragma once

#include <nlohmann/json_fwd.hpp>

namespace taut {

/// The JSON type of the whole program. Keys stay in the order in which they were written. For
/// headers that only name it; json.hpp has the library.
using Json = nlohmann::ordered_json;

}  // namespace taut
