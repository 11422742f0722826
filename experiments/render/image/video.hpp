#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "experiments/render/image/image.hpp"
#include "experiments/system/process.hpp"

namespace taut {

/// Frames per second as a fraction, exact for time steps such as 1/64 s.
struct FrameRate {
  int numerator = 30, denominator = 1;
  double value() const { return static_cast<double>(numerator) / denominator; }
};
/// Nearest fraction to 1 / seconds with a numerator of at most six digits.
FrameRate frame_rate(double seconds);

/// Feeds frames to ffmpeg through a pipe: H.264, yuv420p, BT.709 tags and conversion, index at the
/// front, a key frame every 12 frames so that scrubbing is quick, the same bytes for the same
/// frames.
class VideoWriter {
 public:
  struct Options {
    int width = 0, height = 0;  ///< even
    FrameRate rate;
    int crf = 25;  ///< x264's constant rate factor: smaller is better and larger
  };
  VideoWriter(const std::filesystem::path& mp4, const Options&);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  /// False once ffmpeg is gone: stop drawing and call finish().
  bool write(const Image&);
  /// "" if the file is there; otherwise why not ("ffmpeg is not installed").
  std::string finish();

 private:
  std::filesystem::path path_, temporary_;
  Options options_;
  EndsWithProgram with_program_;  ///< of the temporary file
  std::string failure_;
  std::optional<Process> ffmpeg_;
};

/// The frame as JPEG by ffmpeg; "" without it.
std::string jpeg_bytes(const Image&);

}  // namespace taut
