// SPDX-License-Identifier: Apache-2.0
#include "hal/base/parallel.h"

#include <atomic>
#include <latch>
#include <new>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>

namespace mixrig {
namespace {

class CrewTest : public ::testing::TestWithParam<int> {};

TEST_P(CrewTest, CoversEveryRowOnce) {
  Crew crew(GetParam());
  for (const int count : {0, 1, 7, 64, 1000}) {
    std::vector<std::atomic<int>> hits(static_cast<std::size_t>(count));
    crew.rows(count, 8, [&](int begin, int end) {
      EXPECT_LE(end - begin, 8);
      for (int i = begin; i < end; ++i) ++hits[static_cast<std::size_t>(i)];
    });
    for (const auto& h : hits) EXPECT_EQ(h, 1);
  }
}

TEST_P(CrewTest, ManyCallsInARowAllReturn) {
  Crew crew(GetParam());
  std::atomic<int> sum = 0;
  for (int i = 0; i < 2000; ++i) crew.rows(4, 1, [&](int begin, int end) { sum += end - begin; });
  EXPECT_EQ(sum, 8000);
}

TEST_P(CrewTest, WhatABandThrowsReachesTheCallerAndTheCrewGoesOn) {
  Crew crew(GetParam());
  for (int bad = 0; bad < 64; ++bad) {
    EXPECT_THROW(crew.rows(64, 1,
                           [bad](int begin, int) {
                             if (begin == bad) throw std::bad_alloc();
                           }),
                 std::bad_alloc);
    std::atomic<int> sum = 0;
    crew.rows(64, 1, [&](int begin, int end) { sum += end - begin; });
    ASSERT_EQ(sum, 64) << "after band " << bad << " threw";
  }
}

TEST(Crew, WhatAWorkerThrowsReachesTheCaller) {
  Crew crew(3);
  std::latch all_there(3);
  EXPECT_THROW(crew.rows_by_worker(3, 1,
                                   [&](int worker, int, int) {
                                     all_there.arrive_and_wait();
                                     if (worker != 0) throw std::bad_alloc();
                                   }),
               std::bad_alloc);
}

INSTANTIATE_TEST_SUITE_P(Threads, CrewTest, ::testing::Values(1, 2, 5));

using Cores = std::set<int>;

/// Cores that the calling thread may use.
Cores allowed() {
  cpu_set_t set;
  EXPECT_EQ(::sched_getaffinity(0, sizeof(set), &set), 0);
  Cores cores;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) cores.insert(i);
  return cores;
}

void allow(const Cores& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(core, &set);
  ASSERT_EQ(::sched_setaffinity(0, sizeof(set), &set), 0);
}

/// Cores that each thread of the crew may use while all of them work on one call.
std::vector<Cores> cores_during_a_call(Crew& crew) {
  const int threads = crew.threads();
  std::vector<Cores> seen(static_cast<std::size_t>(threads));
  std::latch all_there(threads);
  crew.rows_by_worker(threads, 1, [&](int worker, int, int) {
    seen[static_cast<std::size_t>(worker)] = allowed();
    all_there.arrive_and_wait();  // one band for each thread
  });
  return seen;
}

TEST(Crew, WithOneThreadPerCoreEachStaysOnACoreOfItsOwn) {
  const Cores before = allowed();
  Crew crew(static_cast<int>(before.size()));
  for (int call = 0; call < 3; ++call) {
    Cores used;
    for (const Cores& cores : cores_during_a_call(crew)) {
      EXPECT_EQ(cores.size(), 1U);
      used.insert(cores.begin(), cores.end());
    }
    EXPECT_EQ(used, before) << "each core once";
    EXPECT_EQ(allowed(), before) << "the caller may use all of its cores again";
  }
}

TEST(Crew, OfAnotherNumberOfThreadsIsPlacedByTheSystem) {
  const Cores before = allowed();
  Crew crew(static_cast<int>(before.size()) + 1);
  for (const Cores& cores : cores_during_a_call(crew)) EXPECT_EQ(cores, before);
}

TEST(Crew, GivesBackTheCoresThatTheCallerHad) {
  const Cores before = allowed();
  if (before.size() < 2) GTEST_SKIP() << "needs two cores";
  Crew crew(static_cast<int>(before.size()));
  const Cores last = {*before.rbegin()};
  std::thread caller([&] {
    allow(last);  // since the crew was made
    crew.rows(64, 1, [](int, int) {});
    EXPECT_EQ(allowed(), last);
  });
  caller.join();
}

TEST(Crew, ZeroMeansOnePerCore) { EXPECT_GE(Crew(0).threads(), 1); }

}  // namespace
}  // namespace mixrig
