// SPDX-License-Identifier: Apache-2.0
// Commands to the head of a running session: its own thread carries them out, between two answers.
#include <utility>

#include "host/capture/live/session/live_session.h"

namespace mixrig::live {

Result<void> LiveSession::move_head(device::PanTiltAngles target) {
  return command_head({false, target});
}

Result<void> LiveSession::halt_head() { return command_head({true, {}}); }

Result<void> LiveSession::command_head(const HeadCommand& command) {
  if (!running_ || !devices_.pan_tilt)
    return Error{ErrorCode::kUsage, "there is no running pan-tilt unit to move"};
  std::unique_lock lock(mutex_);
  if (fault_) return *fault_;
  head_command_ = command;
  head_answer_.reset();
  head_answered_.wait(lock, [this] { return head_answer_.has_value(); });
  return *std::move(head_answer_);
}

void LiveSession::obey_head_command() {
  std::optional<HeadCommand> command;
  {
    const std::lock_guard lock(mutex_);
    command = std::exchange(head_command_, std::nullopt);
  }
  if (!command) return;
  device::PanTilt& head = *devices_.pan_tilt;
  Result<void> answer = command->halt ? head.halt() : head.move_to(command->target);
  const std::lock_guard lock(mutex_);
  head_answer_ = std::move(answer);
  head_answered_.notify_all();
}

}  // namespace mixrig::live
