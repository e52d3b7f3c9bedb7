// SPDX-License-Identifier: Apache-2.0
// libusb transfers that are resubmitted when they complete. Private to this module.
#pragma once

#include <chrono>
#include <vector>

#include <libusb.h>

#include "hal/device/usb_bulk.h"

namespace mixrig::device {

/// The transfers of one device; each is submitted again when it completes. For one thread.
class LibusbTransfers {
 public:
  LibusbTransfers() = default;
  LibusbTransfers(const LibusbTransfers&) = delete;
  LibusbTransfers& operator=(const LibusbTransfers&) = delete;
  ~LibusbTransfers() {
    for (libusb_transfer* transfer : all_) libusb_free_transfer(transfer);
  }

  std::vector<libusb_transfer*>& all() { return all_; }
  /// Resets the state; call it before the first submit() of a stream.
  void begin() { state_ = BulkState::kFlowing, cancelling_ = false; }
  /// Submits one transfer; returns libusb's code.
  int submit(libusb_transfer* transfer) {
    const int code = libusb_submit_transfer(transfer);
    if (code == 0) ++in_flight_;
    return code;
  }
  /// Cancels all transfers and waits, at most 5 s, until libusb has returned them: their memory
  /// belongs to the caller.
  void cancel(libusb_context* context) {
    cancelling_ = true;
    if (in_flight_ > 0)
      for (libusb_transfer* transfer : all_) (void)libusb_cancel_transfer(transfer);
    timeval wait{0, 100000};
    for (int i = 0; in_flight_ > 0 && i < 50; ++i)
      (void)libusb_handle_events_timeout(context, &wait);
  }
  BulkState pump(libusb_context* context, Duration timeout) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
    timeval wait{us / 1000000, us % 1000000};
    (void)libusb_handle_events_timeout(context, &wait);
    return state_;
  }
  /// To be called by the transfer's callback: passes the received data to `give` and submits the
  /// transfer again, unless it failed or is cancelled. Runs inside pump() and cancel().
  template <typename Give>
  void returned(libusb_transfer* transfer, const Give& give) {
    --in_flight_;
    if (cancelling_) return;
    switch (transfer->status) {
      case LIBUSB_TRANSFER_COMPLETED:
      case LIBUSB_TRANSFER_TIMED_OUT:
        break;
      case LIBUSB_TRANSFER_STALL:
      case LIBUSB_TRANSFER_OVERFLOW:
      case LIBUSB_TRANSFER_ERROR:
        if (state_ == BulkState::kFlowing) state_ = BulkState::kStalled;
        return;
      default:
        state_ = BulkState::kGone;
        return;
    }
    give(transfer);
    if (submit(transfer) != 0) state_ = BulkState::kGone;
  }

 private:
  std::vector<libusb_transfer*> all_;
  int in_flight_ = 0;
  bool cancelling_ = false;
  BulkState state_ = BulkState::kFlowing;
};

}  // namespace mixrig::device
