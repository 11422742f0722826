// The program: `taut VERB ...`. Each verb is a file in experiments/cli.
#include "experiments/command_line/verb.hpp"

int main(int argc, char** argv) { return taut::command_line(argc, argv); }
