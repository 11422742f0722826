// The text of an OBJ file; what makes a surface of it is in polygons.cpp.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/io/mesh_io.hpp"
#include "core/io/polygons.hpp"
#include "core/io/text_file.hpp"
#include "core/io/words.hpp"
#include "core/model/input_error.hpp"

namespace taut {

namespace {

/// Keywords that say nothing about the shape.
constexpr std::string_view kSkipped[] = {"vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib"};

class ObjReader {
 public:
  ObjReader(const std::string& file, SurfaceErrors& errors) : errors_(errors) {
    polygons_.file = file;
  }

  void line(std::string_view text) {
    ++line_;
    words_ = words_of(text);
    if (words_.empty()) return;
    if (words_[0] == "v")
      vertex();
    else if (words_[0] == "f")
      face();
    else if (std::find(std::begin(kSkipped), std::end(kSkipped), words_[0]) == std::end(kSkipped))
      report(0, "'" + std::string(words_[0].substr(0, 40)) +
                    "' is not read: a cloth is made of 'v' and 'f' lines");
  }

  /// Faces may name vertices that come later in the file, so the count is known only now.
  Polygons take() {
    const auto count = static_cast<long>(polygons_.vertices.size());
    for (std::size_t f = 0; f < polygons_.faces.size(); ++f)
      for (const int v : polygons_.faces[f])
        if (v >= count) {
          errors_.report(polygons_.face_lines[f], "the face names vertex " +
                                                      std::to_string(v + 1L) + ", but there are " +
                                                      std::to_string(count));
          break;
        }
    return std::move(polygons_);
  }

 private:
  void report(std::size_t word, const std::string& message) {
    const auto column = words_[word].data() - words_[0].data() + 1;
    errors_.report(line_, message, static_cast<int>(column));
  }

  void vertex() {
    Vec3 x = Vec3::Zero();
    if (words_.size() < 4) return report(0, "a vertex needs three coordinates");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = whole<double>(words_[axis + 1]);
      if (!value || !std::isfinite(*value) || std::abs(*value) > 1e9) {
        report(axis + 1, "'" + std::string(words_[axis + 1].substr(0, 40)) +
                             "' is not a coordinate: a finite number within 1e9");
        break;  // the vertex stays, so that faces keep their numbers
      }
      x[static_cast<Eigen::Index>(axis)] = *value;
    }
    polygons_.vertices.push_back(x);
    polygons_.vertex_lines.push_back(line_);
  }

  /// "7", "7/1", "7//3" or "7/1/3"; -1 is the latest vertex. Only the first number matters.
  void face() {
    std::vector<int> corners;
    for (std::size_t w = 1; w < words_.size(); ++w) {
      const auto index = whole<long>(words_[w].substr(0, words_[w].find('/')));
      const auto so_far = static_cast<long>(polygons_.vertices.size());
      if (!index || *index > (1L << 30))
        return report(w, "'" + std::string(words_[w].substr(0, 40)) + "' is not a vertex number");
      if (*index == 0) return report(w, "vertices are numbered from 1; 0 names none");
      if (*index < -so_far)
        return report(w, "the face names vertex " + std::to_string(*index) + ", but there are " +
                             std::to_string(so_far) + " before it");
      corners.push_back(static_cast<int>(*index > 0 ? *index - 1 : so_far + *index));
    }
    if (corners.size() < 3) return report(0, "a face needs three vertices at least");
    std::vector<int> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
      return report(0, "the face names vertex " + std::to_string(*twice + 1) + " twice");
    polygons_.faces.push_back(std::move(corners));
    polygons_.face_lines.push_back(line_);
  }

  SurfaceErrors& errors_;
  Polygons polygons_;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace

Polygons parse_obj(const std::string& file, const std::string& text) {
  SurfaceErrors errors(file);
  ObjReader reader(file, errors);
  std::string_view rest = text;
  while (!rest.empty()) reader.line(take_line(rest));
  Polygons polygons = reader.take();
  errors.throw_if_any();  // what follows presumes that every face names vertices that exist
  judge_surface(polygons, errors);
  errors.throw_if_any();
  return polygons;
}

Polygons read_obj(const std::filesystem::path& path) {
  return parse_obj(path.string(), read_text(path, kMostMeshBytes));
}

}  // namespace taut
