// SPDX-License-Identifier: Apache-2.0
// The path of a frame from driver to consumer allocates nothing, also with ticks and a head.
#include "tests/support/count_allocations.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

TEST_F(Session, NothingIsAllocatedPerFrameAfterStart) {
  add_head();
  ASSERT_TRUE(session_->start());
  run(400);
  long by_reports = 0;
  const auto is_heard = [&] {
    const long before = test::own_allocations;
    const bool heard = session_->report().ticks >= ticked_;
    by_reports += test::own_allocations - before;
    return heard;
  };
  const long before = test::allocations;
  std::uint64_t sets = 0;
  for (int i = 0; i < 400; ++i) {
    clock_.advance(10ms);
    const std::uint64_t number = trigger_->tick();
    ++ticked_;
    wait(is_heard);  // a frame that comes before its tick would be of an older one
    if (number % 10 == 0) side_->emit();
    if (number % 4 != 0) continue;
    color_->emit();
    depth_->emit();
    sets += session_->next(60s).has_value() ? 1 : 0;
  }
  EXPECT_GT(by_reports, 0);
  EXPECT_EQ(test::allocations - before - by_reports, 0);
  EXPECT_EQ(sets, 100U);
  session_->stop();
}

}  // namespace
}  // namespace mixrig::live
