#pragma once

#include <string>

#include "experiments/answer/answer.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/timing/study_bench.hpp"

// What verbs do for each other.

namespace taut::verb {

namespace bench {
/// Times a study, `seconds` of CPU time a sample, and keeps it in the results folder. Throws
/// InputError, Interrupted.
void time_study(const std::string& study, const std::string& preset, double seconds,
                const std::string& results);
}  // namespace bench

namespace convergence {
/// Iterations of these solvers inside one step of a scene, "name:key=value,...". Throws InputError.
Answer one_step(const std::string& scene, const std::vector<std::string>& solvers);
}  // namespace convergence

namespace verify {
/// All truths for every solver, on so many threads.
Answer verify_all(int jobs);
}  // namespace verify

namespace check {
/// Compares all studies that have a baseline, and keeps what it finds for the report. Throws
/// Interrupted.
Answer check_all(int jobs, const std::string& results);
}  // namespace check

namespace reporting {
/// Writes the page of the main job, at this preset, and returns what it says in ten lines, the last
/// of which is its file.
std::string report_main_job(const std::string& preset, const std::string& results);
}  // namespace reporting

namespace render {
/// Draws the end of these runs.
void draw_end(const RunRequest&, const std::string& file);
}  // namespace render

}  // namespace taut::verb
