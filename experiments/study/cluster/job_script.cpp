#include <algorithm>
#include <cmath>
#include <map>

#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/process.hpp"

namespace taut::cluster {

namespace {

constexpr const char* kHead =
    R"SH(# A shard that is started again goes on where it stopped. ONLY=failed runs failures again, nothing else.
taut=${TAUT:-taut}
[[ $("$taut" --version) == *"program @BUILD@"* ]] || { echo "$taut is not the build that planned this: @BUILD@"; exit 2; }
run=("$taut" run @RUN@ ${ONLY:+--only "$ONLY"})
)SH";

constexpr const char* kSlurm =
    R"SH(# Slurm: sbatch job.sh, in this folder; sbatch --array=3,5 job.sh for some shards. A preemption sends SIGTERM, the time limit
# SIGUSR1 before it strikes, which queues the shard again.
shard=$(printf %04d "$SLURM_ARRAY_TASK_ID")
rm -f "shards/$shard/results.db.writer"  # Slurm runs a task once at a time: the process that left this mark is gone
"${run[@]}" --shard "$shard/@SHARDS@" --out "shards/$shard" &
child=$!
trap 'again=yes; kill -TERM $child 2>/dev/null' USR1
trap 'kill -TERM $child 2>/dev/null' TERM
again= code=
until wait $child; code=$?; ! kill -0 $child 2>/dev/null; do :; done
[[ -z $again || $code -eq 0 ]] || exec scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
exit "$code"
)SH";

constexpr const char* kParallel =
    R"SH(# GNU parallel: ./job.sh runs what has not ended well yet; ./job.sh 3 5 runs some shards. Nodes are the lines of the file
# "nodes", if there is one: they see this folder under the same path. $JOBS shards at a time on each node, or one per core.
cd "$(dirname "$0")" || exit
if [[ ${1:-} == --shard ]]; then  # what GNU parallel starts: it reads braces and a shell reads the rest, so no name is told to it
  shard=$2
  exec "${run[@]}" --shard "$shard/@SHARDS@" --out "shards/$shard"
fi
export TAUT=$taut ONLY=${ONLY:-}
options=(--env TAUT --env ONLY --jobs "${JOBS:-100%}" --termseq TERM,20000,KILL,25)
[[ ! -f nodes ]] || options+=(--sshloginfile ./nodes --workdir "$PWD")
[[ $# -gt 0 ]] || { set -- {1..@SHARDS@}; options+=(--joblog joblog --resume --resume-failed); }
shards=($(printf '%04d ' "$@"))
for shard in "${shards[@]}"; do rm -f "shards/$shard/results.db.writer"; done  # the processes that left these marks are gone
exec parallel "${options[@]}" bash ./job.sh --shard {} ::: "${shards[@]}"
)SH";

/// Replaces each mark ("@RUN@") in the text by its value. Values are not searched for marks.
std::string filled(std::string_view text, const std::map<std::string_view, std::string>& values) {
  std::string all;
  while (!text.empty()) {
    const auto mark =
        std::ranges::find_if(values, [&](const auto& one) { return text.starts_with(one.first); });
    all += mark == values.end() ? std::string(1, text.front()) : mark->second;
    text.remove_prefix(mark == values.end() ? 1 : mark->first.size());
  }
  return all;
}

}  // namespace

int shard_minutes(const Plan& plan) {
  return static_cast<int>(std::ceil((2 * plan.longest + plan.limits.wall_seconds()) / 60 + 1));
}

std::string job_script(const Plan& plan, Scheduler on) {
  const bool slurm = on == Scheduler::slurm;
  // Memory beside the case: the program that runs the shard, its records and its scenes.
  const std::size_t bytes = plan.case_memory + (std::size_t{192} << 20);
  std::string text = "#!/bin/bash\n";
  if (slurm)
    text += "#SBATCH --job-name=" + slug("taut-" + plan.study) + "\n#SBATCH --array=1-" +
            std::to_string(plan.shards) +
            "\n#SBATCH --time=" + std::to_string(shard_minutes(plan)) +
            "\n#SBATCH --mem=" + std::to_string(bytes >> 20) +
            "M\n#SBATCH --ntasks=1 --cpus-per-task=1\n" +
            "#SBATCH --requeue --open-mode=append --output=log/%a.txt --signal=B:USR1@60\n";
  const std::string run = shell_word("./" + plan.study + ".toml") +
                          (plan.preset.empty() ? "" : " --preset " + shell_word(plan.preset)) +
                          " -j 1 --timeout " + shortest(plan.limits.seconds) + " --memory " +
                          std::to_string(plan.limits.bytes >> 20);
  text += std::string(kHead) + (slurm ? kSlurm : kParallel);
  return filled(text, {{"@RUN@", run},
                       {"@SHARDS@", std::to_string(plan.shards)},
                       {"@BUILD@", program_digest().substr(0, 10)}});
}

std::string readme(const Plan& plan, Scheduler on) {
  const bool slurm = on == Scheduler::slurm;
  return "Study " + plan.study + (plan.preset.empty() ? "" : " --preset " + plan.preset) + ": " +
         std::to_string(plan.cases) + " cases in " + std::to_string(plan.shards) +
         " shards, for taut build " + program_digest().substr(0, 10) +
         " (`taut --version`; $TAUT names it if it is not in the PATH).\n" +
         "Start, or go on where it stopped: " + (slurm ? "sbatch job.sh" : "./job.sh") +
         " in this folder.\n" +
         "Progress, failures and what to start again: taut cluster status .\n" +
         "All results into one file, if none is missing: taut cluster merge . --out "
         "results/runs\n" +
         "results.db: the plan; " + plan.study + ".toml: the study; shards/: results; " +
         (slurm ? "log/: output of the jobs.\n" : "joblog: GNU parallel's list of ended shards.\n");
}

}  // namespace taut::cluster
