// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/stamp_scale.h"

#include <cmath>

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::pose {

UtcTime StampScale::utc_of(std::int64_t stamp_ns, UtcTime now) {
  const Duration stamp(stamp_ns);
  choose(stamp - now.time_since_epoch());
  return is_tai_ ? utc_from(TaiTime(stamp), tai_minus_utc_) : UtcTime(stamp);
}

void StampScale::choose(Duration ahead) {
  const auto near = [](Duration off) { return off > -kNear && off < kNear; };
  const bool as_tai = near(ahead - tai_minus_utc_), as_utc = near(ahead);
  if (!stated_ && (as_tai || as_utc)) is_tai_ = as_tai;
  if (is_tai_ && !stated_ && !ptp_warned_) {
    ptp_warned_ = true;
    log_warning("pose", fmt::format("OpenTrackIO: the stamps lie {:.0f} s ahead of the system "
                                    "clock, so they are PTP's (TAI): {:.0f} s are taken off; state "
                                    "it by camera.stamps = \"ptp\"",
                                    seconds(ahead), seconds(tai_minus_utc_)));
  }
  const double off_s = seconds(is_tai_ ? ahead - tai_minus_utc_ : ahead);
  if ((is_tai_ ? as_tai : as_utc) || far_warned_) return;
  far_warned_ = true;
  log_warning("pose", fmt::format("OpenTrackIO: the stamps lie {:.1f} s {} this machine's {} time: "
                                  "set both clocks by one source, or use camera.stamps = "
                                  "\"arrival\"",
                                  std::abs(off_s), off_s > 0 ? "ahead of" : "behind",
                                  is_tai_ ? "PTP" : "system"));
}

}  // namespace mixrig::pose
