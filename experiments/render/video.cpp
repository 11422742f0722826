#include "experiments/render/video.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cassert>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <numeric>

namespace taut {

namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string raw_input(int width, int height) {
  return "exec ffmpeg -nostdin -v error -y -f rawvideo -pix_fmt rgb24 -s " + std::to_string(width) +
         "x" + std::to_string(height);
}

bool put(FILE* pipe, const Image& image) {
  const auto& pixels = image.pixels();
  return std::fwrite(pixels.data(), sizeof(Rgb8), pixels.size(), pipe) == pixels.size();
}

/// Says what the exit status of a shell command means.
std::string reason(int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) return "ffmpeg is not installed";
  return "ffmpeg failed";
}

}  // namespace

FrameRate frame_rate(double seconds) {
  FrameRate best;
  double least = 1e300;
  for (int denominator = 1; denominator <= 1001; ++denominator) {
    const double numerator = std::round(denominator / seconds);
    if (numerator < 1 || numerator > 999999) continue;
    const double error = std::abs(numerator / denominator - 1 / seconds);
    if (error < least * (1 - 1e-6) - 1e-12)
      least = error, best = {static_cast<int>(numerator), denominator};
  }
  return best;
}

VideoWriter::VideoWriter(const std::filesystem::path& mp4, const Options& options)
    : path_(mp4), temporary_(mp4.string() + ".tmp.mp4"), options_(options) {
  assert(options.width % 2 == 0 && options.height % 2 == 0);
  old_handler_ = std::signal(SIGPIPE, SIG_IGN);  // a missing ffmpeg is a failed write, not death
  const std::string command =
      raw_input(options.width, options.height) + " -framerate " +
      std::to_string(options.rate.numerator) + "/" + std::to_string(options.rate.denominator) +
      " -i - -vf scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,"
      "format=yuv420p -c:v libx264 -preset medium -tune animation -threads 1 -g 12 -bf 2 -crf " +
      std::to_string(options.crf) +
      " -colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv"
      " -movflags +faststart -map_metadata -1 -fflags +bitexact -flags:v +bitexact " +
      quoted(temporary_.string()) + " 2>/dev/null";
  pipe_ = popen(command.c_str(), "w");
}

VideoWriter::~VideoWriter() {
  if (pipe_) finish();
}

bool VideoWriter::write(const Image& image) {
  assert(image.width() == options_.width && image.height() == options_.height);
  return pipe_ && put(pipe_, image);
}

std::string VideoWriter::finish() {
  std::string why = pipe_ ? reason(pclose(pipe_)) : "no process for ffmpeg";
  pipe_ = nullptr;
  std::signal(SIGPIPE, old_handler_);
  std::error_code error;
  if (why.empty()) std::filesystem::rename(temporary_, path_, error);
  if (error) why = "cannot write " + path_.string() + ": " + error.message();
  if (!why.empty()) std::filesystem::remove(temporary_, error);
  return why;
}

std::string jpeg_bytes(const Image& image) {
  char name[] = "/tmp/taut_jpeg_XXXXXX";
  const int file = mkstemp(name);
  if (file < 0) return "";
  const auto old_handler = std::signal(SIGPIPE, SIG_IGN);
  const std::string command =
      raw_input(image.width(), image.height()) +
      " -i - -frames:v 1 -q:v 3 -fflags +bitexact -flags:v +bitexact -f mjpeg " + name +
      " 2>/dev/null";
  FILE* pipe = popen(command.c_str(), "w");
  const bool written = pipe && put(pipe, image);
  const bool good = pipe && pclose(pipe) == 0 && written;
  std::signal(SIGPIPE, old_handler);
  std::ifstream in(name, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  close(file);
  std::filesystem::remove(name);
  return good ? bytes : "";
}

bool have_ffmpeg() {
  return std::system("command -v ffmpeg >/dev/null 2>&1") == 0;  // NOLINT: a constant command
}

}  // namespace taut
