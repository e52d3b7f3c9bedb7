// SPDX-License-Identifier: Apache-2.0
// Driver of FLIR / Directed Perception pan-tilt units (PTU-D46, D300) over any ByteStream.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/byte_stream.h"
#include "hal/device/pan_tilt.h"
#include "hal/linux/flir_ptu_reply.h"

namespace mixrig::device {

/// Asks the unit for everything it relies on (resolution, range), never for a reset, which would
/// move the head. Verbose replies are switched on, because they name their axis: a late answer
/// cannot be taken for another one's. A silent, confused or interrupted exchange is repeated; a
/// position query and an absolute move mean the same when they are said twice.
class FlirPtu final : public PanTilt {
 public:
  /// `uri` stands in error lines. Errors: kTimeout, kDevice.
  static Result<std::unique_ptr<FlirPtu>> open(std::unique_ptr<ByteStream> stream, Clock& clock,
                                               std::string uri);

  const PanTiltInfo& info() const override { return info_; }
  Result<void> move_to(PanTiltAngles target) override;
  Result<void> set_motion(PanTiltMotion motion) override;
  Result<PanTiltSample> sample() override;
  Result<void> halt() override;
  PanTiltHealth health() const override;

 private:
  FlirPtu(std::unique_ptr<ByteStream> stream, Clock& clock, std::string uri);
  Result<void> configure();
  Result<void> set_up_talk();
  Result<void> greet_again();
  Result<PtuReply> send_and_read(std::string_view words, Duration timeout);
  Result<void> command(std::string_view words, Duration timeout);
  Result<double> query(std::string_view words, PtuAxis axis);
  Result<PtuReply> exchange(std::string_view words, Duration timeout);
  Result<PtuReply> exchange_once(std::string_view words, Duration timeout);
  Result<PtuReply> read_reply(HostTime until);
  Result<void> drain();
  Result<long> steps(double angle_rad, const PanTiltAngles& resolution, PtuAxis axis) const;
  Error silent(std::string_view words) const;

  std::unique_ptr<ByteStream> stream_;
  Clock& clock_;
  PanTiltInfo info_;
  PtuReplyParser parser_;
  PanTiltHealth health_;
  std::uint64_t limits_at_move_ = 0;
  bool stale_ = true;  ///< bytes of an earlier exchange may still be on their way
  bool lost_ = false;  ///< the line failed: greet the unit again when it is back
};

}  // namespace mixrig::device
