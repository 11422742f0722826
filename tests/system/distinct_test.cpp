// Distinct keys and groups in order of first appearance.
#include "experiments/system/distinct.hpp"

#include <gtest/gtest.h>

namespace taut::distinct_test {
namespace {

using Texts = std::vector<std::string>;

TEST(Distinct, ValuesStandOnceInOrderOfAppearance) {
  EXPECT_EQ(distinct(Texts{"b", "a", "b", "c", "a"}), (Texts{"b", "a", "c"}));
  EXPECT_EQ(distinct(Texts{}), Texts{});
  EXPECT_EQ(distinct(Texts{"two", "one", "three"}, &std::string::size),
            (std::vector<std::size_t>{3, 5}));
}

TEST(Groups, AreMadeWhenTheyAreFirstAskedFor) {
  std::vector<std::pair<std::string, std::vector<int>>> groups;
  for (const auto& [name, value] :
       {std::pair("z", 1), std::pair("a", 2), std::pair("z", 3), std::pair("b", 4)})
    group_of(groups, name).push_back(value);
  EXPECT_EQ(groups, (decltype(groups){{"z", {1, 3}}, {"a", {2}}, {"b", {4}}}));
}

}  // namespace
}  // namespace taut::distinct_test
