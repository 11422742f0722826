#pragma once

#include <cstddef>
#include <functional>

namespace taut {

/// Calls work(i) for each i below `count` in `jobs` threads, and returns when all calls have. After
/// the first exception no further call begins; that exception is then thrown.
void run_all(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

}  // namespace taut
