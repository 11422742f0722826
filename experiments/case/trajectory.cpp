#include "experiments/case/trajectory.hpp"

#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iostream>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"

namespace taut {

namespace {

using std::endian;
static_assert(endian::native == endian::little, "the header is written as memory has it");

constexpr char kMagic[8] = {'T', 'A', 'U', 'T', 'T', 'R', 'A', 'J'};
constexpr std::uint32_t kVersion = 1, kRealBytes = 4, kChannels = 1;

/// The first 48 bytes, as documented.
struct FixedHeader {
  char magic[8];
  std::uint32_t version, first, vertices, triangles, real, channels, name_bytes, solver_bytes;
  double frame_dt;
};
static_assert(sizeof(FixedHeader) == 48);

constexpr std::uint64_t round_up_to_8(std::uint64_t bytes) { return (bytes + 7) / 8 * 8; }

std::string header_bytes(const TrajectoryHeader& header) {
  const auto u32 = [](auto value) { return static_cast<std::uint32_t>(value); };
  const std::uint64_t before_triangles =
      round_up_to_8(sizeof(FixedHeader) + header.scene.size() + header.solver.size());
  FixedHeader fixed{.version = kVersion,
                    .first = u32(before_triangles + 12 * header.triangles.size()),
                    .vertices = u32(header.vertices),
                    .triangles = u32(header.triangles.size()),
                    .real = kRealBytes,
                    .channels = kChannels,
                    .name_bytes = u32(header.scene.size()),
                    .solver_bytes = u32(header.solver.size()),
                    .frame_dt = header.frame_dt};
  std::memcpy(fixed.magic, kMagic, sizeof kMagic);
  std::string out;
  append_number(out, fixed, endian::little);
  out += header.scene + header.solver;
  out.resize(before_triangles, '\0');
  for (const Triangle& triangle : header.triangles)
    for (int vertex : triangle) append_number(out, u32(vertex), endian::little);
  return out;
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& path, TrajectoryHeader header)
    : path_(path), header_(std::move(header)), out_(path, std::ios::binary | std::ios::trunc) {
  assert(header_.vertices > 0);
  write_bytes(header_bytes(header_));
}

void TrajectoryWriter::append(double t, const State& state) {
  assert(state.x.size() == static_cast<std::size_t>(header_.vertices));
  buffer_.clear();
  append_number(buffer_, t, endian::little);
  append_vectors<float>(buffer_, state.x, endian::little);
  write_bytes(buffer_);
  ++frames_;
}

void TrajectoryWriter::write_bytes(const std::string& bytes) {
  errno = 0;
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.flush();
  if (out_) return;
  fail_in(path_, std::string("cannot write the trajectory: ") +
                     (errno != 0 ? std::strerror(errno) : "write error"));
}

TrajectoryReader::TrajectoryReader(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    fail_in(path, "is no regular file");  // opening a pipe waits for whoever writes into it
  in_.open(path, std::ios::binary);
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error || !in_)
    fail_in(path, "cannot read: " + (error ? error.message() : "not a readable file"));
  read_header(bytes);
  frame_size_ = sizeof(double) + 3 * kRealBytes * static_cast<std::uint64_t>(header_.vertices);
  frames_ = static_cast<int>((bytes - first_) / frame_size_);
  dropped_ = (bytes - first_) % frame_size_;
}

void TrajectoryReader::read_header(std::uint64_t file_bytes) {
  const auto fail = [&](const std::string& why) { fail_in(path_, why); };
  if (file_bytes == 0) fail("empty file, not a trajectory");
  FixedHeader fixed{};
  const auto known = static_cast<std::streamsize>(std::min<std::uint64_t>(8, file_bytes));
  in_.read(reinterpret_cast<char*>(&fixed), sizeof fixed);
  if (std::memcmp(fixed.magic, kMagic, static_cast<std::size_t>(known)) != 0)
    fail("not a trajectory: it does not begin with TAUTTRAJ");
  if (!in_)
    fail("truncated within its header: it ends at byte " + std::to_string(file_bytes) + " of " +
         std::to_string(sizeof fixed));
  if (fixed.version != kVersion)
    fail("version " + std::to_string(fixed.version) + "; this program reads version 1");
  const std::uint64_t before_triangles = round_up_to_8(
      sizeof fixed + std::uint64_t{fixed.name_bytes} + std::uint64_t{fixed.solver_bytes});
  const bool consistent = fixed.vertices > 0 && fixed.vertices <= 0x7fffffff &&
                          fixed.real == kRealBytes && fixed.channels == kChannels &&
                          fixed.first == before_triangles + 12 * std::uint64_t{fixed.triangles};
  if (!consistent) fail("inconsistent header");
  if (file_bytes < fixed.first)
    fail("truncated within its header: it ends at byte " + std::to_string(file_bytes) + " of " +
         std::to_string(fixed.first));
  first_ = fixed.first;
  header_.vertices = static_cast<int>(fixed.vertices);
  header_.frame_dt = fixed.frame_dt;
  header_.scene.resize(fixed.name_bytes);
  in_.read(header_.scene.data(), fixed.name_bytes);
  header_.solver.resize(fixed.solver_bytes);
  in_.read(header_.solver.data(), fixed.solver_bytes);
  header_.triangles.resize(fixed.triangles);
  in_.seekg(static_cast<std::streamoff>(before_triangles));
  for (Triangle& triangle : header_.triangles) {
    in_.read(reinterpret_cast<char*>(triangle.data()), 12);
    for (int vertex : triangle)
      if (vertex < 0 || vertex >= header_.vertices)
        fail("a triangle names a vertex that is absent");
  }
  if (!in_) fail("cannot read its header");
}

TrajectoryReader::Frame TrajectoryReader::read(int k) {
  assert(k >= 0 && k < frames_);
  std::string bytes(frame_size_, '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(first_ + static_cast<std::uint64_t>(k) * frame_size_));
  in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in_) fail_in(path_, "cannot read frame " + std::to_string(k));
  Frame frame;
  frame.t = number_at<double>(bytes.data(), endian::little);
  frame.state.x.resize(static_cast<std::size_t>(header_.vertices));
  read_vectors<float>(bytes.data() + sizeof(double), frame.state.x, endian::little);
  return frame;
}

Trajectory read_trajectory(const std::filesystem::path& path) {
  TrajectoryReader reader(path);
  if (reader.frames() == 0)
    fail_in(path, "a trajectory without a whole frame: it ends at byte " +
                      std::to_string(reader.end()) + ", the first frame would end at byte " +
                      std::to_string(reader.frame_end(1)));
  if (reader.dropped_bytes() > 0)
    std::cerr << path.string() << ": the writer was interrupted; dropped the last "
              << reader.dropped_bytes() << " bytes, an unfinished frame from byte "
              << reader.frame_end(reader.frames()) << " on, after " << reader.frames()
              << " whole ones\n";
  Trajectory trajectory{reader.header(), {}};
  for (int k = 0; k < reader.frames(); ++k) {
    trajectory.frames.push_back(reader.read(k));
    const double t = trajectory.frames.back().t;
    if (!std::isfinite(t) || (k > 0 && t < trajectory.frames[static_cast<std::size_t>(k) - 1].t))
      fail_in(path, "frame " + std::to_string(k) +
                        " is at no time, or at an earlier one than the frame before it");
  }
  return trajectory;
}

}  // namespace taut
