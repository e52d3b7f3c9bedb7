// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/emulated_dfuse.h"

#include <algorithm>

namespace mixrig::fake {

namespace {

constexpr std::uint8_t kDownload = 1, kUpload = 2, kGetStatus = 3, kClearStatus = 4, kAbort = 6;
constexpr std::uint16_t kTransfer = 2048;
enum State : std::uint8_t {
  kIdle = 2,
  kDownloadSync = 3,
  kDownloadBusy = 4,
  kDownloadIdle = 5,
  kManifest = 7,
  kUploadIdle = 9,
  kErrorState = 10,
};
constexpr std::uint8_t kErrTarget = 1, kErrAddress = 8, kErrStalled = 15;

std::uint32_t word(std::span<const std::uint8_t> b) {
  return b[0] | static_cast<std::uint32_t>(b[1]) << 8 | static_cast<std::uint32_t>(b[2]) << 16 |
         static_cast<std::uint32_t>(b[3]) << 24;
}

}  // namespace

EmulatedDfuse::EmulatedDfuse(EmulatedFlash& flash)
    : flash_(flash),
      interface_{0, kTransfer, "@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg"} {}

void EmulatedDfuse::reset() {
  state_ = kIdle;
  status_ = 0;
  pending_.clear();
  leaving_ = false;
  gone_to_.reset();
}

Result<void> EmulatedDfuse::count_request() {
  if (!flash_.powered() || gone_to_) return Error{ErrorCode::kDevice, "USB device is gone"};
  if (++requests_ != stall_at_) return {};
  state_ = kErrorState;
  status_ = kErrStalled;
  return Error{ErrorCode::kDevice, "USB request stalled"};
}

Result<void> EmulatedDfuse::send(std::uint8_t request, std::uint16_t value,
                                 std::span<const std::uint8_t> data) {
  MIXRIG_TRY(count_request());
  switch (request) {
    case kDownload:
      return download(value, data);
    case kClearStatus:
      if (state_ == kErrorState) reset();
      return {};
    case kAbort:
      if (state_ != kErrorState) state_ = kIdle;
      return {};
    default:
      state_ = kErrorState;
      status_ = kErrStalled;
      return Error{ErrorCode::kDevice, "USB request stalled"};
  }
}

Result<void> EmulatedDfuse::download(std::uint16_t block, std::span<const std::uint8_t> data) {
  if ((state_ != kIdle && state_ != kDownloadIdle) || data.size() > kTransfer) {
    state_ = kErrorState;
    status_ = kErrStalled;
    return Error{ErrorCode::kDevice, "USB request stalled"};
  }
  block_ = block;
  pending_.assign(data.begin(), data.end());
  leaving_ = data.empty();
  state_ = kDownloadSync;
  return {};
}

/// Carries out what was downloaded. As on the device, no error reports a write-protected sector.
void EmulatedDfuse::perform() {
  const auto fail = [&](std::uint8_t why) {
    state_ = kErrorState;
    status_ = why;
  };
  state_ = kDownloadBusy;
  const bool is_command = block_ == 0 && pending_.size() == 5;
  const std::uint32_t target = is_command
                                   ? word(std::span(pending_).subspan(1))
                                   : pointer_ + static_cast<std::uint32_t>(block_ - 2) * kTransfer;
  if (!EmulatedFlash::contains(target, is_command ? 1 : pending_.size())) return fail(kErrAddress);
  if (is_command && pending_[0] == 0x21) {
    pointer_ = target;
  } else if (is_command && pending_[0] == 0x41) {
    flash_.erase_sector(*EmulatedFlash::sector_of(target));
  } else if (block_ >= 2) {
    flash_.program(target, pending_);
  } else {
    fail(kErrTarget);
  }
}

std::array<std::uint8_t, 6> EmulatedDfuse::status() {
  std::uint8_t poll_ms = 0;
  if (state_ == kDownloadSync && leaving_) {
    state_ = kManifest;
    gone_to_ = pointer_;
  } else if (state_ == kDownloadSync) {
    perform();
    poll_ms = 10;
  } else if (state_ == kDownloadBusy) {
    state_ = kDownloadIdle;
  }
  return {status_, poll_ms, 0, 0, state_, 0};
}

Result<std::size_t> EmulatedDfuse::receive(std::uint8_t request, std::uint16_t value,
                                           std::span<std::uint8_t> out) {
  MIXRIG_TRY(count_request());
  if (request == kGetStatus) {
    const auto answer = status();
    if (!flash_.powered()) return Error{ErrorCode::kDevice, "USB device is gone"};
    const std::size_t n = std::min(out.size(), answer.size());
    std::copy_n(answer.begin(), n, out.begin());
    return n;
  }
  const std::uint32_t address = pointer_ + static_cast<std::uint32_t>(value - 2) * kTransfer;
  const bool may = request == kUpload && (state_ == kIdle || state_ == kUploadIdle) && value >= 2 &&
                   out.size() <= kTransfer && EmulatedFlash::contains(address, out.size());
  if (!may) {
    state_ = kErrorState;
    status_ = kErrStalled;
    return Error{ErrorCode::kDevice, "USB request stalled"};
  }
  state_ = kUploadIdle;
  const auto bytes = flash_.read(address, out.size());
  std::copy(bytes.begin(), bytes.end(), out.begin());
  return out.size();
}

std::vector<std::uint8_t> EmulatedDfuse::descriptors() {
  return {// device: USB 1.0, EP0 64 bytes, 0483:df11, release 2.00, one configuration
          18, 1, 0x00, 0x01, 0, 0, 0, 64, 0x83, 0x04, 0x11, 0xDF, 0x00, 0x02, 1, 2, 3, 1,
          // configuration: 27 bytes, one interface, self-powered, 100 mA
          9, 2, 27, 0, 1, 1, 0, 0xC0, 50,
          // interface 0: application specific, DFU, in DFU mode, name is string 4
          9, 4, 0, 0, 0, 0xFE, 1, 2, 4,
          // functional: can download and upload, detach 255 ms, 2048 bytes a transfer, DFU 1.1a
          9, 0x21, 0x0B, 0xFF, 0x00, 0x00, 0x08, 0x1A, 0x01};
}

}  // namespace mixrig::fake
