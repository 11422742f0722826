#include "experiments/report/run_answer.hpp"

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/failure_map.hpp"
#include "experiments/study/study_table.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

namespace {

/// The map of failures by stiffness, with costs if the study was timed.
Table failure_map_of(const Study& study, const Store& store) {
  const std::vector<Record> records = collect(study, store).records;
  std::vector<Record> timed;
  for (const StudyBench& bench : stored_benches(store, study.name)) {  // that of this build first
    const std::vector<Record> of_bench = bench.records();
    timed.insert(timed.end(), of_bench.begin(), of_bench.end());
  }
  return failure_map(records, timed, nullptr);
}

}  // namespace

Answer run_answer(const CampaignProgress& campaign, const std::vector<Study>& studies,
                  const std::vector<std::string>& values, const Store& store) {
  Answer answer{"run", ""};
  answer.add(Column("results").in_detail(), store.root().string());
  answer.add(Column("store").in_detail(), store.digest());
  answer.add(Column("cases").in_detail(), campaign.cases);
  answer.add(Column("ran").in_detail(), campaign.ran);
  answer.add(Column("stored").in_detail(), campaign.reused);
  Table statuses{"statuses", "", {{"status"}, {"cases"}}};
  for (const auto& [kind, count] : campaign.by_status)
    statuses.rows.push_back({cell_of(kind), count});
  statuses.detail = true;
  answer.add(std::move(statuses));
  for (const Study& study : studies)
    for (const std::string& value : values) {
      const std::string name = studies.size() > 1 ? study.name + " " + value : value;
      if (value == kFailureMap)
        answer.add(failure_map_of(study, store)).name = name;
      else
        answer.add(table_of(study, store, value, name));
    }
  return answer;
}

std::string ends_of(const Study& study, const Store& store) {
  const std::vector<Record> records = collect(study, store).records;
  const std::string unequal = unequal_work(records);
  return study.name + ": " + taut::ends_of(records) +
         (unequal.empty() ? "" : "; unequal work: " + unequal);
}

}  // namespace taut::report
