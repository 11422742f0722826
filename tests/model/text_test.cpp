#include "core/model/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace taut::text_test {
namespace {

TEST(Text, NumbersAreSaidAsTheyAreTyped) {
  EXPECT_EQ(as_typed(1e6), "1e6");
  EXPECT_EQ(as_typed(-2.5e-9), "-2.5e-9");
  EXPECT_EQ(as_typed(1e15), "1e15");
  EXPECT_EQ(as_typed(1e100), "1e100");
  EXPECT_EQ(as_typed(1e-100), "1e-100");
  EXPECT_EQ(as_typed(1000), "1000");
  EXPECT_EQ(as_typed(-0.0), "0");
  for (int power = -300; power <= 300; ++power) {
    const double value = 1.0625 * std::pow(10.0, power);
    EXPECT_EQ(whole<double>(as_typed(value)), value);
  }
}

TEST(Text, OfAShareHasNoDigitOfRounding) {
  EXPECT_EQ(percent(0.5), "50 %");
  EXPECT_EQ(percent(0.07), "7 %") << "100 * 0.07 is 7.000000000000001";
  EXPECT_EQ(percent(1e-4), "0.01 %");
}

TEST(Text, ThatLastsStaysWhereItIs) {
  const std::string_view first = lasting("the first, longer than what a string keeps inside");
  for (int n = 0; n < 1000; ++n) lasting(std::to_string(n));
  EXPECT_EQ(first, "the first, longer than what a string keeps inside");
}

}  // namespace
}  // namespace taut::text_test
