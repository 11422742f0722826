#pragma once

#include <string>

#include "experiments/study/cluster/manifest.hpp"

namespace taut::cluster {

/// Who starts the shards of a folder.
enum class Scheduler { slurm, parallel };

/// Time that Slurm gives each shard [minutes]: twice the estimate of the longest one, and what a
/// single case may take, so that every start finishes at least one case.
int shard_minutes(const Manifest&);

/// Fewest shards, each of which ends within so many hours. Throws InputError if one case may not.
int shards_for(const Manifest&, double hours);

/// The text of job.sh. Called with numbers of shards it runs those, else all; it names nothing of
/// the machine that wrote it: the program is $TAUT, or `taut` of the PATH.
std::string job_script(const Manifest&, Scheduler);

/// The README of a folder: five lines.
std::string readme(const Manifest&, Scheduler);

}  // namespace taut::cluster
