#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"

namespace taut {

/// A scene that no study ran.
struct OtherScene {
  std::string name;    ///< or path
  bool still = false;  ///< its poster is enough
};

/// Adds a film of every scene that a study ran, in the order of the report: each contender at the
/// settings at which single cases are quoted, and the reasons of solvers that refuse the scene.
/// Then adds films of `others`, which are smaller, or only pictures, with their values over time.
/// `tell` gets a line for each film that is made and for each that is left out (make_films). Throws
/// InputError if one of the others is no scene.
void add_films(
    report::ReportInput&, const std::vector<OtherScene>& others,
    const std::filesystem::path& folder,
    const std::function<void(const std::string& news, std::size_t done, std::size_t all)>& tell);

}  // namespace taut
