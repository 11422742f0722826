// How errors print texts from outside.
#include "core/model/input_error.hpp"

#include <gtest/gtest.h>

#include "core/model/text.hpp"

namespace taut::input_error_test {
namespace {

TEST(Printable, ControlCharactersDoNotReachATerminal) {
  EXPECT_EQ(printable("a\x1b[31m\x07\r"), "a?[31m??");
  EXPECT_EQ(printable("a\u009b2J\x7f"), "a?2J?");
  EXPECT_EQ(printable("two\nlines\tof ß漢字🙂 \u00a0"), "two\nlines\tof ß漢字🙂 \u00a0");
  EXPECT_EQ(printable("\xc2"), "\xc2");
}

TEST(Printable, ALongTextIsCutBetweenCharacters) {
  EXPECT_EQ(printable(std::string(2000, 'x')).size(), 2000U);
  const std::string cut = printable(std::string(10'000, 'x'));
  EXPECT_EQ(cut.size(), 2003U);
  EXPECT_TRUE(cut.ends_with("xx..."));
  std::string umlauts;
  for (int i = 0; i < 2000; ++i) umlauts += "ü";
  EXPECT_EQ(printable("x" + umlauts), "x" + umlauts.substr(0, 2000) + "...");
}

TEST(Printable, EveryErrorIs) {
  EXPECT_STREQ(InputError("x\x1b[31m").what(), "x?[31m");
  EXPECT_EQ((Diagnostic{"a\x07.toml", 1, 2, "\x1b"}.text()), "a?.toml:1:2: ?");
}

TEST(Suggestion, IsForNamesAndNotForDocuments) {
  EXPECT_EQ(suggestion("iteratons", {"iterations"}), "; did you mean 'iterations'?");
  EXPECT_EQ(suggestion(std::string(201, 'x'), {std::string(200, 'x')}), "");
  EXPECT_NE(suggestion(std::string(200, 'x'), {std::string(199, 'x')}), "");
}

// At most two slips, or one per three letters. A slip is an extra letter, a missing or a wrong one,
// or two swapped neighbours.
TEST(Suggestion, IsTheNearestNameWithinAFewSlips) {
  const auto near = [](const std::string& word, const std::string& name) {
    return !suggestion(word, {name}).empty();
  };
  EXPECT_TRUE(near("tauuut", "taut"));
  EXPECT_FALSE(near("tauuuut", "taut"));
  EXPECT_TRUE(near("ta", "taut"));
  EXPECT_FALSE(near("t", "taut"));
  EXPECT_TRUE(near("xyut", "taut"));
  EXPECT_FALSE(near("xyzt", "taut"));
  EXPECT_TRUE(near("attu", "taut")) << "two swaps";
  EXPECT_FALSE(near("attux", "taut"));
  EXPECT_FALSE(near("abXdeXgX", "abcdefgh"));
  EXPECT_TRUE(near("abXdeXgXi", "abcdefghi")) << "one more for three letters more";
  EXPECT_FALSE(near("abXdeXgXX", "abcdefghi"));
  EXPECT_TRUE(near("abc", "cba")) << "two other letters";
  EXPECT_FALSE(near("abcd", "dcba"));
  EXPECT_EQ(suggestion("hnag", {"hung", "hang", "hand"}), "; did you mean 'hang'?");
  EXPECT_EQ(suggestion("ab", {"ac", "ad"}), "; did you mean 'ac'?") << "the first of equals";
  EXPECT_EQ(suggestion("ab", {}), "");
  EXPECT_EQ(suggestion("iters", {"omega", "iterations"}), "; did you mean 'iterations'?");
  EXPECT_EQ(suggestion("prec", {"precision"}), "; did you mean 'precision'?");
  EXPECT_FALSE(near("itxrs", "iterations"));
  EXPECT_FALSE(near("ite", "iterations")) << "three letters and one that may be wrong";
}

TEST(Diagnostics, SayTheirPlaceAsFarAsItIsKnown) {
  EXPECT_EQ((Diagnostic{"", 3, 4, "m"}.text()), "m");
  EXPECT_EQ((Diagnostic{"f", 3, 4, "m"}.text()), "f:3:4: m");
  EXPECT_EQ((Diagnostic{"f", 3, 0, "m"}.text()), "f:3: m");
  EXPECT_EQ((Diagnostic{"f", 0, 4, "m"}.text()), "f: column 4: m");
  EXPECT_EQ((Diagnostic{"f", 0, 0, "m"}.text()), "f: m");
  EXPECT_STREQ(InputError({{"f", 1, 2, "a"}, {"g", 0, 0, "b"}}).what(), "f:1:2: a\ng: b");
}

}  // namespace
}  // namespace taut::input_error_test
