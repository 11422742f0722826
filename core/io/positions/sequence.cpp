// Format with a file for each frame: OBJ.
#include <algorithm>
#include <cassert>

#include "core/io/obj_lines.hpp"
#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kDigits = "0123456789";

/// A file of a sequence and its number.
struct Numbered {
  long number;
  fs::path file;
};

/// The files beside `path` that have its extension and whose name is `prefix`, optionally one of
/// _.-, and digits.
std::vector<Numbered> numbered_files(const fs::path& path, const std::string& prefix) {
  std::vector<Numbered> found;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path name = entry.path().filename();
    std::string digits = name.stem().string();
    if (name.extension() != path.extension() || !digits.starts_with(prefix)) continue;
    digits.erase(0, prefix.size());
    if (!digits.empty() && std::string_view("_.-").find(digits[0]) != std::string_view::npos)
      digits.erase(0, 1);
    if (const auto number = whole<long>(digits);
        number && digits.find_first_not_of(kDigits) == digits.npos)
      found.push_back({*number, path.parent_path() / name});
  }
  std::ranges::sort(found, {}, &Numbered::number);
  return found;
}

std::vector<fs::path> files_of(const fs::path& path) {
  std::string prefix = path.stem().string();
  const auto end = prefix.find_last_not_of(kDigits);
  const bool numbered = end + 1 < prefix.size(), exists = fs::exists(path);
  if (!numbered && exists) return {path};
  if (numbered && exists) prefix.resize(end + 1);  // npos + 1 is 0
  if (numbered && !exists) prefix += '_';          // "run2" names run2_00000.obj
  const std::vector<Numbered> all = numbered_files(path, prefix);
  if (all.empty()) fail_in(path, "no such file, and no frames of that name");
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k > 0 && all[k].number == all[k - 1].number)
      fail_in(all[k].file, "is the same frame as " + all[k - 1].file.string());
    if (k > 1 && all[k].number - all[k - 1].number != all[1].number - all[0].number)
      fail_in(all[k].file, "the frame before it is missing: number " +
                               std::to_string(all[k - 1].number + all[1].number - all[0].number));
    files.push_back(all[k].file);
  }
  return files;
}

std::vector<Vec3> obj_vertices(const fs::path& path) {
  const std::string text = read_text(path, kMostMeshBytes);
  std::vector<Vec3> x;
  std::vector<ObjWord> words;
  for (ObjLines lines(text); lines.next(words);) {
    if (words.empty() || words[0].text != "v") continue;
    Vec3& v = x.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto c = axis + 1 < words.size() ? whole<double>(words[axis + 1].text) : std::nullopt;
      if (!c) fail_in(path, "a vertex needs three numbers", words[0].line, 1);
      v[static_cast<Eigen::Index>(axis)] = *c;
    }
  }
  return x;
}

std::string obj_text(double t, const std::vector<Vec3>& x, const Mesh& mesh) {
  std::string out = "# t = " + shortest(t) + " s, metres\n";
  for (const Vec3& v : x)
    out += "v " + shortest(v.x()) + ' ' + shortest(v.y()) + ' ' + shortest(v.z()) + '\n';
  const bool textured = mesh.grid && !mesh.triangles.empty();
  for (int j = 0; textured && j < mesh.grid->nv; ++j)
    for (int i = 0; i < mesh.grid->nu; ++i)
      out += "vt " + shortest(1.0 * i / (mesh.grid->nu - 1)) + ' ' +
             shortest(1 - 1.0 * j / (mesh.grid->nv - 1)) + '\n';
  for (const Triangle& triangle : mesh.triangles) {
    out += 'f';
    for (const int vertex : triangle) {
      const std::string number = std::to_string(vertex + 1);
      out += ' ' + number + (textured ? '/' + number : "");
    }
    out += '\n';
  }
  if (mesh.grid && mesh.triangles.empty()) {  // a chain
    out += 'l';
    for (int i = 1; i <= mesh.size(); ++i) out += ' ' + std::to_string(i);
    out += '\n';
  }
  return out;
}

class SequenceReader final : public PositionReader {
 public:
  explicit SequenceReader(const fs::path& path) {
    header_.files = files_of(path);
    header_.frames = static_cast<int>(header_.files.size());
    header_.rounding = Rounding::decimal;
    header_.vertices = static_cast<int>(obj_vertices(header_.files.front()).size());
    if (header_.vertices == 0) fail_in(header_.files.front(), "has no vertices");
  }

  std::vector<Vec3> read(int k) override {
    assert(k >= 0 && k < header_.frames);
    const fs::path& file = header_.files[static_cast<std::size_t>(k)];
    std::vector<Vec3> x = obj_vertices(file);
    if (x.size() != static_cast<std::size_t>(header_.vertices))
      fail_in(file, "has " + std::to_string(x.size()) + " vertices; " +
                        header_.files.front().string() + " has " +
                        std::to_string(header_.vertices));
    return x;
  }
};

class SequenceWriter final : public PositionWriter {
 public:
  /// Removes the frames of an earlier sequence, which would be read as the end of this one.
  SequenceWriter(const fs::path& path, const Mesh& mesh) : path_(path), mesh_(mesh) {
    std::error_code error;
    for (int k = 0; fs::remove(frame(k), error); ++k) {
    }
  }

  void append(double t, const std::vector<Vec3>& x) override {
    OutputFile(frame(frames_++)).write_at(0, obj_text(t, x, mesh_));
  }

 private:
  fs::path frame(int k) const {
    std::string digits = std::to_string(k);
    digits.insert(0, 5 - std::min<std::size_t>(5, digits.size()), '0');
    fs::path file = path_;
    return file.replace_filename(path_.stem().string() + "_" + digits + path_.extension().string());
  }

  fs::path path_;
  Mesh mesh_;
  int frames_ = 0;
};

}  // namespace

std::unique_ptr<PositionReader> open_sequence(const fs::path& path) {
  return std::make_unique<SequenceReader>(path);
}

std::unique_ptr<PositionWriter> create_sequence(const fs::path& path, const Mesh& mesh) {
  return std::make_unique<SequenceWriter>(path, mesh);
}

}  // namespace taut
