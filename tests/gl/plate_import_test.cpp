// SPDX-License-Identifier: Apache-2.0
// Camera pictures read in place: samples are decoded as by the host's decoder, buffers are imported
// once, and pictures that cannot be imported are copied. Real imports are tested in tests/board.
#include "host/render/gles/plate/plate_import.h"

#include <optional>
#include <random>

#include "host/render/frame/exposure.h"
#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/plate/decode_pass.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/room_setup.h"

namespace mixrig::test {
namespace {

using namespace render::gles;
using render::PlateNeed;

std::vector<std::uint8_t> noise(std::size_t count) {
  std::mt19937 generator(3);
  std::vector<std::uint8_t> bytes(count);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(generator());
  return bytes;
}

constexpr YuvToRgb kYuv{.y_scale = 257 * 18997,
                        .y_shift = 16,
                        .y_add = -1160,
                        .red_v = 102,
                        .green_u = -25,
                        .green_v = -52,
                        .blue_u = 128,
                        .shift = 6};

RawPicture raw_of(RawLayout layout, Size size, const std::vector<std::uint8_t>& bytes,
                  std::size_t stride) {
  return {.layout = layout, .size = size, .stride_bytes = stride, .bytes = bytes, .yuv = kYuv};
}

/// The picture's planes as textures, as an import would provide them.
ImportedPlanes textures_of(const RawPicture& picture) {
  ImportedPlanes out;
  const PlaneLayouts layouts = planes_of(picture);
  for (std::size_t i = 0; i < layouts.count; ++i) {
    const PlaneLayout& plane = layouts.planes[i];
    out[i] = make_texture(plane.size, plane.internal_format);
    const int texel = plane.internal_format == GL_RG8 ? 2 : 1;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(plane.stride_bytes) / texel);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, plane.size.width, plane.size.height,
                    texel == 2 ? GL_RG : GL_RED, GL_UNSIGNED_BYTE,
                    picture.bytes.data() + plane.offset_bytes);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  }
  return out;
}

class DecodePassTest : public GlTest {
 protected:
  void see(Size size) {
    auto made = DecodePass::create();
    ASSERT_TRUE(made) << to_line(made.error());
    pass_.emplace(std::move(*made));
    color_ = make_texture(size, GL_SRGB8_ALPHA8);
    auto target = make_target({&color_});
    ASSERT_TRUE(target) << to_line(target.error());
    target_ = std::move(*target);
  }
  int differing(const RawPicture& picture) {
    pass_->draw(picture, textures_of(picture), target_);
    const auto drawn = read(color_);
    int count = 0;
    for (int y = 0; y < drawn.height(); ++y)
      for (int x = 0; x < drawn.width(); ++x) {
        const Rgb8 want = pixel_of(picture, x, y);
        count += glm::round(255.0F * drawn.at(x, y)) != glm::vec4(want.r, want.g, want.b, 255);
      }
    return count;
  }
  std::optional<DecodePass> pass_;
  Texture color_;
  Target target_;
};

TEST_F(DecodePassTest, every_layout_becomes_the_bytes_of_the_host) {
  const auto bytes = noise(40 * 60);
  SampleTable table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto v = static_cast<std::uint8_t>(i);
    table[i] = {static_cast<std::uint8_t>(255 - v), v, static_cast<std::uint8_t>(v / 2), 255};
  }
  for (const Size size : {Size{18, 34}, Size{17, 9}, Size{1, 3}}) {
    see(size);
    for (const RawLayout layout :
         {RawLayout::kYuyv, RawLayout::kNv12, RawLayout::kGray, RawLayout::kBayer})
      for (int red = 0; red < (layout == RawLayout::kBayer ? 4 : 1); ++red) {
        RawPicture picture = raw_of(layout, size, bytes, 40);
        picture.red_x = red & 1, picture.red_y = red >> 1;
        EXPECT_EQ(differing(picture), 0) << name(layout) << size.width << ", red " << red;
        picture.samples = &table;
        EXPECT_EQ(differing(picture), 0) << name(layout) << size.width << ", table, red " << red;
      }
  }
}

// Each byte survives the conversion to linear light and back.
TEST_F(DecodePassTest, every_grey_stays) {
  std::vector<std::uint8_t> bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  see({256, 1});
  EXPECT_EQ(differing(raw_of(RawLayout::kGray, {256, 1}, bytes, 256)), 0);
}

TEST_F(DecodePassTest, products_of_24_bits_are_whole) {
  const auto bytes = noise(64 * 64);
  RawPicture picture = raw_of(RawLayout::kYuyv, {32, 64}, bytes, 64);
  see({32, 64});
  // Coefficients of limited-range BT.2020 in 1/65536.
  picture.yuv = {76309, 0, 32768 - 16 * 76309, 110013, -12277, -42626, 140363, 16};
  EXPECT_EQ(differing(picture), 0);
}

TEST(Planes, of_each_layout_are_plain_samples) {
  RawPicture picture{.layout = RawLayout::kYuyv, .size = {641, 480}, .stride_bytes = 1344};
  picture.memory.offset_bytes = 4096;
  PlaneLayouts planes = planes_of(picture);
  ASSERT_EQ(planes.count, 1U);
  EXPECT_EQ(planes.planes[0].fourcc, 0x38385247U);  // 'GR88'
  EXPECT_EQ(planes.planes[0].size, (Size{642, 480}));
  EXPECT_EQ(planes.planes[0].offset_bytes, 4096U);
  EXPECT_EQ(planes.planes[0].stride_bytes, 1344U);
  picture.layout = RawLayout::kNv12, picture.size = {640, 481}, picture.stride_bytes = 704;
  planes = planes_of(picture);
  ASSERT_EQ(planes.count, 2U);
  EXPECT_EQ(planes.planes[0].fourcc, 0x20203852U);  // 'R8  '
  EXPECT_EQ(planes.planes[0].size, (Size{640, 481}));
  EXPECT_EQ(planes.planes[1].fourcc, 0x38385247U);
  EXPECT_EQ(planes.planes[1].size, (Size{320, 241}));
  EXPECT_EQ(planes.planes[1].offset_bytes, 4096U + 704U * 481U);
  picture.layout = RawLayout::kBayer;
  planes = planes_of(picture);
  ASSERT_EQ(planes.count, 1U);
  EXPECT_EQ(planes.planes[0].fourcc, 0x20203852U);
  EXPECT_EQ(planes.planes[0].size, (Size{640, 481}));
}

/// A driver that counts its calls.
struct FakeDriver {
  int created = 0, destroyed = 0, attached = 0;
  int refuse_from = 1 << 30;  ///< number of the first call that fails
  bool refuses_modifiers = false;
  std::vector<EGLint> last;
};
FakeDriver g_driver;

EGLImageKHR fake_create(EGLDisplay, EGLContext, EGLenum target, EGLClientBuffer,
                        const EGLint* attributes) {
  EXPECT_EQ(target, static_cast<EGLenum>(EGL_LINUX_DMA_BUF_EXT));
  g_driver.last.clear();
  bool modifiers = false;
  for (; *attributes != EGL_NONE; attributes += 2) {
    g_driver.last.insert(g_driver.last.end(), {attributes[0], attributes[1]});
    modifiers |= attributes[0] == EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT;
  }
  if (modifiers && g_driver.refuses_modifiers) return EGL_NO_IMAGE_KHR;
  if (g_driver.created >= g_driver.refuse_from) return EGL_NO_IMAGE_KHR;
  ++g_driver.created;
  return &g_driver;
}
EGLBoolean fake_destroy(EGLDisplay, EGLImageKHR) {
  ++g_driver.destroyed;
  return EGL_TRUE;
}
void fake_attach(GLenum target, GLeglImageOES) {
  ++g_driver.attached;
  glTexStorage2D(target, 1, GL_R8, 8, 4);
}

class PlateImportTest : public GlTest {
 protected:
  void SetUp() override { g_driver = {}; }
  static ImportCalls calls(bool modifiers = false) {
    return {.create = fake_create,
            .destroy = fake_destroy,
            .attach = fake_attach,
            .modifiers = modifiers};
  }
  static RawPicture buffer(std::uint32_t index, std::uint64_t set = 1,
                           RawLayout layout = RawLayout::kGray) {
    RawPicture picture{.layout = layout, .size = {8, 4}, .stride_bytes = 8};
    picture.memory = {.fd = 40 + static_cast<int>(index), .set = set, .index = index};
    return picture;
  }
};

TEST_F(PlateImportTest, each_buffer_is_imported_once) {
  PlateImports imports(calls());
  for (int frame = 0; frame < 20; ++frame)
    ASSERT_NE(imports.find(buffer(static_cast<std::uint32_t>(frame) % 4)), nullptr);
  EXPECT_EQ(g_driver.created, 4);
  EXPECT_EQ(g_driver.attached, 4);
  EXPECT_EQ(g_driver.destroyed, 4) << "textures keep the memory";
  EXPECT_EQ(imports.size(), 4U);
  EXPECT_EQ(imports.find(buffer(1)), imports.find(buffer(1)));
  EXPECT_NE(imports.find(buffer(1)), imports.find(buffer(2)));
}

TEST_F(PlateImportTest, buffers_of_a_device_that_came_back_take_the_place_of_the_old_ones) {
  PlateImports imports(calls());
  for (std::uint32_t i = 0; i < 4; ++i) (void)imports.find(buffer(i));
  (void)imports.find(buffer(0, 2));
  EXPECT_EQ(g_driver.created, 5);
  EXPECT_EQ(imports.size(), 1U);
}

TEST_F(PlateImportTest, a_driver_with_endless_buffers_does_not_fill_the_memory) {
  PlateImports imports(calls());
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_NE(imports.find(buffer(i)), nullptr);
  EXPECT_LE(imports.size(), 32U);
}

TEST_F(PlateImportTest, the_driver_is_told_where_a_plane_lies) {
  PlateImports imports(calls(true));
  (void)imports.find(buffer(3, 1, RawLayout::kNv12));
  EXPECT_EQ(g_driver.created, 2);
  EXPECT_EQ(g_driver.last, (std::vector<EGLint>{
                               EGL_WIDTH, 4, EGL_HEIGHT, 2, EGL_LINUX_DRM_FOURCC_EXT, 0x38385247,
                               EGL_DMA_BUF_PLANE0_FD_EXT, 43, EGL_DMA_BUF_PLANE0_OFFSET_EXT, 32,
                               EGL_DMA_BUF_PLANE0_PITCH_EXT, 8, EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT,
                               0, EGL_DMA_BUF_PLANE0_MODIFIER_HI_EXT, 0}));
}

TEST_F(PlateImportTest, a_driver_that_takes_no_modifiers_is_asked_without) {
  g_driver.refuses_modifiers = true;
  PlateImports imports(calls(true));
  EXPECT_NE(imports.find(buffer(0)), nullptr);
  EXPECT_EQ(g_driver.last.size(), 12U);
}

TEST_F(PlateImportTest, after_one_refusal_nothing_is_imported) {
  g_driver.refuse_from = 2;
  PlateImports imports(calls());
  EXPECT_NE(imports.find(buffer(0)), nullptr);
  EXPECT_NE(imports.find(buffer(1)), nullptr);
  EXPECT_EQ(imports.why(), "");
  EXPECT_EQ(imports.find(buffer(2)), nullptr);
  EXPECT_NE(imports.why().find("does not take a camera's buffer of 8x4"), std::string::npos);
  g_driver.refuse_from = 1 << 30;
  EXPECT_EQ(imports.find(buffer(0)), nullptr) << "also where it would take it now";
  EXPECT_EQ(imports.size(), 0U);
  EXPECT_EQ(g_driver.created, 2);
}

TEST_F(PlateImportTest, what_the_driver_lacks_is_named) {
  if (context_->has_display_extension("EGL_EXT_image_dma_buf_import"))
    GTEST_SKIP() << "this driver offers it";
  const auto calls = find_import_calls(*context_);
  ASSERT_FALSE(calls);
  EXPECT_EQ(calls.error().context, "the driver offers no EGL_EXT_image_dma_buf_import");
}

/// The room's plate as grey samples in a camera's memory.
class GrayPlate final : public render::SharedPlate {
 public:
  explicit GrayPlate(const Image<Rgb8>& plate) : image_(plate.size()) {
    for (int y = 0; y < plate.height(); ++y)
      for (int x = 0; x < plate.width(); ++x) {
        const std::uint8_t grey = plate.at(x, y).g;
        bytes_.push_back(grey), image_.at(x, y) = {grey, grey, grey};
      }
    raw_ = {.size = plate.size(),
            .stride_bytes = static_cast<std::size_t>(plate.width()),
            .bytes = bytes_};
    raw_.memory.fd = 0;
  }
  const RawPicture& raw() const override { return raw_; }
  ImageView<const Rgb8> decoded() const override { return ++decoded_, image_.view(); }
  std::shared_ptr<const void> hold() const override { return hold_; }
  std::shared_ptr<const void> hold_ = std::make_shared<int>();
  mutable int decoded_ = 0;
  Image<Rgb8> image_;

 private:
  std::vector<std::uint8_t> bytes_;
  RawPicture raw_;
};

TEST(PlateImportFallback, software_copies_and_a_plate_that_is_not_decoded_is) {
  const RoomSetup room({.view = {64, 48}, .tof = {32, 24}, .objects = false, .background = false});
  const auto made = render::make_gles_compositor(room.setup);
  ASSERT_TRUE(made) << to_line(made.error());
  render::Compositor& gles = **made;
  if (!is_software(gles.state().renderer)) GTEST_SKIP() << "this driver draws on a GPU";
  EXPECT_EQ(gles.state().plate_need, PlateNeed::kDecoded);
  EXPECT_EQ(gles.state().why_copied, gles.state().renderer + " draws on the processor");
  const GrayPlate plate(room.plate);
  render::FrameInput input = room.frame();
  input.plate = plate.image_;
  render::FrameOutput with_copy, with_shared;
  with_copy.wanted = with_shared.wanted = render::kComposite;
  ASSERT_TRUE(gles.compose(input, with_copy));
  input.plate = {}, input.shared = &plate;
  ASSERT_TRUE(gles.compose(input, with_shared));
  EXPECT_FALSE(gles.state().imported_plate);
  EXPECT_EQ(plate.decoded_, 1);
  EXPECT_EQ(plate.hold_.use_count(), 1) << "nothing reads its memory any more";
  int differing = 0;
  for (int y = 0; y < with_copy.color.height(); ++y)
    for (int x = 0; x < with_copy.color.width(); ++x)
      differing += !(with_copy.color.at(x, y) == with_shared.color.at(x, y));
  EXPECT_EQ(differing, 0);
}

TEST(PlateImportFallback, the_meter_reads_single_pixels_as_the_whole_plate) {
  const RoomSetup room({});
  render::Tables tables = render::make_tables(room.setup);
  render::ExposureMeter meter(tables, room.setup.background);
  const GrayPlate plate(room.plate);
  const render::ToneCurve whole = meter.curve(plate.image_), single = meter.curve(plate.raw());
  EXPECT_EQ(whole.gain, single.gain);
  EXPECT_EQ(whole.bends, single.bends);
  EXPECT_EQ(whole.slope, single.slope);
}

}  // namespace
}  // namespace mixrig::test
