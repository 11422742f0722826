#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/mesh.hpp"

/// Positions of one cloth over time, as other programs write and read them:
///
///     .npy   NumPy array [T, n, 3] of float32 or float64, in C order
///     .pc2   Point Cache 2: a header of 32 bytes, then float32, little-endian
///     .obj   Wavefront, a file for each frame: its `v` lines
///
/// The frames of a sequence have names that end in digits, equally far apart; any of them names it,
/// as does the name without the digits: cloth_0001.obj, cloth.obj.
namespace taut {

/// To what the coordinates of a file are rounded.
enum class Rounding { binary32, binary64, decimal };

/// What a file of positions says about itself.
struct PositionsHeader {
  int vertices = 0, frames = 0;  ///< >= 1 each
  Rounding rounding = Rounding::binary64;
  double spacing = 1;                        ///< between two frames, in frames of the animation
  std::vector<std::filesystem::path> files;  ///< in the order of the frames, or one for all
};

/// Reads frames in any order, each when it is asked for.
class PositionReader {
 public:
  virtual ~PositionReader() = default;
  const PositionsHeader& header() const { return header_; }
  /// [n] in the file's unit and axes; a coordinate that is not finite is data. Precondition:
  /// 0 <= k < frames. Throws InputError with file and line or byte: malformed, another number of
  /// vertices than the first frame.
  virtual std::vector<Vec3> read(int k) = 0;

 protected:
  PositionsHeader header_;
};

/// Throws InputError with file and line or byte: unreadable, another extension, a malformed header,
/// counts that do not agree with the size of the file, a missing frame of a sequence.
std::unique_ptr<PositionReader> open_positions(const std::filesystem::path&);

/// Frames in memory, [frames][vertices][3] in C order, which must outlive the reader. Throws
/// InputError that names `name`: no whole frame, or more numbers than whole frames have.
std::unique_ptr<PositionReader> positions_in(std::span<const float>, std::size_t vertices,
                                             const std::string& name);
std::unique_ptr<PositionReader> positions_in(std::span<const double>, std::size_t vertices,
                                             const std::string& name);

/// Appends frames to a new file or sequence; what was written is good if the program is killed.
/// float32 where the format has nothing else; coordinates of .npy and .obj come back bit for bit.
class PositionWriter {
 public:
  virtual ~PositionWriter() = default;
  /// `x` is [n] m, the same n each time. Throws InputError if it cannot be written.
  virtual void append(double t, const std::vector<Vec3>& x) = 0;
};

/// Throws InputError: no format has this extension.
void check_positions_name(const std::filesystem::path&);

/// Replaces what is there; frames of a sequence are NAME_00000.obj and on, with the triangles; .obj
/// has material coordinates too, and a line for a chain.
/// Throws InputError: another extension, or it cannot be written.
std::unique_ptr<PositionWriter> create_positions(const std::filesystem::path&, const Mesh&);

}  // namespace taut
