#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace taut {

/// Most that a file of each kind may have [bytes].
inline constexpr std::size_t kMostSceneBytes = std::size_t{16} << 20;
inline constexpr std::size_t kMostMeshBytes = std::size_t{1} << 30;
inline constexpr std::size_t kMostResultBytes = std::size_t{1} << 30;

/// Everything in a regular file. Throws InputError that names it: it cannot be read, is no regular
/// file (a folder, a pipe, a device; none is waited for) or is larger than `most` bytes.
std::string read_text(const std::filesystem::path&, std::size_t most = kMostResultBytes);

}  // namespace taut
