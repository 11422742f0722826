// Order of the links in a sweep and layout of the vertices in memory, against the rules in the
// headers and a second implementation of them.
#include <gtest/gtest.h>

#include <random>

#include "core/model/index.hpp"
#include "core/solver/layout/interleaved_sheet.hpp"
#include "core/solver/layout/order.hpp"
#include "tests/support/cloths.hpp"

namespace taut::layout_test {
namespace {

using Link3 = std::tuple<int, int, double>;

std::vector<Link3> ends(const std::vector<Link>& links) {
  std::vector<Link3> all;
  for (const Link& l : links) all.emplace_back(l.a, l.b, l.rest);
  return all;
}

/// Jolt Physics 5, SoftBodySharedSettings::Optimize, in plain loops, as jolt_order.cpp describes
/// it.
class Jolt {
 public:
  explicit Jolt(const Scene& scene) : scene_(scene), batch_(scene.start.x.size(), -1) {
    for (const Vec3& x : scene.start.x) x_.push_back(x.cast<float>());
    for (const Link& l : scene.links) {
      near_[l.a].push_back(l.b);
      near_[l.b].push_back(l.a);
    }
    gather();
    find_ways();
  }

  std::vector<Link> order() const {
    std::map<int, int> links;
    for (const Link& l : scene_.links) ++links[batch_of(l)];
    std::vector<Link> all = scene_.links;
    std::stable_sort(all.begin(), all.end(), [&](const Link& a, const Link& b) {
      const auto rank = [&](const Link& l) {
        const int batch = batch_of(l);
        return std::tuple(batch == last_, batch == last_ ? 0 : -links[batch], batch,
                          std::min(way_[to_index(l.a)], way_[to_index(l.b)]), std::min(l.a, l.b));
      };
      return rank(a) < rank(b);
    });
    return all;
  }
  int batches() const { return last_; }

 private:
  /// Batch of a link. Links between batches, and those of vertices left over, belong to none.
  int batch_of(const Link& l) const {
    const int a = batch_[to_index(l.a)], b = batch_[to_index(l.b)];
    return a == b ? a : last_;
  }

  int first_free() const {
    Eigen::AlignedBox3f box;
    for (std::size_t v = 0; v < x_.size(); ++v)
      if (batch_[v] < 0) box.extend(x_[v]);
    std::vector<int> axes{0, 1, 2};
    std::sort(axes.begin(), axes.end(),
              [&](int a, int b) { return box.sizes()[a] > box.sizes()[b]; });
    int best = -1;
    const auto key = [&](int v) {
      const Eigen::Vector3f& p = x_[to_index(v)];
      return std::tuple(p[axes[0]], p[axes[1]], p[axes[2]]);
    };
    for (int v = 0; v < static_cast<int>(x_.size()); ++v)
      if (batch_[to_index(v)] < 0 && (best < 0 || key(v) < key(best))) best = v;
    return best;
  }

  void gather() {
    std::vector<int> own;
    for (int start = first_free(); start >= 0; start = first_free()) {
      int next = start;
      while (next >= 0 && own.size() < 256) {
        own.push_back(next);
        batch_[to_index(next)] = last_;
        next = -1;
        std::pair<int, float> best;
        for (const int from : own)
          for (const int v : near_[from]) {
            if (batch_[to_index(v)] >= 0) continue;
            int shared = 0;
            for (const int other : near_[v]) shared += batch_[to_index(other)] == last_;
            const std::pair rank(-shared, (x_[to_index(v)] - x_[to_index(own[0])]).squaredNorm());
            if (next < 0 || rank < best) {
              next = v;
              best = rank;
            }
          }
      }
      if (own.size() > 128) {
        own.clear();
        ++last_;
      }
    }
  }

  /// Bellman-Ford algorithm for the distances from the pins.
  void find_ways() {
    way_.assign(x_.size(), std::numeric_limits<float>::infinity());
    for (const int pin : scene_.pins) way_[to_index(pin)] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Link& l : scene_.links)
        for (const auto& [a, b] : {std::pair(l.a, l.b), {l.b, l.a}}) {
          const float way = way_[to_index(a)] + (x_[to_index(a)] - x_[to_index(b)]).norm();
          if (way < way_[to_index(b)]) {
            way_[to_index(b)] = way;
            changed = true;
          }
        }
    }
  }

  const Scene& scene_;
  std::vector<Eigen::Vector3f> x_;
  std::map<int, std::vector<int>> near_;
  std::vector<int> batch_;
  int last_ = 0;
  std::vector<float> way_;
};

// Sheets with whole batches and a rest of less than half a batch; long and short sides lie along
// each axis.
TEST(Order, OfJoltIsThatOfASecondImplementation) {
  for (const auto& [nu, nv, axis] :
       {std::tuple{26, 23, 0}, {11, 60, 1}, {40, 20, 2}, {19, 30, 1}, {9, 9, 0}, {5, 30, 2}}) {
    Scene scene = crumpled(hanging_sheet(nu, nv), 0.2 / nu);
    for (Vec3& x : scene.start.x)
      x = Vec3(x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3]).cwiseProduct(Vec3(1, 1.1, 1.3));
    const Jolt jolt(scene);
    EXPECT_EQ(ends(ordered(scene, Order::jolt, 0)), ends(jolt.order())) << nu << " x " << nv;
    EXPECT_EQ(jolt.batches(), (nu * nv + 127) / 256) << "a rest of more than 128 is one, too";
  }
}

TEST(Order, AtRandomIsFisherYatesWithMersennesTwister) {
  const Scene scene = hanging_sheet(7, 5);
  for (const std::uint32_t seed : {0u, 7u}) {
    std::vector<Link> list = scene.links;
    std::mt19937 random(seed);
    for (std::size_t left = list.size(); left >= 2; --left)
      std::swap(list[random() % left], list[left - 1]);
    EXPECT_EQ(ends(ordered(scene, Order::random, seed)), ends(list));
  }
}

// Small sheets have as many vectors as their links need; bend links span two columns.
TEST(InterleavedLayout, OfASmallSheetHasAVectorMoreThanColumns) {
  for (const bool bend : {false, true})
    for (const int columns : {8, 12, 16}) {
      const Scene scene = hanging_sheet(columns, 5, {true, true, bend});
      const auto regular = regular_links(scene.mesh, scene.links);
      ASSERT_TRUE(regular);
      EXPECT_EQ(interleaved_layout(regular->grid).sheet().vectors, bend ? 3 : 2) << columns;
    }
}

// Sixteen columns lie side by side if each lane has at least four columns, otherwise eight. The
// stride grows by one vector where rows would be 32 vectors apart.
TEST(InterleavedLayout, HasTheLanesThatItsColumnsFill) {
  struct Case {
    int columns, lanes, vectors, stride;
  };
  for (const Case& one :
       {Case{17, 8, 3, 72}, Case{24, 8, 3, 72}, Case{25, 8, 4, 96}, Case{63, 8, 8, 192},
        Case{64, 16, 4, 192}, Case{65, 16, 5, 240}, Case{496, 16, 31, 31 * 48},
        Case{497, 16, 32, 33 * 48}, Case{512, 16, 32, 33 * 48}, Case{1024, 16, 64, 65 * 48},
        Case{1025, 16, 65, 65 * 48}}) {
    const SheetSides sides{one.columns, 3, false};
    const Layout layout = interleaved_layout(sides);
    const SheetRows& rows = layout.sheet();
    EXPECT_EQ(rows.lanes, one.lanes) << one.columns;
    EXPECT_EQ(rows.vectors, one.vectors) << one.columns;
    EXPECT_EQ(rows.stride, to_index(one.stride)) << one.columns;
    EXPECT_EQ(rows.rows, 3);
    EXPECT_EQ(layout.size(), to_index(3 * one.columns));
    EXPECT_GE(layout.length(), 3 * rows.stride);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < one.columns; ++i)  // the i-th column is in lane i / vectors
        ASSERT_EQ(layout.slot(to_index(sides.index(i, j))),
                  to_index(j) * rows.stride +
                      to_index(i % one.vectors * 3 * one.lanes + i / one.vectors));
  }
}

TEST(InterleavedLayout, BlocksAreOfEightRowsAndTheLastHasTheRest) {
  const auto layout_of = [](int rows) {
    SheetRows sheet;
    sheet.rows = rows;
    sheet.lanes = 8;
    sheet.stride = 48;
    std::vector<std::uint32_t> slots;
    for (int j = 0; j < rows; ++j) slots.push_back(static_cast<std::uint32_t>(j) * 48);
    return Layout::interleaved(slots, sheet);
  };
  const Layout layout = layout_of(29);
  EXPECT_EQ(layout.blocks(), 4u);
  for (std::size_t block = 0; block < 4; ++block)
    EXPECT_EQ(layout.place_of_block(block), block * 8 * 48);
  EXPECT_EQ(layout.place_of_block(4), layout.length());
  for (std::size_t row = 0; row < 29; ++row) EXPECT_EQ(layout.block_of(row), row / 8);
  EXPECT_EQ(layout_of(8).blocks(), 1u);
  EXPECT_EQ(layout_of(17).blocks(), 3u);
}

// Rows of the longer side lie along the lanes; if both sides are long enough, those of the first.
TEST(InterleavedLayout, TakesTheSideThatIsLongEnough) {
  const auto sides = [](int nu, int nv) -> std::string {
    const Scene scene = hanging_sheet(nu, nv);
    const auto regular = regular_links(scene.mesh, scene.links);
    if (!regular) return "";
    const SheetSides& is = regular->grid;
    return std::to_string(is.columns) + " x " + std::to_string(is.rows) +
           (is.across ? " across" : "");
  };
  EXPECT_EQ(sides(17, 40), "17 x 40");
  EXPECT_EQ(sides(40, 17), "40 x 17");
  EXPECT_EQ(sides(16, 17), "17 x 16 across");
  EXPECT_EQ(sides(2, 17), "17 x 2 across");
  EXPECT_EQ(sides(17, 1), "17 x 1");
  EXPECT_EQ(sides(16, 16), "16 x 16");
  EXPECT_EQ(sides(8, 9), "8 x 9");
  EXPECT_EQ(sides(7, 8), "8 x 7 across");
  EXPECT_EQ(sides(1, 16), "");
  EXPECT_EQ(sides(7, 7), "");
}

}  // namespace
}  // namespace taut::layout_test
