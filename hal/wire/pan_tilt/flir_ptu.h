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
#include "hal/wire/pan_tilt/flir_ptu_reply.h"

namespace mixrig::device {

/// Queries resolution and range from the unit; never sends a reset, which would move the head.
/// Verbose replies are switched on because they name their axis, so that a late answer is not taken
/// as that of another query. An exchange without an answer, or with an invalid or interrupted one,
/// is repeated: position queries and absolute moves are idempotent. Positions are asked for as
/// often as the line and the unit answer, at most 500 times a second.
class FlirPtu final : public PanTilt {
 public:
  /// `uri` stands in error lines; `byte_time` is that of the line, 10 bits at its rate, 0 where it
  /// has none. Errors: kTimeout, kDevice.
  static Result<std::unique_ptr<FlirPtu>> open(std::unique_ptr<ByteStream> stream, Clock& clock,
                                               std::string uri, Duration byte_time = {});

  const PanTiltInfo& info() const override { return info_; }
  Result<void> move_to(PanTiltAngles target) override;
  Result<void> set_motion(PanTiltMotion motion) override;
  Result<PanTiltSample> sample() override;
  Result<void> halt() override;
  PanTiltHealth health() const override;

 private:
  FlirPtu(std::unique_ptr<ByteStream> stream, Clock& clock, std::string uri, Duration byte_time);
  Result<void> configure();
  Result<void> set_up_protocol();
  Result<void> set_up_again();
  Result<PtuReply> send_and_read(std::string_view text, Duration timeout);
  Result<void> command(std::string_view text, Duration timeout);
  Result<double> query(std::string_view text, PtuAxis axis);
  Result<PtuReply> exchange(std::string_view text, Duration timeout);
  Result<PtuReply> exchange_once(std::string_view text, Duration timeout);
  Result<PtuReply> read_reply(HostTime until);
  HostTime heard_at(std::size_t question_bytes) const;
  Result<void> drain();
  Result<long> steps(double angle_rad, const PanTiltAngles& resolution, PtuAxis axis) const;
  Error no_answer(std::string_view text) const;

  std::unique_ptr<ByteStream> stream_;
  Clock& clock_;
  const Duration byte_time_;
  PanTiltInfo info_;
  PtuReplyParser parser_;
  PanTiltHealth health_;
  std::uint64_t limits_at_move_ = 0;
  HostTime sampled_at_{};             ///< when a position was asked for last
  HostTime asked_at_{}, heard_at_{};  ///< of the last answered exchange
  std::size_t answer_bytes_ = 0;      ///< since it was asked
  bool stale_ = true;                 ///< bytes of an earlier exchange may still arrive
  bool lost_ = false;  ///< the line failed: set up the protocol again when it is back
};

}  // namespace mixrig::device
