// SPDX-License-Identifier: Apache-2.0
#include "hal/device/frame_pool.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"

namespace mixrig::device {
namespace {

Frame gray(Size size) {
  return {.format = PixelFormat::kGray8,
          .size = size,
          .stride_bytes = static_cast<std::size_t>(size.width)};
}

TEST(FramePool, PublishedFrameHoldsTheBytesOfTheDraft) {
  FramePool pool(2, 16, 4);
  auto draft = pool.take();
  ASSERT_TRUE(draft);
  for (std::size_t i = 0; i < 16; ++i) draft.bytes()[i] = static_cast<std::uint8_t>(i);
  draft.amplitude()[3] = 9;
  const FramePtr frame = std::move(draft).publish(gray({4, 4}), 12, 4);
  ASSERT_EQ(frame->bytes.size(), 12U);
  EXPECT_EQ(frame->bytes[11], 11);
  EXPECT_EQ(frame->amplitude[3], 9);
}

TEST(FramePool, PublishedSizesAreClippedToTheBuffer) {
  FramePool pool(1, 8);
  EXPECT_EQ(std::move(*std::make_unique<FramePool::Draft>(pool.take()))
                .publish(gray({4, 4}), 100)
                ->bytes.size(),
            8U);
}

TEST(FramePool, IsEmptyWhenAllAreHeldAndFullAgainWhenTheyAreDropped) {
  FramePool pool(2, 8);
  std::vector<FramePtr> held;
  held.push_back(pool.take().publish(gray({2, 2}), 4));
  held.push_back(pool.take().publish(gray({2, 2}), 4));
  EXPECT_FALSE(pool.take());
  const FramePtr second = held[0];
  held.clear();
  EXPECT_EQ(pool.free(), 1) << "a second reference keeps its buffer";
}

TEST(FramePool, AnUnpublishedDraftReturnsItsBuffer) {
  FramePool pool(1, 8);
  { const auto draft = pool.take(); }
  EXPECT_EQ(pool.free(), 1);
}

TEST(FramePool, FramesOutliveTheirPool) {
  FramePtr frame;
  {
    FramePool pool(1, 8);
    auto draft = pool.take();
    draft.bytes()[0] = 42;
    frame = std::move(draft).publish(gray({2, 2}), 4);
  }
  EXPECT_EQ(frame->bytes[0], 42);
}

TEST(FramePool, PublishingAndDroppingAllocatesNothing) {
  FramePool pool(3, 1024);
  FramePtr kept = pool.take().publish(gray({32, 32}), 1024);
  const long before = test::allocations;
  for (int i = 0; i < 1000; ++i) {
    FramePtr frame = pool.take().publish(gray({32, 32}), 1024);
    ASSERT_TRUE(frame);
    kept = frame;
  }
  EXPECT_EQ(test::allocations - before, 0);
}

TEST(FramePool, BuffersAreNeverSharedAcrossThreads) {
  FramePool pool(4, 64);
  std::vector<FramePtr> mailbox(1);
  std::mutex mutex;
  std::atomic<bool> done = false;
  std::atomic<int> torn = 0;
  std::thread reader([&] {
    while (!done) {
      FramePtr frame;
      {
        const std::lock_guard lock(mutex);
        frame = std::move(mailbox[0]);
      }
      if (!frame) continue;
      for (const std::uint8_t byte : frame->bytes)
        if (byte != frame->bytes[0]) ++torn;
    }
  });
  for (int i = 0; i < 20000; ++i) {
    auto draft = pool.take();
    if (!draft) continue;
    for (auto& byte : draft.bytes()) byte = static_cast<std::uint8_t>(i);
    const FramePtr frame = std::move(draft).publish(gray({8, 8}), 64);
    const std::lock_guard lock(mutex);
    mailbox[0] = frame;
  }
  done = true;
  reader.join();
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace mixrig::device
