// The program: `taut VERB ...`. Each verb is a file in experiments/verbs.
#include "experiments/verbs/invoke.hpp"

int main(int argc, char** argv) { return taut::command_line(argc, argv); }
