// A scene's digest is the address of all its stored results, so it must never change.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/data.hpp"

namespace taut::scene_digests_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRecorded = fs::path(TAUT_SOURCE_DIR) / "tests/case/scene_digests.txt";

/// Random scene files. Each key is present in about half of them; every run makes the same files.
class MadeUp {
 public:
  explicit MadeUp(unsigned seed) : random_(seed) {}

  std::string scene() {
    text_ = "summary = \"made up\"\n";
    fabric_ = coin();
    if (fabric_) line("fabric", "\"petrak-m3\"");
    cloth();
    links();
    if (fabric_ || coin()) bending();
    if (coin()) {
      section("forces");
      maybe("gravity", vec(10));
      maybe("damping", number(0, 2));
    }
    if (coin()) wind();
    for (const char* type : {"plane", "ball", "box", "capsule"})
      if (coin()) collider(type);
    if (coin()) pin_motion();
    if (coin()) {
      section("self_collision");
      line("radius", number(0.001, 0.01));
      line("overlap", flag());
    }
    section("time");
    maybe("dt", coin() ? "\"1/120\"" : number(0.001, 0.1));
    maybe("duration", number(0.1, 20));
    return text_;
  }

 private:
  bool coin() { return random_() % 2 == 0; }
  std::string number(double low, double high) {
    return shortest(low + (high - low) * static_cast<double>(random_() % 10007) / 10007);
  }
  std::string flag() { return coin() ? "true" : "false"; }
  std::string vec(double bound) {
    const std::string x = number(-bound, bound), y = number(-bound, bound);
    return "[" + x + ", " + y + ", " + number(-bound, bound) + "]";
  }
  void section(const std::string& name) { text_ += "[" + name + "]\n"; }
  void line(const std::string& key, const std::string& value) {
    text_ += key + " = " + value + "\n";
  }
  void maybe(const std::string& key, const std::string& value) {
    if (coin()) line(key, value);
  }

  void cloth() {
    section("cloth");
    if (random_() % 4 == 0) {
      line("mesh", "\"disc.obj\"");
      maybe("scale", number(0.5, 2));
      maybe("rotation", rotation());
    } else {
      line("grid", "[" + std::to_string(3 + random_() % 5) + ", 4]");
      line("size", "[1.5, " + number(0.5, 2) + "]");
      maybe("u", "[1, " + number(-0.5, 0.5) + ", 0]");
      maybe("v", "[0, -1, " + number(-0.5, 0.5) + "]");
      maybe("span", number(0.5, 1.5));
      maybe("tilt", number(-90, 90));
    }
    maybe("origin", vec(2));
    // separate statements here and below, since compilers evaluate arguments in any order
    if (coin()) {
      const std::string mass = number(0.1, 2);
      const bool whole = coin();
      if (!fabric_) line(whole ? "mass" : "area_density", mass);
    }
    maybe("lumping", coin() ? "\"equal\"" : "\"area\"");
    maybe("stretch", number(0.5, 2));
    maybe("weights", "[{ vertices = [0, 2], factor = " + number(0.5, 2) + " }]");
    line("pins", "[1, 3]");
    maybe("placed", "[{ vertex = 5, at = " + vec(1) + " }]");
    maybe("velocity", vec(3));
    maybe("thickness", number(0.001, 0.01));
    line("start_inside", "\"resolve\"");
  }

  void links() {
    section("links");
    maybe("structural", "true");
    maybe("shear", flag());
    maybe("bend", flag());
    const std::string structural = number(100, 1000), bend = number(1, 10);
    maybe("stiffness", "{ structural = " + structural + ", bend = " + bend + " }");
  }

  void bending() {
    section("bending");
    const std::string stiffness =
        coin() ? number(1e-6, 1e-3) : "{ warp = " + number(1e-6, 1e-3) + ", weft = 2e-5 }";
    if (!fabric_) line("stiffness", stiffness);
    line("warp", "[0, 1, " + number(-1, 1) + "]");
  }

  void wind() {
    section("wind");
    maybe("velocity", vec(5));
    maybe("strength", number(0.05, 1));
    maybe("law", coin() ? "\"literal\"" : "\"relative\"");
  }

  std::string rotation() {
    const bool about_axis = coin();
    const std::string y = number(-1, 1);
    return about_axis ? "{ axis = [0, 1, " + y + "], angle = " + number(-180, 180) + " }"
                      : "[1, " + y + ", 0.5, 0]";
  }

  void motion() {
    maybe("velocity", vec(1));
    maybe("spin", vec(3));
    maybe("pivot", vec(1));
    maybe("path",
          "[{ t = 0, displacement = [0, 0, 0] }, { t = 2, displacement = " + vec(0.1) + " }]");
  }

  /// Collider far below the cloth, so that the cloth starts outside.
  void collider(const std::string& type) {
    section("[collider]");
    line("type", "\"" + type + "\"");
    const std::string x = number(-1, 1), center = "[" + x + ", -50, 0]";
    if (type == "plane") {
      line("normal", "[0, 1, " + number(-0.1, 0.1) + "]");
      line("offset", "-30");
    }
    if (type == "ball" || type == "box") line("center", center);
    if (type == "box") line("half_extents", "[1, 2, " + number(1, 3) + "]");
    if (type == "box") maybe("rotation", rotation());
    if (type == "capsule") {
      line("from", center);
      line("to", "[3, -55, 0]");
    }
    if (type == "ball" || type == "capsule") line("radius", number(0.5, 3));
    maybe("friction", number(0, 1));
    motion();
  }

  void pin_motion() {
    section("[pin_motion]");
    line("vertices", "[1]");
    motion();
  }

  std::mt19937 random_;
  std::string text_;
  bool fabric_ = false;  ///< fabric sets the mass and the stiffness, so that the scene must not
};

std::map<std::string, std::string> digests() {
  std::map<std::string, std::string> all;
  const fs::path folder = data_folder() / "scenes";
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".toml")
      all[fs::relative(entry.path(), folder).replace_extension().string()] =
          digest(load_scene(entry.path()));
  for (unsigned seed = 0; seed < 64; ++seed)
    all["made-up-" + std::to_string(seed)] =
        digest(parse_scene(folder / "made-up.toml", MadeUp(seed).scene()));
  return all;
}

/// TAUT_WRITE_DIGESTS=1 in the environment records the digests anew. Results stored for such scenes
/// are then no longer found.
TEST(SceneDigests, AreTheRecordedOnes) {
  const auto now = digests();
  if (std::getenv("TAUT_WRITE_DIGESTS")) {
    std::ofstream out(kRecorded);
    for (const auto& [name, digest] : now) out << name << ' ' << digest << '\n';
  }
  std::map<std::string, std::string> recorded;
  std::ifstream in(kRecorded);
  for (std::string name, digest; in >> name >> digest;) recorded[name] = digest;
  EXPECT_GT(recorded.size(), 80u);
  for (const auto& [name, digest] : recorded) {
    ASSERT_TRUE(now.count(name)) << name << " is gone";
    EXPECT_EQ(now.at(name), digest) << name << " is another scene than it was";
  }
  for (const auto& [name, digest] : now)
    EXPECT_TRUE(recorded.count(name)) << name << " is not recorded: " << digest;
}

}  // namespace
}  // namespace taut::scene_digests_test
