#pragma once

#include <filesystem>
#include <string>

#include "core/model/input_error.hpp"

namespace taut {

/// A results file that cannot be read or written, whatever was asked of it: no space, locked,
/// damaged, of another taut.
class StoreError : public InputError {
 public:
  StoreError(const std::filesystem::path& file, const std::string& why)
      : InputError(file.string() + ": " + why) {}
};

}  // namespace taut
