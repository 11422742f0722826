#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/process.hpp"

namespace taut::cluster {

namespace {

/// Wall time that a case may take (isolate.hpp) [s].
double longest_case(const Manifest& manifest) { return 5 * manifest.limits.seconds; }

double longest_shard(const Manifest& manifest) {
  std::vector<double> seconds(static_cast<std::size_t>(manifest.shards), 0);
  for (const PlannedCase& one : manifest.cases)
    seconds[static_cast<std::size_t>(one.shard) - 1] += estimated_seconds(one.work);
  return *std::ranges::max_element(seconds);
}

constexpr const char* kSlurm =
    R"SH(# Slurm: sbatch job.sh, in this folder; sbatch --array=3,5 job.sh for some shards. A shard that is started again goes on
# where it stopped: after a failed node, a preemption (SIGTERM) or its time limit (SIGUSR1, which queues it again).
"${TAUT:-taut}" cluster run . --shard "$SLURM_ARRAY_TASK_ID" -j 1 &
child=$!
trap 'again=yes; kill -TERM $child 2>/dev/null' USR1
trap 'kill -TERM $child 2>/dev/null' TERM
again= code=
until wait $child; code=$?; ! kill -0 $child 2>/dev/null; do :; done
[[ -z $again || $code -eq 0 ]] || exec scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
exit "$code"
)SH";

constexpr const char* kParallel =
    R"SH(# GNU parallel: ./job.sh runs what has not ended well yet; ./job.sh 3 5 runs some shards. A shard that is started again
# goes on where it stopped. Nodes are the lines of the file "nodes", if there is one: they see this folder under the same
# path. $JOBS shards at a time on each node, or one per core.
cd "$(dirname "$0")" || exit
options=(--jobs "${JOBS:-100%}" --termseq TERM,20000,KILL,25)
[[ ! -f nodes ]] || options+=(--sshloginfile ./nodes --workdir "$PWD")
shards=("$@")
[[ $# -gt 0 ]] || { shards=({1..@SHARDS@}); options+=(--joblog joblog --resume --resume-failed); }
exec parallel "${options[@]}" "${TAUT:-taut}" cluster run . --shard '{}' -j 1 ::: "${shards[@]}"
)SH";

}  // namespace

int shard_minutes(const Manifest& manifest) {
  return static_cast<int>(
      std::ceil((2 * longest_shard(manifest) + longest_case(manifest)) / 60 + 1));
}

int shards_for(const Manifest& manifest, double hours) {
  const double room = 3600 * hours - longest_case(manifest) - 60;
  if (!(room > 0))
    throw InputError("--hours " + shortest(hours) + ": a single case may take " +
                     shortest(std::ceil(longest_case(manifest) / 60)) +
                     " minutes (--timeout makes that less)");
  Manifest shared = manifest;
  double all = 0;
  for (const PlannedCase& one : manifest.cases) all += estimated_seconds(one.work);
  const int most = std::min(kMostShards, static_cast<int>(manifest.cases.size()));
  const auto fits = [&](int shards) {
    shared.shards = shards;
    share_out(shared);
    return shard_minutes(shared) <= 60 * hours;
  };
  if (!fits(most))
    throw InputError("--hours " + shortest(hours) + ": " + std::to_string(most) +
                     " shards, as many as there can be, take " +
                     std::to_string(shard_minutes(shared)) + " minutes each");
  int fewest = std::clamp(static_cast<int>(std::min(std::ceil(2 * all / room), 1e6)), 1, most);
  while (!fits(fewest)) ++fewest;
  return fewest;
}

std::string job_script(const Manifest& manifest, Scheduler on) {
  std::ostringstream text;
  text << "#!/bin/bash\n";
  if (on == Scheduler::parallel) {
    std::string body = kParallel;
    body.replace(body.find("@SHARDS@"), 8, std::to_string(manifest.shards));
    return text.str() + body;
  }
  // Beside the case: the program that runs the shard, its records and its scenes.
  const std::size_t bytes = manifest.case_memory + (std::size_t{192} << 20);
  text << "#SBATCH --job-name=" << shell_word("taut-" + manifest.study) << "\n#SBATCH --array=1-"
       << manifest.shards << "\n#SBATCH --time=" << shard_minutes(manifest)
       << "\n#SBATCH --mem=" << (bytes >> 20) << "M\n#SBATCH --ntasks=1 --cpus-per-task=1\n"
       << "#SBATCH --requeue --open-mode=append --output=log/%a.txt --signal=B:USR1@60\n"
       << kSlurm;
  return text.str();
}

std::string readme(const Manifest& manifest, Scheduler on) {
  const bool slurm = on == Scheduler::slurm;
  std::ostringstream text;
  text
      << "Study " << manifest.study
      << (manifest.preset.empty() ? "" : " --preset " + manifest.preset) << ": "
      << manifest.cases.size() << " cases in " << manifest.shards << " shards, for taut build "
      << manifest.build.substr(0, 10)
      << " (`taut --version`; $TAUT names it if it is not in the PATH).\n"
      << "Start, or go on where it stopped: " << (slurm ? "sbatch job.sh" : "./job.sh")
      << " in this folder; a shard by hand: taut cluster run . --shard 1\n"
      << "How far it is, what failed, what to start again: taut cluster status .\n"
      << "All results into one store, if none is missing: taut cluster merge . --out results/runs\n"
      << "manifest.jsonl: what is to run; study.toml: the study; shards/: results; "
      << (slurm ? "log/: what the jobs said.\n" : "joblog: GNU parallel's list of what ended.\n");
  return text.str();
}

}  // namespace taut::cluster
