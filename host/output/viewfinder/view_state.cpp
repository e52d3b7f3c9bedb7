// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/view_state.h"

#include <algorithm>
#include <utility>

namespace mixrig::viewfinder {
namespace {

constexpr std::array<char, kOverlays> kOverlayKeys{'f', 'd', 's', 'p', 'z', 'x', 'g', 'h'};

}  // namespace

Request press(char key, ViewState& state) {
  if (key >= '1' && key < static_cast<char>('1' + kViews)) {
    state.view = static_cast<View>(key - '1');
    return Request::kNone;
  }
  if (const auto* const found = std::find(kOverlayKeys.begin(), kOverlayKeys.end(), key);
      found != kOverlayKeys.end()) {
    bool& on = state.overlays[static_cast<std::size_t>(found - kOverlayKeys.begin())];
    on = !on;
    return Request::kNone;
  }
  switch (key) {
    case ' ':
      state.frozen = !state.frozen;
      return Request::kNone;
    case 'b':
      return Request::kLearn;
    case 'r':
      return Request::kRecord;
    case 'o':
      return Request::kPlace;
    case kFullScreenKey:
      return Request::kFullScreen;
    case kEscape:
      return Request::kLeave;
    case 'q':
    case kWindowClosed:
      return Request::kQuit;
    default:
      return Request::kNone;
  }
}

RunNews follow(const output::RunState& run, ViewState& state) {
  RunNews news;
  news.view = run.view != std::exchange(state.view, run.view);
  news.frozen = run.frozen != std::exchange(state.frozen, run.frozen);
  if (run.placements != std::exchange(state.placements, run.placements)) news.placed = run.placed;
  return news;
}

Freshness freshness(Duration since_last, double rate_hz) {
  const Duration periods(rate_hz > 0 ? static_cast<Duration::rep>(3e9 / rate_hz) : 0);
  if (since_last >= std::max(kGoneAfter, periods)) return Freshness::kGone;
  return since_last >= std::max(kStaleAfter, periods) ? Freshness::kStale : Freshness::kLive;
}

}  // namespace mixrig::viewfinder
