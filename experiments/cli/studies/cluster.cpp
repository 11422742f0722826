#include "experiments/command_line/verb.hpp"

TAUT_VERB(cluster) = {.name = "cluster",
                      .group = VerbGroup::studies,
                      .summary = "Runs a study on many machines: submit, status, merge",
                      .example =
                          "taut cluster submit iterations --on slurm --shards 8\n"
                          "  taut cluster status results/cluster/iterations\n"
                          "  taut cluster merge results/cluster/iterations"};
