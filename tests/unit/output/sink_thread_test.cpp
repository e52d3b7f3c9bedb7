// SPDX-License-Identifier: Apache-2.0
#include "host/output/sink/sink_thread.h"

#include <condition_variable>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/progress.h"
#include "tests/support/refusal.h"

namespace mixrig::output {
namespace {

/// Keeps the numbers of the frames; write() waits while the sink is held.
class GatedSink final : public CompositeSink {
 public:
  struct Log {
    std::mutex mutex;
    std::condition_variable changed;
    bool held = false, finished = false;
    int entered = 0, fails_at = 0, throws_at = 0;
    std::vector<int> numbers;
    void hold(bool value) {
      const std::lock_guard lock(mutex);
      held = value;
      changed.notify_all();
    }
  };
  explicit GatedSink(Log& log) : log_(log) {}
  std::string_view name() const override { return "gated"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const CompositePtr& composite) override {
    std::unique_lock lock(log_.mutex);
    ++log_.entered;
    log_.changed.notify_all();
    log_.changed.wait(lock, [this] { return !log_.held; });
    if (composite->capture->number == log_.fails_at) return Error{ErrorCode::kIo, "disk full"};
    if (composite->capture->number == log_.throws_at) throw std::bad_alloc();
    log_.numbers.push_back(composite->capture->number);
    return {};
  }
  Result<void> finish() override {
    const std::lock_guard lock(log_.mutex);
    log_.finished = true;
    return {};
  }

 private:
  Log& log_;
};

CompositePtr composite(int number) {
  auto capture = std::make_shared<capture::Capture>();
  capture->number = number;
  auto out = std::make_shared<Composite>();
  out->capture = std::move(capture);
  return out;
}

class SinkThreadTest : public ::testing::Test {
 protected:
  void await_entered(int count) {
    std::unique_lock lock(log_.mutex);
    log_.changed.wait(lock, [&] { return log_.entered >= count; });
  }
  GatedSink::Log log_;
};

TEST_F(SinkThreadTest, WritesEverythingInOrderAndFinishes) {
  SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kWait);
  for (int i = 1; i <= 50; ++i) ASSERT_TRUE(sink.push(composite(i)));
  ASSERT_TRUE(sink.finish());
  ASSERT_EQ(log_.numbers.size(), 50U);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(log_.numbers[static_cast<std::size_t>(i)], i + 1);
  EXPECT_TRUE(log_.finished);
  EXPECT_EQ(sink.report().written, 50U);
  EXPECT_EQ(sink.report().dropped, 0U);
}

TEST_F(SinkThreadTest, ASlowLiveSinkLosesItsOldestFramesAndPushNeverWaits) {
  SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kDropOldest);
  log_.hold(true);
  ASSERT_TRUE(sink.push(composite(1)));
  await_entered(1);  // it holds frame 1, the queue is empty
  for (int i = 2; i <= 20; ++i) ASSERT_TRUE(sink.push(composite(i)));
  log_.hold(false);
  ASSERT_TRUE(sink.finish());
  EXPECT_EQ(log_.numbers, (std::vector<int>{1, 19, 20}));
  EXPECT_EQ(sink.report().written, 3U);
  EXPECT_EQ(sink.report().dropped, 17U);
}

TEST_F(SinkThreadTest, AnErrorReachesTheNextPushAndFinish) {
  log_.fails_at = 2;
  SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kWait);
  ASSERT_TRUE(sink.push(composite(1)));
  ASSERT_TRUE(sink.push(composite(2)));
  ASSERT_TRUE(test::comes_true([&] { return !sink.push(composite(3)); }));
  const auto finished = sink.finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().context, "disk full");
  EXPECT_EQ(log_.numbers, std::vector<int>{1});
  EXPECT_FALSE(log_.finished) << "a sink that failed is not finished";
}

TEST_F(SinkThreadTest, WhatASinkThrowsIsItsError) {
  log_.throws_at = 2;
  SinkThread thread(std::make_unique<GatedSink>(log_), WhenFull::kWait);
  for (int number = 1; number <= 2; ++number) ASSERT_TRUE(thread.push(composite(number)));
  thread.wait_until_idle();
  EXPECT_TRUE(test::refused(thread.push(composite(3)), {"gated: no memory is left"}));
  EXPECT_FALSE(thread.finish());
  EXPECT_EQ(thread.report().written, 1U);
}

TEST_F(SinkThreadTest, IsIdleWhenAllThatWasPushedIsWritten) {
  SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kWait);
  for (int i = 1; i <= 20; ++i) {
    ASSERT_TRUE(sink.push(composite(i)));
    sink.wait_until_idle();
    EXPECT_EQ(sink.report().written, static_cast<std::uint64_t>(i));
  }
  log_.fails_at = 21;
  ASSERT_TRUE(sink.push(composite(21)));
  sink.wait_until_idle();
  EXPECT_FALSE(sink.push(composite(22))) << "an error is known when the sink is idle";
}

TEST_F(SinkThreadTest, WritesNothingWhileItsGateIsPausedAndEverythingAfter) {
  WorkGate gate;
  SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kWait, &gate);
  for (int number = 1; number <= 20; ++number) {
    {
      const WorkGate::Pause pause(&gate);
      ASSERT_TRUE(sink.push(composite(number)));  // returns when the thread has taken it
      for (int i = 0; i < 200; ++i) std::this_thread::yield();
      const std::lock_guard lock(log_.mutex);
      EXPECT_EQ(log_.entered, number - 1);
    }
    sink.wait_until_idle();
    EXPECT_EQ(sink.report().written, static_cast<std::uint64_t>(number));
  }
  ASSERT_TRUE(sink.finish());
  EXPECT_EQ(log_.numbers.size(), 20U);
}

TEST_F(SinkThreadTest, DroppedUnfinishedItEndsWithoutFinish) {
  { SinkThread sink(std::make_unique<GatedSink>(log_), WhenFull::kWait); }
  EXPECT_FALSE(log_.finished);
}

}  // namespace
}  // namespace mixrig::output
