// The program `taut VERB ...`. Each verb is a file in experiments/cli, in the folder of its group.
#include "experiments/command_line/verb.hpp"
#include "experiments/external/external.hpp"

int main(int argc, char** argv) {
  taut::external::enable();
  return taut::command_line(argc, argv);
}
