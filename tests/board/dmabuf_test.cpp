// SPDX-License-Identifier: Apache-2.0
// Camera pictures in shared memory: V4L2's buffers exported by the kernel, and textures of the
// memory of a DRM device (vgem), on which Mesa's software renderer offers imports.
#include <cstring>
#include <mutex>
#include <optional>
#include <random>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include "hal/linux/v4l2/v4l2_camera.h"
#include "host/render/gles/plate/plate_import.h"
#include "host/render/gles/plate/plate_pass.h"
#include "tests/board/dumb_buffer.h"
#include "tests/gl/gl_fixture.h"
#include "tests/support/progress.h"

namespace mixrig::board {
namespace {

constexpr const char* kNode = "/dev/video0";
constexpr Size kCamera_px{320, 180};
SystemClock g_clock;

/// The newest frames of a camera.
class Kept {
 public:
  device::FrameSink sink() {
    return [this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      ++count_;
      if (keeps_ > frames_.size()) frames_.push_back(frame);
    };
  }
  /// Keeps the next `frames` frames.
  void keep(std::size_t frames) {
    const std::lock_guard lock(mutex_);
    frames_.clear();
    keeps_ = frames;
  }
  std::vector<device::FramePtr> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  bool wait_for(std::size_t frames) {
    return test::comes_true([&] { return this->frames().size() == frames; });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<device::FramePtr> frames_;
  std::size_t keeps_ = 0, count_ = 0;
};

std::unique_ptr<device::V4l2Camera> open_camera(device::PixelFormat format) {
  auto camera = device::V4l2Camera::open(
      kNode, {.size = kCamera_px, .format = format, .rate_hz = 30, .lends = true}, g_clock);
  EXPECT_TRUE(camera) << to_line(camera.error());
  return camera ? *std::move(camera) : nullptr;
}

/// Whether the frame's DMABUF, mapped separately, holds the bytes of the frame.
bool holds_the_same(const device::Frame& frame) {
  const std::size_t all = frame.memory.offset_bytes + frame.bytes.size();
  void* const address = ::mmap(nullptr, all, PROT_READ, MAP_SHARED, frame.memory.fd, 0);
  if (address == MAP_FAILED) return false;
  const auto* bytes = static_cast<const std::uint8_t*>(address) + frame.memory.offset_bytes;
  const bool same = std::memcmp(bytes, frame.bytes.data(), frame.bytes.size()) == 0;
  ::munmap(address, all);
  return same;
}

TEST(LentBuffers, AreTheBytesOfTheDmabufAndGoBackWhenTheyAreDropped) {
  using device::PixelFormat;
  for (const PixelFormat format :
       {PixelFormat::kYuyv, PixelFormat::kNv12, PixelFormat::kGray8, PixelFormat::kBayerRggb8}) {
    const auto camera = open_camera(format);
    ASSERT_TRUE(camera);
    Kept kept;
    kept.keep(2);
    ASSERT_TRUE(camera->start(kept.sink()));
    ASSERT_TRUE(kept.wait_for(2)) << device::name(format);
    const auto frames = kept.frames();
    for (const device::FramePtr& frame : frames) {
      ASSERT_TRUE(frame->memory) << device::name(format);
      EXPECT_TRUE(holds_the_same(*frame)) << device::name(format);
    }
    // vivid draws a running counter: a held picture must not change while others are taken.
    const std::vector<std::uint8_t> first(frames[0]->bytes.begin(), frames[0]->bytes.end());
    const std::size_t before = kept.count();
    ASSERT_TRUE(test::comes_true([&] { return kept.count() > before + 20; }))
        << "buffers that are dropped are queued again";
    EXPECT_EQ(std::memcmp(first.data(), frames[0]->bytes.data(), first.size()), 0);
    const int fd = frames[0]->memory.fd;
    camera->stop();
    EXPECT_GE(::fcntl(fd, F_GETFD), 0);
    kept.keep(0);
    EXPECT_TRUE(holds_the_same(*frames[1])) << "a frame outlives the stream";
  }
}

TEST(LentBuffers, ALateConsumerGetsCopiesAndTheCameraGoesOn) {
  const auto camera = open_camera(device::PixelFormat::kYuyv);
  ASSERT_TRUE(camera);
  Kept kept;
  kept.keep(10);  // the number of copies that the driver has
  ASSERT_TRUE(camera->start(kept.sink()));
  ASSERT_TRUE(kept.wait_for(10));
  int lent = 0;
  for (const auto& frame : kept.frames()) lent += static_cast<bool>(frame->memory);
  EXPECT_GT(lent, 0);
  EXPECT_LT(lent, 10);
  const std::size_t before = kept.count();
  EXPECT_TRUE(test::comes_true([&] { return kept.count() > before + 5; }));
  camera->stop();
}

/// A camera's picture in the memory of vgem.
struct VgemPicture {
  VgemPicture(RawLayout layout, Size size, std::uint32_t index) : decoded(size) {
    const int row = layout == RawLayout::kYuyv ? 2 * size.width : size.width;
    const int rows = layout == RawLayout::kNv12 ? size.height * 3 / 2 : size.height;
    buffer = DumbBuffer::make("vgem", {row, rows});
    if (!buffer) return;
    raw = {.layout = layout,
           .size = size,
           .stride_bytes = buffer->stride_bytes(),
           .bytes = buffer->bytes(),
           .red_x = 1,
           .yuv = {257 * 18997, 16, -1160, 102, -25, -52, 128, 6}};
    raw.memory = {.fd = buffer->fd(), .set = 1, .index = index};
  }
  /// Fills the buffer with random bytes, like a camera.
  void fill(unsigned seed) {
    std::mt19937 generator(seed);
    for (auto& byte : buffer->bytes()) byte = static_cast<std::uint8_t>(generator());
    for (int y = 0; y < decoded.height(); ++y)
      for (int x = 0; x < decoded.width(); ++x) decoded.at(x, y) = pixel_of(raw, x, y);
  }
  std::unique_ptr<DumbBuffer> buffer;
  RawPicture raw;
  Image<Rgb8> decoded;
};

/// Runs the plate pass through a lens, on a driver that imports.
class Imports : public test::GlTest {
 protected:
  void SetUp() override {
    const auto calls = render::gles::find_import_calls(*context_);
    ASSERT_TRUE(calls) << context_->renderer() << ": " << to_line(calls.error());
    imports_.emplace(*calls);
    render::CompositorSetup setup;
    setup.view = {kSize, 1, 1, 0, 0};
    setup.target.pinhole = {kSize, 1.02, 0.97, -0.7, 0.4};
    auto pass = render::gles::PlatePass::create(setup, false);
    ASSERT_TRUE(pass) << to_line(pass.error());
    pass_.emplace(std::move(*pass));
    ASSERT_TRUE(pass_->prepare_decoding());
  }
  /// Number of pixels of the view that differ between the picture read in place and its copy; -1
  /// where the driver refuses the picture.
  int differing(const VgemPicture& picture) {
    const auto* planes = imports_->find(picture.raw);
    if (planes == nullptr) return -1;
    pass_->decode(picture.raw, *planes);
    pass_->draw();
    const auto in_place = test::read(pass_->in_view());
    EXPECT_TRUE(pass_->upload_plate(picture.decoded));
    pass_->draw();
    const auto copied = test::read(pass_->in_view());
    int count = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) count += in_place.at(x, y) != copied.at(x, y);
    return count;
  }
  static constexpr Size kSize{96, 64};
  std::optional<render::gles::PlateImports> imports_;
  std::optional<render::gles::PlatePass> pass_;
};

TEST_F(Imports, APictureReadInPlaceIsDrawnAsItsCopy) {
  std::uint32_t index = 0;
  for (const RawLayout layout :
       {RawLayout::kYuyv, RawLayout::kNv12, RawLayout::kGray, RawLayout::kBayer}) {
    VgemPicture picture(layout, kSize, index++);
    ASSERT_TRUE(picture.buffer) << "no dumb buffer of vgem";
    picture.fill(1);
    EXPECT_EQ(differing(picture), 0) << name(layout);
    // The camera fills the same buffer again; it is not imported again.
    picture.fill(2);
    EXPECT_EQ(differing(picture), 0) << name(layout) << ", filled again";
    EXPECT_EQ(imports_->size(), index);
  }
}

TEST_F(Imports, ABufferThatIsNoneIsRefusedAndSoAreAllAfterIt) {
  VgemPicture good(RawLayout::kYuyv, kSize, 0), bad(RawLayout::kYuyv, kSize, 1);
  ASSERT_TRUE(good.buffer && bad.buffer);
  good.fill(1), bad.fill(2);
  const int none = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  bad.raw.memory.fd = none;
  EXPECT_EQ(differing(good), 0);
  EXPECT_EQ(differing(bad), -1);
  EXPECT_NE(imports_->why().find("does not take a camera's buffer"), std::string::npos);
  EXPECT_EQ(differing(good), -1);
  ::close(none);
}

}  // namespace
}  // namespace mixrig::board
