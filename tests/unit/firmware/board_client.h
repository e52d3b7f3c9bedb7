// SPDX-License-Identifier: Apache-2.0
// A minimal host for tests of the firmware: each request waits for one reply, and telemetry is
// collected.
#pragma once

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/port/sim/sim_board.h"

namespace mixrig::sim {

class BoardClient {
 public:
  explicit BoardClient(SimBoard& board) : board_(board) {}

  /// Sends a command and returns the verdict; the test fails without a reply.
  template <typename M>
  protocol::Verdict ask(const M& message, typename M::Reply* reply = nullptr) {
    std::array<std::uint8_t, protocol::kMaxBody> body;
    const std::size_t n = protocol::write_message(message, body);
    return ask_raw(M::kId, {body.data(), n}, [&](std::span<const std::uint8_t> answer) {
      if (reply != nullptr) {
        EXPECT_TRUE(protocol::read_message(answer, *reply));
      }
    });
  }

  template <typename Take>
  protocol::Verdict ask_raw(std::uint8_t type, std::span<const std::uint8_t> body, Take&& take) {
    std::array<std::uint8_t, protocol::kMaxWire> wire;
    const std::size_t n = protocol::encode_frame(type, ++sequence_, body, wire);
    board_.receive({wire.data(), n});
    std::optional<protocol::Verdict> verdict;
    for (const std::uint8_t byte : board_.transmitted()) {
      if (decoder_.push(byte) != protocol::FrameEvent::kFrame) continue;
      if (decoder_.type() >= 0xC0) {
        keep_telemetry();
      } else if (decoder_.type() == (type | protocol::kReplyBit) &&
                 decoder_.sequence() == sequence_ && !decoder_.body().empty()) {
        verdict = static_cast<protocol::Verdict>(decoder_.body()[0]);
        if (decoder_.body().size() > 1) take(decoder_.body().subspan(1));
      }
    }
    EXPECT_TRUE(verdict.has_value()) << "no reply to " << int{type};
    return verdict.value_or(protocol::Verdict::kUnknown);
  }

  protocol::Verdict say_hello() { return ask(protocol::Hello{protocol::kTableHash}); }
  protocol::StatusReply status() {
    protocol::StatusReply reply;
    EXPECT_EQ(ask(protocol::Status{}, &reply), protocol::Verdict::kOk);
    return reply;
  }
  int faults(protocol::Fault fault) { return status().faults[static_cast<std::size_t>(fault)]; }

  protocol::Verdict set(int index, int divider, int phase, int width, bool low = false) {
    protocol::SetChannel config;
    config.channel = static_cast<std::uint8_t>(index);
    config.divider = static_cast<std::uint16_t>(divider);
    config.phase_slots = static_cast<std::uint16_t>(phase);
    config.width_slots = static_cast<std::uint16_t>(width);
    config.flags =
        static_cast<std::uint8_t>(protocol::kFlagEnable | (low ? protocol::kFlagActiveLow : 0));
    return ask(config);
  }
  void run() {
    EXPECT_EQ(ask(protocol::Arm{}), protocol::Verdict::kOk);
    EXPECT_EQ(ask(protocol::Start{}), protocol::Verdict::kOk);
  }

  /// Reads what has arrived, without sending a command.
  void listen() {
    for (const std::uint8_t byte : board_.transmitted()) {
      if (decoder_.push(byte) == protocol::FrameEvent::kFrame && decoder_.type() >= 0xC0)
        keep_telemetry();
    }
  }

  std::vector<protocol::TriggerTick> ticks;
  std::vector<protocol::TriggerEdge> edges;
  int telemetry_gaps = 0;

 private:
  void keep_telemetry() {
    if (next_telemetry_ && *next_telemetry_ != decoder_.sequence()) ++telemetry_gaps;
    next_telemetry_ = static_cast<std::uint8_t>(decoder_.sequence() + 1);
    protocol::TriggerTick tick;
    protocol::TriggerEdge edge;
    if (decoder_.type() == protocol::TriggerTick::kId &&
        protocol::read_message(decoder_.body(), tick))
      ticks.push_back(tick);
    if (decoder_.type() == protocol::TriggerEdge::kId &&
        protocol::read_message(decoder_.body(), edge))
      edges.push_back(edge);
  }

  SimBoard& board_;
  protocol::FrameDecoder decoder_;
  std::uint8_t sequence_ = 0;
  std::optional<std::uint8_t> next_telemetry_;
};

}  // namespace mixrig::sim
