// SPDX-License-Identifier: Apache-2.0
// The beginning of a live run: what was exposed before it was ready is not composited.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "host/run/loop/run.h"
#include "tests/unit/run/posed_source.h"

namespace mixrig::session {
namespace {

class FirstFrameSink final : public output::CompositeSink {
 public:
  explicit FirstFrameSink(std::atomic<int>& first) : first_(first) {}
  std::string_view name() const override { return "first frame"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    int none = 0;
    (void)first_.compare_exchange_strong(none, composite->capture->number);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  std::atomic<int>& first_;
};

/// Captures 1 to 5 were exposed 200 to 40 ms before the run is ready; the 6th comes once a frame
/// was composited.
TEST(WarmUpRun, BeginsWithACaptureThatIsNotLate) {
  std::atomic<int> first = 0;
  ManualClock clock;
  clock.advance(std::chrono::seconds(10));
  const HostTime ready = clock.now();
  Session session;
  session.source = std::make_unique<test::PosedSource>(
      12,
      [&](capture::Capture& capture) {
        capture.mid_exposure = ready + std::chrono::milliseconds(40) * (capture.number - 6);
        while (capture.number > 5 && first == 0) std::this_thread::yield();
      },
      true);
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunOptions options;
  options.watch_room = false;
  RunParts parts;
  parts.sinks.push_back(std::make_unique<FirstFrameSink>(first));
  const auto report = run(session, options, clock, {}, std::move(parts));
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(first, 5) << "40 ms late is a period";
  EXPECT_LE(report->before_ready, 4U);
  EXPECT_GE(report->before_ready, 1U) << "the one that it became ready with";
}

/// A source that has nothing but late captures is composited all the same.
TEST(WarmUpRun, KeepsTheLastCaptureThatThereIs) {
  std::atomic<int> first = 0;
  ManualClock clock;
  clock.advance(std::chrono::seconds(10));
  Session session;
  session.source = std::make_unique<test::PosedSource>(1, nullptr, true);
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunOptions options;
  options.watch_room = false;
  RunParts parts;
  parts.sinks.push_back(std::make_unique<FirstFrameSink>(first));
  const auto report = run(session, options, clock, {}, std::move(parts));
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(first, 1);
  EXPECT_EQ(report->before_ready, 0U);
  EXPECT_EQ(report->frames.frame_ms.count(), 1U) << "the warming up is no frame";
}

}  // namespace
}  // namespace mixrig::session
