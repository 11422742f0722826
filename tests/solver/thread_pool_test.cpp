#include "core/solver/thread_pool.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <new>
#include <numeric>
#include <system_error>
#include <vector>

namespace taut::thread_pool_test {

namespace {

/// Works for long enough that the other threads arrive.
void dawdle() {
  volatile int work = 0;
  for (int n = 0; n < 300; ++n) work = work + 1;
}

/// Has more threads than cores, so that some threads always arrive late.
TEST(ThreadPool, DoesEveryItemOfEveryRoundOnce) {
  ThreadPool pool(6);
  std::vector<int> visits(50, 0);
  std::vector<int> expected(50, 0);
  for (std::size_t round = 0; round < 4000; ++round) {
    const std::size_t count = round % 51;
    pool.run(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        ++visits[i];
        dawdle();
      }
    });
    for (std::size_t i = 0; i < count; ++i) ++expected[i];
    ASSERT_EQ(visits, expected) << "round " << round;
  }
}

TEST(ThreadPool, RoundsDoNotOverlap) {
  ThreadPool pool(4);
  std::vector<std::size_t> value(97);
  std::iota(value.begin(), value.end(), std::size_t{0});
  std::vector<std::size_t> next(value.size());
  // each item reads what another item wrote in the round before
  for (int round = 0; round < 2000; ++round) {
    pool.run(value.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        dawdle();
        next[i] = value[(i + 1) % value.size()];
      }
    });
    pool.run(value.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) value[i] = next[i];
    });
  }
  for (std::size_t i = 0; i < value.size(); ++i) ASSERT_EQ(value[i], (i + 2000) % value.size());
}

/// Stages over single blocks and over a block with its successor, in an irregular order. Each stage
/// of a block has to find the block as all earlier stages left it.
TEST(ThreadPool, AStageOfABlockFollowsThoseBeforeIt) {
  static constexpr std::size_t kStages = 300;  // more than the pool keeps
  for (const std::size_t blocks : {23U, 24U, 3U, 1U})
    for (const int threads : {2, 5}) {
      ThreadPool pool(threads);
      std::vector<std::uint32_t> value(blocks, 1), want(blocks, 1);
      const auto mix = [](std::uint32_t& a, std::uint32_t b) {
        dawdle();
        a = 31 * a + b;
      };
      for (std::size_t stage = 0; stage < kStages; ++stage) {
        const auto n = static_cast<std::uint32_t>(stage);
        const auto one = [&mix, n](std::vector<std::uint32_t>& v, std::size_t block) {
          mix(v[block], n);
        };
        const auto two = [&mix, n](std::vector<std::uint32_t>& v, std::size_t block) {
          mix(v[block], n);
          if (block + 1 < v.size()) {
            mix(v[block + 1], v[block]);
            mix(v[block], v[block + 1]);
          }
        };
        if (stage % 7 % 3 == 0) {
          pool.queue_pairs(blocks, [&value, two](std::size_t block) { two(value, block); });
          for (const std::size_t parity : {0U, 1U})
            for (std::size_t block = parity; block < blocks; block += 2) two(want, block);
        } else {
          pool.queue(blocks, [&value, one](std::size_t begin, std::size_t end) {
            for (std::size_t block = begin; block < end; ++block) one(value, block);
          });
          for (std::size_t block = 0; block < blocks; ++block) one(want, block);
        }
      }
      pool.finish();
      EXPECT_EQ(value, want) << blocks << " blocks, " << threads << " threads";
    }
}

/// Starts one stage below the number that the pool keeps: the two stages of a pair do not both fit.
TEST(ThreadPool, PairsStayTogetherAfterManyStages) {
  constexpr std::uint32_t kBlocks = 23, kBefore = 127;
  ThreadPool pool(2);
  std::vector<std::uint32_t> value(kBlocks, 0), want(kBlocks, kBefore);
  for (std::uint32_t n = 0; n < kBefore; ++n)
    pool.queue(kBlocks, [&value](std::size_t begin, std::size_t end) {
      for (std::size_t block = begin; block < end; ++block) {
        dawdle();
        ++value[block];
      }
    });
  const auto mix = [](std::vector<std::uint32_t>& v, std::size_t block) {
    if (block + 1 < v.size()) v[block + 1] = 31 * v[block + 1] + v[block];
  };
  pool.queue_pairs(kBlocks, [&value, mix](std::size_t block) { mix(value, block); });
  for (const std::size_t parity : {0U, 1U})
    for (std::size_t block = parity; block < kBlocks; block += 2) mix(want, block);
  pool.finish();
  EXPECT_EQ(value, want);
}

TEST(ThreadPool, WhatWorkThrowsComesToTheCaller) {
  const auto caller = std::this_thread::get_id();
  for (const bool by_caller : {true, false}) {
    SCOPED_TRACE(by_caller);
    ThreadPool pool(3);
    for (int round = 0; round < 100; ++round) {
      std::atomic<bool> thrown{false};
      std::atomic<int> after{0};
      pool.queue(64, [&](std::size_t, std::size_t) {
        if ((std::this_thread::get_id() == caller) == by_caller) {
          thrown = true;
          throw std::bad_alloc();
        }
        while (!thrown) std::this_thread::yield();
      });
      pool.queue(
          64, [&](std::size_t begin, std::size_t end) { after += static_cast<int>(end - begin); });
      EXPECT_THROW(pool.finish(), std::bad_alloc);
      EXPECT_LT(after, 64) << "not where the stage before it has failed";
      std::vector<int> visits(50, 0);
      pool.run(visits.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      ASSERT_EQ(visits, std::vector<int>(50, 1)) << "it works as before";
    }
  }
}

TEST(ThreadPool, WithoutMemoryForItsThreadsThrows) {
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  // stacks take 8 MiB each
  const rlimit little{pages * 4096 + (rlim_t{200} << 20), before.rlim_max};
  setrlimit(RLIMIT_AS, &little);
  EXPECT_THROW(ThreadPool(200), std::system_error);
  setrlimit(RLIMIT_AS, &before);
}

TEST(ThreadPool, FinishesWhatIsQueuedBeforeOtherWork) {
  ThreadPool pool(3);
  std::vector<int> value(64, 0);
  const auto add = [&value](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      dawdle();
      ++value[i];
    }
  };
  for (int n = 0; n < 300; ++n) {
    const int before = value[0];
    pool.queue(value.size(), add);
    pool.queue(value.size(), add);
    pool.run(value.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) value[i] = 3 * value[i] % 1000;
    });
    ASSERT_EQ(value, std::vector<int>(64, 3 * (before + 2) % 1000));
    pool.queue(32, add);  // other blocks
    pool.queue(64, add);
    pool.finish();
    EXPECT_EQ(value[31], value[32] + 1);
    pool.run(value.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) value[i] = before + 1;
    });
  }
}

TEST(ThreadPool, OfOneIsTheCaller) {
  ThreadPool pool(1);
  const auto caller = std::this_thread::get_id();
  std::size_t done = 0;
  pool.run(7, [&](std::size_t begin, std::size_t end) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    done += end - begin;
  });
  EXPECT_EQ(done, 7U);
}

}  // namespace

}  // namespace taut::thread_pool_test
