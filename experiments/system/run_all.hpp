#pragma once

#include <cstddef>
#include <functional>

namespace taut {

/// Calls work(i) for each i below `count`, so many at a time, and returns when all have returned.
/// After the first exception no further call begins, and it is thrown here.
void run_all(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

}  // namespace taut
