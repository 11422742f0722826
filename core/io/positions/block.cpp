#include <cassert>
#include <cerrno>
#include <limits>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"

namespace taut {

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), out_(path_, std::ios::binary | std::ios::trunc) {
  write_at(0, {});
}

void OutputFile::write_at(std::uint64_t offset, std::string_view bytes) {
  errno = 0;
  out_.seekp(static_cast<std::streamoff>(offset));
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.flush();
  if (out_) return;
  fail_in(path_,
          std::string("cannot be written: ") + (errno != 0 ? std::strerror(errno) : "write error"));
}

std::string first_bytes(const std::filesystem::path& path, std::size_t most) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    fail_in(path, "is no regular file");  // a pipe would be waited for
  std::ifstream in(path, std::ios::binary);
  if (!in) fail_in(path, std::string("cannot be read: ") + std::strerror(errno));
  std::string bytes(most, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

namespace {

class BlockReader final : public PositionReader {
 public:
  BlockReader(const std::filesystem::path& path, const FrameBlock& block, PositionsHeader header)
      : path_(path), in_(path, std::ios::binary), block_(block) {
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

}  // namespace

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

}  // namespace taut
