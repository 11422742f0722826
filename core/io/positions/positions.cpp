#include "core/io/positions/positions.hpp"

// Formats with all frames in one file: NumPy arrays (versions 1 to 3,
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html), and PC2, the point cache
// of animation programs.
#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <limits>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"
#include "core/model/text.hpp"

namespace taut {

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), out_(path_, std::ios::binary | std::ios::trunc) {
  write_at(0, {});
}

void OutputFile::write_at(std::uint64_t offset, std::string_view bytes) {
  out_.seekp(static_cast<std::streamoff>(offset));
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.flush();
  if (out_) return;
  fail_in(path_, std::string("cannot be written: ") + std::strerror(errno));
}

namespace {

/// The first `most` bytes of a file, or all of them if it is shorter.
std::string first_bytes(const std::filesystem::path& path, std::size_t most) {
  std::ifstream in = open_file(path);
  std::string bytes(most, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

/// Frames of equal size, one after another: what follows the header in every single-file format.
struct FrameBlock {
  std::uint64_t first = 0;          ///< byte of the first frame
  std::uint64_t frames = 0, n = 0;  ///< from the header
  std::endian order = std::endian::little;
  bool single = true;  ///< float32, otherwise float64
};

class BlockReader final : public PositionReader {
 public:
  BlockReader(const std::filesystem::path& path, const FrameBlock& block, PositionsHeader header)
      : path_(path), in_(open_file(path)), block_(block) {
    header_ = std::move(header);
    header_.vertices = static_cast<int>(block.n);
    header_.frames = static_cast<int>(block.frames);
    header_.rounding = block.single ? Rounding::binary32 : Rounding::binary64;
    header_.files = {path};
  }

  std::vector<Vec3> read(int k) override {
    assert(k >= 0 && k < header_.frames);
    const std::size_t size = (block_.single ? 12 : 24) * block_.n;
    bytes_.resize(size);
    const std::uint64_t at = block_.first + static_cast<std::uint64_t>(k) * size;
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(bytes_.data(), static_cast<std::streamsize>(size));
    if (!in_)
      fail_in(path_, "byte " + std::to_string(at) + ": cannot read frame " + std::to_string(k));
    std::vector<Vec3> x(block_.n);
    block_.single ? read_vectors<float>(bytes_.data(), x, block_.order)
                  : read_vectors<double>(bytes_.data(), x, block_.order);
    return x;
  }

 private:
  std::filesystem::path path_;
  std::ifstream in_;
  FrameBlock block_;
  std::string bytes_;
};

/// Opens a block. Throws InputError if the file does not end with it.
std::unique_ptr<PositionReader> read_block(const std::filesystem::path& path,
                                           const FrameBlock& block, PositionsHeader header) {
  const std::string counts =
      std::to_string(block.frames) + " frames of " + std::to_string(block.n) + " vertices";
  constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
  if (block.frames == 0 || block.n == 0 || block.frames > kMost || block.n > kMost)
    fail_in(path, "the header says " + counts + ": 1 to " + std::to_string(kMost) + " of each");
  const std::uint64_t size = std::filesystem::file_size(path),
                      frame = block.n * (block.single ? 12 : 24);
  const std::uint64_t body = size < block.first ? 0 : size - block.first;
  if (body / frame < block.frames)
    fail_in(path, "the header says " + counts + " from byte " + std::to_string(block.first) +
                      " on, but the file ends at byte " + std::to_string(size) + ", after " +
                      std::to_string(body / frame) + " whole frames");
  if (body != block.frames * frame)
    fail_in(path, "the header says " + counts + ", which end at byte " +
                      std::to_string(block.first + block.frames * frame) + ", but the file has " +
                      std::to_string(size) + " bytes");
  return std::make_unique<BlockReader>(path, block, std::move(header));
}

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::size_t kWritten = 128;  ///< bytes of the header that this program writes

[[noreturn]] void fail_at(const std::filesystem::path& path, std::size_t byte,
                          const std::string& why) {
  fail_in(path, "byte " + std::to_string(byte) + ": " + why);
}

/// Text after 'key': in the header's dictionary, up to `end`; "" if there is no such key.
std::string_view value_of(std::string_view dictionary, std::string_view key, char end) {
  const auto at = dictionary.find("'" + std::string(key) + "':");
  if (at == dictionary.npos) return {};
  std::string_view rest = dictionary.substr(at + key.size() + 3);
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  return rest.substr(0, rest.find(end));
}

/// The numbers in "(10, 4, 3"; empty if there is anything else.
std::vector<std::uint64_t> numbers_of(std::string_view tuple) {
  std::string text(tuple);
  std::ranges::replace_if(
      text, [](char c) { return c == '(' || c == ','; }, ' ');
  std::vector<std::uint64_t> numbers;
  for (const std::string_view word : words_of(text)) {
    const auto number = whole<std::uint64_t>(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

template <class Real>
class NpyWriter final : public PositionWriter {
 public:
  explicit NpyWriter(const std::filesystem::path& path) : out_(path) {}

  void append(double, const std::vector<Vec3>& x) override {
    std::string frame;
    append_vectors<Real>(frame, x, std::endian::little);
    out_.write_at(kWritten + frames_++ * frame.size(), frame);
    std::string header = std::string(kNpyMagic) + std::string("\1\0", 2);
    append_number(header, static_cast<std::uint16_t>(kWritten - 10), std::endian::little);
    header += "{'descr': '<f" + std::to_string(sizeof(Real)) +
              "', 'fortran_order': False, 'shape': (" + std::to_string(frames_) + ", " +
              std::to_string(x.size()) + ", 3), }";
    header.resize(kWritten - 1, ' ');
    out_.write_at(0, header + '\n');  // last, so that it never promises frames that are not there
  }

 private:
  OutputFile out_;
  std::uint64_t frames_ = 0;
};

std::unique_ptr<PositionReader> open_npy(const std::filesystem::path& path) {
  constexpr std::size_t kMostHeader = 1 << 16;
  const std::string bytes = first_bytes(path, 12 + kMostHeader);
  if (!bytes.starts_with(kNpyMagic) || bytes.size() < 12)
    fail_at(path, 0, "an array of NumPy begins with \\x93NUMPY and its version");
  const int version = bytes[6];
  if (version < 1 || version > 3)
    fail_at(path, 6, "version " + std::to_string(version) + "; known are 1 to 3");
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length = version == 1
                                 ? number_at<std::uint16_t>(bytes.data() + 8, std::endian::little)
                                 : number_at<std::uint32_t>(bytes.data() + 8, std::endian::little);
  if (length > kMostHeader || start + length > bytes.size())
    fail_at(path, 8,
            "a header of " + std::to_string(length) + " bytes, but the file has " +
                std::to_string(std::filesystem::file_size(path)) + ", or no header is so long");
  const std::string_view dictionary = std::string_view(bytes).substr(start, length);
  std::string_view type = value_of(dictionary, "descr", ',');
  if (type.size() == 5) type = type.substr(1, 3);  // without its quotes
  if (type != "<f4" && type != "<f8" && type != ">f4" && type != ">f8")
    fail_at(path, start,
            "the type is " + std::string(type.substr(0, 40)) +
                "; positions are float32 or float64: x.astype('float64')");
  if (value_of(dictionary, "fortran_order", ',') != "False")
    fail_at(path, start, "it is in Fortran order; numpy.ascontiguousarray puts it in C order");
  const std::vector<std::uint64_t> shape = numbers_of(value_of(dictionary, "shape", ')'));
  if (shape.size() != 3 || shape[2] != 3)
    fail_at(path, start,
            "the shape is " + std::string(value_of(dictionary, "shape", ')').substr(0, 60)) +
                "); positions are [frames, vertices, 3]");
  return read_block(path,
                    {.first = start + length,
                     .frames = shape[0],
                     .n = shape[1],
                     .order = type[0] == '<' ? std::endian::little : std::endian::big,
                     .single = type[2] == '4'},
                    {});
}

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
    put(std::int32_t{1});  // version
    put(static_cast<std::int32_t>(x.size()));
    put(0.f);
    put(1.f);
    put(++frames_);  // first frame, rate, frames
    append_vectors<float>(frame, x, endian::little);
    out_.write_at(kPc2Header + static_cast<std::uint64_t>(frames_ - 1) * frame.size(), frame);
    out_.write_at(0, header);  // last, so that it never promises frames that are not there
  }

 private:
  OutputFile out_;
  std::int32_t frames_ = 0;
};

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

template <class Real>
class MemoryReader final : public PositionReader {
 public:
  MemoryReader(std::span<const Real> numbers, std::size_t vertices, const std::string& name)
      : numbers_(numbers) {
    const std::size_t frames = vertices > 0 ? numbers.size() / (3 * vertices) : 0;
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    if (frames == 0 || frames > kMost || vertices > kMost ||
        frames * 3 * vertices != numbers.size())
      fail_in(name, std::to_string(numbers.size()) + " numbers are no frames of " +
                        std::to_string(vertices) + " vertices");
    header_.vertices = static_cast<int>(vertices);
    header_.frames = static_cast<int>(frames);
    header_.rounding = sizeof(Real) == 4 ? Rounding::binary32 : Rounding::binary64;
  }

  std::vector<Vec3> read(int k) override {
    assert(k >= 0 && k < header_.frames);
    const std::size_t n = static_cast<std::size_t>(header_.vertices);
    const Real* at = numbers_.data() + static_cast<std::size_t>(k) * 3 * n;
    std::vector<Vec3> x(n);
    for (Vec3& v : x)
      for (double& c : v) c = static_cast<double>(*at++);
    return x;
  }

 private:
  std::span<const Real> numbers_;
};

struct Format {
  std::string_view extension;
  std::unique_ptr<PositionReader> (*open)(const std::filesystem::path&);
  std::unique_ptr<PositionWriter> (*create)(const std::filesystem::path&, const Mesh&);
};

template <class Writer>
std::unique_ptr<PositionWriter> create(const std::filesystem::path& path, const Mesh&) {
  return std::make_unique<Writer>(path);
}

constexpr std::array kFormats{Format{".npy", open_npy, create<NpyWriter<double>>},
                              Format{".pc2", open_pc2, create<Pc2Writer>},
                              Format{".obj", open_sequence, create_sequence}};

const Format& format_of(const std::filesystem::path& path) {
  const auto at = std::ranges::find(kFormats, path.extension().string(), &Format::extension);
  if (at != kFormats.end()) return *at;
  fail_in(path, "positions are in files that end in .npy, .pc2 or .obj");
}

}  // namespace

void check_positions_name(const std::filesystem::path& path) { format_of(path); }

std::unique_ptr<PositionReader> open_positions(const std::filesystem::path& path) {
  return format_of(path).open(path);
}

std::unique_ptr<PositionReader> positions_in(std::span<const float> numbers, std::size_t vertices,
                                             const std::string& name) {
  return std::make_unique<MemoryReader<float>>(numbers, vertices, name);
}

std::unique_ptr<PositionReader> positions_in(std::span<const double> numbers, std::size_t vertices,
                                             const std::string& name) {
  return std::make_unique<MemoryReader<double>>(numbers, vertices, name);
}

std::unique_ptr<PositionWriter> create_positions(const std::filesystem::path& path,
                                                 const Mesh& mesh) {
  return format_of(path).create(path, mesh);
}

std::unique_ptr<PositionWriter> create_rounded_npy(const std::filesystem::path& path) {
  return std::make_unique<NpyWriter<float>>(path);
}

}  // namespace taut
