#include "experiments/verbs/film.hpp"

#include <atomic>
#include <cmath>
#include <csignal>
#include <mutex>
#include <optional>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/render/media.hpp"
#include "experiments/report/comparison.hpp"
#include "experiments/verbs/takes.hpp"

namespace taut {

namespace {

constexpr int kScenesAtATime = 2;

/// The case of this contender that pictures show: the quoted sweeps, dt nearest to 1/64 s.
const Record* shown_case(const report::Contender& contender, const std::string& scene, int sweeps) {
  const Record* best = nullptr;
  const auto distance = [](const Record& r) { return std::abs(std::log(r.dt * 64)); };
  for (const Record& r : contender.records) {
    if (r.scene != scene || r.status.kind == Status::Kind::unsupported) continue;
    if (!report::quoted_at(r, sweeps)) continue;
    if (!best || distance(r) < distance(*best)) best = &r;
  }
  return best;
}

/// One scene, all contenders; empty solvers: nothing to be shown.
TakeRequest request_of(const report::Comparison& facts, const std::string& scene) {
  TakeRequest request;
  for (const report::Contender& contender : facts.contenders) {
    const Record* one = shown_case(contender, scene, facts.sweeps);
    if (!one || request.solvers.size() == 4) continue;
    request.scene = one->spec.scene, request.overrides = one->spec.overrides;
    request.solvers.push_back(one->spec.solver);
  }
  return request;
}

report::ColourBar bar_of(const ColourScale& scale) {
  constexpr int kStops = 17;
  report::ColourBar bar{scale.title(), {}, {}};
  for (int k = 0; k < kStops; ++k) {
    const Rgb8 c = scale.map().at(static_cast<double>(k) / (kStops - 1));
    char text[8];
    std::snprintf(text, sizeof text, "#%02X%02X%02X", c.r, c.g, c.b);
    bar.stops.emplace_back(text);
  }
  for (const double value : scale.ticks())
    bar.ticks.emplace_back(scale.position(value), scale.text(value));
  return bar;
}

report::Clip clip_of(const TakeSet& set, const Media& media) {
  report::Clip clip;
  std::string who;
  for (std::size_t k = 0; k < set.takes.size(); ++k) {
    const std::string solver = set.takes[k].trajectory.header.solver;
    clip.panels.emplace_back(solver.substr(0, solver.find(':')), set.takes[k].settings);
    who += (k > 0 ? " and " : "") + set.takes[k].title + " (" + set.takes[k].settings + ")";
  }
  clip.alt = set.scene.name + ": " + who + " side by side from the left, coloured by " +
             media.scale.title() + ", full red at " + media.scale.text(media.scale.high) +
             "; cloth inside a collider is hatched, a run that ended early is framed in red";
  clip.type = media.mp4.empty() ? "image/png" : "video/mp4";
  clip.bytes = media.mp4.empty() ? media.strip_png : media.mp4;
  clip.poster = media.poster, clip.poster_type = media.poster_type;
  return clip;
}

report::SceneMedia media_of(const TakeRequest& request) {
  const TakeSet set = make_takes(request, [](const std::string&) {});
  MediaOptions options;
  options.duration = 3;
  options.width = set.takes.size() == 1 ? 480 : 960;
  const Media media = render_media(set.scene, set.takes, options);
  report::SceneMedia out{.scene = set.scene.name,
                         .clips = {clip_of(set, media)},
                         .duration = media.t.back(),
                         .bar = bar_of(media.scale),
                         .aspect = media.aspect};
  for (std::size_t k = 0; k < media.material.size(); ++k) {
    report::MaterialRow& row = out.material.emplace_back();
    row.solver = out.clips.front().panels[k].first;
    for (const Media::Flat& flat : media.material[k])
      row.moments.push_back({flat.t, flat.rms, flat.png});
  }
  return out;
}

}  // namespace

std::vector<report::SceneMedia> film_scenes(const report::ReportInput& input,
                                            const std::function<void(const std::string&)>& say) {
  std::signal(SIGPIPE, SIG_IGN);
  const report::Comparison facts = report::compare(input);
  std::vector<std::optional<report::SceneMedia>> drawn(input.scenes.size());
  std::atomic<std::size_t> next{0};
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t k = next++; k < drawn.size(); k = next++) {
      const std::string& scene = input.scenes[k].name;
      const TakeRequest request = request_of(facts, scene);
      if (request.solvers.empty()) continue;
      std::string news = scene + " filmed";
      try {
        drawn[k] = media_of(request);
      } catch (const InputError& error) {
        news = scene + " not filmed: " + error.what();
      }
      const std::lock_guard lock(telling);
      say(news);
    }
  };
  std::vector<std::thread> threads;
  for (int j = 1; j < kScenesAtATime; ++j) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  std::vector<report::SceneMedia> media;
  for (auto& one : drawn)
    if (one) media.push_back(std::move(*one));
  return media;
}

}  // namespace taut
