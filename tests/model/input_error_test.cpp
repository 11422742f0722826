// What errors print of texts from outside.
#include "core/model/input_error.hpp"

#include <gtest/gtest.h>

#include "core/model/text.hpp"

namespace taut {
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
}

}  // namespace
}  // namespace taut
