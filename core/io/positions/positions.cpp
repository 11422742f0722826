#include "core/io/positions/positions.hpp"

#include <algorithm>
#include <array>

#include "core/io/positions/formats.hpp"
#include "core/io/text_file.hpp"

namespace taut {

namespace {

struct Format {
  std::string_view extension;
  std::unique_ptr<PositionReader> (*open)(const std::filesystem::path&);
  std::unique_ptr<PositionWriter> (*create)(const std::filesystem::path&, const Mesh&);
};

template <std::unique_ptr<PositionWriter> create(const std::filesystem::path&)>
std::unique_ptr<PositionWriter> without_mesh(const std::filesystem::path& path, const Mesh&) {
  return create(path);
}

constexpr std::array kFormats{Format{".npy", open_npy, without_mesh<create_npy>},
                              Format{".pc2", open_pc2, without_mesh<create_pc2>},
                              Format{".mdd", open_mdd, without_mesh<create_mdd>},
                              Format{".obj", open_sequence, create_sequence},
                              Format{".ply", open_sequence, create_sequence}};

const Format* find_format(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const auto at = std::ranges::find(kFormats, extension, &Format::extension);
  return at == kFormats.end() ? nullptr : at;
}

const Format& format_of(const std::filesystem::path& path) {
  if (const Format* format = find_format(path)) return *format;
  fail_in(path,
          "positions are in files that end in .npy, .pc2, .mdd, .obj or .ply, or in taut's own "
          ".traj");
}

}  // namespace

std::unique_ptr<PositionReader> open_positions(const std::filesystem::path& path) {
  return format_of(path).open(path);
}

std::unique_ptr<PositionWriter> create_positions(const std::filesystem::path& path,
                                                 const Mesh& mesh) {
  return format_of(path).create(path, mesh);
}

}  // namespace taut
