// PC2 and MDD, the point caches of animation programs.
#include <cmath>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

using std::endian;
constexpr std::string_view kPc2Magic{"POINTCACHE2\0", 12};
constexpr std::size_t kPc2Header = 32;

std::uint64_t count_at(const std::filesystem::path& path, const std::string& bytes,
                       std::size_t offset, endian order) {
  const auto count = number_at<std::int32_t>(bytes.data() + offset, order);
  if (count <= 0)
    fail_in(path, "byte " + std::to_string(offset) + ": " + std::to_string(count) +
                      " is no number of vertices or frames");
  return static_cast<std::uint64_t>(count);
}

class Pc2Writer final : public PositionWriter {
 public:
  explicit Pc2Writer(const std::filesystem::path& path) : out_(path) {}

  void append(double, const std::vector<Vec3>& x) override {
    std::string header(kPc2Magic), frame;
    const auto put = [&](auto value) { append_number(header, value, endian::little); };
    put(std::int32_t{1}), put(static_cast<std::int32_t>(x.size()));  // version, vertices
    put(0.f), put(1.f), put(++frames_);                              // first frame, rate, frames
    append_vectors<float>(frame, x, endian::little);
    out_.write_at(kPc2Header + static_cast<std::uint64_t>(frames_ - 1) * frame.size(), frame);
    out_.write_at(0, header);  // last: it never promises what is not there
  }

 private:
  OutputFile out_;
  std::int32_t frames_ = 0;
};

/// The times come first, so nothing can be written before their number is known.
class MddWriter final : public PositionWriter {
 public:
  explicit MddWriter(const std::filesystem::path& path) : out_(path) {}

  void append(double t, const std::vector<Vec3>& x) override {
    times_.push_back(static_cast<float>(t));
    vertices_ = static_cast<std::int32_t>(x.size());
    append_vectors<float>(frames_, x, endian::big);
  }

  void finish() override {
    std::string header;
    append_number(header, static_cast<std::int32_t>(times_.size()), endian::big);
    append_number(header, vertices_, endian::big);
    for (const float t : times_) append_number(header, t, endian::big);
    out_.write_at(0, header);
    out_.write_at(header.size(), frames_);
  }

 private:
  OutputFile out_;
  std::vector<float> times_;
  std::int32_t vertices_ = 0;
  std::string frames_;
};

}  // namespace

std::unique_ptr<PositionReader> open_pc2(const std::filesystem::path& path) {
  const std::string header = first_bytes(path, kPc2Header);
  if (!header.starts_with(kPc2Magic)) fail_in(path, "byte 0: a PC2 file begins with POINTCACHE2");
  if (header.size() < kPc2Header)
    fail_in(path, "ends at byte " + std::to_string(header.size()) + ", within its header");
  const auto version = number_at<std::int32_t>(header.data() + 12, endian::little);
  if (version != 1) fail_in(path, "byte 12: version " + std::to_string(version) + "; known is 1");
  const auto rate = static_cast<double>(number_at<float>(header.data() + 24, endian::little));
  if (!(rate > 0) || !std::isfinite(rate))
    fail_in(path,
            "byte 24: a frame every " + shortest(rate) + " frames; expected a number above 0");
  return read_block(path,
                    {.first = kPc2Header,
                     .frames = count_at(path, header, 28, endian::little),
                     .n = count_at(path, header, 16, endian::little)},
                    {.spacing = rate});
}

std::unique_ptr<PositionReader> open_mdd(const std::filesystem::path& path) {
  constexpr std::size_t kCounts = 8;
  std::string header = first_bytes(path, kCounts);
  if (header.size() < kCounts)
    fail_in(path, "ends at byte " + std::to_string(header.size()) + ", within its header");
  const std::uint64_t frames = count_at(path, header, 0, endian::big);
  const FrameBlock block{.first = kCounts + 4 * frames,
                         .frames = frames,
                         .n = count_at(path, header, 4, endian::big),
                         .order = endian::big};
  auto reader = read_block(path, block, {});  // before as many times are read as it says
  header = first_bytes(path, block.first);
  PositionsHeader about;
  for (std::size_t k = 0; k < frames; ++k)
    about.times.push_back(
        static_cast<double>(number_at<float>(header.data() + kCounts + 4 * k, endian::big)));
  return read_block(path, block, std::move(about));
}

std::unique_ptr<PositionWriter> create_pc2(const std::filesystem::path& path) {
  return std::make_unique<Pc2Writer>(path);
}
std::unique_ptr<PositionWriter> create_mdd(const std::filesystem::path& path) {
  return std::make_unique<MddWriter>(path);
}

}  // namespace taut
