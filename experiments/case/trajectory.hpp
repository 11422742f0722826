#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

/// A cloth's motion as a file. Little-endian, no compression, frames of one size, so that a frame
/// is found by a multiplication and a file whose writer was killed is good up to its last whole
/// frame.
///
///     offset  type
///          0  char[8]  "TAUTTRAJ"
///          8  u32      version, 1
///         12  u32      F: offset of the first frame
///         16  u32      n: vertices
///         20  u32      m: triangles
///         24  u32      4: bytes of a coordinate (IEEE 754)
///         28  u32      1: positions alone
///         32  u32      s: bytes of the scene's name
///         36  u32      q: bytes of the solver's text
///         40  f64      nominal time between frames [s]
///         48  char[s]  scene name, UTF-8
///       48+s  char[q]  solver and its parameters, UTF-8; zeros up to F - 12 m
///     F-12 m  u32[m][3]     triangles: vertex indices
///          F  the frames: f64 t [s]; f32[n][3] x [m]
///
/// The number of frames is (file size - F) / (8 + 12 n), rounded down. Read in Python:
///
///     import struct
///     d = open("run.traj", "rb").read()
///     magic, version, F, n, m, real, channels, s, q, dt = struct.unpack_from("<8s8Id", d)
///     assert magic == b"TAUTTRAJ" and version == 1
///     triangles = list(struct.iter_unpack("<3I", d[F - 12 * m : F]))
///     size = 8 + 12 * n
///     for k in range((len(d) - F) // size):
///         t, *u = struct.unpack_from(f"<d{3 * n}f", d, F + k * size)
///         x = [u[i : i + 3] for i in range(0, 3 * n, 3)]
namespace taut {

/// What a trajectory says about itself.
struct TrajectoryHeader {
  std::string scene;                ///< name
  std::string solver;               ///< SolverChoice::canonical()
  double frame_dt = 0;              ///< s, nominal: frames carry their own times
  int vertices = 0;                 ///< > 0
  std::vector<Triangle> triangles;  ///< may be empty (a chain)
};

/// Appends frames to a new file, each handed to the operating system whole before `append` returns:
/// a writer that is killed costs at most the frame it was writing.
class TrajectoryWriter {
 public:
  /// Replaces an existing file. Throws InputError if it cannot be written.
  TrajectoryWriter(const std::filesystem::path&, TrajectoryHeader);
  /// Times must not decrease. Non-finite states are stored as they are: they are data. Throws
  /// InputError on a full disk.
  void append(double t, const State&);
  int frames() const { return frames_; }

 private:
  void write_bytes(const std::string&);
  std::filesystem::path path_;
  TrajectoryHeader header_;
  std::ofstream out_;
  std::string buffer_;
  int frames_ = 0;
};

/// Reads frames in any order. Throws InputError if the file is empty, truncated within its header,
/// not a trajectory, of another version, or inconsistent.
class TrajectoryReader {
 public:
  explicit TrajectoryReader(const std::filesystem::path&);
  const TrajectoryHeader& header() const { return header_; }
  int frames() const { return frames_; }
  /// Bytes of an unfinished frame at the end, which is ignored; 0: the file is whole.
  std::uint64_t dropped_bytes() const { return dropped_; }
  /// Where the first `count` frames end, and where the file does [bytes].
  std::uint64_t frame_end(int count) const {
    return first_ + static_cast<std::uint64_t>(count) * frame_size_;
  }
  std::uint64_t end() const { return frame_end(frames_) + dropped_; }
  struct Frame {
    double t = 0;  ///< s
    State state;   ///< v is empty
  };
  /// Precondition: 0 <= k < frames().
  Frame read(int k);

 private:
  void read_header(std::uint64_t file_bytes);
  std::filesystem::path path_;
  TrajectoryHeader header_;
  std::ifstream in_;
  std::uint64_t first_ = 0;       ///< offset of the first frame
  std::uint64_t frame_size_ = 0;  ///< bytes
  int frames_ = 0;
  std::uint64_t dropped_ = 0;
};

/// A whole motion in memory.
struct Trajectory {
  TrajectoryHeader header;
  std::vector<TrajectoryReader::Frame> frames;
};

/// Everything in the file; a dropped tail is reported on stderr. Throws InputError, also if there
/// is no whole frame.
Trajectory read_trajectory(const std::filesystem::path&);

}  // namespace taut
