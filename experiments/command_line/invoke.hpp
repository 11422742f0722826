#pragma once

#include <string>
#include <vector>

namespace taut {

/// What main() does: finds the verb, parses its options, runs it; gives the exit code.
int command_line(int argc, char** argv);

/// Runs another verb of this program as if it had been typed: how `taut run` ends in a report
/// without knowing how reports are made. Gives its exit code; throws InputError if there is no such
/// verb or its arguments are wrong.
int invoke(const std::string& verb, std::vector<std::string> arguments);

/// Whether this program has the verb.
bool has_verb(const std::string& verb);

}  // namespace taut
