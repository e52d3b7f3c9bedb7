// SPDX-License-Identifier: Apache-2.0
// A serial line that is reopened after it was unplugged.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "hal/base/clock.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Forwards to a stream. When the stream is lost (kDevice) it is closed; later calls try to reopen
/// it with the last line settings, at most four times a second, and return that kDevice error until
/// it works. No call waits for it, and nothing is resent: the protocol above must do that.
class ReopeningByteStream final : public ByteStream {
 public:
  using Open = std::function<Result<std::unique_ptr<ByteStream>>()>;
  /// Makes the stream and opens it for the first time. `clock` must outlive it. Errors: those of
  /// `open`.
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
