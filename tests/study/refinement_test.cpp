// A map refined along its frontiers says of every cell what the dense grid says, for fewer cases.
#include "experiments/study/refinement.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace taut {
namespace {

struct Outcome {
  std::size_t run = 0, wrong = 0;
};

Outcome explore(std::size_t columns, std::size_t rows,
                const std::function<int(std::size_t, std::size_t)>& truth) {
  Refinement map(columns, rows);
  std::set<MapCell> asked;
  for (auto cells = map.next(); !cells.empty(); cells = map.next())
    for (const MapCell& cell : cells) {
      EXPECT_TRUE(asked.insert(cell).second) << "asked twice";
      map.tell(cell, truth(cell.x, cell.y));
    }
  Outcome outcome{map.run(), 0};
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const auto said = map.inferred({x, y});
      EXPECT_TRUE(said.has_value()) << x << ' ' << y;
      if (said != truth(x, y)) ++outcome.wrong;
    }
  return outcome;
}

TEST(Refinement, AUniformMapCostsItsCoarseMesh) {
  const Outcome outcome = explore(33, 17, [](auto, auto) { return 0; });
  EXPECT_EQ(outcome.run, 9u * 5u);
  EXPECT_EQ(outcome.wrong, 0u);
}

TEST(Refinement, MonotoneFrontiersAreFoundCellByCell) {
  const auto slope = [](std::size_t x, std::size_t y) { return 2 * x > 3 * y + 11 ? 1 : 0; };
  const auto bent = [](std::size_t x, std::size_t y) { return x * x + 2 * y * y > 400 ? 1 : 0; };
  const auto bands = [](std::size_t x, std::size_t) { return x < 7 ? 0 : x < 20 ? 1 : 2; };
  for (const std::function<int(std::size_t, std::size_t)>& truth :
       {std::function<int(std::size_t, std::size_t)>(slope), {bent}, {bands}}) {
    const Outcome outcome = explore(33, 17, truth);
    EXPECT_EQ(outcome.wrong, 0u);
    EXPECT_LT(outcome.run, 33u * 17u * 2 / 3);
  }
}

TEST(Refinement, FollowsAFrontierIntoBlocksThatLookedUniform) {
  // The class of the right edge reaches into the next blocks between their corners only.
  const auto bay = [](std::size_t x, std::size_t y) {
    return x >= 16 || (x >= 13 && y >= 5 && y <= 7) ? 1 : 0;
  };
  EXPECT_EQ(explore(33, 17, bay).wrong, 0u);
}

TEST(Refinement, AnyShapeOfGridIsCovered) {
  for (std::size_t columns = 1; columns < 12; ++columns)
    for (std::size_t rows = 1; rows < 12; ++rows) {
      const Outcome outcome =
          explore(columns, rows, [&](auto x, auto y) { return x + y > 6 ? 1 : 0; });
      EXPECT_EQ(outcome.wrong, 0u) << columns << " x " << rows;
      EXPECT_LE(outcome.run, columns * rows);
    }
}

}  // namespace
}  // namespace taut
