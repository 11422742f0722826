#pragma once

#include <cstddef>
#include <functional>

namespace taut {

/// Calls work(i) for each i below `count`, `at_a_time` calls at once, and returns when all have.
/// After the first exception no further call begins, and that exception is thrown here.
void run_all(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

}  // namespace taut
