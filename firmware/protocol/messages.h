// SPDX-License-Identifier: Apache-2.0
// Every message between host and trigger controller, described once, compiled by both sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "firmware/protocol/framing.h"
#include "firmware/protocol/serialize.h"

namespace mixrig::protocol {

// The time base. One master tick is 10 ms; outputs change on the borders of 100 us slots.
inline constexpr std::uint32_t kTickHz = 100;
inline constexpr std::uint32_t kTickUs = 1'000'000 / kTickHz;
inline constexpr std::uint32_t kSlotsPerTick = 100;
inline constexpr std::uint32_t kSlotUs = kTickUs / kSlotsPerTick;
inline constexpr std::uint32_t kChannels = 16;
inline constexpr std::uint16_t kMaxDivider = 600;  ///< one pulse every 6 s

/// Increased when the meaning of a field changes but not its size.
inline constexpr std::uint32_t kMeaning = 1;

/// Added to the type of a command to give that of its reply; replies begin with a Verdict byte.
inline constexpr std::uint8_t kReplyBit = 0x80;

enum class Verdict : std::uint8_t {
  kOk,
  kUnknown,        ///< unknown command
  kLength,         ///< body of the wrong length
  kArgument,       ///< a value out of range
  kState,          ///< refused in the present state
  kHelloFirst,     ///< no Hello since the last reset of the controller
  kTableMismatch,  ///< the other side was built from another message table
  kImageBad,       ///< the image fails its checksum: only Hello, Status and Reboot are served
};

enum class State : std::uint8_t { kIdle, kArmed, kRunning };
enum class ResetCause : std::uint8_t { kUnknown, kPower, kPin, kSoftware, kWatchdog };
enum class ClockSource : std::uint8_t { kEmulated, kCrystal, kInternal };

/// Faults that the controller counts in Status, saturating.
enum class Fault : std::uint8_t {
  kFrameBad,       ///< a frame with a wrong CRC or length
  kRxOverrun,      ///< received bytes were lost
  kReplyLost,      ///< no room to send a reply
  kTelemetryLost,  ///< no room to send ticks or edges
  kTickLate,       ///< tick interrupt later than kLateNs; the outputs were on time
  kTickMissed,     ///< refill too late: the outputs repeated an old tick
  kHostLost,       ///< no command for kHostSilentUs while running; triggers continued
  kWatchdog,       ///< the last reset came from the watchdog
  kClockFallback,  ///< the crystal did not start: internal oscillator, 1 % off
  kImageBad,       ///< the image in flash fails its checksum
  kCount,
};
inline constexpr std::size_t kFaults = static_cast<std::size_t>(Fault::kCount);
inline constexpr std::uint32_t kLateNs = 1'000'000;
inline constexpr std::uint32_t kHostSilentUs = 2'000'000;

struct Empty {
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

struct HelloReply {
  std::uint32_t table_hash = 0;
  std::array<std::uint8_t, 3> version{};
  std::uint16_t board = 0;
  ResetCause reset_cause = ResetCause::kUnknown;
  ClockSource clock = ClockSource::kEmulated;
  std::uint8_t channels = 0;
  std::uint32_t image_crc = 0;
  std::uint8_t image_ok = 0;
  std::array<std::uint8_t, 12> uid{};
  static constexpr auto fields(auto& m) {
    return std::tie(m.table_hash, m.version, m.board, m.reset_cause, m.clock, m.channels,
                    m.image_crc, m.image_ok, m.uid);
  }
};

/// First command after a reset. The layouts of Hello, HelloReply and Reboot never change, so that
/// any host can identify and flash any firmware.
struct Hello {
  static constexpr std::uint8_t kId = 0x01;
  static constexpr const char* kName = "hello";
  using Reply = HelloReply;
  std::uint32_t table_hash = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.table_hash); }
};

struct StatusReply {
  State state = State::kIdle;
  std::uint16_t enabled = 0;        ///< mask of channels
  std::uint32_t tick = 0;           ///< current tick, counted from start
  std::uint64_t now_us = 0;         ///< controller clock, never wraps
  std::uint32_t late_max_ns = 0;    ///< largest delay of the tick interrupt since start
  std::uint32_t cost_max_ns = 0;    ///< longest run time of the tick interrupt since start
  std::uint16_t silence_max_s = 0;  ///< longest time without a command while running
  std::array<std::uint16_t, kFaults> faults{};
  static constexpr auto fields(auto& m) {
    return std::tie(m.state, m.enabled, m.tick, m.now_us, m.late_max_ns, m.cost_max_ns,
                    m.silence_max_s, m.faults);
  }
};

struct Status {
  static constexpr std::uint8_t kId = 0x02;
  static constexpr const char* kName = "status";
  using Reply = StatusReply;
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

inline constexpr std::uint8_t kFlagEnable = 1;
inline constexpr std::uint8_t kFlagActiveLow = 2;

/// A pulse of `width_slots` begins `phase_slots` after every `divider`-th tick.
/// 1 <= divider <= kMaxDivider, width >= 1, phase + width < divider * kSlotsPerTick.
struct ChannelConfig {
  std::uint8_t channel = 0;
  std::uint16_t divider = 0;
  std::uint16_t phase_slots = 0;
  std::uint16_t width_slots = 0;
  std::uint8_t flags = 0;
  bool enabled() const { return (flags & kFlagEnable) != 0; }
  bool active_low() const { return (flags & kFlagActiveLow) != 0; }
  bool operator==(const ChannelConfig&) const = default;
  static constexpr auto fields(auto& m) {
    return std::tie(m.channel, m.divider, m.phase_slots, m.width_slots, m.flags);
  }
};

struct SetChannel : ChannelConfig {
  static constexpr std::uint8_t kId = 0x10;
  static constexpr const char* kName = "set_channel";
  using Reply = Empty;
};

struct GetChannel {
  static constexpr std::uint8_t kId = 0x11;
  static constexpr const char* kName = "get_channel";
  using Reply = ChannelConfig;
  std::uint8_t channel = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.channel); }
};

/// Idle -> armed: enabled lines are driven, inactive. No effect where already armed.
struct Arm {
  static constexpr std::uint8_t kId = 0x12;
  static constexpr const char* kName = "arm";
  using Reply = Empty;
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

/// Armed -> running from the next master tick, which is tick 0. No effect where running.
struct Start {
  static constexpr std::uint8_t kId = 0x13;
  static constexpr const char* kName = "start";
  using Reply = Empty;
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

/// Any state -> idle: enabled lines go inactive at once.
struct Stop {
  static constexpr std::uint8_t kId = 0x14;
  static constexpr const char* kName = "stop";
  using Reply = Empty;
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

inline constexpr std::uint8_t kSubscribeTicks = 1;
inline constexpr std::uint8_t kSubscribeEdges = 2;

struct Subscribe {
  static constexpr std::uint8_t kId = 0x20;
  static constexpr const char* kName = "subscribe";
  using Reply = Empty;
  std::uint8_t mask = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.mask); }
};

/// Bits of SelfTestReply::failures.
enum class SelfTestBit : std::uint8_t { kImage, kTimer, kClock, kCrc, kOutputs, kCount };

struct SelfTestReply {
  std::uint32_t failures = 0;  ///< 0: all passed
  static constexpr auto fields(auto& m) { return std::tie(m.failures); }
};

struct SelfTest {
  static constexpr std::uint8_t kId = 0x30;
  static constexpr const char* kName = "self_test";
  using Reply = SelfTestReply;
  static constexpr auto fields(auto&) { return std::tuple<>(); }
};

enum class RebootTarget : std::uint8_t { kFirmware, kBootloader };
inline constexpr std::uint32_t kRebootKey =
    0x544F4F42;  // "BOOT": protects against reboots by damaged frames

/// Refused while running. The reset follows after the reply was sent.
struct Reboot {
  static constexpr std::uint8_t kId = 0x31;
  static constexpr const char* kName = "reboot";
  using Reply = Empty;
  RebootTarget target = RebootTarget::kFirmware;
  std::uint32_t key = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.target, m.key); }
};

/// Controller -> host, one per master tick while running. May be lost; gaps in `tick` show it.
struct TriggerTick {
  static constexpr std::uint8_t kId = 0xC0;
  static constexpr const char* kName = "tick";
  using Reply = Empty;
  std::uint32_t tick = 0;
  std::uint32_t mcu_us = 0;  ///< when the interrupt ran; wraps after 71.6 min
  std::uint16_t fired = 0;   ///< channels whose pulse begins in this tick
  static constexpr auto fields(auto& m) { return std::tie(m.tick, m.mcu_us, m.fired); }
};

/// Controller -> host, one per change of an output. May be lost.
struct TriggerEdge {
  static constexpr std::uint8_t kId = 0xC1;
  static constexpr const char* kName = "edge";
  using Reply = Empty;
  std::uint32_t tick = 0;
  std::uint8_t slot = 0;  ///< the edge lies slot * kSlotUs after the start of the tick
  std::uint8_t channel = 0;
  std::uint8_t level = 0;  ///< electrical: 1 high
  static constexpr auto fields(auto& m) { return std::tie(m.tick, m.slot, m.channel, m.level); }
};

/// All messages, in the order in which they enter the hash.
using MessageTable = std::tuple<Hello, Status, SetChannel, GetChannel, Arm, Start, Stop, Subscribe,
                                SelfTest, Reboot, TriggerTick, TriggerEdge>;

namespace detail {
struct Fnv1a {
  std::uint32_t value = 0x811C9DC5u;
  constexpr void add(std::uint32_t word) {
    for (int i = 0; i < 4; ++i, word >>= 8) value = (value ^ (word & 0xFFu)) * 0x01000193u;
  }
};
template <typename M>
constexpr void add_message(Fnv1a& hash) {
  static_assert(M::kId != '\n' && M::kId != '\r', "would look like a typed line");
  static_assert(wire_size<M>() <= kMaxBody && wire_size<typename M::Reply>() < kMaxBody);
  hash.add(M::kId);
  for (const std::size_t size : field_sizes<M>()) hash.add(static_cast<std::uint32_t>(size));
  hash.add(0xFF);
  for (const std::size_t size : field_sizes<typename M::Reply>())
    hash.add(static_cast<std::uint32_t>(size));
}
template <typename... M>
constexpr std::uint32_t hash_table(std::tuple<M...>*) {
  Fnv1a hash;
  for (const std::uint32_t word : {kMeaning, kTickHz, kSlotsPerTick, kChannels}) hash.add(word);
  (add_message<M>(hash), ...);
  return hash.value;
}
}  // namespace detail

/// Hash of the message table: each side refuses a peer whose hash differs.
inline constexpr std::uint32_t kTableHash = detail::hash_table(static_cast<MessageTable*>(nullptr));

}  // namespace mixrig::protocol
