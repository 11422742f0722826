#pragma once

namespace taut {

/// Parses the words of the command line, whose first is a known verb or an option, and runs the
/// verb. Prints help and complaints about options. Returns the exit code.
int parse_and_run(int argc, char** argv);

}  // namespace taut
