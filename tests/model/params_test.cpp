// Parameters: accepted values, their spelling and errors in others; solvers by their texts.
#include "core/model/params.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"

namespace taut::params_test {
namespace {

constexpr ParamSpec kSpecs[] = {
    ParamSpec::integer("sweeps", "100000", -5, 1e6, "how often"),
    ParamSpec::real("omega", "m", "0.10", -1, 2.5, "how much"),
    ParamSpec::choice("order", "mesh", "mesh|coloured|reversed", "in which order"),
    {.name = "note", .kind = ParamSpec::Kind::text, .default_value = "a b"}};

std::string canonical(std::string_view text) { return Params("mine", kSpecs, text).canonical(); }
std::string brief(std::string_view text) { return Params("mine", kSpecs, text).brief(); }

std::string problems(std::string_view text) {
  try {
    Params("mine", kSpecs, text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Params, AreWrittenInOneFormWhateverWasTyped) {
  EXPECT_EQ(canonical(""), "sweeps=100000,omega=0.1,order=mesh,note='a b'");
  EXPECT_EQ(canonical("order=reversed,sweeps=007,omega=1e0,note=x"),
            "sweeps=7,omega=1,order=reversed,note=x");
  EXPECT_EQ(canonical("omega=-0.0,note=''"), "sweeps=100000,omega=0,order=mesh,note=''");
  EXPECT_EQ(brief(""), "");
  EXPECT_EQ(brief("omega=.1,sweeps=100000,order=coloured"), "order=coloured");
  EXPECT_EQ(brief("omega=0.25,note=\"it's\""), "omega=0.25,note='it''s'");
  const Params params("mine", kSpecs, "omega=-0.75,sweeps=-3");
  EXPECT_EQ(params.integer("sweeps"), -3);
  EXPECT_EQ(params.real("omega"), -0.75);
  EXPECT_EQ(params.choice("order"), "mesh");
  EXPECT_TRUE(params.is("order", "mesh"));
  EXPECT_FALSE(params.is("order", "coloured"));
  EXPECT_EQ(params.specs().size(), 4u);
}

TEST(Params, BordersBelongToTheirRange) {
  EXPECT_EQ(canonical("sweeps=-5,omega=-1"), "sweeps=-5,omega=-1,order=mesh,note='a b'");
  EXPECT_EQ(canonical("sweeps=1000000,omega=2.5"),
            "sweeps=1000000,omega=2.5,order=mesh,note='a b'");
  const std::string start = ": column 1: mine: ";
  EXPECT_EQ(problems("sweeps=-6"), "sweeps=-6" + start + "sweeps=-6 is outside -5 to 1e6");
  EXPECT_EQ(problems("sweeps=1000001"),
            "sweeps=1000001" + start + "sweeps=1000001 is outside -5 to 1e6");
  EXPECT_EQ(problems("omega=-1.001"), "omega=-1.001" + start + "omega=-1.001 is outside -1 to 2.5");
  EXPECT_EQ(problems("omega=2.501"), "omega=2.501" + start + "omega=2.501 is outside -1 to 2.5");
  EXPECT_EQ(problems("omega=nan"), "omega=nan" + start + "omega=nan is outside -1 to 2.5");
}

TEST(Params, EverythingThatIsWrongIsSaidWithItsColumn) {
  const std::string text = "sweeps=1.5,omega=much,order=mash,swepes=3,order=mesh,sweeps=2";
  EXPECT_EQ(problems(text),
            text + ": column 1: mine: sweeps=1.5 is not a whole number\n" + text +
                ": column 12: mine: omega=much is not a number\n" + text +
                ": column 23: mine: order=mash is not one of mesh|coloured|reversed; did you mean "
                "'mesh'?\n" +
                text + ": column 34: mine: unknown parameter 'swepes'; did you mean 'sweeps'?\n" +
                text + ": column 43: mine: parameter 'order' is given twice\n" + text +
                ": column 54: mine: parameter 'sweeps' is given twice");
  EXPECT_EQ(problems("omega=1x"), "omega=1x: column 1: mine: omega=1x is not a number");
  EXPECT_EQ(problems("omega="), "omega=: column 1: mine: omega= is not a number");
}

using Item = std::pair<std::string, std::string>;

TEST(ParamItems, AreTakenApartAtCommasOutsideQuotes) {
  const auto items = [](std::string_view text) {
    std::vector<Item> all;
    for (const ParamItem& item : param_items(text)) all.emplace_back(item.key, item.value);
    return all;
  };
  EXPECT_EQ(items(""), std::vector<Item>{});
  EXPECT_EQ(items("a=1,bc=\"x,'y\"\"z\",d=e=f"),
            (std::vector<Item>{{"a", "1"}, {"bc", "x,'y\"z"}, {"d", "e=f"}}));
  const auto parts = param_items("a=1,b,='x',c='y'z,d='q");
  ASSERT_EQ(parts.size(), 5u);
  const std::vector<std::size_t> at{0, 4, 6, 11, 18};
  const std::vector<std::string> problem{
      "", "expected key=value, got 'b'", "expected key=value, got '='x''",
      "c: a comma has to follow the quote", "d: the quote ' is not closed"};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(parts[k].at, at[k]) << k;
    EXPECT_EQ(parts[k].problem, problem[k]) << k;
  }
}

std::string solver_problems(std::string_view text) {
  try {
    parse_solver(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(SolverTexts, AreReadWithErrorsCountedFromTheFirstCharacter) {
  const SolverChoice choice = parse_solver("xpbd:iterations=3,bend=0.5");
  EXPECT_EQ(choice.entry->name, "xpbd");
  EXPECT_EQ(choice.canonical(),
            "xpbd:substeps=8,iterations=3,structural=0,shear=0,bend=0.5,precision=float"
            ",material=scene,multipliers=keep,method=sweeps,primal=off,order=coloured,seed=1,"
            "layout=auto,tethers=off,"
            "contact=continuous,faces=off,self=grid,simd=auto,threads=1");
  EXPECT_EQ(choice.brief(), "xpbd:iterations=3,bend=0.5");
  EXPECT_EQ(parse_solver("xpbd:substeps=8").brief(), "xpbd");
  EXPECT_EQ(&find_solver("bullet"), parse_solver("bullet").entry);
  EXPECT_EQ(solver_problems("xpbd:"), "xpbd:: column 6: expected key=value after the colon");
  EXPECT_EQ(solver_problems("xpbd:bend=-1,bind=2"),
            "xpbd:bend=-1,bind=2: column 6: xpbd: bend=-1 is outside 0 to 1e12\n"
            "xpbd:bend=-1,bind=2: column 14: xpbd: unknown parameter 'bind'; did you mean 'bend'?");
  EXPECT_EQ(solver_problems("xpdb:bend=1,2"),
            "xpdb:bend=1,2: column 1: unknown solver 'xpdb'; did you mean 'xpbd'? (`taut list "
            "solvers` names all)\n"
            "xpdb:bend=1,2: column 13: expected key=value, got '2'");
}

/// Solver without optional answers.
struct Silent final : Solver {
  void load(const State&) override {}
  void step(double, double) override {}
  void store(State&) const override {}
  std::vector<PassCost> step_cost() const override {
    return {{.pass = "a", .items = 7, .repeats = 3, .projections = true},
            {.pass = "b", .items = 100, .repeats = 9},
            {.pass = "c", .items = 5, .repeats = 2, .projections = true}};
  }
};

TEST(SolverDefaults, AreTheProcesssOwnClockAndMemoryAndSilence) {
  const Silent silent;
  EXPECT_EQ(projections_per_step(silent), 7u * 3 + 5 * 2);
  EXPECT_EQ(silent.time_remark(), "");
  EXPECT_EQ(silent.log(), "");
  const double before = static_cast<double>(std::clock()) / CLOCKS_PER_SEC,
               said = silent.cpu_seconds();
  volatile double work = 0;
  while (static_cast<double>(std::clock()) / CLOCKS_PER_SEC < before + 0.05) work = work + 1;
  const double after = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  EXPECT_NEAR(said, before, 0.02);
  EXPECT_NEAR(silent.cpu_seconds(), after, 0.02);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_NEAR(static_cast<double>(silent.peak_bytes()),
              1024.0 * static_cast<double>(usage.ru_maxrss), 1e6);
  EXPECT_GT(silent.peak_bytes(), std::size_t{1} << 20);
}

TEST(Params, HaveAnotherDefaultBesideAnotherChoice) {
  const ParamSpec specs[] = {ParamSpec::choice("method", "sweeps", "sweeps|global", "how"),
                             ParamSpec::integer("n", "8", 1, 99, "how many")
                                 .but("method=global", "3")
                                 .but("primal=on", "9"),
                             ParamSpec::choice("primal", "off", "off|on", "more")};
  EXPECT_EQ(specs[1].defaults(), "8; 3 with method=global; 9 with primal=on");
  const auto of = [&](const char* text) { return Params("s", specs, text); };
  EXPECT_EQ(of("").canonical(), "method=sweeps,n=8,primal=off");
  EXPECT_EQ(of("method=global").canonical(), "method=global,n=3,primal=off");
  EXPECT_EQ(of("method=global,primal=on").canonical(), "method=global,n=9,primal=on");
  EXPECT_EQ(of("method=global").brief(), "method=global");
  EXPECT_EQ(of("n=8,method=global").brief(), "method=global,n=8");
  EXPECT_EQ(of("n=3").brief(), "n=3");
}

TEST(Params, KnowWhatWasGivenAndTakeAnotherValue) {
  const Params some("mine", kSpecs, "omega=0.10,note='a, b'");
  EXPECT_TRUE(some.given("omega") && some.given("note"));
  EXPECT_FALSE(some.given("sweeps") || some.given("nosuch"));
  EXPECT_EQ(some.given_with("omega", "2"), "omega=2,note='a, b'");
  EXPECT_EQ(some.given_with("sweeps", "3"), "sweeps=3,omega=0.1,note='a, b'");
  EXPECT_EQ(some.given_with("note", "it's"), "omega=0.1,note='it''s'");
  EXPECT_EQ(problems(some.given_with("omeg", "2")),
            "omeg=2: column 1: mine: unknown parameter 'omeg'; did you mean 'omega'?");
  EXPECT_EQ(parse_solver("jakobsen:omega=1.5").with("omega", "2").brief(), "jakobsen:omega=2");
}

}  // namespace
}  // namespace taut::params_test
