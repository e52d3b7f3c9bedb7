// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/capture_feed.h"

#include <utility>

namespace mixrig::session {

Result<std::optional<capture::CaptureItem>> CaptureFeed::next() {
  const double latency_s = session_.poses->info().latency_s;
  const auto waits = [&] {
    return held_.empty() || seconds(held_.back().capture->mid_exposure -
                                    held_.front().capture->mid_exposure) < latency_s;
  };
  while (!drained_ && waits()) {
    MIXRIG_ASSIGN(auto item, reader_.next());
    drained_ = !item;
    if (drained_) break;
    session_.poses->see(*item->capture);
    held_.push_back(*std::move(item));
  }
  if (held_.empty()) return std::optional<capture::CaptureItem>();
  std::optional<capture::CaptureItem> oldest(std::move(held_.front()));
  held_.erase(held_.begin());
  return oldest;
}

void CaptureFeed::give_back(capture::CaptureItem item, HostTime now) {
  if (session_.source->info().is_live()) ready_ = now;
  held_.insert(held_.begin(), std::move(item));
}

Result<std::optional<capture::CaptureItem>> CaptureFeed::next_fresh() {
  constexpr double kLatePeriods = 1.5;
  constexpr int kMostLate = 8;  // as many wait between the devices and here
  MIXRIG_ASSIGN(auto item, next());
  if (!ready_) return item;
  const double rate_hz = session_.source->info().rate_hz;
  const double late_s = kLatePeriods / (rate_hz > 0 ? rate_hz : 25);
  for (int i = 0; i < kMostLate && item && seconds(*ready_ - item->capture->mid_exposure) > late_s;
       ++i) {
    MIXRIG_ASSIGN(auto newer, next());
    if (!newer) break;
    item = std::move(newer);
    ++late_;
  }
  ready_.reset();
  return item;
}

}  // namespace mixrig::session
