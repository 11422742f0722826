#pragma once

#include <vector>

#include "core/io/document.hpp"

namespace taut {

/// The values of a scene's document that name files. Whoever writes the scene to another folder
/// changes them, or copies the files. A name is relative to the scene's folder.
std::vector<Value*> file_names(Value& root);

}  // namespace taut
