// Every mutated scene or OBJ file loads or is refused with a place inside the file.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/io/document.hpp"
#include "core/io/mesh_io.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"

namespace taut::scene_fuzz_test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes";

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Mutates texts as typing errors and broken disks do; every run makes the same sequence.
class Mutator {
 public:
  std::string mutate(std::string text) {
    const std::size_t changes = 1 + random_() % 3;
    for (std::size_t k = 0; k < changes && !text.empty(); ++k) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  void change(std::string& text) {
    static const std::vector<std::string> kInserts{
        "-",          "nan",   "inf", "\"",     "[",  "]",         "[[",    "=",
        "0",          "1e999", ",",   "\n",     ".",  "#",         "true",  "\xff",
        "{",          "}",     "'",   "1e-320", "\0", "[cloth]\n", "\"/\"", "99999999999999999999",
        "mass = 1\n", "=="};
    const std::size_t at = below(text.size());
    switch (below(6)) {
      case 0:
        text.erase(at, 1 + below(8));
        break;
      case 1:
        text.insert(at, kInserts[below(kInserts.size())]);
        break;
      case 2:
        text[at] = static_cast<char>(random_());
        break;
      case 3:
        text.resize(at);
        break;
      case 4:
        text.insert(at, text.substr(below(text.size()), below(40)));
        break;
      default:  // replaces a digit
        if (const auto digit = text.find_first_of("0123456789", at); digit != text.npos)
          text[digit] = static_cast<char>('0' + below(10));
    }
  }

  std::mt19937 random_{20};
};

void expect_places_inside(const InputError& error, const std::string& file,
                          const std::string& text) {
  const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
  EXPECT_FALSE(error.diagnostics().empty());
  for (const Diagnostic& d : error.diagnostics()) {
    EXPECT_FALSE(d.message.empty());
    if (d.file != file) continue;  // a missing mesh has no line
    EXPECT_GE(d.line, 1) << d.text() << "\n---\n" << text;
    EXPECT_LE(d.line, lines) << d.text() << "\n---\n" << text;
    EXPECT_GE(d.column, 1) << d.text() << "\n---\n" << text;
  }
}

TEST(SceneFuzz, EveryMutantLoadsOrIsRefusedWithItsPlace) {
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes))
    if (entry.path().extension() == ".toml") texts.push_back(slurp(entry.path()));
  std::sort(texts.begin(), texts.end());  // the order of directory entries is unspecified
  const std::string readme = slurp(kScenes / "README.md");
  const auto begin = readme.find("```toml\n") + 8;
  texts.push_back(readme.substr(begin, readme.find("```", begin) - begin));

  const auto file = kScenes / "mutant.toml";  // never written; relative meshes are found beside it
  Mutator mutator;
  int loaded = 0, refused = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::string text = mutator.mutate(texts[static_cast<std::size_t>(k) % texts.size()]);
    try {
      parse_scene(file, text,
                  {"cloth.grid=[4, 3]"});  // small, as a mutant may ask for 9999 x 9999 vertices
      ++loaded;
    } catch (const InputError& error) {
      expect_places_inside(error, file.string(), text);
      ++refused;
    }
  }
  EXPECT_GT(loaded, 100);
  EXPECT_GT(refused, 500);
}

TEST(SceneFuzz, EveryMutantSettingIsAppliedOrRefused) {
  Mutator mutator;
  const std::vector<std::string> settings{"cloth.grid=[4, 3]", "time.dt=\"1/120\"",
                                          "collider.0.radius=0.4", "wind.velocity=[1, 0, 0]"};
  int refused = 0;
  for (int k = 0; k < 400; ++k) try {
      load_scene(kScenes / "hang.toml",
                 {mutator.mutate(settings[static_cast<std::size_t>(k) % settings.size()])});
    } catch (const InputError&) {
      ++refused;
    }
  EXPECT_GT(refused, 100);
}

TEST(SceneFuzz, EveryMutantMeshIsReadOrRefusedWithItsPlace) {
  const std::string quads =
      "# two quads and a triangle\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
      "v 3 0.5 0\nvt 0 0\nf 1 2 5 4\nf 2/1 3/1 6/1 5/1\nf -5 -1 -2\n";
  Mutator mutator;
  int read = 0, refused = 0;
  for (int k = 0; k < 1000; ++k) {
    const std::string text = mutator.mutate(quads);
    try {
      const Polygons p = parse_obj("mutant.obj", text);
      EXPECT_GE(mesh_links(p, {true, true, true}).size(), 3u);
      for (const double m : make_mesh(p, 1, Lumping::area).mass) EXPECT_GT(m, 0);
      ++read;
    } catch (const InputError& error) {
      expect_places_inside(error, "mutant.obj", text);
      ++refused;
    }
  }
  EXPECT_GT(read, 90);  // another digit often makes a quad cross itself
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace taut::scene_fuzz_test
