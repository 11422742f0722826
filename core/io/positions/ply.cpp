// Stanford's polygon format 1.0.
#include <array>
#include <optional>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

struct Type {
  std::string_view name, other_name;
  std::size_t bytes;
};
constexpr std::array kTypes{Type{"char", "int8", 1},     Type{"uchar", "uint8", 1},
                            Type{"short", "int16", 2},   Type{"ushort", "uint16", 2},
                            Type{"int", "int32", 4},     Type{"uint", "uint32", 4},
                            Type{"float", "float32", 4}, Type{"double", "float64", 8}};

/// Where a coordinate stands in a vertex, as a column and as a byte; `bytes` 0: it is not there.
struct Coordinate {
  std::size_t column = 0, offset = 0, bytes = 0;
};

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& path, const std::string& text)
      : path_(path), text_(text), rest_(text) {}

  std::vector<Vec3> read(Rounding& rounding) {
    header();
    for (const Coordinate& place : places_)
      if (place.bytes == 0) fail("its vertices lack one of the properties x, y, z");
    rounding = ascii_                  ? Rounding::decimal
               : places_[0].bytes == 4 ? Rounding::binary32
                                       : Rounding::binary64;
    return ascii_ ? ascii_vertices() : binary_vertices();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    fail_in(path_, why, line_, line_ > 0 ? 1 : 0);
  }

  std::vector<std::string_view> next_line() {
    if (rest_.empty()) fail("ends within its header");
    ++line_;
    return words_of(take_line(rest_), '\0');
  }

  void header() {
    if (const auto first = next_line(); first.size() != 1 || first[0] != "ply")
      fail("a PLY file begins with the line 'ply'");
    bool in_vertex = false;
    for (auto words = next_line(); words.empty() || words[0] != "end_header"; words = next_line()) {
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format" && words.size() == 3)
        format(words[1]);
      else if (words[0] == "element" && words.size() == 3)
        in_vertex = element(words);
      else if (words[0] != "property")
        fail("expected format, element, property, comment or end_header");
      else if (in_vertex)
        property(words);
    }
    if (!format_known_) fail("its header has no format");
    if (!count_) fail("its header has no element vertex");
  }

  void format(std::string_view name) {
    format_known_ = true;
    ascii_ = name == "ascii";
    order_ = name == "binary_big_endian" ? std::endian::big : std::endian::little;
    if (!ascii_ && name != "binary_little_endian" && name != "binary_big_endian")
      fail("format '" + std::string(name.substr(0, 40)) + "' is not known");
  }

  bool element(const std::vector<std::string_view>& words) {
    if (words[1] != "vertex") {
      if (!count_) fail("the element vertex has to be the first");
      return false;
    }
    count_ = whole<std::uint32_t>(words[2]);
    if (!count_) fail("'" + std::string(words[2].substr(0, 40)) + "' is no number of vertices");
    return true;
  }

  void property(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("a property of a vertex has a type and a name, and is no list");
    const Type* type = nullptr;
    for (const Type& known : kTypes)
      if (words[1] == known.name || words[1] == known.other_name) type = &known;
    if (!type) fail("type '" + std::string(words[1].substr(0, 40)) + "' is not known");
    constexpr std::string_view kAxes = "xyz";
    if (const auto axis = kAxes.find(words[2]); words[2].size() == 1 && axis != kAxes.npos) {
      if (type < &kTypes[6]) fail("a coordinate is float or double");
      places_[axis] = {columns_, size_, type->bytes};
    }
    ++columns_;
    size_ += type->bytes;
  }

  std::vector<Vec3> ascii_vertices() {
    std::vector<Vec3> x;
    while (x.size() < *count_) {
      if (rest_.empty())
        fail("ends after " + std::to_string(x.size()) + " of " + std::to_string(*count_) +
             " vertices");
      ++line_;
      const auto words = words_of(take_line(rest_), '\0');
      Vec3& v = x.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t column = places_[axis].column;
        const auto c = column < words.size() ? whole<double>(words[column]) : std::nullopt;
        if (!c) fail("a vertex has " + std::to_string(columns_) + " numbers");
        v[static_cast<Eigen::Index>(axis)] = *c;
      }
    }
    return x;
  }

  std::vector<Vec3> binary_vertices() {
    if (rest_.size() / size_ < *count_) {
      line_ = 0;
      fail(std::to_string(*count_) + " vertices of " + std::to_string(size_) +
           " bytes begin at byte " + std::to_string(text_.size() - rest_.size()) +
           ", but the file ends at byte " + std::to_string(text_.size()));
    }
    std::vector<Vec3> x(*count_);
    const char* from = rest_.data();
    for (Vec3& v : x) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& [column, offset, bytes] = places_[axis];
        v[static_cast<Eigen::Index>(axis)] =
            bytes == 4 ? static_cast<double>(number_at<float>(from + offset, order_))
                       : number_at<double>(from + offset, order_);
      }
      from += size_;
    }
    return x;
  }

  std::filesystem::path path_;
  const std::string& text_;
  std::string_view rest_;
  int line_ = 0;
  bool ascii_ = false, format_known_ = false;
  std::endian order_ = std::endian::little;
  std::optional<std::uint32_t> count_;
  std::array<Coordinate, 3> places_;
  std::size_t columns_ = 0, size_ = 0;
};

}  // namespace

std::vector<Vec3> ply_vertices(const std::filesystem::path& path, Rounding& rounding) {
  const std::string text = read_text(path, kMostMeshBytes);
  return PlyReader(path, text).read(rounding);
}

std::string ply_text(double t, const std::vector<Vec3>& x, const Mesh& mesh) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment t = " + shortest(t) +
                    " s, metres\nelement vertex " + std::to_string(x.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                    std::to_string(mesh.triangles.size()) +
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  append_vectors<double>(out, x, std::endian::little);
  for (const Triangle& triangle : mesh.triangles) {
    out += '\3';
    for (const int vertex : triangle)
      append_number(out, static_cast<std::int32_t>(vertex), std::endian::little);
  }
  return out;
}

}  // namespace taut
