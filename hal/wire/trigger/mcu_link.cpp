// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/trigger/mcu_link.h"

#include <algorithm>
#include <utility>

namespace mixrig::device {

using protocol::Verdict;

const char* meaning(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk:
      return "done";
    case Verdict::kUnknown:
      return "does not support this command: flash the firmware that belongs to this host";
    case Verdict::kLength:
      return "got a command of the wrong length: flash the firmware that belongs to this host";
    case Verdict::kArgument:
      return "refuses a value that is out of range";
    case Verdict::kState:
      return "cannot do that in its present state: stop it first, or arm before start";
    case Verdict::kHelloFirst:
      return "was reset since the last hello: set its channels and start it again";
    case Verdict::kTableMismatch:
      return "runs firmware of another version: mixrig flash";
    case Verdict::kImageBad:
      return "reports that its firmware image is damaged: mixrig flash";
  }
  return "gave an answer that this host cannot read: mixrig flash";
}

McuLink::McuLink(ByteStream& stream, Clock& clock, std::string name)
    : stream_(stream), clock_(clock), name_(std::move(name)) {}

Error McuLink::verdict_error(const char* command, Verdict verdict) const {
  const ErrorCode code = verdict == Verdict::kArgument ? ErrorCode::kUsage : ErrorCode::kDevice;
  return Error{code,
               "trigger controller at " + name_ + " " + meaning(verdict) + " (" + command + ")"};
}

Result<void> McuLink::push(Command command) {
  if (queue_.size() == kQueue) {
    return Error{ErrorCode::kIo, name_ + ": too many commands are queued: call pump() more often"};
  }
  command.retry.tries = std::clamp(command.retry.tries, 1, kMaxTries);
  (void)queue_.push(std::move(command));
  ++health_.commands;
  return {};
}

/// Sends the first command of the queue if it is new or timed out; gives up after its last try.
Result<void> McuLink::send_next() {
  while (!queue_.empty()) {
    Command& command = queue_.front();
    const HostTime now = clock_.now();
    if (command.tries > 0 && now - command.sent[command.tries - 1] < command.retry.per_try) {
      return {};
    }
    if (command.tries == command.retry.tries) {
      ++health_.unanswered;
      finish(Error{ErrorCode::kTimeout,
                   "no answer from the trigger controller at " + name_ + " to " + command.name +
                       " (" + std::to_string(command.tries) +
                       " tries): check cable and power, or flash it with BOOT0 held"});
      continue;
    }
    if (command.tries == 0) {
      command.first_sequence = static_cast<std::uint8_t>(sequence_ + 1);
    } else {
      ++health_.resent;
    }
    std::array<std::uint8_t, protocol::kMaxWire> wire;
    const std::size_t size = protocol::encode_frame(command.type, ++sequence_,
                                                    {command.body.data(), command.size}, wire);
    command.sent[command.tries++] = now;
    return stream_.write({wire.data(), size});
  }
  return {};
}

Result<void> McuLink::pump(Duration timeout) {
  MIXRIG_TRY(send_next());
  if (!queue_.empty() && queue_.front().tries > 0) {
    const Command& command = queue_.front();
    const Duration left = command.sent[command.tries - 1] + command.retry.per_try - clock_.now();
    timeout = std::clamp(left, Duration{0}, timeout);
  }
  std::array<std::uint8_t, 512> buffer;
  MIXRIG_ASSIGN(const std::size_t size, stream_.read(buffer, timeout));
  take({buffer.data(), size}, clock_.now());
  return send_next();
}

void McuLink::take(std::span<const std::uint8_t> bytes, HostTime received) {
  for (const std::uint8_t byte : bytes) {
    const protocol::FrameEvent event = decoder_.push(byte);
    if (event == protocol::FrameEvent::kFrame) take_frame(received);
    if (event == protocol::FrameEvent::kBad) ++health_.bad_frames;
  }
}

void McuLink::take_frame(HostTime received) {
  if (decoder_.type() < 0xC0) return take_reply(received);
  const std::uint8_t sequence = decoder_.sequence();
  if (next_telemetry_) {
    health_.telemetry_lost += static_cast<std::uint8_t>(sequence - *next_telemetry_);
  }
  next_telemetry_ = static_cast<std::uint8_t>(sequence + 1);
  if (telemetry_) telemetry_(decoder_.type(), decoder_.body());
}

void McuLink::take_reply(HostTime received) {
  const bool awaited = !queue_.empty() && queue_.front().tries > 0 &&
                       decoder_.type() == (queue_.front().type | protocol::kReplyBit) &&
                       !decoder_.body().empty();
  const int attempt =
      awaited ? static_cast<std::uint8_t>(decoder_.sequence() - queue_.front().first_sequence) : 0;
  if (!awaited || attempt >= queue_.front().tries) {
    ++health_.stale_replies;
    return;
  }
  finish(Reply{static_cast<Verdict>(decoder_.body()[0]),
               decoder_.body().subspan(1),
               {queue_.front().sent[attempt], received}});
}

void McuLink::finish(const Result<Reply>& result) {
  const Done done = queue_.pop().done;
  if (done) done(result);
}

Result<void> McuLink::wait_for(bool& finished) {
  while (!finished) {
    if (auto pumped = pump(std::chrono::seconds(1)); !pumped) {
      // The queued commands refer to variables of callers that are about to return.
      queue_.clear();
      return pumped;
    }
  }
  return {};
}

}  // namespace mixrig::device
