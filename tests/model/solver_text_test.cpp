// Parsing of a solver's text: quotes protect commas and quotes, and every error has its column.
#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "core/model/params.hpp"
#include "core/model/solver.hpp"

namespace taut::solver_text_test {
namespace {

constexpr ParamSpec kSpecs[] = {
    {.name = "cmd", .kind = ParamSpec::Kind::text},
    {.name = "n", .kind = ParamSpec::Kind::integer, .default_value = "8", .min = 1, .max = 99}};

std::string canonical(std::string_view text) { return Params("mine", kSpecs, text).canonical(); }

std::string problem(std::string_view text) {
  try {
    Params("mine", kSpecs, text);
  } catch (const InputError& error) {
    const Diagnostic& d = error.diagnostics().front();
    return std::to_string(d.column) + ": " + d.message;
  }
  return "none";
}

TEST(SolverText, AQuotedValueHoldsCommasAndQuotes) {
  EXPECT_EQ(Params("mine", kSpecs, "cmd='a, b=\"c\"',n=3").value("cmd"), "a, b=\"c\"");
  EXPECT_EQ(Params("mine", kSpecs, "n=3,cmd=\"it's\"").value("cmd"), "it's");
  EXPECT_EQ(Params("mine", kSpecs, "cmd='it''s'").value("cmd"), "it's");
  EXPECT_EQ(Params("mine", kSpecs, "cmd=").value("cmd"), "");
}

TEST(SolverText, TheCanonicalTextIsReadBackAsTheSame) {
  for (const char* text : {"cmd='python3 a.py'", "cmd='a,b'", "cmd='it''s'", "cmd=plain-1.0/x"}) {
    const std::string once = canonical(text);
    EXPECT_EQ(once, std::string(text) + ",n=8");
    EXPECT_EQ(canonical(once), once);
  }
  EXPECT_EQ(canonical("cmd=\"a b\""), "cmd='a b',n=8");
}

TEST(SolverText, ErrorsNameTheirColumn) {
  EXPECT_EQ(problem("cmd='a,b',n=100"), "11: mine: n=100 is outside 1 to 99");
  EXPECT_EQ(problem("cmd='a,b"), "1: mine: cmd: the quote ' is not closed");
  EXPECT_EQ(problem("n=3,cmd='a'b"), "5: mine: cmd: a comma has to follow the quote");
  EXPECT_EQ(problem("n=3,,"), "5: mine: expected key=value, got ''");
  EXPECT_EQ(problem("=3"), "1: mine: expected key=value, got '=3'");
  EXPECT_EQ(problem("n"), "1: mine: expected key=value, got 'n'");
}

TEST(SolverText, TheNameStandsBeforeTheColon) {
  EXPECT_EQ(solver_name("xpbd"), "xpbd");
  EXPECT_EQ(solver_name("mine:cmd='a:b',n=3"), "mine");
  EXPECT_EQ(with("xpbd", "bend=1"), "xpbd:bend=1");
  EXPECT_EQ(with("xpbd:bend=1", "iterations=2,substeps=3"), "xpbd:bend=1,iterations=2,substeps=3");
  EXPECT_EQ(with("xpbd", ""), "xpbd");
}

}  // namespace
}  // namespace taut::solver_text_test
