#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/study/session.hpp"
#include "experiments/study/store.hpp"

namespace taut {

/// Marks a results folder: these cases were planned and are not there. The mark stands in
/// <root>/missing/<name>.jsonl; reports show it until the cases come. Throws InputError.
void mark_missing(const std::filesystem::path& root, const std::string& name,
                  const std::vector<ManifestEntry>&);

/// A mark that still holds.
struct Missing {
  std::filesystem::path file;
  std::vector<std::string> ids;  ///< of cases that the store still lacks
  std::size_t cases = 0;         ///< that lacked when it was marked
  std::string sentence() const;
};
/// Throws InputError with file and line.
std::vector<Missing> still_missing(const Store&);

}  // namespace taut
