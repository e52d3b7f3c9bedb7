// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/decode.h"

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/each_pixel.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::capture {
namespace {

using device::PixelFormat;

device::Frame frame(PixelFormat format, Size size, std::span<const std::uint8_t> bytes,
                    std::size_t stride = 0) {
  device::Frame f;
  f.format = format;
  f.size = size;
  f.stride_bytes = stride > 0 ? stride : device::row_bytes(format, size.width);
  f.bytes = bytes;
  return f;
}

/// Decodes like for a camera that states nothing about its colours.
Result<void> usual(const device::Frame& frame, Image<Rgb8>& out) {
  return ColorDecoder().decode(frame, out);
}

struct Matrix {
  double kr, kb;
  bool full;
};
constexpr Matrix k601{0.299, 0.114, false};

/// YUV in exact arithmetic, 8 bit, by the matrix' luma coefficients.
Eigen::Vector3d exact_rgb(int y, int u, int v, const Matrix& matrix = k601) {
  const double luma = matrix.full ? y / 255.0 : (y - 16) / 219.0;
  const double chroma = matrix.full ? 255.0 : 224.0;
  const double blue = (u - 128) / chroma, red = (v - 128) / chroma;
  const double kr = matrix.kr, kb = matrix.kb, kg = 1 - kr - kb;
  const Eigen::Vector3d rgb(luma + 2 * (1 - kr) * red,
                            luma - 2 * kb * (1 - kb) / kg * blue - 2 * kr * (1 - kr) / kg * red,
                            luma + 2 * (1 - kb) * blue);
  return 255 * rgb.cwiseMax(0).cwiseMin(1);
}

void expect_exact(Rgb8 pixel, int y, int u, int v) {
  const Eigen::Vector3d exact = exact_rgb(y, u, v);
  ASSERT_NEAR(pixel.r, exact[0], 1) << y << " " << u << " " << v;
  ASSERT_NEAR(pixel.g, exact[1], 1) << y << " " << u << " " << v;
  ASSERT_NEAR(pixel.b, exact[2], 3) << y << " " << u << " " << v;
}

TEST(Decode, EveryYuvFollowsBt601) {
  std::vector<std::uint8_t> yuyv(512), nv12(256 + 256);
  Image<Rgb8> out;
  for (int u = 0; u < 256; u += 3)
    for (int v = 0; v < 256; v += 3) {
      for (int x = 0; x < 256; ++x) {
        const auto index = static_cast<std::size_t>(x);
        yuyv[2 * index] = nv12[index] = static_cast<std::uint8_t>(x);
        yuyv[2 * index + 1] = nv12[256 + index] = static_cast<std::uint8_t>(x % 2 == 0 ? u : v);
      }
      ASSERT_TRUE(usual(frame(PixelFormat::kYuyv, {256, 1}, yuyv), out));
      for (int x = 0; x < 256; ++x) expect_exact(out.at(x, 0), x, u, v);
      ASSERT_TRUE(usual(frame(PixelFormat::kNv12, {256, 1}, nv12), out));
      for (int x = 0; x < 256; ++x) expect_exact(out.at(x, 0), x, u, v);
    }
}

// Widths around the blocks of vector instructions and of the decoder; rows are padded.
TEST(Decode, YuvOfAnyWidthReadsItsOwnSamples) {
  std::mt19937 random(3);
  for (const int width : {1, 2, 3, 7, 15, 16, 17, 31, 33, 640, 1023, 1024, 1025, 2050}) {
    for (const PixelFormat format : {PixelFormat::kYuyv, PixelFormat::kNv12}) {
      const std::size_t stride = device::row_bytes(format, width + width % 2) + 6;
      std::vector<std::uint8_t> bytes(device::image_bytes(format, {width, 3}, stride));
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      Image<Rgb8> out;
      ASSERT_TRUE(usual(frame(format, {width, 3}, bytes, stride), out));
      for (std::size_t y = 0; y < 3; ++y)
        for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
          const bool packed = format == PixelFormat::kYuyv;
          const std::size_t luma = y * stride + (packed ? 2 * x : x);
          const std::size_t u =
              packed ? y * stride + x / 2 * 4 + 1 : (3 + y / 2) * stride + x / 2 * 2;
          expect_exact(out.at(static_cast<int>(x), static_cast<int>(y)), bytes[luma], bytes[u],
                       bytes[u + (packed ? 2 : 1)]);
        }
    }
  }
}

TEST(Decode, Nv12WithHalfAPairOfChromaIsRefused) {
  const std::vector<std::uint8_t> bytes(device::image_bytes(PixelFormat::kNv12, {5, 2}, 5));
  Image<Rgb8> out;
  EXPECT_FALSE(usual(frame(PixelFormat::kNv12, {5, 2}, bytes), out));
}

TEST(Decode, PackedColoursKeepTheirOrderAndStride) {
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 4, 5, 6, 99, 99, 7, 8, 9, 10, 11, 12, 99, 99};
  Image<Rgb8> out;
  ASSERT_TRUE(usual(frame(PixelFormat::kRgb8, {2, 2}, bytes, 8), out));
  EXPECT_EQ(out.at(1, 1), (Rgb8{10, 11, 12}));
  ASSERT_TRUE(usual(frame(PixelFormat::kBgr8, {2, 2}, bytes, 8), out));
  EXPECT_EQ(out.at(0, 1), (Rgb8{9, 8, 7}));
}

TEST(Decode, GrayKeepsTheUpperByte) {
  const std::vector<std::uint8_t> bytes = {0xFF, 0x12, 0x00, 0x80};
  Image<Rgb8> out;
  ASSERT_TRUE(usual(frame(PixelFormat::kGray16, {2, 1}, bytes), out));
  EXPECT_EQ(out.at(0, 0), (Rgb8{0x12, 0x12, 0x12}));
  EXPECT_EQ(out.at(1, 0), (Rgb8{0x80, 0x80, 0x80}));
}

TEST(Decode, AFlatColourBehindEveryBayerPatternIsThatColour) {
  struct Pattern {
    PixelFormat format;
    int red_x, red_y;
  };
  for (const Pattern& p :
       {Pattern{PixelFormat::kBayerRggb8, 0, 0}, Pattern{PixelFormat::kBayerGrbg8, 1, 0},
        Pattern{PixelFormat::kBayerGbrg8, 0, 1}, Pattern{PixelFormat::kBayerBggr8, 1, 1},
        Pattern{PixelFormat::kBayerRggb16, 0, 0}, Pattern{PixelFormat::kBayerGrbg16, 1, 0},
        Pattern{PixelFormat::kBayerGbrg16, 0, 1}, Pattern{PixelFormat::kBayerBggr16, 1, 1}}) {
    const bool wide = device::row_bytes(p.format, 1) == 2;
    std::vector<std::uint8_t> bytes;
    for (const auto [x, y] : test::each_pixel({0, 0}, {7, 6})) {
      const bool row = y % 2 == p.red_y, column = x % 2 == p.red_x;
      if (wide) bytes.push_back(0x55);
      bytes.push_back(row && column ? 200 : row != column ? 100 : 50);
    }
    Image<Rgb8> out;
    ASSERT_TRUE(usual(frame(p.format, {7, 6}, bytes), out));
    for (const auto [x, y] : test::each_pixel({0, 0}, {7, 6}))
      EXPECT_EQ(out.at(x, y), (Rgb8{200, 100, 50})) << name(p.format) << x << y;
  }
}

// Coefficients of ITU-R BT.601, BT.709 and BT.2020.
TEST(Decode, EveryMatrixAndRangeThatADriverTellsIsHonoured) {
  struct Case {
    device::YuvMatrix matrix;
    device::SampleRange range;
    Matrix exact;
  };
  using enum device::YuvMatrix;
  using enum device::SampleRange;
  for (const Case& c :
       {Case{kBt601, kFull, {0.299, 0.114, true}}, Case{kBt601, kLimited, {0.299, 0.114, false}},
        Case{kBt709, kUsual, {0.2126, 0.0722, false}}, Case{kBt709, kFull, {0.2126, 0.0722, true}},
        Case{kBt2020, kLimited, {0.2627, 0.0593, false}},
        Case{kBt2020, kFull, {0.2627, 0.0593, true}}}) {
    ColorDecoder decoder({.encoding = {.matrix = c.matrix, .range = c.range}});
    for (const PixelFormat format : {PixelFormat::kYuyv, PixelFormat::kNv12})
      for (const auto& [y, u, v] :
           {std::array{180, 90, 170}, std::array{60, 140, 100}, std::array{128, 128, 128},
            std::array{200, 100, 128}, std::array{41, 240, 110}, std::array{200, 17, 140}}) {
        const auto Y = static_cast<std::uint8_t>(y), U = static_cast<std::uint8_t>(u),
                   V = static_cast<std::uint8_t>(v);
        const std::vector<std::uint8_t> yuyv = {Y, U, Y, V}, nv12 = {Y, Y, U, V};
        Image<Rgb8> out;
        ASSERT_TRUE(
            decoder.decode(frame(format, {2, 1}, format == PixelFormat::kYuyv ? yuyv : nv12), out));
        const Eigen::Vector3d exact = exact_rgb(y, u, v, c.exact);
        const bool own_rows = c.matrix != kBt601 && !c.exact.full;  // the others are libyuv's
        EXPECT_NEAR(out.at(1, 0).r, exact[0], own_rows ? 1 : 2) << static_cast<int>(c.matrix) << y;
        EXPECT_NEAR(out.at(1, 0).g, exact[1], own_rows ? 1 : 2) << static_cast<int>(c.matrix) << y;
        EXPECT_NEAR(out.at(1, 0).b, exact[2], own_rows ? 1 : 3) << static_cast<int>(c.matrix) << y;
      }
  }
}

/// sRGB by IEC 61966-2-1.
double srgb(double light) {
  return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

// A grey card of 18 % and its surroundings, as four cameras send them: all give the same picture.
TEST(Decode, TheSameLightIsTheSamePictureWhateverTheTransfer) {
  struct Case {
    device::Transfer transfer;
    double gamma;
    double (*sample)(double light);  // of full scale, from the standards
  };
  const Case cases[] = {
      {device::Transfer::kSrgb, 1, [](double l) { return srgb(l) / 255; }},
      {device::Transfer::kLinear, 1, [](double l) { return l; }},
      {device::Transfer::kGamma, 2.2, [](double l) { return std::pow(l, 1 / 2.2); }},
      {device::Transfer::kBt709, 1,
       [](double l) { return l < 0.018 ? 4.5 * l : 1.099 * std::pow(l, 0.45) - 0.099; }}};
  for (const Case& c : cases) {
    ColorDecoder decoder({.encoding = {.transfer = c.transfer, .gamma = c.gamma}});
    for (const double light : {0.0, 0.02, 0.18, 0.5, 0.9, 1.0}) {
      const auto wide = static_cast<unsigned>(std::lround(65535 * c.sample(light)));
      const std::vector<std::uint8_t> grey16 = {static_cast<std::uint8_t>(wide),
                                                static_cast<std::uint8_t>(wide >> 8)};
      Image<Rgb8> out;
      ASSERT_TRUE(decoder.decode(frame(PixelFormat::kGray16, {1, 1}, grey16), out));
      EXPECT_NEAR(out.at(0, 0).g, srgb(light), 1.1) << static_cast<int>(c.transfer) << light;
      if (light < 0.1) continue;  // 8 linear bits are coarse in the dark
      const auto byte = static_cast<std::uint8_t>(std::lround(255 * c.sample(light)));
      const std::vector<std::uint8_t> rgb = {byte, byte, byte};
      ASSERT_TRUE(decoder.decode(frame(PixelFormat::kRgb8, {1, 1}, rgb), out));
      EXPECT_NEAR(out.at(0, 0).g, srgb(light), 1.1) << static_cast<int>(c.transfer) << light;
      ASSERT_TRUE(decoder.decode(frame(PixelFormat::kGray8, {1, 1}, rgb), out));
      EXPECT_NEAR(out.at(0, 0).r, srgb(light), 1.1) << static_cast<int>(c.transfer) << light;
    }
  }
}

// A linear 12-bit Bayer sensor with a pedestal of 240 steps whose red is at 1/1.6 and blue at 1/2.
TEST(Decode, BlackLevelAndGainsMakeABayerSensorsGreyCardGrey) {
  constexpr double kBlack = 240, kFull = 4095, kLight = 0.18;
  ColorDecoder decoder({.encoding = {.transfer = device::Transfer::kLinear},
                        .black = kBlack / kFull,
                        .gains = {1.6, 1, 2}});
  const double sensed[] = {kLight / 1.6, kLight, kLight / 2};
  std::vector<std::uint8_t> bytes;
  for (const auto [x, y] : test::each_pixel({0, 0}, {5, 4})) {
    const int color = y % 2 == 0 ? (x % 2 == 0 ? 0 : 1) : (x % 2 == 0 ? 1 : 2);
    const double step = kBlack + sensed[color] * (kFull - kBlack);
    const auto wide = static_cast<unsigned>(std::lround(step / kFull * 65535));
    bytes.push_back(static_cast<std::uint8_t>(wide));
    bytes.push_back(static_cast<std::uint8_t>(wide >> 8));
  }
  Image<Rgb8> out;
  ASSERT_TRUE(decoder.decode(frame(PixelFormat::kBayerRggb16, {5, 4}, bytes), out));
  for (const auto [x, y] : test::each_pixel({0, 0}, {5, 4})) {
    EXPECT_NEAR(out.at(x, y).r, srgb(kLight), 1.5) << x << y;
    EXPECT_NEAR(out.at(x, y).g, srgb(kLight), 1.5) << x << y;
    EXPECT_NEAR(out.at(x, y).b, srgb(kLight), 1.5) << x << y;
  }
}

TEST(Decode, LimitedGreyIsStretched) {
  ColorDecoder decoder({.limited_samples = true});
  const std::vector<std::uint8_t> bytes = {16, 235, 5, 126};
  Image<Rgb8> out;
  ASSERT_TRUE(decoder.decode(frame(PixelFormat::kGray8, {4, 1}, bytes), out));
  EXPECT_EQ(out.at(0, 0).g, 0);
  EXPECT_EQ(out.at(1, 0).g, 255);
  EXPECT_EQ(out.at(2, 0).g, 0);
  EXPECT_NEAR(out.at(3, 0).g, 255 * 110 / 219.0, 1);
}

TEST(Decode, ABayerPictureOfOnePixelIsRead) {
  const std::vector<std::uint8_t> bytes = {9};
  Image<Rgb8> out;
  ASSERT_TRUE(usual(frame(PixelFormat::kBayerRggb8, {1, 1}, bytes), out));
}

TEST(Decode, ShortFramesAndDepthAreRefused) {
  Image<Rgb8> out;
  for (int format = 1; format < device::kPixelFormats; ++format) {
    const std::vector<std::uint8_t> bytes(
        device::image_bytes(static_cast<PixelFormat>(format), {8, 8},
                            device::row_bytes(static_cast<PixelFormat>(format), 8)) /
        2);
    EXPECT_FALSE(usual(frame(static_cast<PixelFormat>(format), {8, 8}, bytes), out)) << format;
  }
  const std::vector<std::uint8_t> depth(128);
  EXPECT_FALSE(usual(frame(PixelFormat::kDepth16, {8, 8}, depth), out));
}

TEST(ColorDecoder, AMirroredCamerasPicturesAreTurnedBack) {
  const test::TemporaryFolder folder;
  Image<Rgb8> sent({5, 2}), seen;
  for (const auto [x, y] : test::each_pixel({0, 0}, {5, 2}))
    sent.at(x, y) = {static_cast<std::uint8_t>(40 * x), static_cast<std::uint8_t>(y), 7};
  ASSERT_TRUE(image_io::write_png(folder.path() / "p.png", std::as_const(sent).view()));
  std::ifstream in(folder.path() / "p.png", std::ios::binary);
  const std::vector<std::uint8_t> file{std::istreambuf_iterator<char>(in), {}};
  const device::Frame f = frame(PixelFormat::kMjpeg, sent.size(), file);
  ASSERT_TRUE(ColorDecoder({.mirrored = true}).decode(f, seen));
  for (const auto [x, y] : test::each_pixel({0, 0}, {5, 2}))
    EXPECT_EQ(seen.at(x, y), sent.at(4 - x, y));
  ASSERT_TRUE(ColorDecoder().decode(f, seen));
  EXPECT_EQ(seen.at(1, 1), sent.at(1, 1));
}

}  // namespace
}  // namespace mixrig::capture
