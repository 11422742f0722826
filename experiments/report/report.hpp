#pragma once

#include <filesystem>

#include "experiments/report/input.hpp"

namespace taut::report {

/// The report as one HTML text that needs nothing else: no request leaves it (its content security
/// policy forbids them). Figures are drawn on the way; where gnuplot is missing the data tables
/// stay and a line says why the picture is absent. Throws InputError if no study has a record.
std::string make_report(const ReportInput&);

/// The same into a file, whole or not at all; gives its path. Throws std::runtime_error as well.
std::filesystem::path write_report(const ReportInput&, const std::filesystem::path&);

/// A report may weigh this much [bytes]: a megabyte a scene, three for a single one, a third of one
/// for a scene that is only shown. Pictures that would exceed it are left out, and said so.
constexpr std::size_t report_limit(std::size_t scenes, std::size_t others = 0) {
  return (scenes < 3 ? 3'000'000 : scenes * 1'000'000) + others * 333'000;
}

}  // namespace taut::report
