// SPDX-License-Identifier: Apache-2.0
// A frame drawn by both back ends, and checks that the results agree.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>

#include "host/render/contract/compositor.h"
#include "tests/gl/room_setup.h"

namespace mixrig::test {

double psnr_db(const Image<Rgb8>& a, const Image<Rgb8>& b);
/// Share of pixels whose values lie within `tolerance`.
template <typename T>
double share_within(const Image<T>& a, const Image<T>& b, double tolerance) {
  std::size_t good = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      good +=
          std::abs(static_cast<double>(a.at(x, y)) - static_cast<double>(b.at(x, y))) <= tolerance;
  return static_cast<double>(good) / static_cast<double>(a.size().area());
}

struct Pair {
  std::unique_ptr<render::Compositor> cpu, gles;
  render::FrameOutput cpu_frame, gles_frame;
};

Pair make_pair(const RoomSetup& room);
/// Both back ends draw the frame; expects that their outputs agree.
void expect_agreement(Pair& pair, const render::FrameInput& frame);
void expect_agreement(const RoomSetup::Options& options);
bool shows(const render::FrameOutput& frame, render::Layer layer);
float time_of(const Pair& pair, render::Stage stage);
/// A frame in a world with z up whose camera is 1.4 m over the room's floor; people are keyed by
/// the capture volume alone.
render::FrameInput volume_frame(RoomSetup& room);
/// Expects agreement at rest and after a turn, with the person in view.
void expect_agreement_as_it_turns(Pair& pair, render::FrameInput frame);

}  // namespace mixrig::test
