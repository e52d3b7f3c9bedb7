// SPDX-License-Identifier: Apache-2.0
// submit() and collect() of both back ends: frames in flight, and only the wanted images.
#include <cstring>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "host/render/contract/frame_io.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/render/gles/compositor_gles.h"
#include "tests/gl/room_setup.h"

namespace mixrig::test {
namespace {

using render::FrameOutput;
using render::OutputMask;

template <typename T>
bool same(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (std::memcmp(a.row(y), b.row(y), sizeof(T) * static_cast<std::size_t>(a.width())) != 0)
      return false;
  return true;
}

/// The images among `which` that differ between two frames.
OutputMask differing(const FrameOutput& a, const FrameOutput& b, OutputMask which) {
  OutputMask out = 0;
  render::for_each_image(a, b, [&](OutputMask bit, const auto& left, const auto& right) {
    if ((which & bit) && !same(left, right)) out |= bit;
  });
  return out;
}

class InFlight : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<render::Compositor> make(const RoomSetup& room) {
    auto made = std::string(GetParam()) == "cpu" ? render::make_cpu_compositor(room.setup, 2)
                                                 : render::make_gles_compositor(room.setup);
    EXPECT_TRUE(made) << made.error().context;
    return made ? std::move(*made) : nullptr;
  }
  static constexpr Size kView{160, 120}, kTof{64, 48};
  /// A frame of the room from a camera position that depends on `number`.
  static render::FrameInput frame(const RoomSetup& room, int number) {
    render::FrameInput input = room.frame();
    input.world_from_target.translation_m.x() = 0.05 * number;
    return input;
  }
};

TEST_P(InFlight, frames_come_out_in_order_and_as_compose_makes_them) {
  const RoomSetup room({kView, kTof});
  const auto one = make(room), two = make(room);
  ASSERT_TRUE(one && two);
  ASSERT_TRUE(two->submit(frame(room, 0), render::kAll));
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(two->submit(frame(room, i + 1), render::kAll));
    EXPECT_EQ(two->in_flight(), 2);
    FrameOutput alone, queued;
    alone.wanted = render::kAll;
    ASSERT_TRUE(one->compose(frame(room, i), alone));
    ASSERT_TRUE(two->collect(queued));
    EXPECT_EQ(queued.wanted, render::kAll);
    EXPECT_EQ(differing(alone, queued, render::kAll), 0U) << "frame " << i;
    EXPECT_GT(two->state().stage_times[static_cast<std::size_t>(render::Stage::kUpload)], 0);
  }
}

TEST_P(InFlight, frames_may_want_different_images) {
  const RoomSetup room({kView, kTof});
  const auto compositor = make(room);
  ASSERT_TRUE(compositor);
  FrameOutput all, color, depth;
  all.wanted = render::kAll;
  ASSERT_TRUE(compositor->compose(frame(room, 0), all));
  ASSERT_TRUE(compositor->submit(frame(room, 0), render::kColor));
  ASSERT_TRUE(compositor->submit(frame(room, 0), render::kWarpedDepth | render::kLayer));
  ASSERT_TRUE(compositor->collect(color));
  ASSERT_TRUE(compositor->collect(depth));
  EXPECT_EQ(differing(all, color, render::kAll), render::kAll & ~render::kColor);
  EXPECT_EQ(differing(all, depth, render::kAll),
            render::kAll & ~(render::kWarpedDepth | render::kLayer));
  EXPECT_TRUE(color.matte.empty() && depth.color.empty());
}

TEST_P(InFlight, each_image_alone_is_the_same_and_the_others_stay_empty) {
  const RoomSetup room({kView, kTof}), bare({kView, kTof, false}),
      unlearned({.view = kView, .tof = kTof, .background = false});
  for (const RoomSetup* scene : {&room, &bare, &unlearned}) {
    const auto compositor = make(*scene);
    ASSERT_TRUE(compositor);
    FrameOutput all;
    all.wanted = render::kAll;
    ASSERT_TRUE(compositor->compose(frame(*scene, 1), all));
    for (OutputMask bit = 1; bit <= render::kAll; bit <<= 1) {
      FrameOutput alone;
      alone.wanted = bit;
      ASSERT_TRUE(compositor->compose(frame(*scene, 0), alone));
      ASSERT_TRUE(compositor->compose(frame(*scene, 1), alone));
      EXPECT_EQ(differing(all, alone, bit), 0U) << "output " << bit;
      const OutputMask made = render::with_needed(bit, false);
      render::for_each_image(alone, alone, [&](OutputMask other, const auto& image, const auto&) {
        EXPECT_EQ(image.empty(), (other & made) == 0) << "output " << other << " with " << bit;
      });
    }
  }
}

TEST_P(InFlight, images_that_are_not_wanted_stay_as_they_were) {
  const RoomSetup room({kView, kTof});
  const auto compositor = make(room);
  ASSERT_TRUE(compositor);
  FrameOutput output;
  output.wanted = render::kAll;
  ASSERT_TRUE(compositor->compose(frame(room, 0), output));
  const FrameOutput before = output;
  output.wanted = render::kColor;
  ASSERT_TRUE(compositor->compose(frame(room, 4), output));
  EXPECT_EQ(differing(before, output, render::kAll), render::kColor);
}

TEST_P(InFlight, too_many_and_none_are_errors_that_lose_nothing) {
  const RoomSetup room({kView, kTof});
  const auto compositor = make(room);
  ASSERT_TRUE(compositor);
  FrameOutput first, output;
  const auto none = compositor->collect(output);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kUsage);
  ASSERT_TRUE(compositor->compose(frame(room, 1), first));
  ASSERT_TRUE(compositor->submit(frame(room, 1), render::kComposite));
  EXPECT_FALSE(compositor->compose(frame(room, 2), output));
  ASSERT_TRUE(compositor->submit(frame(room, 2), render::kComposite));
  const auto third = compositor->submit(frame(room, 3), render::kComposite);
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, ErrorCode::kUsage);
  const Image<float> wrong({3, 3});
  render::FrameInput bad = frame(room, 1);
  bad.tof_depth_m = wrong;
  EXPECT_FALSE(compositor->submit(bad, render::kComposite));
  EXPECT_EQ(compositor->in_flight(), 2);
  ASSERT_TRUE(compositor->collect(output));
  EXPECT_EQ(differing(first, output, render::kComposite), 0U);
  ASSERT_TRUE(compositor->collect(output));
  EXPECT_EQ(compositor->in_flight(), 0);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, InFlight, testing::Values("cpu", "gles"),
                         [](const auto& back_end) { return std::string(back_end.param); });

}  // namespace
}  // namespace mixrig::test
