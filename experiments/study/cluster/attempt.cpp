#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::cluster {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStates[] = {"claiming", "running", "ended"};

constexpr std::tuple kBeatFields{
    Field{"done", &Beat::done},       Field{"cases", &Beat::cases},
    Field{"work", &Beat::work},       Field{"work_done", &Beat::work_done},
    Field{"seconds", &Beat::seconds}, Field{"why", &Beat::why},
    Field{"host", &Beat::host},       Field{"started", &Beat::started}};

Beat beat_of(const JsonReader& j) {
  Beat beat = read_as(j, kBeatFields);
  const std::string state = j.at("state").text();
  const auto known = std::ranges::find(kStates, state);
  if (known == std::end(kStates)) j.at("state").fail("unknown state '" + state + "'");
  beat.state = static_cast<Beat::State>(known - std::begin(kStates));
  return beat;
}

std::string line_of(const Beat& beat) {
  Json json{{"state", kStates[static_cast<int>(beat.state)]}};
  json.update(json_of(beat, kBeatFields));
  return to_text(json) + "\n";
}

/// What a start has said so far; a line that is being written is not counted.
Beats read(const fs::path& file) {
  Beats beats{file, 0, {}};
  std::istringstream lines(read_text(file));
  std::string last;
  for (std::string line; std::getline(lines, line) && !lines.eof(); ++beats.count) last = line;
  if (!last.empty())
    beats.last = read_json(last, file.string(), beat_of, static_cast<int>(beats.count));
  return beats;
}

}  // namespace

std::chrono::duration<double> patience() {
  const char* given = std::getenv("TAUT_CLUSTER_PATIENCE");
  const double seconds = given ? std::atof(given) : 0;
  return std::chrono::duration<double>(seconds > 0 ? seconds : 8);
}

std::vector<Beats> not_ended(const fs::path& shard) {
  std::vector<Beats> all;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(shard / "beats", none))
    if (Beats beats = read(file); beats.last.state != Beat::State::ended)
      all.push_back(std::move(beats));
  std::ranges::sort(all, {}, &Beats::file);
  return all;
}

std::vector<Beats> living(const std::vector<Beats>& before) {
  std::vector<Beats> alive;
  const auto deadline = SteadyClock::now() + patience();
  std::vector<Beats> silent = before;
  while (!silent.empty() && SteadyClock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    std::erase_if(silent, [&](const Beats& known) {
      Beats now = read(known.file);
      if (now.count == known.count) return false;
      if (now.last.state != Beat::State::ended) alive.push_back(std::move(now));
      return true;
    });
  }
  return alive;
}

Attempt::Attempt(const fs::path& shard) : Attempt(shard, utc_stamp() + "-" + unique_suffix()) {}

Attempt::Attempt(const fs::path& shard, const std::string& name)
    : file_(shard / "beats" / name), start_(SteadyClock::now()) {
  make_folder(shard / "beats");
  now_.host = host_name(), now_.started = utc_stamp();
  beat();
  std::vector<Beats> others = not_ended(shard);
  std::erase_if(others, [&](const Beats& b) { return b.file == file_; });
  // Of two that start together the one with the lesser name goes on.
  const auto before_me = [&](const Beats& b) {
    return b.last.state == Beat::State::running || b.file < file_;
  };
  for (const auto until = SteadyClock::now() + patience();
       !others.empty() && SteadyClock::now() < until;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    if (SteadyClock::now() - last_ >= kBeat) beat();
    for (const Beats& other : others)
      if (const Beats now = read(other.file);
          now.count > other.count && now.last.state != Beat::State::ended && before_me(now)) {
        end("another start was at this shard");
        throw InputError(shard.string() + ": is being run on " + printable(other.last.host) +
                         " since " + printable(other.last.started) +
                         " (its clock); nothing was run here");
      }
  }
  for (const Beats& silent : others)  // nobody waits for it again, unless it speaks again
    append(silent.file, line_of({Beat::State::ended, silent.last.done, silent.last.cases, 0, 0, 0,
                                 "lost", silent.last.host, silent.last.started}));
  now_.state = Beat::State::running;
  beat();
}

Attempt::~Attempt() {
  try {
    if (now_.state != Beat::State::ended) end("an error");
  } catch (const InputError&) {  // a disk that is full: the silence says it
  }
}

void Attempt::progress(const CampaignProgress& campaign) {
  now_.done = campaign.done(), now_.cases = campaign.cases;
  now_.work = campaign.work, now_.work_done = campaign.work_done;
  if (SteadyClock::now() - last_ >= kBeat) beat();
}

void Attempt::end(const std::string& why) {
  now_.state = Beat::State::ended, now_.why = why;
  beat();
}

void Attempt::beat() {
  last_ = SteadyClock::now();
  now_.seconds = seconds_between(start_, last_);
  append(file_, line_of(now_));
}

}  // namespace taut::cluster
