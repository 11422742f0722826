#pragma once

#include <vector>

#include "core/model/input_error.hpp"

namespace taut {

/// Calls read(one) for each item and throws the errors of all of them as one InputError.
template <class All, class Read>
void read_all(const All& all, const Read& read) {
  std::vector<Diagnostic> wrong;
  for (const auto& one : all) try {
      read(one);
    } catch (const InputError& error) {
      wrong.insert(wrong.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  if (!wrong.empty()) throw InputError(wrong);
}

}  // namespace taut
