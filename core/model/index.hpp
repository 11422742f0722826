#pragma once

#include <cstddef>

namespace taut {

/// Converts an index of a vertex or link for containers. Indices are int, as in files and OpenGL.
inline std::size_t to_index(int index) { return static_cast<std::size_t>(index); }

}  // namespace taut
