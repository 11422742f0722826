#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace taut {

/// The man page taut(1) in roff, from the descriptions of a program's verbs and options.
std::string man_page(const CLI::App&, const std::string& version);

/// Completion for bash of verbs, options and the names of scenes, studies and solvers.
std::string bash_completion(const CLI::App&);

}  // namespace taut
