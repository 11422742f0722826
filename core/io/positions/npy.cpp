// NumPy's format, versions 1 to 3:
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include <algorithm>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"

namespace taut {

namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::size_t kWritten = 128;  ///< bytes of the header that this program writes

[[noreturn]] void fail_at(const std::filesystem::path& path, std::size_t byte,
                          const std::string& why) {
  fail_in(path, "byte " + std::to_string(byte) + ": " + why);
}

/// What follows 'key': in the dictionary of the header, up to `end`; "" if it has no such key.
std::string_view value_of(std::string_view dictionary, std::string_view key, char end) {
  const auto at = dictionary.find("'" + std::string(key) + "':");
  if (at == dictionary.npos) return {};
  std::string_view rest = dictionary.substr(at + key.size() + 3);
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  return rest.substr(0, rest.find(end));
}

/// "(10, 4, 3" -> 10, 4, 3; nothing if there is anything but numbers.
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

class NpyWriter final : public PositionWriter {
 public:
  explicit NpyWriter(const std::filesystem::path& path) : out_(path) {}

  void append(double, const std::vector<Vec3>& x) override {
    std::string frame;
    append_vectors<double>(frame, x, std::endian::little);
    out_.write_at(kWritten + frames_++ * frame.size(), frame);
    std::string header = std::string(kNpyMagic) + std::string("\1\0", 2);
    append_number(header, static_cast<std::uint16_t>(kWritten - 10), std::endian::little);
    header += "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(frames_) +
              ", " + std::to_string(x.size()) + ", 3), }";
    header.resize(kWritten - 1, ' ');
    out_.write_at(0, header + '\n');  // last: it never promises what is not there
  }

 private:
  OutputFile out_;
  std::uint64_t frames_ = 0;
};

}  // namespace

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

std::unique_ptr<PositionWriter> create_npy(const std::filesystem::path& path) {
  return std::make_unique<NpyWriter>(path);
}

}  // namespace taut
