#include "experiments/render/picture/media.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "experiments/render/picture/figure.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

/// Times of the frames: whole steps of the coarsest run.
std::vector<double> frame_times(const Scene& scene, const std::vector<RecordedRun>& runs,
                                const MediaOptions& options) {
  double step = scene.dt;
  for (const RecordedRun& run : runs) step = std::max(step, run.trajectory.frame_dt);
  const double stride = std::max(1.0, std::round(options.speed / (options.fps * step)));
  const double end = std::min(options.duration, scene.duration());
  std::vector<double> times;
  for (int k = 0; k * stride * step <= end + 1e-9; ++k) times.push_back(k * stride * step);
  if (times.size() == 1) times.push_back(stride * step);
  return times;
}

/// Where the cloth laid flat stands in a panel: its upper right corner [px].
struct FlatPlace {
  static constexpr int kRim = 3;
  int side, margin;
  explicit FlatPlace(int height) : side(height / 5), margin(height / 28) {}

  /// Some of the cloth lies below it.
  bool hides(const std::vector<Eigen::Vector2f>& cloth, int width, int height) const {
    const float x = 1 - 2.f * static_cast<float>(side + margin + kRim) / static_cast<float>(width);
    const float y = 1 - 2.f * static_cast<float>(side + margin + kRim) / static_cast<float>(height);
    return std::ranges::any_of(
        cloth, [&](const auto& p) { return p.x() > x && p.x() < 1 && p.y() > y && p.y() < 1; });
  }
};

void add_flat(Image& panel, const SceneRenderer& renderer, std::size_t run, double t) {
  const FlatPlace place(panel.height());
  const int pad = FlatPlace::kRim;
  const Image flat = renderer.material_space(run, t, place.side);
  if (flat.width() == 0) return;
  const int x = panel.width() - place.margin - flat.width(), y = place.margin;
  Canvas(panel).fill_rounded(x - pad, y - pad, flat.width() + 2 * pad, flat.height() + 2 * pad, pad,
                             rgb(0x4A5361));
  panel.paste(flat, x, y);
}

Image side_by_side(const SceneRenderer& renderer, const MediaOptions& options, double t) {
  const int count = static_cast<int>(renderer.runs().size()), width = options.width / count;
  Image picture(options.width, options.height, renderer.options().theme.top);
  std::vector<std::vector<Eigen::Vector2f>> cloth;
  for (std::size_t k = 0; k < renderer.runs().size(); ++k)
    cloth.push_back(renderer.projected(k, t));
  // In the first moments a sheet may reach into the corner: all panels do without the flat then.
  const FlatPlace place(options.height);
  const bool hides = std::ranges::any_of(
      cloth, [&](const auto& one) { return place.hides(one, width, options.height); });
  for (int k = 0; k < count; ++k) {
    const auto index = static_cast<std::size_t>(k);
    Image panel = renderer.panel(index, t);
    if (!hides) add_flat(panel, renderer, index, t);
    mark_absence(panel, renderer, index, t, options.height / 836.0);
    picture.paste(panel, k * width, 0);
  }
  return picture;
}

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

/// Where the runs differ most in strain, else in place; the greatest strain of a single one; two
/// thirds on the way if nothing differs.
std::size_t most_different(const Media& media, const Scene& scene,
                           const std::vector<RecordedRun>& runs) {
  constexpr double kStrain = 1e-3, kPlace = 1e-2;  // differences that are seen: 1, of the extent
  std::vector<double> strain, place;
  for (std::size_t k = 0; k < media.t.size(); ++k) {
    double low = runs.size() > 1 ? 1e300 : 0, high = 0, apart = 0;
    for (const auto& series : media.rms_strain)
      low = std::min(low, series[k]), high = std::max(high, series[k]);
    for (const RecordedRun& run : runs)
      apart = std::max(apart, distance(runs.front(), run, media.t[k]));
    strain.push_back(high - low), place.push_back(apart);
  }
  if (const auto k = peak(strain, kStrain)) return *k;
  return peak(place, kPlace * extent(scene)).value_or(media.t.size() * 2 / 3);
}

/// Four moments: the first motion, two on the way, the end.
void lay_flat(Media& media, const SceneRenderer& renderer) {
  constexpr int kSide = 56;
  const std::size_t last = media.t.size() - 1;
  for (std::size_t run = 0; run < renderer.runs().size(); ++run) {
    std::vector<Media::Flat> moments;
    for (const std::size_t k : {last / 8, last / 3, last * 2 / 3, last}) {
      const Image flat = renderer.material_space(run, media.t[k], kSide);
      if (flat.width() == 0) return;
      media.aspect = static_cast<double>(flat.width()) / flat.height();
      moments.push_back({media.t[k], media.rms_strain[run][k], png_bytes(flat)});
    }
    media.material.push_back(std::move(moments));
  }
}

}  // namespace

Media render_media(const Scene& scene, const std::vector<RecordedRun>& runs,
                   const MediaOptions& options) {
  assert(!runs.empty() && runs.size() <= 4);
  Media media;
  media.t = frame_times(scene, runs, options);
  for (const RecordedRun& run : runs) {
    auto& series = media.rms_strain.emplace_back();
    for (const double t : media.t)
      series.push_back(live_figures(scene, run.at(t).state, run.at(t).t).rms_strain);
  }
  SceneRendererOptions look;
  look.width = options.width / static_cast<int>(runs.size());
  look.height = options.height;
  look.theme = Theme::dark();
  look.quality = options.quality;
  look.frame = {-0.94, 0.84, -0.64, 0.74};
  look.to = media.t.back();
  const SceneRenderer renderer(scene, runs, look);
  media.scale = renderer.scale();
  lay_flat(media, renderer);
  const std::size_t poster = most_different(media, scene, runs);
  media.poster_t = media.t[poster];
  const Image poster_image = side_by_side(renderer, options, media.poster_t);
  media.poster = jpeg_bytes(poster_image);
  media.poster_type = "image/jpeg";
  if (media.poster.empty()) {
    media.poster = png_bytes(poster_image), media.poster_type = "image/png";
    return media;
  }
  const Scratch scratch;
  const std::filesystem::path file = scratch.path() / "film.mp4";
  VideoWriter video(file, {options.width, options.height,
                           frame_rate((media.t[1] - media.t[0]) / options.speed), options.crf});
  for (std::size_t k = 0; k < media.t.size(); ++k)
    if (!video.write(k == poster ? poster_image : side_by_side(renderer, options, media.t[k])))
      break;
  if (video.finish().empty()) media.mp4 = read_text(file);
  return media;
}

}  // namespace taut
