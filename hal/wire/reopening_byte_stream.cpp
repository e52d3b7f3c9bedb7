// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/reopening_byte_stream.h"

#include <utility>

namespace mixrig::device {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds(250);

}  // namespace

Result<std::unique_ptr<ByteStream>> ReopeningByteStream::make(Open open, Clock& clock) {
  std::unique_ptr<ReopeningByteStream> stream(new ReopeningByteStream(std::move(open), clock));
  MIXRIG_ASSIGN(stream->stream_, stream->open_());
  return std::unique_ptr<ByteStream>(std::move(stream));
}

Result<void> ReopeningByteStream::ready() {
  if (stream_) return {};
  if (clock_.now() < next_try_) return *lost_;
  next_try_ = clock_.now() + kLookAgain;
  auto opened = open_();
  if (!opened) return *lost_;
  if (settings_)
    if (const auto set = (*opened)->set_line(*settings_); !set) return *lost_;
  stream_ = *std::move(opened);
  return {};
}

void ReopeningByteStream::lost(const Error& error) {
  if (error.code != ErrorCode::kDevice) return;
  stream_.reset();
  lost_ = error;
  next_try_ = clock_.now() + kLookAgain;
}

Result<std::size_t> ReopeningByteStream::read(std::span<std::uint8_t> out, Duration timeout) {
  MIXRIG_TRY(ready());
  auto count = stream_->read(out, timeout);
  if (!count) lost(count.error());
  return count;
}

Result<void> ReopeningByteStream::write(std::span<const std::uint8_t> bytes) {
  MIXRIG_TRY(ready());
  auto written = stream_->write(bytes);
  if (!written) lost(written.error());
  return written;
}

Result<void> ReopeningByteStream::set_line(const LineSettings& settings) {
  settings_ = settings;
  MIXRIG_TRY(ready());
  return stream_->set_line(settings);
}

}  // namespace mixrig::device
