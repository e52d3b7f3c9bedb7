// SPDX-License-Identifier: Apache-2.0
// One function per command. All are idempotent: a repeated command has no further effect.
#include <algorithm>

#include "firmware/app/app.h"
#include "firmware/protocol/image_header.h"

namespace mixrig::firmware {

using protocol::Fault;
using protocol::State;
using protocol::Verdict;

/// The body of a reply: a verdict, then a message.
class App::Body {
 public:
  template <typename M>
  Verdict put(const M& message) {
    size_ = 1 + protocol::write_message(message, std::span(bytes_).subspan(1));
    return Verdict::kOk;
  }
  std::span<const std::uint8_t> finish(Verdict verdict) {
    bytes_[0] = static_cast<std::uint8_t>(verdict);
    return {bytes_.data(), size_};
  }
  void drop_message() { size_ = 1; }

 private:
  std::array<std::uint8_t, protocol::kMaxBody> bytes_{};
  std::size_t size_ = 1;
};

void App::handle_frame() {
  const std::uint8_t type = decoder_.type();
  if (type >= protocol::kReplyBit) return;  // an echo of a frame that this side sent
  Body reply;
  const Verdict verdict = dispatch(reply);
  // Hello gets the full answer even with another message table: the host reports what to flash.
  if (verdict != Verdict::kOk && type != protocol::Hello::kId) reply.drop_message();
  const auto reply_type = static_cast<std::uint8_t>(type | protocol::kReplyBit);
  if (!send(reply_type, decoder_.sequence(), reply.finish(verdict), 0)) count(Fault::kReplyLost);
}

Verdict App::dispatch(Body& reply) {
  const std::uint8_t type = decoder_.type();
  if (type == protocol::Hello::kId) return hello(reply);
  if (type == protocol::Reboot::kId) return reboot();
  if (!hello_done_) return Verdict::kHelloFirst;
  const bool read_only = type == protocol::Status::kId || type == protocol::SelfTest::kId;
  if (identity_.image_bad && !read_only) return Verdict::kImageBad;

  const bool empty = decoder_.body().empty();
  switch (type) {
    case protocol::Status::kId:
      return empty ? status(reply) : Verdict::kLength;
    case protocol::SetChannel::kId:
      return set_channel();
    case protocol::GetChannel::kId:
      return get_channel(reply);
    case protocol::Arm::kId:
      return empty ? arm() : Verdict::kLength;
    case protocol::Start::kId:
      return empty ? start() : Verdict::kLength;
    case protocol::Stop::kId:
      return empty ? stop() : Verdict::kLength;
    case protocol::Subscribe::kId: {
      protocol::Subscribe subscribe;
      if (!read(subscribe)) return Verdict::kLength;
      subscribed_.store(subscribe.mask);
      return Verdict::kOk;
    }
    case protocol::SelfTest::kId:
      return empty ? self_test(reply) : Verdict::kLength;
    default:
      return Verdict::kUnknown;
  }
}

Verdict App::hello(Body& reply) {
  protocol::Hello hello;
  if (!read(hello)) return Verdict::kLength;
  protocol::HelloReply answer;
  answer.table_hash = protocol::kTableHash;
  answer.version = kVersion;
  answer.board = protocol::kBoardF405;
  answer.reset_cause = identity_.reset_cause;
  answer.clock = identity_.clock;
  answer.channels = protocol::kChannels;
  answer.image_crc = identity_.image_crc;
  answer.image_ok = !identity_.image_bad;
  answer.uid = identity_.uid;
  reply.put(answer);
  hello_done_ = hello.table_hash == protocol::kTableHash;
  return hello_done_ ? Verdict::kOk : Verdict::kTableMismatch;
}

Verdict App::status(Body& reply) {
  protocol::StatusReply answer;
  answer.state = state_.load();
  answer.enabled = schedule_.enabled();
  answer.tick = tick_.load();
  answer.now_us = port::now_us();
  answer.late_max_ns = late_max_ns_.load();
  answer.cost_max_ns = cost_max_ns_.load();
  answer.silence_max_s =
      static_cast<std::uint16_t>(std::min<std::uint64_t>(silence_max_us_ / 1'000'000, 0xFFFF));
  for (std::size_t i = 0; i < protocol::kFaults; ++i) answer.faults[i] = faults_[i].load();
  return reply.put(answer);
}

Verdict App::set_channel() {
  protocol::SetChannel config;
  if (!read(config)) return Verdict::kLength;
  if (!TriggerSchedule::valid(config)) return Verdict::kArgument;
  if (schedule_.get(config.channel) == config) return Verdict::kOk;
  if (state_.load() == State::kRunning) return Verdict::kState;
  // Sets the lines driven so far inactive; arm() drives the new set.
  stop();
  schedule_.set(config);
  return Verdict::kOk;
}

Verdict App::get_channel(Body& reply) {
  protocol::GetChannel get;
  if (!read(get)) return Verdict::kLength;
  if (get.channel >= protocol::kChannels) return Verdict::kArgument;
  protocol::ChannelConfig config = schedule_.get(get.channel);
  config.channel = get.channel;
  return reply.put(config);
}

Verdict App::arm() {
  if (state_.load() == State::kArmed) return Verdict::kOk;
  if (state_.load() == State::kRunning) return Verdict::kState;
  port::outputs_idle(schedule_.idle_word());
  state_.store(State::kArmed);
  return Verdict::kOk;
}

Verdict App::start() {
  if (state_.load() == State::kRunning) return Verdict::kOk;
  if (state_.load() != State::kArmed) return Verdict::kState;
  schedule_.rewind();
  refill(0);
  refill(1);
  tick_.store(0);
  late_max_ns_.store(0);
  cost_max_ns_.store(0);
  first_tick_seen_ = false;
  silence_max_us_ = 0;
  const port::IrqLock lock;
  state_.store(State::kRunning);
  port::outputs_start(words_.data());
  return Verdict::kOk;
}

Verdict App::stop() {
  const port::IrqLock lock;
  if (state_.load() != State::kIdle) port::outputs_idle(schedule_.idle_word());
  state_.store(State::kIdle);
  return Verdict::kOk;
}

std::uint32_t App::failed_self_tests() {
  std::uint32_t failures = 0;
  const auto expect = [&](protocol::SelfTestBit bit, bool passed) {
    if (!passed) failures |= 1u << static_cast<unsigned>(bit);
  };
  expect(protocol::SelfTestBit::kImage, !identity_.image_bad);
  const std::uint64_t before = port::now_us();
  std::uint32_t tries = 100'000;  // some milliseconds
  while (port::now_us() == before && tries != 0) --tries;
  expect(protocol::SelfTestBit::kTimer, tries != 0);
  expect(protocol::SelfTestBit::kClock, identity_.clock != protocol::ClockSource::kInternal);
  static constexpr std::uint8_t kDigits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  expect(protocol::SelfTestBit::kCrc, protocol::crc16(kDigits) == 0x29B1);
  if (state_.load() == State::kArmed) {  // driven, no edges: the pins must read back as driven
    const auto mask = schedule_.enabled();
    const auto driven = static_cast<std::uint16_t>(schedule_.idle_word() & mask);
    expect(protocol::SelfTestBit::kOutputs, (port::outputs_read(driven) & mask) == driven);
  }
  return failures;
}

Verdict App::self_test(Body& reply) {
  return reply.put(protocol::SelfTestReply{failed_self_tests()});
}

Verdict App::reboot() {
  protocol::Reboot reboot;
  if (!read(reboot)) return Verdict::kLength;
  if (reboot.key != protocol::kRebootKey) return Verdict::kArgument;
  if (reboot.target > protocol::RebootTarget::kBootloader) return Verdict::kArgument;
  if (state_.load() == State::kRunning) return Verdict::kState;
  stop();
  reboot_target_ = reboot.target;
  reboot_requested_ = true;
  return Verdict::kOk;
}

}  // namespace mixrig::firmware
