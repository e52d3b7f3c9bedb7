// SPDX-License-Identifier: Apache-2.0
// Emulated boards behind a pty, in real time, for programs that open a port.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

#include "firmware/port/sim/sim_line.h"
#include "hal/base/clock.h"
#include "hal/fake/emulated_board.h"
#include "tests/sim/qemu.h"

namespace mixrig::test {

/// Serves a pty at `path`: a thread passes received bytes to `board.step(from_host)` and sends what
/// it returns.
template <typename Board>
class PtyServer {
 public:
  explicit PtyServer(const std::string& path) : line_(sim::SimLine::open_pty(path, error_)) {
    if (!line_) throw std::runtime_error(error_);
    thread_ = std::thread([this] { serve(); });
  }
  PtyServer(const PtyServer&) = delete;
  PtyServer& operator=(const PtyServer&) = delete;
  ~PtyServer() {
    stop_ = true;
    thread_.join();
  }

  /// Runs `action(board)` between two steps.
  template <typename Action>
  auto with(Action action) {
    const std::lock_guard lock(mutex_);
    return action(board_);
  }

 private:
  void serve() {
    std::array<std::uint8_t, 512> buffer;
    while (!stop_) {
      const std::size_t n = line_->read(buffer, 1'000);
      const std::lock_guard lock(mutex_);
      line_->write(board_.step(std::span(buffer).first(n)));
    }
  }

  std::string error_;
  std::optional<sim::SimLine> line_;
  Board board_;
  std::mutex mutex_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// The emulated board, on the clock of this host.
class RealTimeBoard : public fake::EmulatedBoard {
 public:
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> from_host) {
    const Duration age = clock_.now() - begin_;
    advance_to(static_cast<std::uint64_t>(age / std::chrono::microseconds(1)));
    receive(damaged({from_host.begin(), from_host.end()}));
    std::vector<std::uint8_t> sent = transmitted();
    const std::vector<std::uint8_t> more =
        transmitted();  // after a change of mode, the new mode may have bytes to send
    sent.insert(sent.end(), more.begin(), more.end());
    return damaged(std::move(sent));
  }

  double byte_error_share = 0;  ///< share of bytes that are damaged, either way

 private:
  std::vector<std::uint8_t> damaged(std::vector<std::uint8_t> bytes) {
    std::bernoulli_distribution hit(byte_error_share);
    for (std::uint8_t& byte : bytes) {
      if (hit(random_)) byte ^= static_cast<std::uint8_t>(1 + random_() % 255);
    }
    return bytes;
  }

  std::mt19937 random_{1};
  SystemClock clock_;
  HostTime begin_ = clock_.now();
};

/// The emulated ROM bootloader; the program that it starts runs in QEMU, from the written flash.
/// QEMU ends at a reset of the chip; the tests request only the reset to the ROM.
class QemuBoard {
 public:
  fake::EmulatedFlash& flash() { return flash_; }
  int boots() const { return boots_; }

  std::vector<std::uint8_t> step(std::span<const std::uint8_t> from_host) {
    std::vector<std::uint8_t> sent;
    if (!stream_ && rom_.gone_to()) boot();
    if (!stream_) {
      for (const std::uint8_t byte : from_host) rom_.receive(byte);
      sent.swap(rom_.output());
      return sent;
    }
    sent.resize(512);
    const auto written = stream_->write(from_host);
    const auto n = stream_->read(sent, Duration{0});
    sent.resize(n ? *n : 0);
    if (!written || !n) {  // the chip was reset
      stream_.reset();
      qemu_.reset();
      rom_.reset();
    }
    return sent;
  }

 private:
  void boot() {
    const auto bytes = flash_.bytes();
    const std::string chip = folder_.write(
        "flash.bin", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    qemu_.emplace(chip);
    stream_ = qemu_->connect(clock_);
    ++boots_;
  }

  SystemClock clock_;
  TemporaryFolder folder_;
  fake::EmulatedFlash flash_;
  fake::EmulatedRom rom_{flash_};
  std::optional<Qemu> qemu_;
  std::unique_ptr<device::ByteStream> stream_;
  int boots_ = 0;
};

}  // namespace mixrig::test
