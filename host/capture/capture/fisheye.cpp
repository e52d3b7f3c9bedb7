// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/fisheye.h"

#include <algorithm>
#include <cmath>

namespace mixrig::capture {
namespace {

constexpr double kHeldPeriods = 1.5, kLongestHold_s = 1e6;

}  // namespace

Duration fisheye_hold(double rate_hz) {
  if (!(rate_hz > 0)) return {};
  return Duration(std::llround(1e9 * std::min(kHeldPeriods / rate_hz, kLongestHold_s)));
}

StreamStatus fisheye_status(bool first, HostTime plate, HostTime picture, Duration hold) {
  if (first) return StreamStatus::kFresh;
  return plate - picture <= hold ? StreamStatus::kRepeated : StreamStatus::kMissing;
}

void clear_fisheye(Capture& capture) {
  capture.fisheye.reset({});
  capture.fisheye_mid_exposure = {};
  capture.fisheye_counter = 0;
}

void lose_fisheye(Capture& capture) {
  clear_fisheye(capture);
  capture.set_status(Stream::kFisheye, StreamStatus::kMissing);
}

}  // namespace mixrig::capture
