#pragma once

#include <vector>

#include "core/io/document.hpp"

namespace taut {

/// The values of a scene's document that name files, relative to the scene's folder. To write the
/// scene to another folder, change them or copy the files.
std::vector<Value*> file_names(Value& root);

}  // namespace taut
