// JSON that is written and read back: texts are unchanged, and errors have file, line and place.
#include "experiments/system/json.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

namespace taut::json_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(JsonText, IsInOrderAndReplacesWhatIsNotUtf8) {
  EXPECT_EQ(to_text({{"z", 1}, {"a", {0.1, nullptr, true}}}), R"({"z":1,"a":[0.1,null,true]})");
  EXPECT_EQ(to_text({{"z", Json::array({1, 2})}}, 2), "{\n  \"z\": [\n    1,\n    2\n  ]\n}");
  EXPECT_EQ(to_text("a\xff"), "\"a\xEF\xBF\xBD\"");
  EXPECT_EQ(parse_json(R"({"z":1,"a":2})"), (Json{{"z", 1}, {"a", 2}}));
  EXPECT_EQ(json_number(-2.5), -2.5);
  EXPECT_TRUE(json_number(std::nan("")).is_null());
  EXPECT_TRUE(json_number(-kInfinity).is_null());
}

TEST(JsonText, ANulByteIsNoEnd) {
  EXPECT_THROW(parse_json(std::string_view("{}\0", 3)), Json::exception);
  EXPECT_THROW(parse_json(std::string_view("{}\0{", 4)), Json::exception);
  EXPECT_EQ(parse_json("{}"), Json::object());
}

TEST(JsonText, AFieldIsAddedUnlessItIsEmpty) {
  Json object{{"first", 1}};
  for (const Json& empty : {Json(""), Json(), Json::array(), Json::object()})
    add_if(object, "none", empty);
  EXPECT_EQ(to_text(object), R"({"first":1})");
  const Json given[] = {" ", 0, false, Json::array({nullptr}), Json{{"a", ""}}};
  for (std::size_t i = 0; i < std::size(given); ++i)
    add_if(object, std::string(1, static_cast<char>('a' + i)).c_str(), given[i]);
  EXPECT_EQ(to_text(object), R"({"first":1,"a":" ","b":0,"c":false,"d":[null],"e":{"a":""}})");
}

/// Message about a value that `read` refuses; "" if it accepts the value.
template <class Read>
std::string wrong(const Json& json, const Read& read) {
  try {
    read(JsonReader(json, "x.json", 7));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

struct Part {
  std::string name;
  bool whole = false;
  std::size_t count = 0;
  double size = 1, known = std::nan("");
};
constexpr std::tuple kFields{Field{"name", &Part::name}, Field{"whole", &Part::whole},
                             Field{"count", &Part::count}, Field{"size_m", &Part::size},
                             Field{"known", &Part::known}};

TEST(Fields, WriteAStructInTheirOrderAndReadItBack) {
  const Json json = json_of(Part{"a", true, 3, 0.1, 2}, kFields);
  EXPECT_EQ(to_text(json), R"({"name":"a","whole":true,"count":3,"size_m":0.1,"known":2.0})");
  const Part back = read_as(JsonReader(json, "x.json"), kFields);
  EXPECT_EQ(to_text(json_of(back, kFields)), to_text(json));
}

TEST(Fields, NullIsReadOnlyWhereANumberMayBeUnknown) {
  const std::string unknown = to_text(json_of(Part{}, kFields));
  EXPECT_EQ(unknown, R"({"name":"","whole":false,"count":0,"size_m":1.0,"known":null})");
  const auto read = [](const JsonReader& j) { return read_as(j, kFields); };
  EXPECT_TRUE(std::isnan(read_json(unknown, "x.json", read).known));
  Json json = parse_json(unknown);
  json["size_m"] = nullptr;
  EXPECT_EQ(wrong(json, read), "x.json:7: size_m: expected a number");
  json["size_m"] = 1;
  json["count"] = -1;
  EXPECT_EQ(wrong(json, read), "x.json:7: count: expected a count");
  json.erase("name");
  EXPECT_EQ(wrong(json, read), "x.json:7: has no 'name'");
}

TEST(JsonText, AnArrayIsMadeItemByItemAndIsThereWithoutItems) {
  const auto square = [](int n) -> Json { return {{"square", n * n}}; };
  EXPECT_EQ(to_text(json_array(std::vector{2, 3}, square)), R"([{"square":4},{"square":9}])");
  EXPECT_EQ(to_text(json_array(std::vector<int>{}, square)), "[]");
}

TEST(JsonReader, NamesFileLineAndThePlaceWithinTheText) {
  const Json json =
      parse_json(R"({"scenes": [{}, {"cases": [1, {"n": "x"}]}], "list": [[1, 2], 3]})");
  const auto deep = [](const JsonReader& j) {
    return j.at("scenes").items()[1].at("cases").items()[1];
  };
  EXPECT_EQ(wrong(json, [&](const JsonReader& j) { deep(j).at("n").number(); }),
            "x.json:7: scenes[1].cases[1].n: expected a number");
  EXPECT_EQ(wrong(json, [&](const JsonReader& j) { deep(j).at("m"); }),
            "x.json:7: scenes[1].cases[1]: has no 'm'");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.at("list").items()[0].items(3); }),
            "x.json:7: list[0]: has 2 items, not 3");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.at("list").items()[1].items(); }),
            "x.json:7: list[1]: expected an array");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.at("list").members(); }),
            "x.json:7: list: expected an object");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.at("list").find("a"); }),
            "x.json:7: list: expected an object");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.fail("no"); }), "x.json:7: no");
  EXPECT_EQ(wrong(Json::array({Json::object()}), [](const JsonReader& j) { j.items()[0].at("a"); }),
            "x.json:7: [0]: has no 'a'");
  EXPECT_FALSE(JsonReader(json, "x.json").find("cases"));
  std::string keys;
  for (const auto& [key, value] : JsonReader(json, "x.json").members()) keys += key + " ";
  EXPECT_EQ(keys, "scenes list ");
  EXPECT_EQ(wrong(json, [](const JsonReader& j) { j.members()[1].second.flag(); }),
            "x.json:7: list: expected true or false");
}

TEST(JsonReader, TakesAValueOfItsTypeWithinItsBounds) {
  const auto integer = [](int least, int most) {
    return [=](const JsonReader& j) { j.integer(least, most); };
  };
  for (const int good : {-3, 0, 4}) EXPECT_EQ(wrong(good, integer(-3, 4)), "") << good;
  for (const Json& bad : {Json(-4), Json(5), Json(0.5)})
    EXPECT_EQ(wrong(bad, integer(-3, 4)), "x.json:7: expected a whole number from -3 to 4") << bad;
  EXPECT_EQ(JsonReader(-3.0, "").integer(-3, 4), -3);
  const auto count = [](const JsonReader& j) { j.count(); };
  for (const Json& good : {Json(0), Json(9007199254740992.0)})
    EXPECT_EQ(wrong(good, count), "") << good;
  for (const Json& bad : {Json(-1), Json(1.5), Json(9007199254740994.0)})
    EXPECT_EQ(wrong(bad, count), "x.json:7: expected a count") << bad;
  EXPECT_EQ(JsonReader(9007199254740992.0, "").count(), std::size_t{1} << 53);
  EXPECT_EQ(wrong(kInfinity, [](const JsonReader& j) { j.number(); }),
            "x.json:7: expected a finite number");
  EXPECT_EQ(wrong(nullptr, [](const JsonReader& j) { j.number(); }), "x.json:7: expected a number");
  EXPECT_TRUE(std::isnan(JsonReader(nullptr, "").number_or_null()));
  EXPECT_EQ(JsonReader(2.5, "").number_or_null(), 2.5);
  EXPECT_EQ(wrong("2", [](const JsonReader& j) { j.number_or_null(); }),
            "x.json:7: expected a number");
  EXPECT_EQ(wrong(1, [](const JsonReader& j) { j.text(); }), "x.json:7: expected a text");
  EXPECT_EQ(JsonReader("1", "").text(), "1");
  EXPECT_TRUE(JsonReader(true, "").flag());
  EXPECT_EQ(JsonReader(Json::array({"b", "a"}), "").texts(), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(JsonReader(Json::array({2, 1.5}), "").numbers(), (std::vector<double>{2, 1.5}));
  EXPECT_EQ(wrong(Json::array({2, "x"}), [](const JsonReader& j) { j.numbers(); }),
            "x.json:7: [1]: expected a number");
  EXPECT_EQ(wrong({{"schema", 2}}, [](const JsonReader& j) { j.require_schema(3); }),
            "x.json:7: schema: is 2; this program reads 3");
  EXPECT_EQ(wrong({{"schema", "a-1"}}, [](const JsonReader& j) { j.require_schema("a-1"); }), "");
}

TEST(JsonLines, AreReadOneAfterTheOtherAndADamagedOneIsNamed) {
  const Scratch scratch;
  const auto file = scratch.path() / "lines";
  write_file(file, "{\"n\": 4}\n{\"n\": 2}\n");
  const auto n = [](const JsonReader& j) { return j.at("n").integer(); };
  EXPECT_EQ(read_json_lines(file, n), (std::vector<int>{4, 2}));
  for (const char* bad : {"{\"n\": 4}\n{\"n\": \n", "{\"n\": 4}\n{\"m\": 1}\n{\"n\": 1}\n"}) {
    write_file(file, bad);
    try {
      read_json_lines(file, n);
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_EQ(error.diagnostics().front().line, 2) << bad;
      EXPECT_EQ(error.diagnostics().front().file, file.string());
    }
  }
  EXPECT_EQ(wrong(0, [](const JsonReader&) { parse_json_of("{", "y.json", 3); }).substr(0, 22),
            "y.json:3: is not JSON:");
}

}  // namespace
}  // namespace taut::json_test
