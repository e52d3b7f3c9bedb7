// SPDX-License-Identifier: Apache-2.0
// A serial line that outlives its cable.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "hal/base/clock.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Passes everything on to a stream. One that is lost (kDevice) is closed, and a later call opens
/// it again, with the line as it was set, at most four times a second; meanwhile every call is that
/// kDevice error. Nothing waits and nothing is resent: what was in flight is the protocol's affair.
class ReopeningByteStream final : public ByteStream {
 public:
  using Open = std::function<Result<std::unique_ptr<ByteStream>>()>;
  /// Opens it for the first time. `clock` outlives it. Errors: those of `open`.
  static Result<std::unique_ptr<ByteStream>> make(Open open, Clock& clock);

  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<void> set_line(const LineSettings& settings) override;

 private:
  ReopeningByteStream(Open open, Clock& clock) : open_(std::move(open)), clock_(clock) {}
  Result<void> ready();
  void lost(const Error& error);

  Open open_;
  Clock& clock_;
  std::unique_ptr<ByteStream> stream_;
  std::optional<LineSettings> settings_;
  std::optional<Error> lost_;
  HostTime next_try_{};
};

}  // namespace mixrig::device
