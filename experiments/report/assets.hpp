#pragma once

namespace taut::report {

// Texts of experiments/report/assets, put into the program by CMake.
extern const char* const report_css;
extern const char* const report_js;

}  // namespace taut::report
