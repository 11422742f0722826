#pragma once

#include <filesystem>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/external/connection.hpp"

namespace taut::external {

/// Makes external programs available as solvers: "external:cmd='python3 mine.py',iterations=8", and
/// NAME for every NAME.toml in registered_folder(). main() calls it once.
void enable();

/// $TAUT_SOLVERS, else $XDG_CONFIG_HOME/taut/solvers, else ~/.config/taut/solvers.
std::filesystem::path registered_folder();

/// Why the program behind a solver did not introduce itself; "" if it did or if the solver is no
/// program.
std::string why_silent(const SolverEntry&);

/// Runs programs that did not pass the quick probe, too, from now on: for the conformance suite,
/// which finds the same errors and names them.
void run_unprobed();

/// Command of "external:cmd='...'" or of a registered name; any other text is itself a command.
/// Throws InputError.
Command command_of(const std::string& text);

}  // namespace taut::external
