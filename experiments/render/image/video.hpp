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

/// Pipes frames to ffmpeg, which writes H.264 in yuv420p, converted to and tagged as BT.709. The
/// index is at the front, and every twelfth frame is a key frame so that scrubbing is quick. The
/// same frames give the same bytes.
class VideoWriter {
 public:
  struct Options {
    int width = 0, height = 0;  ///< even
    FrameRate rate;
    int crf = 25;  ///< x264's constant rate factor: smaller is better, but gives a larger file
  };
  VideoWriter(const std::filesystem::path& mp4, const Options&);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  /// False once ffmpeg has exited: the caller should stop drawing and call finish().
  bool write(const Image&);
  /// "" on success, otherwise the reason why there is no file ("ffmpeg is not installed").
  std::string finish();

 private:
  std::filesystem::path path_, temporary_;
  Options options_;
  EndsWithProgram with_program_;  ///< removes the temporary file when a signal ends the program
  std::string failure_;
  std::optional<Process> ffmpeg_;
};

/// The frame as JPEG, encoded by ffmpeg; "" without ffmpeg.
std::string jpeg_bytes(const Image&);

}  // namespace taut
