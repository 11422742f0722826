#include "experiments/render/image/video.hpp"

#include <cassert>
#include <cmath>
#include <iterator>
#include <sstream>

#include "core/model/input_error.hpp"

namespace taut {

namespace {

/// The words of a command. No word may contain a blank.
std::vector<std::string> split(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

std::string raw_input(int width, int height) {
  return "ffmpeg -nostdin -v error -y -f rawvideo -pix_fmt rgb24 -s " + std::to_string(width) +
         "x" + std::to_string(height);
}

bool put(Process& process, const Image& image) {
  const auto& pixels = image.pixels();
  return process.write(
      {reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof(Rgb8)});
}

}  // namespace

FrameRate frame_rate(double seconds) {
  FrameRate best;
  double least = 1e300;
  for (int denominator = 1; denominator <= 1001; ++denominator) {
    const double numerator = std::round(denominator / seconds);
    if (numerator < 1 || numerator > 999999) continue;
    const double error = std::abs(numerator / denominator - 1 / seconds);
    if (error < least * (1 - 1e-6) - 1e-12) {
      least = error;
      best = {static_cast<int>(numerator), denominator};
    }
  }
  return best;
}

VideoWriter::VideoWriter(const std::filesystem::path& mp4, const Options& options)
    : path_(mp4),
      temporary_(mp4.string() + ".tmp.mp4"),
      options_(options),
      with_program_(temporary_) {
  assert(options.width % 2 == 0 && options.height % 2 == 0);
  const std::string rate =
      std::to_string(options.rate.numerator) + "/" + std::to_string(options.rate.denominator);
  try {
    std::vector<std::string> words = split(
        raw_input(options.width, options.height) + " -framerate " + rate +
        " -i - -vf scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,"
        "format=yuv420p -c:v libx264 -preset veryfast -tune animation -threads 1 -g 12 -bf 2 "
        "-crf " +
        std::to_string(options.crf) +
        " -colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv"
        " -movflags +faststart -map_metadata -1 -fflags +bitexact -flags:v +bitexact");
    words.push_back("file:" + temporary_.string());
    ffmpeg_.emplace(std::move(words), ProcessOptions{.input = ProcessOptions::Stream::piped});
  } catch (const InputError& error) {
    failure_ = on_path("ffmpeg") ? error.what() : "ffmpeg is not installed";
  }
}

VideoWriter::~VideoWriter() {
  if (ffmpeg_) finish();
}

bool VideoWriter::write(const Image& image) {
  assert(image.width() == options_.width && image.height() == options_.height);
  return ffmpeg_ && put(*ffmpeg_, image);
}

std::string VideoWriter::finish() {
  if (ffmpeg_) {
    ffmpeg_->close_input();
    if (!ffmpeg_->wait()->good()) failure_ = "ffmpeg failed";
    ffmpeg_.reset();
  }
  std::error_code error;
  if (failure_.empty()) std::filesystem::rename(temporary_, path_, error);
  if (error) failure_ = "cannot write " + path_.string() + ": " + error.message();
  if (!failure_.empty()) std::filesystem::remove(temporary_, error);
  return failure_;
}

std::string jpeg_bytes(const Image& image) try {
  using Stream = ProcessOptions::Stream;
  Process ffmpeg(split(raw_input(image.width(), image.height()) +
                       " -i - -frames:v 1 -q:v 3 -fflags +bitexact -flags:v +bitexact -f mjpeg -"),
                 {.input = Stream::piped, .output = Stream::piped});
  const bool written = put(ffmpeg, image);
  ffmpeg.close_input();
  std::string bytes = ffmpeg.read_all();
  return written && ffmpeg.wait()->good() ? bytes : "";
} catch (const InputError&) {
  return "";
}

}  // namespace taut
