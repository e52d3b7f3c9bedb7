// SPDX-License-Identifier: Apache-2.0
// Colorimetry that V4L2 drivers report, and the unit of Z16 by product.
#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {
namespace {

// Numbers of linux/videodev2.h.
enum Colorspace : std::uint32_t {
  kSpace240m = 2,
  kSpace709 = 3,
  kSpaceJpeg = 7,
  kSpaceSrgb = 8,
  kSpaceOpRgb = 9,
  kSpace2020 = 10,
  kSpaceRaw = 11,
  kSpaceDciP3 = 12
};
enum TransferNumber : std::uint32_t {
  kTransfer709 = 1,
  kTransferSrgb = 2,
  kTransferOpRgb = 3,
  kTransfer240m = 4,
  kTransferNone = 5,
  kTransferDciP3 = 6
};
enum YcbcrNumber : std::uint32_t {
  kYcbcr709 = 2,
  kYcbcrXv709 = 4,
  kYcbcr2020 = 6,
  kYcbcr2020c = 7,
  kYcbcr240m = 8
};
constexpr std::uint32_t kFullRange = 1, kLimitedRange = 2;

std::uint32_t default_transfer(std::uint32_t colorspace) {
  switch (colorspace) {
    case 0:  // not reported
    case kSpaceSrgb:
    case kSpaceJpeg:
      return kTransferSrgb;
    case kSpaceOpRgb:
      return kTransferOpRgb;
    case kSpace240m:
      return kTransfer240m;
    case kSpaceDciP3:
      return kTransferDciP3;
    case kSpaceRaw:
      return kTransferNone;
    default:
      return kTransfer709;
  }
}

void set_transfer(std::uint32_t number, ColorEncoding& encoding) {
  switch (number) {
    case kTransfer709:
    case kTransfer240m:
      encoding.transfer = Transfer::kBt709;
      return;
    case kTransferNone:
      encoding.transfer = Transfer::kLinear;
      return;
    case kTransferOpRgb:
    case kTransferDciP3:
      encoding.transfer = Transfer::kGamma;
      encoding.gamma = number == kTransferOpRgb ? 2.2 : 2.6;
      return;
    default:
      encoding.transfer = Transfer::kSrgb;
  }
}

YuvMatrix matrix_of(std::uint32_t ycbcr, std::uint32_t colorspace) {
  switch (ycbcr) {
    case 0:
      return colorspace == kSpace709 || colorspace == kSpaceDciP3 || colorspace == kSpace240m
                 ? YuvMatrix::kBt709
             : colorspace == kSpace2020 ? YuvMatrix::kBt2020
                                        : YuvMatrix::kBt601;
    case kYcbcr709:
    case kYcbcrXv709:
    case kYcbcr240m:
      return YuvMatrix::kBt709;
    case kYcbcr2020:
    case kYcbcr2020c:
      return YuvMatrix::kBt2020;
    default:
      return YuvMatrix::kBt601;
  }
}

struct Z16Product {
  std::uint16_t vendor, product;
  double metres_per_step;
};
// Units that the maker states (docs/reference/devices.md): the D400 series 1 mm, its D405 0.1 mm,
// the L515 0.25 mm. Those of the D400 series can be set by other programs.
constexpr std::uint16_t kIntel = 0x8086;
constexpr auto kZ16Products = std::to_array<Z16Product>({
    {kIntel, 0x0AD1, 1e-3},    // D400
    {kIntel, 0x0AD2, 1e-3},    // D410
    {kIntel, 0x0AD3, 1e-3},    // D415
    {kIntel, 0x0AD4, 1e-3},    // D430
    {kIntel, 0x0B07, 1e-3},    // D435
    {kIntel, 0x0B3A, 1e-3},    // D435i
    {kIntel, 0x0B5C, 1e-3},    // D455
    {kIntel, 0x0B5B, 1e-4},    // D405
    {kIntel, 0x0B64, 2.5e-4},  // L515
    {kIntel, 0x0B3D, 2.5e-4},  // L515, early
});

}  // namespace

ColorEncoding encoding_of(const V4l2Colors& colors) {
  ColorEncoding encoding;
  set_transfer(colors.transfer != 0 ? colors.transfer : default_transfer(colors.colorspace),
               encoding);
  encoding.matrix = matrix_of(colors.ycbcr, colors.colorspace);
  if (colors.quantization == kFullRange ||
      (colors.quantization == 0 && colors.colorspace == kSpaceJpeg))
    encoding.range = SampleRange::kFull;
  else if (colors.quantization == kLimitedRange)
    encoding.range = SampleRange::kLimited;
  return encoding;
}

std::optional<double> z16_metres_per_step(std::uint16_t usb_vendor, std::uint16_t usb_product) {
  for (const Z16Product& known : kZ16Products)
    if (known.vendor == usb_vendor && known.product == usb_product) return known.metres_per_step;
  return std::nullopt;
}

}  // namespace mixrig::device
