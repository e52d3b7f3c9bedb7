// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/mean_capture.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixrig::calibration {
namespace {

using capture::Capture;
using Captures = std::span<const Capture* const>;

Image<Rgb8> mean_picture(const std::vector<const Image<Rgb8>*>& pictures) {
  const Size size = pictures.front()->size();
  const auto count = static_cast<unsigned>(pictures.size());
  Image<Rgb8> out(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      unsigned r = count / 2, g = count / 2, b = count / 2;
      for (const Image<Rgb8>* picture : pictures) {
        const Rgb8& p = picture->row(y)[x];
        r += p.r, g += p.g, b += p.b;
      }
      out.row(y)[x] = {static_cast<std::uint8_t>(r / count), static_cast<std::uint8_t>(g / count),
                       static_cast<std::uint8_t>(b / count)};
    }
  return out;
}

/// Values above 0 in more than half of the images, their means over `unit`; else 0.
Image<std::uint16_t> mean_known(const std::vector<const Image<float>*>& images, double unit) {
  const Size size = images.front()->size();
  Image<std::uint16_t> out(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      std::size_t known = 0;
      for (const Image<float>* image : images)
        if (const float value = image->row(y)[x]; value > 0) sum += value, ++known;
      const double steps = known > 0 ? sum / (static_cast<double>(known) * unit) : 0;
      const bool there = 2 * known > images.size() && steps < 65535.5;
      out.row(y)[x] = there ? static_cast<std::uint16_t>(std::lround(steps)) : 0;
    }
  return out;
}

Image<Rgb8> mean_fisheye(Captures captures) {
  std::vector<const Image<Rgb8>*> pictures;
  std::uint64_t last = 0;
  for (const Capture* c : captures) {
    const bool inside = c->fisheye_mid_exposure >= captures.front()->mid_exposure &&
                        c->fisheye_mid_exposure <= captures.back()->mid_exposure;
    if (c->fisheye.empty() || !inside || (!pictures.empty() && c->fisheye_counter == last))
      continue;
    last = c->fisheye_counter;
    pictures.push_back(&c->fisheye);
  }
  return pictures.empty() ? Image<Rgb8>() : mean_picture(pictures);
}

std::optional<device::PanTiltAngles> mean_angles(Captures captures) {
  device::PanTiltAngles mean;
  for (const Capture* c : captures) {
    if (!c->pan_tilt) return std::nullopt;
    mean.pan_rad += c->pan_tilt->pan_rad / static_cast<double>(captures.size());
    mean.tilt_rad += c->pan_tilt->tilt_rad / static_cast<double>(captures.size());
  }
  return mean;
}

}  // namespace

StillView mean_of(Captures captures, double depth_unit_m) {
  std::vector<const Image<Rgb8>*> plates;
  std::vector<const Image<float>*> depths, amplitudes, depths2, amplitudes2;
  for (const Capture* c : captures) {
    plates.push_back(&c->plate);
    depths.push_back(&c->depth_m);
    if (!c->amplitude.empty()) amplitudes.push_back(&c->amplitude);
    if (c->depth2.depth_m.empty() || c->depth2.amplitude.empty()) continue;
    depths2.push_back(&c->depth2.depth_m), amplitudes2.push_back(&c->depth2.amplitude);
  }
  StillView view;
  view.target = mean_picture(plates);
  view.depth = mean_known(depths, depth_unit_m);
  if (!amplitudes.empty()) view.amplitude = mean_known(amplitudes, 1);
  if (!depths2.empty()) {
    view.depth2 = mean_known(depths2, depth_unit_m);
    view.amplitude2 = mean_known(amplitudes2, 1);
  }
  view.fisheye = mean_fisheye(captures);
  view.pan_tilt = mean_angles(captures);
  return view;
}

}  // namespace mixrig::calibration
