// Answers of a program that speaks taut-solver/1, and commands that call one: what is read, what is
// refused.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/model/input_error.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/system/files.hpp"

namespace taut::external::answers_test {
namespace {

/// What the reader says against the answer; "": nothing.
template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

Json hello_with(const std::string& name, const Json& spec) {
  return {
      {"protocol", "taut-solver/1"}, {"name", "p"}, {"version", "2"}, {"params", {{name, spec}}}};
}

Json integer(double least, double given, double most) {
  return {{"type", "integer"}, {"min", least}, {"default", given}, {"max", most}};
}

std::string refused_param(const Json& spec, const std::string& name = "n") {
  return refusal([&] { read_hello(hello_with(name, spec)); });
}

TEST(Hello, HasParametersOfEveryType) {
  Json answer = hello_with("n", integer(-3, 2, 7));
  answer["params"]["n"]["unit"] = "m", answer["params"]["n"]["doc"] = "help";
  answer["params"]["r"] = {{"type", "real"}, {"min", 0}, {"max", 1}, {"default", 0.25}};
  answer["params"]["c"] = {{"type", "choice"}, {"choices", {"a", "b"}}, {"default", "b"}};
  answer["params"]["t"] = {{"type", "text"}, {"default", "x y"}};
  const auto hello = read_hello(answer);
  EXPECT_EQ(hello->name + hello->version, "p2");
  EXPECT_EQ(hello->summary, "p");
  EXPECT_EQ(hello->source, "p 2");
  EXPECT_EQ(hello->unmeasurable, "");
  std::map<std::string, ParamSpec> specs;
  for (const ParamSpec& spec : hello->params) specs[std::string(spec.name)] = spec;
  ASSERT_EQ(specs.size(), 4u);
  EXPECT_EQ(specs["n"].min, -3);
  EXPECT_EQ(specs["n"].max, 7);
  EXPECT_EQ(specs["n"].default_value, "2");
  EXPECT_EQ(specs["n"].unit, "m");
  EXPECT_EQ(specs["n"].help, "help");
  EXPECT_EQ(specs["n"].kind, ParamSpec::Kind::integer);
  EXPECT_EQ(specs["r"].default_value, "0.25");
  EXPECT_EQ(specs["r"].kind, ParamSpec::Kind::real);
  EXPECT_EQ(specs["c"].choices, "a|b");
  EXPECT_EQ(specs["c"].default_value, "b");
  EXPECT_EQ(specs["t"].default_value, "x y");
  EXPECT_EQ(default_params(*hello), (Json{{"n", 2}, {"r", 0.25}, {"c", "b"}, {"t", "x y"}}));
  answer["summary"] = "s", answer["source"] = "o", answer["unmeasurable"] = "u";
  const auto told = read_hello(answer);
  EXPECT_EQ(told->summary + told->source + told->unmeasurable, "sou");
}

TEST(Hello, RefusesWhatNoParameterCanBe) {
  const double most = 2147483647;
  EXPECT_EQ(refused_param(integer(-most, most, most)), "");
  EXPECT_EQ(refused_param(integer(1, 1, 1)), "");
  EXPECT_NE(refused_param(integer(-most - 1, 0, 1)), "");
  EXPECT_NE(refused_param(integer(0, 0, most + 1)), "");
  EXPECT_NE(refused_param(integer(0, 0.5, 1)), "");
  EXPECT_NE(refused_param(integer(1, 0, 2)), "");
  EXPECT_NE(refused_param(integer(1, 3, 2)), "");
  EXPECT_NE(refused_param({{"type", "number"}}), "");
  for (const char* choice : {"", "a|b", "a,b", "a'b", "a\"b", "a b"})
    EXPECT_NE(refused_param({{"type", "choice"}, {"choices", {"x", choice}}, {"default", "x"}}), "")
        << choice;
  EXPECT_NE(refused_param({{"type", "choice"}, {"choices", {"x"}}, {"default", "y"}}), "");
  for (const char* name : {"cmd", "timeout", "a b", "1a", ""})
    EXPECT_NE(refused_param(integer(0, 0, 1), name), "") << name;
  Json other = hello_with("n", integer(0, 0, 1));
  other["protocol"] = "taut-solver/2";
  EXPECT_NE(refusal([&] { read_hello(other); }), "");
}

TEST(SceneAnswer, HasPassesAndSettingsUnlessTheSceneIsRefused) {
  const Json answer{
      {"vertices", 9},
      {"plan",
       {{{"pass", "a"}, {"items", 4}},
        {{"pass", "b"}, {"items", 5}, {"repeats", 6}, {"bytes", 7}, {"projections", true}}}},
      {"settings", {{"order", "mesh"}}}};
  const SceneAnswer told = read_scene_answer(answer, 9);
  ASSERT_EQ(told.plan.size(), 2u);
  EXPECT_EQ(told.plan[0].items, 4u);
  EXPECT_EQ(told.plan[0].repeats, 1u);
  EXPECT_EQ(told.plan[0].bytes, 0u);
  EXPECT_FALSE(told.plan[0].projections);
  EXPECT_EQ(told.plan[1].items, 5u);
  EXPECT_EQ(told.plan[1].repeats, 6u);
  EXPECT_EQ(told.plan[1].bytes, 7u);
  EXPECT_TRUE(told.plan[1].projections);
  EXPECT_EQ(told.settings, (ResolvedSettings{{"order", "mesh"}}));
  EXPECT_THROW(read_scene_answer(answer, 8), InputError);
  const SceneAnswer refused = read_scene_answer({{"cannot", {"wind"}}, {"vertices", 1}}, 9);
  EXPECT_EQ(refused.cannot, std::vector<std::string>{"wind"});
  EXPECT_EQ(read_scene_answer({{"cannot", Json::array()}, {"vertices", 9}}, 9).cannot.size(), 0u);
}

TEST(StepAnswer, HasNanosecondsIfAny) {
  EXPECT_DOUBLE_EQ(read_step({{"cpu_ns", 2500}}), 2.5e-6);
  EXPECT_TRUE(std::isnan(read_step(Json::object())));
}

TEST(StoreAnswer, HasTheBytesOfPositionsAndVelocities) {
  EXPECT_EQ(read_store({{"bytes", 480}}, 10), 480u);
  EXPECT_THROW(read_store({{"bytes", 479}}, 10), InputError);
  EXPECT_THROW(read_store({{"bytes", 481}}, 10), InputError);
}

TEST(ItsOwnWord, AgreesWithinATenthAndTwoEmptyExchanges) {
  EXPECT_TRUE(agrees(1.09, 1, 0));
  EXPECT_FALSE(agrees(1.11, 1, 0));
  EXPECT_TRUE(agrees(0.91, 1, 0));
  EXPECT_FALSE(agrees(0.89, 1, 0));
  EXPECT_TRUE(agrees(1.28, 1, 0.1));
  EXPECT_FALSE(agrees(1.32, 1, 0.1));
  EXPECT_TRUE(agrees(0, 1, 0.5));
}

TEST(Commands, AreSplitAsAShellWouldButRunByNone) {
  const Scratch scratch;
  write_file(scratch.path() / "prog", "");
  const Command command = split_command("./prog 'a b' \"c d\" e", scratch.path());
  EXPECT_EQ(command.words, (std::vector<std::string>{"./prog", "a b", "c d", "e"}));
  EXPECT_EQ(command.folder, scratch.path());
  EXPECT_EQ(command.text(), "./prog 'a b' 'c d' e");
  EXPECT_EQ(split_command("sh -c x", scratch.path()).words.size(), 3u);
  const auto said = [&](const std::string& text) {
    return refusal([&] { split_command(text, scratch.path()); });
  };
  for (const char* text :
       {"./prog | cat", "./prog; true", "./prog & x", "./prog $(id)", "./prog `id`"})
    EXPECT_NE(said(text).find("no shell runs it"), std::string::npos) << text;
  EXPECT_NE(said("./prog 'a").find("a quote is not closed"), std::string::npos);
  EXPECT_NE(said("  ").find("names no program"), std::string::npos);
  EXPECT_NE(said("./no x").find("no program './no'"), std::string::npos);
  EXPECT_NE(said("no-such-program-at-all x").find("no program"), std::string::npos);
}

TEST(SolverNames, StartWithALetterAndAreShort) {
  EXPECT_TRUE(is_solver_name("a"));
  EXPECT_TRUE(is_solver_name("aB_c-9"));
  EXPECT_TRUE(is_solver_name(std::string(40, 'a')));
  for (const std::string& text : {std::string(41, 'a'), std::string(), std::string("9a"),
                                  std::string("_a"), std::string("a.b"), std::string("a b")})
    EXPECT_FALSE(is_solver_name(text)) << text;
  const std::string name = name_for("my prog.py", "told by");
  EXPECT_TRUE(name.starts_with("my-prog-py-")) << name;
  EXPECT_EQ(name.size(), 15u);
  EXPECT_NE(name_for("my prog.py", "another"), name);
  EXPECT_EQ(name_for(std::string(50, 'a'), "x").size(), 35u);
  EXPECT_TRUE(name_for("9", "x").starts_with("external9-"));
  EXPECT_TRUE(name_for("", "x").starts_with("external-"));
}

}  // namespace
}  // namespace taut::external::answers_test
