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

/// A pan-tilt unit. Queries resolution and range from the unit; never sends a reset, which would
/// move the head. It switches verbose replies on: they name their axis, so that a late answer is
/// not taken for the answer to another query. An exchange without an answer, or with an invalid or
/// interrupted one, is repeated: position queries and absolute moves are idempotent. Positions are
/// queried as fast as the line and the unit answer, at most 500 times a second.
class FlirPtu final : public PanTilt {
 public:
  /// Opens the unit. `uri` is for error lines. `byte_time` is the time of a byte on the line (10
  /// bits at its rate), 0 if it has no rate. Errors: kTimeout, kDevice.
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
  HostTime sampled_at_{};             ///< when a position was last queried
  HostTime asked_at_{}, heard_at_{};  ///< times of the last answered exchange
  std::size_t answer_bytes_ = 0;      ///< bytes received since asked_at_
  bool stale_ = true;                 ///< bytes of an earlier exchange may still arrive
  bool lost_ = false;  ///< the line failed: set up the protocol again when it is back
};

}  // namespace mixrig::device
