#pragma once

#include <filesystem>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/external/connection.hpp"

namespace taut::external {

/// Makes programs known as solvers: "external:cmd='python3 mine.py',iterations=8", and NAME for
/// every NAME.toml in registered_folder(). Called once, by main().
void enable();

/// $TAUT_SOLVERS, else $XDG_CONFIG_HOME/taut/solvers, else ~/.config/taut/solvers.
std::filesystem::path registered_folder();

/// Why the program behind a solver did not introduce itself; "": it did, or there is none.
std::string why_silent(const SolverEntry&);

/// The command of "external:cmd='...'" or of a registered name, or the text itself as a command.
/// Throws InputError.
Command command_of(const std::string& text);

}  // namespace taut::external
