#include "experiments/study/campaign.hpp"

#include <poll.h>

#include <algorithm>
#include <deque>
#include <iostream>
#include <list>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

double estimated_work(const Case& one) {
  const double sweeps = 1.0 * one.choice.substeps() * one.choice.sweeps();
  return one.scene->steps *
         (20.0 * one.scene->mesh.size() + static_cast<double>(one.scene->links.size()) * sweeps);
}

namespace {

class Campaign {
 public:
  Campaign(Store& store, const CampaignOptions& options) : store_(store), options_(options) {}

  CampaignProgress run(const std::vector<Case>& cases) {
    sort_out(cases);
    const GracefulStop signals;
    while (!waiting_.empty() || !running_.empty()) {
      if (GracefulStop::requested() || SteadyClock::now() >= options_.deadline) break;
      while (!waiting_.empty() && running_.size() < static_cast<std::size_t>(options_.jobs)) {
        const Case& next = *waiting_.front();
        waiting_.pop_front();
        running_.emplace_back(next, store_.stage(next.key), options_.limits,
                              options_.frames ? kFrames : 0);
      }
      wait();
      reap();
      report(nullptr);
    }
    progress_.interrupted = GracefulStop::requested();
    while (!running_.empty()) {
      const std::filesystem::path folder = running_.front().folder();
      running_.pop_front();
      std::filesystem::remove_all(folder);
    }
    return progress_;
  }

 private:
  void sort_out(const std::vector<Case>& cases) {
    for (const Case& one : cases) {
      if (!options_.shard.has(one.key)) continue;
      const std::optional<Record> stored = store_.find(one);
      const bool failed = stored && !stored->status.is_result();
      if (options_.only_failed && !failed) continue;
      ++progress_.cases;
      const bool whole = stored && (!options_.frames || failed || store_.has_frames(one.key));
      if (whole && !(options_.only_failed && failed)) {
        ++progress_.reused;
        ++progress_.by_status[stored->status.kind];
      } else {
        progress_.work += estimated_work(one);
        waiting_.push_back(&one);
      }
    }
    std::ranges::sort(waiting_, {}, [](const Case* one) {
      return std::pair(-estimated_work(*one), std::string_view(one->key));
    });
    report(nullptr);
  }

  /// Waits until a case has ended, the deadline or half a second has passed.
  void wait() {
    std::vector<pollfd> ends;
    for (const IsolatedCase& one : running_) ends.push_back({one.descriptor(), POLLIN, 0});
    const double left = seconds_until(options_.deadline);
    ::poll(ends.data(), ends.size(), static_cast<int>(1e3 * std::clamp(left, 0.001, 0.5)));
  }

  void reap() {
    for (auto one = running_.begin(); one != running_.end();) {
      std::optional<Record> record;
      try {
        record = one->poll();
      } catch (const EndedFromOutside& error) {
        std::cerr << error.what() << '\n';
        std::filesystem::remove_all(one->folder());
        ++progress_.ended_from_outside;
        one = running_.erase(one);
        continue;
      }
      if (!record) {
        ++one;
        continue;
      }
      const Store::Commit commit = store_.commit(one->folder(), *record, one->spent());
      ++progress_.ran;
      ++progress_.by_status[record->status.kind];
      if (commit == Store::Commit::conflict) ++progress_.conflicts;
      progress_.work_done += estimated_work(one->of());
      one = running_.erase(one);
      report(&*record);
    }
  }

  void report(const Record* record) const {
    if (options_.progress) options_.progress(progress_, record);
  }

  Store& store_;
  const CampaignOptions& options_;
  std::deque<const Case*> waiting_;
  std::list<IsolatedCase> running_;
  CampaignProgress progress_;
};

}  // namespace

Record run_again(const Case& one, Store& store, const Limits& limits) {
  const std::filesystem::path folder = store.stage(one.key);
  IsolatedCase running(one, folder, limits);
  const Record record = running.wait();
  std::filesystem::remove_all(folder);
  return record;
}

CampaignProgress run_cases(const std::vector<Case>& cases, Store& store,
                           const CampaignOptions& options) {
  return Campaign(store, options).run(cases);
}

CasesRun run_and_read(std::vector<Case> cases, Store& store, const CampaignOptions& options) {
  CasesRun run{std::move(cases), {}, {}};
  run.campaign = run_cases(run.cases, store, options);
  if (run.campaign.conflicts > 0)
    throw InputError("another result than the one stored; see table conflicts of " +
                     store.file().string());
  for (const Case& one : run.cases) {
    std::optional<Record> record = store.find(one);
    if (record && options.frames && completed(record->status) && !store.has_frames(one.key))
      record.reset();
    run.records.push_back(std::move(record));
  }
  return run;
}

std::optional<Record> run_stored(const Case& one, Store& store, const Limits& limits,
                                 SteadyClock::time_point deadline) {
  CasesRun run = run_and_read({one}, store, {.limits = limits, .deadline = deadline});
  if (run.campaign.interrupted) throw Interrupted();
  return std::move(run.records.front());
}

StudyRecords collect(const Study& study, const Store& store) {
  StudyRecords result{study, cases_of(study), {}};
  for (const Case& one : result.cases)
    if (std::optional<Record> record = store.find(one)) result.records.push_back(*record);
  return result;
}

}  // namespace taut
