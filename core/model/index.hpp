#pragma once

#include <cstddef>

namespace taut {

/// Vertices and links are numbered with int, as in files and OpenGL; containers are not.
inline std::size_t to_index(int index) { return static_cast<std::size_t>(index); }

}  // namespace taut
