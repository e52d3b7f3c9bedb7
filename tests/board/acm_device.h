// SPDX-License-Identifier: Apache-2.0
// A serial line over USB (CDC-ACM): /dev/ttyACMn in the guest, with a peer of this process on it.
#pragma once

#include <mutex>
#include <vector>

#include "hal/fake/flir_ptu_emulator.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

/// Called on the port's thread.
class SerialPeer {
 public:
  virtual ~SerialPeer() = default;
  virtual void plugged(HostTime /*now*/) {}
  virtual void receive(std::span<const std::uint8_t> bytes, HostTime now) = 0;
  /// Appends the bytes that it sends to `out`.
  virtual void transmit_ready(std::vector<std::uint8_t>& out, HostTime now) = 0;
  virtual std::optional<HostTime> next_event() { return std::nullopt; }
};

class AcmDevice final : public UsbDevice {
 public:
  AcmDevice(const std::string& product, SerialPeer& peer);
  const UsbDescriptors& descriptors() const override { return descriptors_; }
  int control(const UsbSetup&, std::span<std::uint8_t>) override { return 0; }
  void receive(int endpoint, std::span<const std::uint8_t> bytes) override;
  int transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) override;
  std::optional<HostTime> next_event() override { return peer_.next_event(); }
  void configured() override;

 private:
  SerialPeer& peer_;
  UsbDescriptors descriptors_;
  std::vector<std::uint8_t> out_;
};

/// The emulated pan-tilt unit as the peer of a serial line.
class PtuPeer final : public SerialPeer {
 public:
  /// `byte_time`: duration of every byte of a command or an answer on the line.
  explicit PtuPeer(Duration byte_time = {}) : byte_time_(byte_time) {}
  void receive(std::span<const std::uint8_t> bytes, HostTime now) override;
  void transmit_ready(std::vector<std::uint8_t>& out, HostTime now) override;
  std::optional<HostTime> next_event() override;
  void set_faults(const fake::FlirPtuEmulator::Faults& faults);
  std::array<long, 2> position(HostTime now);
  /// Gives the unit a command from another controller; the host does not see the answers.
  void order(const std::string& words, HostTime now);
  std::uint64_t limit_reports() const;

 private:
  mutable std::mutex mutex_;
  fake::FlirPtuEmulator unit_{1};
  Duration byte_time_;
  HostTime ready_{};  ///< when the current answer has been transmitted
};

}  // namespace mixrig::board
