// Accuracy parameters that solvers declare, checked against the settings that they accept.
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "tests/support/numbers.hpp"

namespace taut::accuracy_parameters_test {
namespace {

TEST(AccuracyParameters, AreParametersAndTheirValuesAreAccepted) {
  for (const SolverEntry* entry : solvers()) {
    const std::string name(entry->name);
    const AccuracyParameters& accuracy = entry->accuracy;
    // this solver has no accuracy parameter to search
    if (accuracy.substeps.empty() && accuracy.sweeps.empty()) continue;
    EXPECT_FALSE(accuracy.substeps.empty()) << name;
    EXPECT_FALSE(accuracy.sweeps.empty() && accuracy.stiffness.parameters.empty())
        << name << ": one of the two is what substeps are weighed against";
    for (const std::string_view number : {accuracy.substeps, accuracy.sweeps})
      if (!number.empty()) {
        EXPECT_EQ(parse_solver(name + ":" + std::string(number) + "=64").params.integer(number),
                  64);
      }
    std::vector<AccuracyParameters::Ladder> ladders(accuracy.alternatives.begin(),
                                                    accuracy.alternatives.end());
    ladders.push_back(accuracy.stiffness);
    for (const auto& [parameters, values] : ladders) {
      EXPECT_EQ(parameters.empty(), values.empty()) << name;
      for (const std::string_view parameter : parameters)
        for (const std::string_view value : values)
          EXPECT_EQ(parse_solver(name).with(parameter, std::string(value)).params.value(parameter),
                    value);
    }
  }
}

TEST(AccuracyParameters, StiffnessesRiseAndHaveTheDefault) {
  for (const SolverEntry* entry : solvers())
    for (const std::string_view parameter : entry->accuracy.stiffness.parameters) {
      const Words& values = entry->accuracy.stiffness.values;
      const std::string own(parse_solver(std::string(entry->name)).params.value(parameter));
      EXPECT_NE(std::ranges::find(values, own), values.end()) << entry->name;
      EXPECT_TRUE(
          std::ranges::is_sorted(values, {}, [](std::string_view v) { return number_at(v); }));
    }
}

// A page names the arithmetic of a solver by these roles, whatever its parameters are called.
TEST(ParameterRoles, BelongToEveryChoiceOfPrecisionAndOfInstructions) {
  using Role = ParamSpec::Role;
  std::size_t precisions = 0;
  for (const SolverEntry* entry : solvers())
    for (const ParamSpec& spec : entry->params) {
      const bool chooses = spec.choices == "float|double",
                 computes = spec.choices.starts_with("auto|scalar|");
      precisions += chooses;
      EXPECT_EQ(spec.role == Role::precision, chooses) << entry->name << " " << spec.name;
      EXPECT_EQ(spec.role == Role::instructions, computes) << entry->name << " " << spec.name;
    }
  EXPECT_GE(precisions, 5u);
  const std::span<const ParamSpec> jakobsen = parse_solver("jakobsen").entry->params;
  EXPECT_EQ(parameter_with(Role::precision, jakobsen), "precision");
  EXPECT_EQ(parameter_with(Role::instructions, jakobsen), "simd");
  EXPECT_EQ(parameter_with(Role::face_contact, jakobsen), "faces");
  const std::span<const ParamSpec> bullet = parse_solver("bullet").entry->params;
  EXPECT_EQ(parameter_with(Role::face_contact, bullet), "") << "its faces are about normals";
  EXPECT_EQ(parameter_with(Role::contact_share, bullet), "hardness");
  EXPECT_EQ(parameter_with(Role::precision, {}), "");
}

}  // namespace
}  // namespace taut::accuracy_parameters_test
