// Settings of a scene: key and value of a text in each of its spellings, and lists of settings.
#include "core/model/scene_setting.hpp"

#include <gtest/gtest.h>

namespace taut::scene_setting_test {
namespace {

TEST(SceneSetting, HasOneTextHoweverItIsWritten) {
  const SceneSetting plain("cloth.grid=[4, 4]"), spaced(" time . dt\t= \"1/64\" ");
  EXPECT_EQ(plain.key() + "|" + plain.value(), "cloth.grid|[4, 4]");
  EXPECT_EQ(plain, SceneSetting("cloth.grid", "[4, 4]"));
  EXPECT_EQ(spaced.key() + "|" + spaced.value(), "time.dt|\"1/64\"");
  EXPECT_EQ(spaced.text(), "time.dt=\"1/64\"");
  EXPECT_EQ(spaced.written(), " time . dt\t= \"1/64\" ");
  EXPECT_EQ(spaced, SceneSetting("time.dt", "\"1/64\""));
  EXPECT_TRUE(spaced.is_of_time() && !plain.is_of_time());
  EXPECT_EQ(SceneSetting("a.\"b\"='c=d'").key(), "a.b");
  EXPECT_EQ(SceneSetting("a.\"b\"='c=d'").value(), "'c=d'");
  EXPECT_EQ(SceneSetting("no key=").value() + SceneSetting("nokey").value(), "");
  EXPECT_EQ(SceneSetting("nokey").key(), "nokey");
}

TEST(SceneSetting, OfASceneHasADotOrIsTheFabric) {
  EXPECT_TRUE(is_of_scene("time.dt") && is_of_scene("collider.0.radius") && is_of_scene("fabric"));
  EXPECT_FALSE(is_of_scene("dt") || is_of_scene("xpbd:structural") || is_of_scene(""));
}

TEST(SceneSetting, TheLastOfAKeyCounts) {
  const SceneSettings all{"a.b=1", "a.bc=2", "a.b = 3"};
  EXPECT_EQ(find_setting(all, "a.b"), &all[2]);
  EXPECT_EQ(find_setting(all, "a"), nullptr);
  EXPECT_EQ(without(all, "a.b"), SceneSettings{"a.bc=2"});
  EXPECT_EQ(replaced(all, {"a.b=4", "x=5"}), (SceneSettings{"a.bc=2", "a.b=4", "x=5"}));
}

}  // namespace
}  // namespace taut::scene_setting_test
