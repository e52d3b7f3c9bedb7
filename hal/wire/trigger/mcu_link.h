// SPDX-License-Identifier: Apache-2.0
// Exchanges frames with the trigger controller: a queue of commands, one in flight, resent until
// it is answered.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "firmware/protocol/framing.h"
#include "firmware/protocol/messages.h"
#include "hal/base/clock.h"
#include "hal/base/ring.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Times at which the answered request was sent and its answer received.
struct RoundTrip {
  HostTime sent{}, received{};
};

/// Counts since construction.
struct McuLinkHealth {
  std::uint64_t commands = 0;
  std::uint64_t resent = 0;         ///< commands sent again because no answer came
  std::uint64_t unanswered = 0;     ///< commands never answered
  std::uint64_t stale_replies = 0;  ///< answers that match no command in flight
  std::uint64_t bad_frames = 0;     ///< frames from the controller with a wrong CRC or length
  std::uint64_t telemetry_lost =
      0;  ///< reports missing according to their sequence numbers (mod 256)
};

/// A link to the trigger controller. Commands are idempotent, so that resending is always safe. For
/// one thread.
class McuLink {
 public:
  struct RetryPolicy {
    Duration per_try = std::chrono::milliseconds(100);
    int tries = 20;
  };
  /// A reply: verdict, body after it, and its times.
  struct Reply {
    protocol::Verdict verdict = protocol::Verdict::kOk;
    std::span<const std::uint8_t> body;
    RoundTrip times;
  };
  using Done = std::function<void(const Result<Reply>&)>;
  /// Receives telemetry: type and body of a valid frame.
  using Telemetry = std::function<void(std::uint8_t type, std::span<const std::uint8_t> body)>;

  /// Stream and clock must outlive it; `name` names the stream in error lines.
  McuLink(ByteStream& stream, Clock& clock, std::string name);

  /// Queues a command; a later pump() calls `done` with the reply or kTimeout. Errors: kIo if
  /// kQueue commands wait.
  template <typename M>
  Result<void> post(const M& message, Done done, RetryPolicy how_long) {
    Command command{M::kId, {}, protocol::wire_size<M>(), M::kName, std::move(done), how_long};
    protocol::write_message(message, command.body);
    return push(std::move(command));
  }
  /// Sends, resends and receives once; waits at most `timeout` for bytes. Errors: kDevice.
  Result<void> pump(Duration timeout);

  /// Posts a command and pumps until it is answered. A verdict other than kOk becomes an error
  /// (kDevice; kUsage for kArgument) unless `verdict_out` is given, which then receives it.
  template <typename M>
  Result<typename M::Reply> ask(const M& message, RoundTrip* times = nullptr,
                                protocol::Verdict* verdict_out = nullptr) {
    return ask(message, retry, times, verdict_out);
  }
  template <typename M>
  Result<typename M::Reply> ask(const M& message, RetryPolicy how_long, RoundTrip* times = nullptr,
                                protocol::Verdict* verdict_out = nullptr);

  void on_telemetry(Telemetry handler) { telemetry_ = std::move(handler); }
  const McuLinkHealth& health() const { return health_; }
  const std::string& name() const { return name_; }

  RetryPolicy retry;

 private:
  static constexpr std::size_t kQueue = 64;
  static constexpr int kMaxTries = 64;

  struct Command {
    std::uint8_t type = 0;
    std::array<std::uint8_t, protocol::kMaxBody> body{};
    std::size_t size = 0;
    const char* name = "";
    Done done;
    RetryPolicy retry;
    int tries = 0;
    std::uint8_t first_sequence = 0;
    std::array<HostTime, kMaxTries>
        sent{};  ///< time of each try; an answer's sequence number gives its try
  };

  Result<void> push(Command command);
  Result<void> send_next();
  void take(std::span<const std::uint8_t> bytes, HostTime received);
  void take_frame(HostTime received);
  void take_reply(HostTime received);
  void finish(const Result<Reply>& result);
  Result<void> wait_for(bool& finished);
  Error verdict_error(const char* command, protocol::Verdict verdict) const;

  ByteStream& stream_;
  Clock& clock_;
  std::string name_;
  protocol::FrameDecoder decoder_;
  Ring<Command, kQueue> queue_;
  std::uint8_t sequence_ = 0;
  std::optional<std::uint8_t> next_telemetry_;
  Telemetry telemetry_;
  McuLinkHealth health_;
};

/// Returns what the controller's refusal means and what to do, for users.
const char* meaning(protocol::Verdict verdict);

template <typename M>
Result<typename M::Reply> McuLink::ask(const M& message, RetryPolicy how_long, RoundTrip* times,
                                       protocol::Verdict* verdict_out) {
  bool finished = false;
  Result<typename M::Reply> answer = typename M::Reply{};
  const auto done = [&](const Result<Reply>& result) {
    finished = true;
    if (!result) {
      answer = result.error();
      return;
    }
    if (times != nullptr) *times = result->times;
    if (verdict_out != nullptr) *verdict_out = result->verdict;
    if (result->verdict != protocol::Verdict::kOk && verdict_out == nullptr) {
      answer = verdict_error(M::kName, result->verdict);
    } else if (!protocol::read_message(result->body, *answer) &&
               result->verdict == protocol::Verdict::kOk) {
      answer = Error{ErrorCode::kDevice, name_ + ": reply to " + M::kName +
                                             " has a wrong length: flash the firmware that "
                                             "belongs to this host (mixrig flash)"};
    }
  };
  MIXRIG_TRY(post(message, done, how_long));
  MIXRIG_TRY(wait_for(finished));
  return answer;
}

}  // namespace mixrig::device
