// SPDX-License-Identifier: Apache-2.0
#include "hal/base/work_gate.h"

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

TEST(WorkGate, NoWorkRunsDuringAPause) {
  WorkGate gate;
  std::atomic<int> working = 0, pieces = 0;
  std::atomic<bool> stop = false;
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back([&] {
      while (!stop) {
        const WorkGate::Work work(&gate);
        ++working;
        ++pieces;
        --working;
      }
    });
  for (int i = 0; i < 200; ++i) {
    const WorkGate::Pause pause(&gate);
    const int before = pieces;
    EXPECT_EQ(working, 0);
    std::this_thread::yield();
    EXPECT_EQ(pieces, before);
  }
  stop = true;
  for (auto& thread : threads) thread.join();
}

TEST(WorkGate, APauseWaitsForWorkThatHasBegunAndHoldsBackWhatComesAfter) {
  WorkGate gate;
  std::promise<void> end_first;
  std::promise<void> first_began;
  std::atomic<bool> first_ended = false, second_began = false;
  std::thread first([&] {
    const WorkGate::Work work(&gate);
    first_began.set_value();
    end_first.get_future().wait();
    first_ended = true;
  });
  first_began.get_future().wait();
  std::thread second;
  std::thread pausing([&] {
    const WorkGate::Pause pause(&gate);
    EXPECT_TRUE(first_ended);
    second = std::thread([&] {
      const WorkGate::Work work(&gate);
      second_began = true;
    });
    std::this_thread::yield();
    EXPECT_FALSE(second_began);
  });
  end_first.set_value();
  pausing.join();
  first.join();
  second.join();
  EXPECT_TRUE(second_began) << "work goes on after the pause";
}

/// Whether another thread can begin work now. If it cannot, `blocking` is released, so that the
/// test fails and does not hang.
template <typename Blocking>
bool begins_work(WorkGate* gate, std::optional<Blocking>& blocking) {
  std::promise<void> began;
  std::thread other([&] {
    const WorkGate::Work work(gate);
    began.set_value();
  });
  const bool in_time =
      began.get_future().wait_for(std::chrono::minutes(1)) == std::future_status::ready;
  blocking.reset();
  other.join();
  return in_time;
}

TEST(WorkGate, PiecesOfWorkRunAtTheSameTime) {
  WorkGate gate;
  std::optional<WorkGate::Work> one(std::in_place, &gate);
  EXPECT_TRUE(begins_work(&gate, one));
}

TEST(WorkGate, WithoutAGateNothingWaits) {
  std::optional<WorkGate::Pause> pause(std::in_place, nullptr);
  EXPECT_TRUE(begins_work(nullptr, pause));
}

}  // namespace
}  // namespace mixrig
