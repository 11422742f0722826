#include "experiments/render/media.hpp"

#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <iterator>

#include "experiments/render/figure.hpp"

namespace taut {

namespace {

/// Times of the frames: whole steps of the coarsest take.
std::vector<double> frame_times(const Scene& scene, const std::vector<Take>& takes,
                                const MediaOptions& options) {
  double step = scene.dt;
  for (const Take& take : takes) step = std::max(step, take.trajectory.header.frame_dt);
  const double stride = std::max(1.0, std::round(1 / (options.fps * step)));
  const double end = std::min(options.duration, scene.duration());
  std::vector<double> times;
  for (int k = 0; k * stride * step <= end + 1e-9; ++k) times.push_back(k * stride * step);
  if (times.size() == 1) times.push_back(stride * step);
  return times;
}

Image side_by_side(const Studio& studio, const MediaOptions& options, double t) {
  const int count = static_cast<int>(studio.takes().size());
  Image picture(options.width, options.height, studio.options().theme.top);
  for (int k = 0; k < count; ++k) {
    const auto index = static_cast<std::size_t>(k);
    Image panel = studio.panel(index, t);
    const auto& stop = studio.takes()[index].stop;
    if (stop && t > stop->t) mark_stop(panel, *stop, options.height / 836.0);
    picture.paste(panel, k * (options.width / count), 0);
  }
  return picture;
}

/// Where the takes differ most in strain; the last third of the video if they never do.
std::size_t most_telling(const Media& media) {
  std::size_t best = media.t.size() * 2 / 3;
  double largest = 0;
  for (std::size_t k = media.t.size() / 8; k < media.t.size(); ++k) {
    double low = 1e300, high = 0;
    for (const auto& series : media.rms_strain)
      low = std::min(low, series[k]), high = std::max(high, series[k]);
    if (high - low > largest) largest = high - low, best = k;
  }
  return best;
}

std::string read_and_remove(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::error_code error;
  std::filesystem::remove(path, error);
  return bytes;
}

std::string strip(const Studio& studio, const MediaOptions& options, const Media& media) {
  constexpr std::size_t kMoments = 5;
  Image picture(options.width, options.height * static_cast<int>(kMoments));
  for (std::size_t k = 0; k < kMoments; ++k)
    picture.paste(side_by_side(studio, options, media.t[k * (media.t.size() - 1) / (kMoments - 1)]),
                  0, static_cast<int>(k) * options.height);
  return png_bytes(picture);
}

std::vector<Media::Flat> material_space(const Studio& studio, const std::vector<double>& t) {
  constexpr int kSide = 168, kGap = 14;
  std::vector<Media::Flat> moments;
  for (const std::size_t k : {t.size() / 8, t.size() / 3, t.size() - 1}) {
    std::vector<Image> parts;
    for (std::size_t take = 0; take < studio.takes().size(); ++take)
      parts.push_back(studio.material_space(take, t[k], kSide));
    const int wide = parts[0].width(), high = parts[0].height();
    if (wide == 0) return {};
    const int count = static_cast<int>(parts.size());
    Image row(count * (wide + kGap) + kGap, high + 2 * kGap, studio.options().theme.top);
    for (int i = 0; i < count; ++i)
      row.paste(parts[static_cast<std::size_t>(i)], kGap + i * (wide + kGap), kGap);
    moments.push_back({t[k], png_bytes(row)});
  }
  return moments;
}

}  // namespace

Media render_media(const Scene& scene, const std::vector<Take>& takes, const MediaOptions& options,
                   const std::function<void(int, int)>& progress) {
  assert(!takes.empty() && takes.size() <= 4);
  Media media;
  media.width = options.width, media.height = options.height;
  media.t = frame_times(scene, takes, options);
  media.rate = frame_rate(media.t[1] - media.t[0]);
  for (const Take& take : takes) {
    media.stops.push_back(take.stop);
    auto& series = media.rms_strain.emplace_back();
    for (const double t : media.t)
      series.push_back(live_figures(scene, take.at(t).state, take.at(t).t).rms_strain);
  }
  StudioOptions look;
  look.width = options.width / static_cast<int>(takes.size());
  look.height = options.height;
  look.theme = StageTheme::dark();
  look.quality = options.quality;
  look.view = options.view;
  look.quantity = options.quantity;
  look.to = media.t.back();
  const Studio studio(scene, takes, look);
  media.scale = studio.scale();
  media.material = material_space(studio, media.t);
  const std::size_t poster = most_telling(media);
  media.poster_t = media.t[poster];
  const Image poster_image = side_by_side(studio, options, media.poster_t);
  media.poster = jpeg_bytes(poster_image);
  media.poster_type = "image/jpeg";
  if (media.poster.empty()) {
    media.poster = png_bytes(poster_image), media.poster_type = "image/png";
    media.strip_png = strip(studio, options, media);
    return media;
  }
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      ("taut_media_" + std::to_string(getpid()) + "_" + std::to_string(gettid()) + ".mp4");
  VideoWriter video(file, {options.width, options.height, media.rate, options.crf});
  for (std::size_t k = 0; k < media.t.size(); ++k) {
    if (!video.write(k == poster ? poster_image : side_by_side(studio, options, media.t[k]))) break;
    if (progress) progress(static_cast<int>(k) + 1, static_cast<int>(media.t.size()));
  }
  if (video.finish().empty()) media.mp4 = read_and_remove(file);
  if (media.mp4.empty()) media.strip_png = strip(studio, options, media);
  return media;
}

}  // namespace taut
