#include "experiments/case/trajectory.hpp"

#include <cmath>

#include "core/io/positions/formats.hpp"
#include "core/model/input_error.hpp"

namespace taut {

using std::endian;

std::string frame_bytes(const Frame& frame) {
  std::string bytes;
  append_number(bytes, frame.t, endian::little);
  append_vectors<float>(bytes, frame.state.x, endian::little);
  return bytes;
}

std::vector<Frame> frames_in(std::string_view bytes, int vertices) {
  const auto n = static_cast<std::size_t>(vertices);
  const std::size_t size = sizeof(double) + 3 * sizeof(float) * n;
  std::vector<Frame> frames(bytes.size() / size);
  if (frames.empty()) throw InputError("a motion without a whole frame");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const char* from = bytes.data() + k * size;
    frames[k].t = number_at<double>(from, endian::little);
    frames[k].state.x.resize(n);
    read_vectors<float>(from + sizeof(double), frames[k].state.x, endian::little);
    if (!std::isfinite(frames[k].t) || (k > 0 && frames[k].t < frames[k - 1].t))
      throw InputError("frame " + std::to_string(k) +
                       " has no time, or an earlier one than the frame before it");
  }
  return frames;
}

}  // namespace taut
