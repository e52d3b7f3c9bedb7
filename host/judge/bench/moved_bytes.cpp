// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/moved_bytes.h"

namespace mixrig::bench {
namespace {

// Bytes a view pixel.
constexpr double kPlateBytes = 3 + 8 + 8 + 3;        // sRGB, tap; linear light, sRGB
constexpr double kWarpBytes = 4 + 4;                 // cleared, drawn
constexpr double kKeyBytes = 4 + 4 + 1 + 1 + 1;      // w, limit; state; state; matte
constexpr double kLightBytes = 1 + 4 + 1 + 2 + 2;    // matte, w; matte, light; light
constexpr double kMixBytes = 4 + 4 + 1 + 4 + 4 + 2;  // w, learned, matte; two depths; light
// Bytes a ToF pixel.
constexpr double kCorrectBytes = 4 + 8 + 4 + 4 + 4 + 8 + 8 + 8 + 5;  // five sweeps
constexpr double kProjectBytes = 8 + 4 + 12 + 8;  // ray, w; u, v, w; u and w again

}  // namespace

double moved_bytes(render::Stage stage, Size view, Size tof) {
  const auto view_px = static_cast<double>(view.area()), tof_px = static_cast<double>(tof.area());
  switch (stage) {
    case render::Stage::kPlate:
      return kPlateBytes * view_px;
    case render::Stage::kCorrect:
      return kCorrectBytes * tof_px;
    case render::Stage::kWarp:
      return kWarpBytes * view_px + kProjectBytes * tof_px;
    case render::Stage::kKey:
      return kKeyBytes * view_px;
    case render::Stage::kLight:
      return kLightBytes * view_px;
    case render::Stage::kMix:
      return kMixBytes * view_px;
    default:
      return 0;
  }
}

double moved_bytes(Size view, Size tof) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(render::Stage::kCount); ++i)
    sum += moved_bytes(static_cast<render::Stage>(i), view, tof);
  return sum;
}

}  // namespace mixrig::bench
