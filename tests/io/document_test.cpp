// Documents: types and places of values, the effect of a setting, limits of depth and length.

#include "core/io/document.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/io/scene_io.hpp"
#include "core/model/index.hpp"

namespace taut::document_test {
namespace {

Value root_of(const std::string& text, const SceneSettings& settings = {}) {
  return parse_document("x", text, settings).root;
}

std::string problems(const std::string& text, const SceneSettings& settings = {}) {
  try {
    root_of(text, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Document, KnowsEachKindOfValueAndWhereItStands) {
  const Value root = root_of(
      "yes = true\n  no = false\ni = -7\nr = 1.5\ns = 'a \"b\"'\nl = [1, 2.5, 'z']\nd = "
      "1979-05-27\n"
      "[t]\nu = {v = 9}\n");
  const auto at = [&](const char* key) -> const Value& { return *root.find(key); };
  const std::vector<std::pair<const char*, std::string>> described{{"yes", "true"},
                                                                   {"no", "false"},
                                                                   {"i", "a whole number"},
                                                                   {"r", "a number"},
                                                                   {"s", "the string \"a \"b\"\""},
                                                                   {"l", "an array of 3"},
                                                                   {"d", "a date or time"},
                                                                   {"t", "a table"}};
  for (const auto& [key, text] : described) EXPECT_EQ(describe(at(key)), text);
  EXPECT_EQ(at("i").number, -7);
  EXPECT_EQ(at("r").number, 1.5);
  EXPECT_TRUE(at("i").is_number() && at("r").is_number() && !at("s").is_number());
  EXPECT_TRUE(at("l").is_array() && at("t").is_table() && at("s").is_string());
  EXPECT_FALSE(at("l").is_table() || at("t").is_array() || at("i").is_string());
  EXPECT_EQ(at("l").items[1].number, 2.5);
  EXPECT_EQ(at("t").find("u")->find("v")->number, 9);
  EXPECT_EQ(root.find("u"), nullptr);
  EXPECT_EQ(at("l").find("1"), nullptr) << "no table";
  const auto place = [](const SourceLocation& p) {
    return std::vector{p.line, p.column, p.setting};
  };
  EXPECT_EQ(place(at("no").place), (std::vector{2, 8, -1}));
  EXPECT_EQ(place(at("l").items[2].place), (std::vector{6, 14, -1}));
  for (const Key& key : root.keys)
    if (key.text == "no") {
      EXPECT_EQ(place(key.place), (std::vector{2, 3, -1}));
    }
}

std::string dotted(int parts) {
  std::string key = "p";
  for (int k = 1; k < parts; ++k) key += ".p";
  return key;
}

TEST(Document, AKeyHasSixteenPartsAtMost) {
  EXPECT_EQ(problems(dotted(16) + " = 1"), "none");
  EXPECT_EQ(problems(dotted(17) + " = 1"), "x:1:1: a key of more than 16 parts");
  EXPECT_EQ(problems("a = 1\nb = 2\n   " + dotted(17) + " = 1\n"),
            "x:3:4: a key of more than 16 parts");
  EXPECT_EQ(problems("[ " + dotted(17) + " ]"), "x:1:3: a key of more than 16 parts");
  EXPECT_EQ(problems("a = '" + dotted(30) + "'\n"), "none") << "a text has no parts";
  EXPECT_EQ(problems("a = \"" + dotted(30) + "\"\n"), "none");
  const std::string quoted = "'a.b' . \"c\" ." + dotted(14);
  EXPECT_EQ(problems(quoted + " = 1"), "none") << "a quoted part is one";
  EXPECT_EQ(problems("c-d_E9." + quoted + " = 1"), "x:1:1: a key of more than 16 parts");
  EXPECT_EQ(problems("a = 1", {dotted(17) + "=1"}),
            dotted(17) + "=1: column 1: a key of more than 16 parts");
}

TEST(Document, ValuesLieSixtyFourLevelsDeepAtMost) {
  const auto nested = [](std::size_t arrays) {
    return "a = " + std::string(arrays, '[') + std::string(arrays, ']');
  };
  EXPECT_EQ(problems(nested(64)), "none");
  EXPECT_EQ(problems(nested(65)), "x:1:69: nested more than 64 levels deep");
  std::string tables = "1";
  for (int k = 0; k < 62; ++k) tables = "{t = " + tables + "}";
  EXPECT_EQ(problems("a = {t = " + tables + "}"), "none");
  EXPECT_NE(problems("a = {t = {t = " + tables + "}}").find("nested more than 64 levels deep"),
            std::string::npos);
}

TEST(Settings, ReplaceAddMergeAndPickElements) {
  const std::string text = "n = 1\nlist = [10, 20, {k = 30}]\n[t]\na = 1\nb = 2\n";
  const auto number = [&](const std::string& setting, const std::vector<const char*>& path) {
    const Value root = root_of(text, {setting});
    const Value* value = &root;
    for (const char* step : path)
      value = value->is_array() ? &value->items[to_index(std::stoi(step))] : value->find(step);
    return value ? value->number : -1;
  };
  EXPECT_EQ(number("n=5", {"n"}), 5);
  EXPECT_EQ(number("new=5", {"new"}), 5);
  EXPECT_EQ(number("t.a=5", {"t", "a"}), 5);
  EXPECT_EQ(number("t.a=5", {"t", "b"}), 2) << "the rest stays";
  EXPECT_EQ(root_of(text, {"t={a=5}"}).find("t")->items.size(), 1u) << "written whole: replaced";
  EXPECT_EQ(number("list.0=5", {"list", "0"}), 5);
  EXPECT_EQ(number("list.2.k=5", {"list", "2", "k"}), 5);
  EXPECT_EQ(number("list.2.k=5", {"list", "1"}), 20);
  EXPECT_EQ(number("n.deep.er=5", {"n", "deep", "er"}), 5) << "the schema judges";
  EXPECT_EQ(root_of(text, {"n=5"}).find("n")->place.setting, 0);
  EXPECT_EQ(root_of(text, {"n=5", "t.c=1"}).find("t")->find("c")->place.setting, 1);
  EXPECT_EQ(root_of(text, {"n=5"}).find("list")->place.setting, -1);
}

TEST(Settings, EachThatIsWrongIsNamed) {
  const std::string text = "list = [10, 20, 30]\n";
  const auto element = [&](const std::string& setting, const std::string& name) {
    EXPECT_EQ(problems(text, {setting}),
              setting + ": column 1: no element '" + name + "' among the 3 of this array");
  };
  element("list.3=1", "3");
  element("list.x=1", "x");
  element("list.1x=1", "1x");
  element("list.-1=1", "-1");
  EXPECT_EQ(problems("list = [\n", {"list.7=1", "a=", "b=1"}).rfind("x:1:", 0), 0u);
  const std::string all = problems(text, {"list.7=1", "b=1", "list.8=1"});
  EXPECT_EQ(all,
            "list.7=1: column 1: no element '7' among the 3 of this array\n"
            "list.8=1: column 1: no element '8' among the 3 of this array");
  EXPECT_EQ(problems("", {"a="}).rfind("a=: column ", 0), 0u);
}

TEST(Document, SyntaxErrorsLieInsideTheText) {
  const auto begins = [](const std::string& text, const std::string& place) {
    EXPECT_EQ(problems(text).rfind(place, 0), 0u) << problems(text);
  };
  begins("a = [", "x:1:");
  begins("a = [\n", "x:1:");
  begins("a = 1\nb = [\n", "x:2:");
  begins("a = 1\nb = [", "x:2:");
  begins("a = 1\na = 2\n", "x:2:");
  begins("=", "x:1:1:");
}

bool same(const Value& a, const Value& b) {
  if (a.kind != b.kind || a.boolean != b.boolean || a.number != b.number || a.string != b.string ||
      a.items.size() != b.items.size() || a.keys.size() != b.keys.size())
    return false;
  for (std::size_t i = 0; i < a.keys.size(); ++i)
    if (!b.find(a.keys[i].text) || !same(a.items[i], *b.find(a.keys[i].text))) return false;
  for (std::size_t i = 0; a.keys.empty() && i < a.items.size(); ++i)
    if (!same(a.items[i], b.items[i])) return false;
  return true;
}

TEST(Document, IsReadBackAsItWasWritten) {
  const Value root = root_of(
      "a = true\nb = -3\nc = 0.1\nd = \"it's \\\"x\\\"\\n\"\ne = [[1, 2.0], [], ['y', {z = "
      "1}]]\n[f.g]\nh = 1e300\n"
      "[[k]]\nm = 1\n[[k]]\nm = 2\n");
  EXPECT_TRUE(same(root_of(to_toml(root)), root)) << to_toml(root);
  EXPECT_FALSE(same(root_of(to_toml(root), {"k.1.m=3"}), root));
  EXPECT_TRUE(to_toml(root).ends_with("\n"));
  try {
    to_toml(root_of("d = 1979-05-27"));
    ADD_FAILURE() << "was written";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "a date or time cannot be written");
  }
}

TEST(Numbers, AreDecimalsOrFractions) {
  EXPECT_EQ(parse_number("1/64"), 0.015625);
  EXPECT_EQ(parse_number("-3/4"), -0.75);
  EXPECT_EQ(parse_number("2.5e-1"), 0.25);
  EXPECT_EQ(parse_number("1/-8"), -0.125);
  for (const char* wrong :
       {"", "/", "1/", "/2", "1/2/3", " 1", "1 ", "0x10", "nan", "inf", "1/inf", "one"}) {
    try {
      parse_number(wrong);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(),
                "'" + std::string(wrong) + "' is not a number; write 0.015625 or \"1/64\"");
    }
  }
  EXPECT_THROW(parse_number("1/0"), InputError);
  EXPECT_EQ(as_number(root_of("a = '1/4'").items[0]), 0.25);
  EXPECT_EQ(as_number(root_of("a = 3").items[0]), 3);
  EXPECT_FALSE(as_number(root_of("a = 'x'").items[0]));
  EXPECT_FALSE(as_number(root_of("a = true").items[0]));
}

TEST(Ranges, HoldTheirBordersAndSaySo) {
  const Range positive = Range::positive(10), from_zero = Range::non_negative(10),
              within = Range::within(2.5);
  EXPECT_FALSE(positive.holds(0));
  EXPECT_TRUE(positive.holds(1e-300) && positive.holds(10) && !positive.holds(10.001));
  EXPECT_TRUE(from_zero.holds(0) && from_zero.holds(10) && !from_zero.holds(-1e-300));
  EXPECT_TRUE(within.holds(-2.5) && within.holds(2.5) && !within.holds(-2.501) &&
              !within.holds(2.501));
  EXPECT_EQ(positive.text(), "greater than 0 and at most 10");
  EXPECT_EQ(from_zero.text(), "at least 0 and at most 10");
  EXPECT_EQ(within.text(), "at least -2.5 and at most 2.5");
  EXPECT_EQ((Range{.min = 3}.text()), "at least 3");
  EXPECT_EQ((Range{.max = 3}.text()), "at most 3");
}

}  // namespace
}  // namespace taut::document_test
