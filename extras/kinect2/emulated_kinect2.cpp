// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/emulated_kinect2.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace mixrig::device {
namespace {

constexpr std::size_t kSubPacket = 298648, kIsochronous = 33792, kBulk = 16384;
constexpr std::uint8_t kInfraredPipe = 0x84, kColorPipe = 0x83;

Error unplugged() { return Error{ErrorCode::kNotFound, "kinect2:emulated: not connected"}; }

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t i) {
  std::uint32_t v = 0;
  if (4 * i + 4 <= bytes.size()) std::memcpy(&v, bytes.data() + 4 * i, 4);
  return v;
}

std::vector<std::uint8_t> words(std::initializer_list<std::uint32_t> values) {
  std::vector<std::uint8_t> bytes(4 * values.size());
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

}  // namespace

/// The driver's end.
class EmulatedKinect2Pipes final : public UsbStreams {
 public:
  explicit EmulatedKinect2Pipes(EmulatedKinect2& device) : d_(device) {}
  Result<void> open() override {
    const std::lock_guard lock(d_.mutex_);
    if (!d_.plugged_) return unplugged();
    open_ = true;
    return {};
  }
  void close() override {
    cancel();
    open_ = false;
  }
  Result<void> request(const UsbRequest&) override {
    const std::lock_guard lock(d_.mutex_);
    return there();
  }
  Result<void> set_alternate(int, int setting) override {
    const std::lock_guard lock(d_.mutex_);
    MIXRIG_TRY(there());
    d_.alternate_ = setting;
    return {};
  }
  Result<void> write(std::uint8_t, std::span<const std::uint8_t> bytes) override {
    const std::lock_guard lock(d_.mutex_);
    MIXRIG_TRY(there());
    d_.execute(bytes);
    return {};
  }
  Result<std::size_t> read(std::uint8_t, std::span<std::uint8_t> out) override {
    const std::lock_guard lock(d_.mutex_);
    MIXRIG_TRY(there());
    if (d_.replies_.empty()) return Error{ErrorCode::kDevice, "kinect2:emulated: timed out"};
    const auto reply = std::move(d_.replies_.front());
    d_.replies_.pop_front();
    const std::size_t count = std::min(out.size(), reply.size());
    std::copy_n(reply.begin(), count, out.begin());
    return count;
  }
  Result<void> submit(std::span<const StreamPipe>) override {
    const std::lock_guard lock(d_.mutex_);
    MIXRIG_TRY(there());
    d_.submitted_ = true;
    d_.halted_ = false;
    return {};
  }
  void cancel() override {
    const std::lock_guard lock(d_.mutex_);
    d_.submitted_ = false;
    d_.packets_.clear();
  }
  BulkState pump(Duration timeout, const StreamSink& sink) override {
    std::unique_lock lock(d_.mutex_);
    d_.changed_.wait_for(lock, timeout,
                         [this] { return !d_.packets_.empty() || d_.halted_ || !d_.plugged_; });
    while (!d_.packets_.empty()) {
      const auto packet = std::move(d_.packets_.front());
      d_.packets_.pop_front();
      lock.unlock();
      sink({packet.endpoint, packet.bytes, packet.good});
      lock.lock();
    }
    if (!d_.plugged_ || !open_) return BulkState::kGone;
    return d_.halted_ ? BulkState::kStalled : BulkState::kFlowing;
  }

 private:
  Result<void> there() const {
    return d_.plugged_ && open_ ? Result<void>() : Result<void>(unplugged());
  }
  EmulatedKinect2& d_;
  bool open_ = false;
};

std::unique_ptr<UsbStreams> EmulatedKinect2::pipes() {
  return std::make_unique<EmulatedKinect2Pipes>(*this);
}

/// The caller holds the lock.
void EmulatedKinect2::execute(std::span<const std::uint8_t> command) {
  if (word(command, 0) != 0x06022009) return;  // no command: no answer
  const std::uint32_t code = word(command, 3), parameter = word(command, 5);
  if (code == 0x02) {
    auto versions = std::vector<std::uint8_t>(0x200);
    const auto main = words({4U << 16 | 3U, 3911, 7, 0});
    std::copy(main.begin(), main.end(), versions.begin() + 48);
    replies_.push_back(std::move(versions));
  } else if (code == 0x22 && parameter == 1) {
    std::vector<std::uint8_t> wide(0x80);
    for (std::size_t i = 0; i < answers_.serial.size() && 2 * i < wide.size(); ++i)
      wide[2 * i] = static_cast<std::uint8_t>(answers_.serial[i]);
    replies_.push_back(std::move(wide));
  } else if (code == 0x22) {
    replies_.push_back(parameter == 2   ? answers_.phase_offsets
                       : parameter == 3 ? answers_.infrared
                                        : answers_.color);
  } else if (code == 0x16) {
    replies_.push_back(words({0x2201}));
  } else if (code == 0x2B) {
    enabled_ = parameter == 1;
    starts_ += enabled_ ? 1 : 0;
  }
  if (complete_) replies_.push_back(words({0x0A6FE000, word(command, 1), 0, 0}));
}

void EmulatedKinect2::send(Packet packet) {
  const std::lock_guard lock(mutex_);
  const bool open = packet.endpoint != kInfraredPipe || alternate_ == 1;
  if (enabled_ && submitted_ && open) packets_.push_back(std::move(packet));
  changed_.notify_all();
}

void EmulatedKinect2::send_depth(std::span<const std::uint8_t> bytes, int lost, int cut) {
  int number = 0;
  for (std::size_t begin = 0; begin < bytes.size(); begin += kSubPacket) {
    const auto sub = bytes.subspan(begin, std::min(kSubPacket, bytes.size() - begin));
    for (std::size_t at = 0; at < sub.size(); at += kIsochronous, ++number) {
      auto part = sub.subspan(at, std::min(kIsochronous, sub.size() - at));
      if (number == cut) part = part.first(part.size() - 100);
      if (number == lost) part = {};
      send({kInfraredPipe, {part.begin(), part.end()}, number != lost});
    }
    send({kInfraredPipe, {}, true});
  }
}

void EmulatedKinect2::send_color(std::span<const std::uint8_t> packet) {
  for (std::size_t at = 0; at < packet.size(); at += kBulk) {
    const auto part = packet.subspan(at, std::min(kBulk, packet.size() - at));
    send({kColorPipe, {part.begin(), part.end()}, true});
  }
}

void EmulatedKinect2::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = enabled_ = submitted_ = false;
  alternate_ = 0;
  packets_.clear();
  replies_.clear();
  changed_.notify_all();
}

void EmulatedKinect2::replug() {
  const std::lock_guard lock(mutex_);
  plugged_ = true;
}

void EmulatedKinect2::stall() {
  const std::lock_guard lock(mutex_);
  halted_ = true;
  changed_.notify_all();
}

void EmulatedKinect2::leave_commands_open() {
  const std::lock_guard lock(mutex_);
  complete_ = false;
}

bool EmulatedKinect2::streaming() const {
  const std::lock_guard lock(mutex_);
  return enabled_ && submitted_;
}

int EmulatedKinect2::starts() const {
  const std::lock_guard lock(mutex_);
  return starts_;
}

}  // namespace mixrig::device
