// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/trigger/mcu_trigger.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mixrig::device {

using protocol::Verdict;
using std::chrono::microseconds;
using std::chrono::nanoseconds;

namespace {

std::string hex(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

std::string version_text(const std::array<std::uint8_t, 3>& v) {
  return fmt::format("{}.{}.{}", v[0], v[1], v[2]);
}

const char* text(protocol::ResetCause cause) {
  static constexpr const char* kTexts[] = {"unknown", "power", "reset pin", "software", "watchdog"};
  const auto i = static_cast<std::size_t>(cause);
  return i < std::size(kTexts) ? kTexts[i] : "unknown";
}

const char* text(protocol::ClockSource clock) {
  static constexpr const char* kTexts[] = {"emulated", "crystal", "internal oscillator"};
  const auto i = static_cast<std::size_t>(clock);
  return i < std::size(kTexts) ? kTexts[i] : "unknown";
}

std::uint16_t slots(Duration span) {
  return static_cast<std::uint16_t>(span / microseconds(protocol::kSlotUs));
}

}  // namespace

FaultText fault_text(protocol::Fault fault) {
  switch (fault) {
    case protocol::Fault::kFrameBad:
      return {"frame_bad", "commands arrived damaged: check cable and ground"};
    case protocol::Fault::kRxOverrun:
      return {"rx_overrun", "received bytes were lost: the line carries more than commands"};
    case protocol::Fault::kReplyLost:
      return {"reply_lost", "no room to send a reply; the host repeats its command"};
    case protocol::Fault::kTelemetryLost:
      return {"telemetry_lost",
              "reports of ticks or edges were dropped; the edges themselves were output"};
    case protocol::Fault::kTickLate:
      return {"tick_late",
              "tick interrupt over 1 ms late; the edges, made by hardware, were on time"};
    case protocol::Fault::kTickMissed:
      return {"tick_missed", "lines repeated an old tick: frames of these ticks are mistimed"};
    case protocol::Fault::kHostLost:
      return {"host_lost", "no command from the host for 2 s while running; triggers continued"};
    case protocol::Fault::kWatchdog:
      return {"watchdog", "the watchdog reset the controller: report this"};
    case protocol::Fault::kClockFallback:
      return {"clock_fallback", "crystal did not start: rate is up to 1 % off; replace the board"};
    case protocol::Fault::kImageBad:
      return {"image_bad", "firmware in flash is damaged: mixrig flash"};
    case protocol::Fault::kCount:
      break;
  }
  return {"unknown", "unknown"};
}

const char* self_test_text(protocol::SelfTestBit bit) {
  static constexpr const char* kTexts[] = {"image", "timer", "crystal", "crc", "outputs"};
  const auto i = static_cast<std::size_t>(bit);
  return i < std::size(kTexts) ? kTexts[i] : "unknown";
}

McuTrigger::McuTrigger(std::unique_ptr<ByteStream> stream, Clock& clock, const std::string& name,
                       McuLink::RetryPolicy hello_retry)
    : stream_(std::move(stream)), link_(*stream_, clock, name), hello_retry_(hello_retry) {
  info_.uri = "mcu:" + name;
  link_.on_telemetry([this](std::uint8_t type, std::span<const std::uint8_t> body) {
    take_telemetry(type, body);
  });
}

Result<std::unique_ptr<McuTrigger>> McuTrigger::open(std::unique_ptr<ByteStream> stream,
                                                     Clock& clock, const std::string& name,
                                                     McuLink::RetryPolicy hello_retry) {
  std::unique_ptr<McuTrigger> trigger(new McuTrigger(std::move(stream), clock, name, hello_retry));
  MIXRIG_TRY(trigger->say_hello());
  MIXRIG_TRY(trigger->ask(protocol::Subscribe{protocol::kSubscribeTicks}));
  MIXRIG_TRY(trigger->status());  // sets mcu_clock_, which extends the ticks' stamps
  return trigger;
}

Result<void> McuTrigger::say_hello() {
  Verdict verdict = Verdict::kOk;
  MIXRIG_ASSIGN(const protocol::HelloReply hello,
                link_.ask(protocol::Hello{protocol::kTableHash}, hello_retry_, nullptr, &verdict));
  info_.version = version_text(hello.version);
  info_.unique_id = hex(hello.uid);
  info_.reset_cause = text(hello.reset_cause);
  info_.clock = text(hello.clock);
  info_.image_crc = hello.image_crc;
  info_.channels = std::min<int>(hello.channels, protocol::kChannels);
  info_.max_divider = protocol::kMaxDivider;
  info_.tick = microseconds(protocol::kTickUs);
  info_.slot = microseconds(protocol::kSlotUs);
  if (verdict == Verdict::kOk && hello.table_hash == protocol::kTableHash) {
    if (hello.image_ok != 0) return {};
    verdict = Verdict::kImageBad;
  } else if (verdict == Verdict::kOk) {
    verdict = Verdict::kTableMismatch;
  }
  return Error{ErrorCode::kDevice, "trigger controller at " + link_.name() + " (firmware " +
                                       info_.version + ") " + meaning(verdict)};
}

/// Like link_.ask, but after a reset of the controller it sends Hello again; it still returns the
/// error, so that the caller learns of the reset.
template <typename M>
Result<typename M::Reply> McuTrigger::ask(const M& message, RoundTrip* times) {
  Verdict verdict = Verdict::kOk;
  auto reply = link_.ask(message, times, &verdict);
  if (!reply || verdict == Verdict::kOk) return reply;
  std::string cause;
  if (verdict == Verdict::kHelloFirst) {
    ++resets_;
    ticks_.clear();
    MIXRIG_TRY(say_hello());
    MIXRIG_TRY(link_.ask(protocol::Subscribe{protocol::kSubscribeTicks}));
    cause = ", cause: " + info_.reset_cause;
  }
  return Error{verdict == Verdict::kArgument ? ErrorCode::kUsage : ErrorCode::kDevice,
               "trigger controller at " + link_.name() + " " + meaning(verdict) + " (" + M::kName +
                   cause + ")"};
}

Result<TriggerStatus> McuTrigger::status() {
  RoundTrip times;
  const std::uint64_t resets = resets_;
  auto reply = ask(protocol::Status{}, &times);
  if (!reply && resets_ != resets) reply = ask(protocol::Status{}, &times);
  if (!reply) return std::move(reply).error();
  mcu_clock_.set(reply->now_us);
  TriggerStatus status;
  status.state = static_cast<TriggerState>(std::min<int>(static_cast<int>(reply->state), 2));
  status.enabled = reply->enabled;
  status.tick = reply->tick;
  status.now = McuTime(microseconds(reply->now_us));
  status.asked = times.sent;
  status.answered = times.received;
  status.late_max = nanoseconds(reply->late_max_ns);
  status.cost_max = nanoseconds(reply->cost_max_ns);
  status.silence_max = std::chrono::seconds(reply->silence_max_s);
  status.faults = all_faults(*reply);
  return status;
}

std::vector<TriggerFault> McuTrigger::all_faults(const protocol::StatusReply& reply) const {
  std::vector<TriggerFault> faults;
  for (std::size_t i = 0; i < protocol::kFaults; ++i) {
    const FaultText text = fault_text(static_cast<protocol::Fault>(i));
    faults.push_back({text.name, reply.faults[i], text.meaning});
  }
  const McuLinkHealth& link = link_.health();
  faults.push_back({"controller_reset", resets_, "the controller was reset: set channels, start"});
  faults.push_back(
      {"link_resent", link.resent, "commands were sent again: check cable and ground"});
  faults.push_back({"link_unanswered", link.unanswered, "commands got no answer"});
  faults.push_back({"link_bad_frames", link.bad_frames, "replies or reports arrived damaged"});
  faults.push_back({"link_reports_lost", link.telemetry_lost + ticks_.dropped(),
                    "reports of ticks did not reach the host"});
  return faults;
}

Result<void> McuTrigger::configure(int channel, const TriggerChannel& settings) {
  MIXRIG_TRY(check_channel(info_, channel, settings));
  protocol::SetChannel set;
  set.channel = static_cast<std::uint8_t>(channel);
  if (settings.divider != 0) {
    set.divider = static_cast<std::uint16_t>(settings.divider);
    set.phase_slots = slots(settings.phase);
    set.width_slots = slots(settings.width);
    set.flags = static_cast<std::uint8_t>(protocol::kFlagEnable |
                                          (settings.active_low ? protocol::kFlagActiveLow : 0));
  }
  MIXRIG_TRY(ask(set));
  return {};
}

Result<TriggerChannel> McuTrigger::channel(int index) {
  MIXRIG_ASSIGN(const protocol::ChannelConfig config,
                ask(protocol::GetChannel{static_cast<std::uint8_t>(index)}));
  TriggerChannel channel;
  channel.divider = config.enabled() ? config.divider : 0;
  channel.phase = microseconds(config.phase_slots * protocol::kSlotUs);
  channel.width = microseconds(config.width_slots * protocol::kSlotUs);
  channel.active_low = config.active_low();
  return channel;
}

Result<void> McuTrigger::start() {
  MIXRIG_TRY(ask(protocol::Stop{}));
  MIXRIG_TRY(ask(protocol::Arm{}));
  ticks_.clear();  // reports of the previous run may have arrived after the answer to Stop
  tick_line_ = {};
  MIXRIG_TRY(ask(protocol::Start{}));
  return {};
}

Result<void> McuTrigger::stop() {
  MIXRIG_TRY(ask(protocol::Stop{}));
  return {};
}

void McuTrigger::take_telemetry(std::uint8_t type, std::span<const std::uint8_t> body) {
  protocol::TriggerTick tick;
  if (type != protocol::TriggerTick::kId || !protocol::read_message(body, tick)) return;
  (void)ticks_.push({tick_line_.at(tick.tick),
                     McuTime(microseconds(mcu_clock_.extend(tick.mcu_us))), tick.fired});
}

Result<std::size_t> McuTrigger::read_ticks(std::span<TriggerTick> out, Duration timeout) {
  if (ticks_.empty()) MIXRIG_TRY(link_.pump(timeout));
  return ticks_.take(out);
}

Result<std::vector<std::string>> McuTrigger::self_test() {
  MIXRIG_ASSIGN(const protocol::SelfTestReply reply, ask(protocol::SelfTest{}));
  std::vector<std::string> failed;
  for (unsigned bit = 0; bit < static_cast<unsigned>(protocol::SelfTestBit::kCount); ++bit) {
    if ((reply.failures >> bit & 1u) != 0) {
      failed.emplace_back(self_test_text(static_cast<protocol::SelfTestBit>(bit)));
    }
  }
  return failed;
}

}  // namespace mixrig::device
