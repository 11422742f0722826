// Limits that scenes accept by default, and limits given by `--keep VALUE:LIMIT`.
#include "experiments/study/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/case/case.hpp"

namespace taut::limits_test {
namespace {

Scene scene_of(const char* name) { return *make_case({name, {}, "jakobsen"}).scene; }

TEST(Limits, AreByDefaultOfContactAndOfStrain) {
  const auto limits = [](const char* scene) {
    std::map<std::string, double> all;
    for (const Limit& limit : default_limits(scene_of(scene))) all[limit.name] = limit.most;
    return all;
  };
  EXPECT_EQ(limits("swing"), (std::map<std::string, double>{{"stretch.rms", 0.1}}));
  EXPECT_GT(limits("ball").at("penetration.peak"), 0);
  EXPECT_EQ(limits("ball").at("tunnelling.events"), 0);
}

TEST(Limits, AreSharesOfTheSceneOrNumbersInUnits) {
  const Scene ball = scene_of("ball");
  const auto most = [&](const char* asked) { return parse_limit(asked, ball).most; };
  EXPECT_DOUBLE_EQ(most("penetration.peak:3mm"), 0.003);
  EXPECT_DOUBLE_EQ(most("penetration.peak:0.003"), 0.003);
  EXPECT_DOUBLE_EQ(most("penetration.peak:1%"), 0.01 * extent(ball));
  EXPECT_DOUBLE_EQ(most("settle.time:50%"), 0.5 * ball.duration());
  EXPECT_DOUBLE_EQ(most("stretch.rms:2%"), 0.02);
  EXPECT_EQ(most("tunnelling.events:0"), 0);
  const auto wrong = [&](const char* asked) -> std::string {
    try {
      parse_limit(asked, ball);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(wrong("stretch.rms"),
            "--keep stretch.rms: expected a limit after ':', as in stretch.rms:1%");
  EXPECT_EQ(wrong("motion.error:1%"), "--keep motion.error:1%: has no value on this scene");
  EXPECT_TRUE(wrong("strech.rms:1%").ends_with("; did you mean 'stretch.rms'?"));
  EXPECT_EQ(wrong("energy.mean:5%"),
            "--keep energy.mean:5%: expected a number of at least 0 after ':'")
      << "5 % of what the case has not yet";
  EXPECT_TRUE(wrong("penetration.peak:1s").ends_with(" after ':' and then 'mm', '%' or nothing"));
}

TEST(Limits, DependOnWhatAValueIsAndNotOnHowItIsShown) {
  using Kind = Unit::Kind;
  const Scene ball = scene_of("ball");
  EXPECT_EQ(hundred_percent({Kind::length, "cm", "in"}, ball), extent(ball));
  EXPECT_EQ(hundred_percent({Kind::time, "h", "min"}, ball), ball.duration());
  for (const bool logarithmic : {true, false}) {
    EXPECT_EQ(hundred_percent({Kind::share, "1", "per mille", 1e3, logarithmic}, ball), 1);
    EXPECT_TRUE(std::isnan(hundred_percent({Kind::count, "1", "%", 100, logarithmic}, ball)));
    EXPECT_TRUE(std::isnan(hundred_percent({Kind::other, "m", "%", 100, logarithmic}, ball)));
  }
  EXPECT_DOUBLE_EQ(number_of_kept("v:5%", {Kind::other, "V", "%", 100}, 8), 0.4)
      << "5 % of what 100 % is";
  EXPECT_THROW(number_of_kept("v:5 per mille", {Kind::share, "1", " per mille", 1e3}, 1),
               InputError);
}

TEST(Limits, ThatACaseGoesBeyondAreNamed) {
  Record record;
  record.values = {{"tunnelling.events", 2}, {"penetration.peak", -0.0031}, {"stretch.rms", 0.1}};
  EXPECT_EQ(beyond(record, {{"penetration.peak", 0.001},
                            {"stretch.rms", 0.1},
                            {"motion.error", 0.25},
                            {"tunnelling.events", 0}}),
            "penetration.peak 3.1 mm, more than 1 mm; tunnelling.events 2, more than 0");
  EXPECT_EQ(beyond(record, {}), "");
}

}  // namespace
}  // namespace taut::limits_test
