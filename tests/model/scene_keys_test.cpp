// The table of keys: its entries, and that every member of a scene that has a key counts in its
// content.
#include "core/model/scene_keys.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/model/triangle_mesh.hpp"

namespace taut::scene_keys_test {
namespace {

TEST(SceneKeys, SayWhatIsAllowedAndWhatIsTheDefault) {
  const auto said = [](const char* path) {
    const SceneKey* key = find_scene_key(path);
    return key ? std::string(key->type) + ", " + key->allowed() + ", " + key->default_text()
               : "none";
  };
  EXPECT_EQ(said("forces.damping"), "number, 0 to 1e6, 0");
  EXPECT_EQ(said("forces.gravity"), "vector, within 1e6, [0, -9.81, 0]");
  EXPECT_EQ(said("cloth.v"), "direction, not zero; not parallel to u, [0, -1, 0]");
  EXPECT_EQ(said("cloth.mass"), "number, 1e-9 to 1e9, by area_density");
  EXPECT_EQ(said("links.shear"), "boolean, , true");
  EXPECT_EQ(said("wind.law"), "string, \"relative\" or \"literal\", \"relative\"");
  EXPECT_EQ(said("self_collision.radius"),
            "number, above 0, at most 1e6; at most half the spacing, needed");
  EXPECT_EQ(said("cloth.pins"), "vertices, , none");
  EXPECT_EQ(said("collider.3.velocity.1"), said("collider.velocity")) << "of an element";
  EXPECT_EQ(said("summary"), "string, , \"\"");
  EXPECT_EQ(said("forces.dampin"), "none");
  EXPECT_EQ(find_scene_key("forces.damping")->section(), "forces");
  EXPECT_EQ(find_scene_key("forces.damping")->name(), "damping");
  EXPECT_EQ(find_scene_key("summary")->section(), "");
  EXPECT_EQ(find_scene_key("summary")->name(), "summary");
}

// A look-up of a path returns the first row that has it.
TEST(SceneKeys, OfOnePathSayTheSame) {
  const auto said = [](const SceneKey& key) {
    return std::tuple(key.type, key.unit, key.range.min, key.range.max, key.range.above_min,
                      key.choices, key.example);
  };
  for (const SceneKey& key : scene_keys())
    EXPECT_EQ(said(key), said(*find_scene_key(key.path))) << key.path;
}

void move(double& value) { value += 1; }
void move(bool& value) { value = !value; }
void move(Vec3& value) { value.y() += 1; }
template <class Enumeration>
requires std::is_enum_v<Enumeration>
void move(Enumeration& value) { value = static_cast<Enumeration>(value == Enumeration{} ? 1 : 0); }

/// Scene that has every optional part to which keys belong.
Scene scene_of_all() {
  Scene scene;
  scene.wind.emplace();
  scene.self_collision.emplace();
  scene.bending.emplace();
  const auto triangle = std::make_shared<const TriangleMesh>(
      std::vector<Vec3>{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()},
      std::vector<Triangle>{{0, 1, 2}});
  scene.colliders = {{Plane{}}, {Ball{}}, {Box{}}, {Capsule{}}, {MeshBody{triangle}}};
  scene.pin_motions = {{{0}, {}}};
  return scene;
}

/// Calls visit for each part of a scene that has keys, with its section.
template <class Visit>
void each_part(Scene& scene, const Visit& visit) {
  visit("forces", scene);
  visit("links", scene);
  visit("cloth", scene);
  visit("wind", *scene.wind);
  visit("bending", *scene.bending);
  visit("self_collision", *scene.self_collision);
  for (Collider& collider : scene.colliders) {
    visit("collider", collider);
    visit("collider", collider.motion);
    std::visit([&](auto& shape) { visit("collider", shape); }, collider.shape);
  }
  for (PinMotion& group : scene.pin_motions) visit("pin_motion", group.motion);
}

TEST(SceneKeys, EachThatIsAMemberOfASceneIsPartOfItsContent) {
  const std::string before = content(scene_of_all());
  int parts = 0;
  each_part(*std::make_unique<Scene>(scene_of_all()), [&](auto...) { ++parts; });
  std::set<std::string> counted;
  for (int p = 0; p < parts; ++p)
    for (std::size_t k = 0; k < scene_keys().size(); ++k) {
      Scene scene = scene_of_all();
      const SceneKey& chosen = scene_keys()[k];
      int at = 0;
      bool moved = false;
      each_part(scene, [&](const char* section, auto& part) {
        if (at++ != p) return;
        each_key(section, part, [&](const SceneKey& key, auto& value, const auto&) {
          if (&key == &chosen) {
            move(value);
            moved = true;
          }
        });
      });
      if (!moved) continue;
      counted.emplace(chosen.path);
      EXPECT_NE(content(scene), before) << chosen.path;
    }
  EXPECT_TRUE(counted.count("forces.damping") && counted.count("wind.law") &&
              counted.count("collider.half_extents") && counted.count("bending.warp") &&
              counted.count("pin_motion.spin"));
  EXPECT_GE(counted.size(), 19u);
}

// A row may have any section, since code that reads, hashes or writes a scene has no list of keys.
TEST(SceneKeys, ThatIsAMemberCountsInWhateverSectionItStands) {
  std::vector<SceneKey> keys(scene_keys().begin(), scene_keys().end());
  for (SceneKey& key : keys)
    if (key.path == "forces.damping") key.path = "time.damping";
  Scene scene = scene_of_all();
  scene.damping = 0.5;
  EXPECT_NE(content(scene, keys), content(scene_of_all(), keys));
}

// Tests each key as if it had been added later. A scene with the key's default then has the content
// from before the key, and every other value has a content of its own.
TEST(SceneKeys, OneThatCameLaterCountsOffItsDefault) {
  const std::vector<SceneKey> known(scene_keys().begin(), scene_keys().end());
  const Scene initial = scene_of_all();
  std::size_t later = 0;
  for (std::size_t k = 0; k < known.size(); ++k) {
    std::vector<SceneKey> before = known, now = known;
    before.erase(before.begin() + static_cast<std::ptrdiff_t>(k));
    now[k] = known[k].came_later(5);
    EXPECT_EQ(content(initial, now), content(initial, before)) << known[k].path;
    EXPECT_TRUE(later_keys(initial, now).empty()) << known[k].path;
    if (content(initial) == content(initial, before)) continue;  // not a member of a scene
    Scene scene = initial;
    bool moved = false;
    each_part(scene, [&](const char* section, auto& part) {
      const auto visit = [&](const SceneKey& key, auto& value, const auto&) {
        if (&key == &now[k] && !moved) {
          move(value);
          moved = true;
        }
      };
      each_key(section, part, visit, now);
    });
    ASSERT_TRUE(moved) << known[k].path;
    EXPECT_NE(content(scene, now), content(initial, now)) << known[k].path;
    const std::vector<LaterKey> found = later_keys(scene, now);
    ASSERT_EQ(found.size(), 1u) << known[k].path;
    EXPECT_EQ(found[0].path, known[k].path);
    EXPECT_EQ(found[0].since, 5) << "of this row, whatever other rows of that name say";
    EXPECT_TRUE(later_keys(scene).empty()) << "none of this program's keys came later";
    ++later;
  }
  EXPECT_GE(later, 19u);
}

// The same value at another key is another scene.
TEST(SceneKeys, OneThatCameLaterCountsWithItsPlace) {
  std::vector<SceneKey> keys(scene_keys().begin(), scene_keys().end());
  for (SceneKey& key : keys)
    if (key.path == "collider.friction" || key.path == "forces.damping") key = key.came_later(5);
  std::set<std::string> contents;
  for (std::size_t c = 0; c < 4; ++c) {
    Scene scene = scene_of_all();
    scene.colliders[c].friction = 0.5;
    contents.insert(content(scene, keys));
    scene.colliders[c].friction = 0;
    scene.damping = 0.5 + static_cast<double>(c);
    contents.insert(content(scene, keys));
  }
  EXPECT_EQ(contents.size(), 8u);
}

}  // namespace
}  // namespace taut::scene_keys_test
