#pragma once

#include <span>
#include <string_view>

namespace taut::report {

/// A file of experiments/report/page, or d3, put into the program by CMake.
struct PageFile {
  std::string_view name;  ///< "page.js"
  std::string_view text;
};
std::span<const PageFile> page_files();

}  // namespace taut::report
