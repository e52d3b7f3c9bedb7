// SPDX-License-Identifier: Apache-2.0
// A port of the kernel's virtual USB host controller (vhci_hcd) with a device of this process on
// it: the usbip protocol over a socket pair (Linux, Documentation/usb/usbip_protocol.rst), with
// control, bulk and interrupt transfers and isochronous IN transfers.
#pragma once

#include <array>
#include <atomic>
#include <deque>
#include <thread>
#include <vector>

#include "hal/base/result.h"
#include "tests/board/usb_device.h"

namespace mixrig::board {

/// A device plugged into a virtual port. Needs root and the module vhci-hcd. plug() and unplug()
/// are for one thread.
class VhciPort {
 public:
  /// `device` must outlive the port. `number`: port 0 to 14 among those of the device's speed.
  VhciPort(int number, UsbDevice& device);
  ~VhciPort();
  VhciPort(const VhciPort&) = delete;
  VhciPort& operator=(const VhciPort&) = delete;

  /// Waits until the port is free. Errors: kNotFound without vhci-hcd, kIo.
  Result<void> plug();
  /// Unplugs the cable. Does nothing when it is not plugged in.
  void unplug();
  bool plugged() const { return thread_.joinable(); }
  /// Reports that the device has data to send now. Thread-safe.
  void wake();

 private:
  struct Header;
  struct Transfer {
    std::uint32_t sequence = 0;
    std::uint32_t length = 0;
    std::vector<std::uint32_t> packets{};  ///< lengths of an isochronous transfer's packets
  };
  static constexpr int kEndpoints = 5;

  Result<void> attach(int kernel_end);
  void serve();
  bool read_all(void* to, std::size_t bytes);
  bool write_all(const void* from, std::size_t bytes);
  bool take_request();
  bool submit(const Header& header);
  bool read_packets(std::uint32_t count, std::uint32_t length, std::vector<std::uint32_t>& to);
  bool unlink(const Header& header);
  int answer(const UsbSetup& setup, std::span<std::uint8_t> data);
  int describe(const UsbSetup& setup, std::span<std::uint8_t> out) const;
  bool complete(std::uint32_t sequence, int status, std::size_t actual, bool with_data);
  bool pump();
  bool send_packets(int endpoint, const Transfer& transfer, bool& waits);

  int number_;
  UsbDevice& device_;
  int socket_ = -1;
  const int event_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
  std::array<std::deque<Transfer>, kEndpoints> pending_;  ///< IN transfers that wait
  std::vector<std::uint8_t> buffer_;
};

}  // namespace mixrig::board
