#pragma once

#include "experiments/case/record.hpp"

namespace taut {

/// A record for people, on standard output: what ran, how it ended, every value that has a meaning.
void print_record(const Record&);

}  // namespace taut
