#include "experiments/command_line/main_job_end.hpp"

#include "core/model/text.hpp"
#include "experiments/baseline/check.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/output.hpp"
#include "experiments/command_line/page.hpp"
#include "experiments/command_line/study_options.hpp"
#include "experiments/steps/one_step.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/signals.hpp"
#include "experiments/timing/study_bench.hpp"
#include "experiments/truths/verify.hpp"

namespace taut {

namespace {

void tell_part(int part, const std::string& what) {
  progress() << "part " << part << " of 6: " << what << '\n';
}

}  // namespace

void tell_main_job(const std::vector<StudyCases>& studies) {
  std::size_t all = 0;
  for (const StudyCases& study : studies) all += study.cases.size();
  progress() << "the main job: " << all << " cases of " << studies.size()
             << " studies, then their costs, closed forms, baselines and films; eight minutes "
                "on two idle cores, and it may be interrupted\n";
  tell_part(1, "cases of the studies");
}

std::string end_main_job(const MainJob& job, const MainJobEnd& options) {
  Store store(options.results);
  tell_part(2, "what accuracy costs, one case at a time");
  require_one_quiet_host();
  const Study trade = load_study(job.bench, job.preset);
  keep(store,
       bench_study(trade.name, run_and_collect({trade.name, cases_of(trade)}, store, "taut bench"),
                   tell_timing({.seconds = 0.015})));
  for (const std::string& scene : job.steps) {
    tell_part(3, "inside one step of " + scene);
    const StudyScene chosen = parse_study_scene(scene);
    store.keep(one_step({.scene = chosen.name,
                         .settings = chosen.settings,
                         .solvers = load_study(job.studies.front(), options.preset).solvers}));
  }
  tell_part(4, "solvers beside closed forms and published numbers");
  store.keep(answer_of(taut::verify(
      {.truths = truths_in_order(), .jobs = options.jobs, .progress = Countdown("truth")})));
  tell_part(5, "the committed baselines");
  BaselineOptions baselines = baseline_options();
  baselines.baselines = baselines_folder();
  baselines.out = options.results;
  baselines.jobs = options.jobs;
  const Check compared = check_studies({}, baselines);
  if (compared.end == CheckEnd::interrupted) throw Interrupted();
  if (compared.cases > 0) store.keep(compared.answer);
  if (options.print_check) print(compared.answer, {});
  tell_part(6, "the page and its films");
  const std::filesystem::path file = std::filesystem::absolute("report.html").lexically_normal();
  const Page page = make_page({.preset = options.preset == job.preset ? "" : options.preset,
                               .results = options.results,
                               .output = file.string()});
  write_file(file.string(), page.text);
  return join(page.in_few_lines, "", [](const std::string& line) { return line + "\n"; }) +
         file.string() + "\n";
}

}  // namespace taut
