#include "experiments/render/picture/media.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "experiments/render/picture/figure.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

/// The index of the largest value from an eighth of the video on, if it exceeds `least`.
std::optional<std::size_t> peak(const std::vector<double>& values, double least) {
  const auto from = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 8);
  const auto at = std::max_element(from, values.end());
  if (at == values.end() || *at <= least) return {};
  return static_cast<std::size_t>(at - values.begin());
}

/// RMS distance [m] of a run's vertices from those of the first run.
double distance(const RecordedRun& first, const RecordedRun& other, double t) {
  const auto &a = first.at(t).state.x, &b = other.at(t).state.x;
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(a.size()));
}

/// The moment at which the runs differ most in strain, or else in place; for a single run, that of
/// its largest strain. Two thirds of the way through if nothing differs.
std::size_t most_different(const Media& media, const Scene& scene,
                           const std::vector<RecordedRun>& runs) {
  constexpr double kStrain = 1e-3, kPlace = 1e-2;  // differences that are seen: 1, of the extent
  std::vector<double> strain, place;
  for (std::size_t k = 0; k < media.t.size(); ++k) {
    double low = runs.size() > 1 ? 1e300 : 0, high = 0, apart = 0;
    for (const auto& series : media.rms_strain) {
      low = std::min(low, series[k]);
      high = std::max(high, series[k]);
    }
    for (const RecordedRun& run : runs)
      apart = std::max(apart, distance(runs.front(), run, media.t[k]));
    strain.push_back(high - low);
    place.push_back(apart);
  }
  if (const auto k = peak(strain, kStrain)) return *k;
  return peak(place, kPlace * extent(scene)).value_or(media.t.size() * 2 / 3);
}

}  // namespace

std::vector<double> frame_times(const Scene& scene, const std::vector<RecordedRun>& runs,
                                double wanted, double duration) {
  double step = scene.dt;
  for (const RecordedRun& run : runs) step = std::max(step, run.trajectory.frame_dt);
  const double stride = std::max(1.0, std::round(wanted / step));
  const double end = std::min(duration, scene.duration());
  std::vector<double> times;
  for (int k = 0; k * stride * step <= end + 1e-9; ++k) times.push_back(k * stride * step);
  if (times.size() == 1) times.push_back(stride * step);
  return times;
}

std::string write_video(const std::filesystem::path& mp4, const SceneRenderer& renderer,
                        const PageLayout& layout, const std::vector<double>& times, double speed,
                        int crf, const std::function<void(std::size_t, std::size_t)>& progress) {
  VideoWriter video(mp4,
                    {layout.width, layout.height, frame_rate((times[1] - times[0]) / speed), crf});
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!video.write(compose(renderer, layout, {times[k]}))) break;
    progress(k + 1, times.size());
  }
  return video.finish();
}

Media render_media(const Scene& scene, const std::vector<RecordedRun>& runs,
                   const MediaOptions& options) {
  assert(!runs.empty() && runs.size() <= std::size_t{kMostPanels});
  Media media;
  media.t = frame_times(scene, runs, options.speed / options.fps, options.duration);
  for (const RecordedRun& run : runs) {
    auto& series = media.rms_strain.emplace_back();
    for (const double t : media.t)
      series.push_back(live_figures(scene, run.at(t).state, run.at(t).t).rms_strain);
  }
  const PageLayout layout =
      PageLayout::bare(options.width, options.height, static_cast<int>(runs.size()));
  SceneRendererOptions look;
  look.width = layout.panel_width;
  look.height = layout.panel_height;
  look.theme = Theme::dark();
  look.quality = options.quality;
  look.frame = {-0.94, 0.84, -0.64, 0.74};
  look.to = media.t.back();
  const SceneRenderer renderer(scene, runs, look);
  media.scale = renderer.scale();
  media.poster_t = media.t[most_different(media, scene, runs)];
  const Image poster_image = compose(renderer, layout, {media.poster_t});
  media.poster = jpeg_bytes(poster_image);
  media.poster_type = "image/jpeg";
  if (media.poster.empty()) {
    media.poster = png_bytes(poster_image);
    media.poster_type = "image/png";
    return media;
  }
  if (options.still) return media;
  const Scratch scratch;
  const std::filesystem::path file = scratch.path() / "film.mp4";
  const auto silent = [](std::size_t, std::size_t) {};
  if (write_video(file, renderer, layout, media.t, options.speed, options.crf, silent).empty())
    media.mp4 = read_text(file);
  return media;
}

}  // namespace taut
