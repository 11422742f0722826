#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/mesh.hpp"

/// Positions of one cloth over time, as exchanged with other programs:
///
///     .npy   NumPy array [T, n, 3] of float32 or float64, in C order
///     .pc2   Point Cache 2: a header of 32 bytes, then float32, little-endian
///     .obj   Wavefront, a file for each frame: its `v` lines
///
/// The files of a sequence have names that end in digits, at equal intervals. Any of them names the
/// sequence, and so does the name without digits: cloth_0001.obj, cloth.obj.
namespace taut {

/// Precision to which the coordinates of a file are rounded.
enum class Rounding { binary32, binary64, decimal };

/// Description that a file of positions gives of itself.
struct PositionsHeader {
  int vertices = 0, frames = 0;  ///< >= 1 each
  Rounding rounding = Rounding::binary64;
  double spacing = 1;                        ///< between two files, in frames of the animation
  std::vector<std::filesystem::path> files;  ///< in the order of the frames, or a single one
};

/// Reads frames in any order, each on request.
class PositionReader {
 public:
  virtual ~PositionReader() = default;
  const PositionsHeader& header() const { return header_; }
  /// Frame k, [n] in the file's unit and axes; non-finite coordinates are returned as they are.
  /// Precondition: 0 <= k < frames. Throws InputError, with file and line or byte, if the frame is
  /// malformed or does not have the number of vertices of the first one.
  virtual std::vector<Vec3> read(int k) = 0;

 protected:
  PositionsHeader header_;
};

/// Opens a file or sequence. Throws InputError, with file and line or byte, if it is unreadable,
/// has another extension or a malformed header, if its counts do not agree with its size, or if a
/// frame of a sequence is missing.
std::unique_ptr<PositionReader> open_positions(const std::filesystem::path&);

/// Reads frames in memory, [frames][vertices][3] in C order, which must outlive the reader. Throws
/// InputError that names `name` unless there is at least one frame and all frames are whole.
std::unique_ptr<PositionReader> positions_in(std::span<const float>, std::size_t vertices,
                                             const std::string& name);
std::unique_ptr<PositionReader> positions_in(std::span<const double>, std::size_t vertices,
                                             const std::string& name);

/// Appends frames to a new file or sequence. Frames that were written stay valid if the program is
/// killed. A .pc2 file rounds to float32; .npy and .obj keep every bit.
class PositionWriter {
 public:
  virtual ~PositionWriter() = default;
  /// Appends a frame `x`, [n] m, with the same n each time. Throws InputError if it cannot be
  /// written.
  virtual void append(double t, const std::vector<Vec3>& x) = 0;
};

/// Throws InputError if no format has this extension.
void check_positions_name(const std::filesystem::path&);

/// Creates a file or sequence, replacing what is there. Frames of a sequence are NAME_00000.obj,
/// NAME_00001.obj, ..., each with triangles and material coordinates; a chain is written as one
/// line. Throws InputError for another extension, or if it cannot be written.
std::unique_ptr<PositionWriter> create_positions(const std::filesystem::path&, const Mesh&);
/// Creates an array of NumPy in float32, half as large.
std::unique_ptr<PositionWriter> create_rounded_npy(const std::filesystem::path&);

}  // namespace taut
