// SPDX-License-Identifier: Apache-2.0
// A composite whose images a test knows.
#pragma once

#include <memory>

#include "host/output/sink/composite_sink.h"

namespace mixrig::viewfinder {

inline constexpr Size kMadeSize{160, 120};
inline constexpr Rgb8 kMadePlate{10, 20, 30};

inline Rgb8 made_color(int x, int y) {
  return {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 77};
}

/// A composite with all images; its capture is frame `number`, exposed at `at`.
inline std::shared_ptr<output::Composite> made_composite(int number = 1, HostTime at = {}) {
  auto capture = std::make_shared<capture::Capture>();
  capture->number = number, capture->mid_exposure = at;
  capture->plate.reset({80, 60}, kMadePlate);
  capture->set_status(capture::Stream::kPlate, capture::StreamStatus::kFresh);
  capture->set_status(capture::Stream::kDepth, capture::StreamStatus::kFresh);
  auto made = std::make_shared<output::Composite>();
  made->capture = std::move(capture);
  render::FrameOutput& images = made->images;
  images.wanted = render::kAll;
  images.color.reset(kMadeSize);
  for (int y = 0; y < kMadeSize.height; ++y)
    for (int x = 0; x < kMadeSize.width; ++x) images.color.at(x, y) = made_color(x, y);
  images.mixed_depth_m.reset(kMadeSize, 2.0F);
  images.state.reset(kMadeSize, static_cast<std::uint8_t>(render::PixelState::kEdge));
  images.light.reset(kMadeSize, 1.0F);
  images.matte.reset(kMadeSize, 200);
  return made;
}

}  // namespace mixrig::viewfinder
