// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/tof_usb_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace mixrig::device {

TofUsbDecoder::TofUsbDecoder(const TofDescription& description, FramePool& pool)
    : description_(description), pool_(pool), pending_(2 * (kTofHeaderBytes + kTofMostPayload)) {}

void TofUsbDecoder::restart() {
  pending_count_ = 0;
  in_sync_ = true;
  draft_ = FramePool::Draft();
  open_ = false;
  after_restart_ = !first_;
  first_ = true;
}

void TofUsbDecoder::feed(std::span<const std::uint8_t> bytes, HostTime now, const FrameSink& sink) {
  now_ = now;
  sink_ = &sink;
  while (!bytes.empty()) {
    const std::size_t room = std::min(bytes.size(), pending_.size() - pending_count_);
    std::copy_n(bytes.begin(), room,
                pending_.begin() + static_cast<std::ptrdiff_t>(pending_count_));
    pending_count_ += room;
    bytes = bytes.subspan(room);
    const std::size_t used = parse({pending_.data(), pending_count_});
    std::memmove(pending_.data(), pending_.data() + used, pending_count_ - used);
    pending_count_ -= used;
  }
  sink_ = nullptr;
}

/// Takes complete packets from the front; returns how many bytes are used up. The rest is shorter
/// than one packet, so the buffer never fills up.
std::size_t TofUsbDecoder::parse(std::span<const std::uint8_t> bytes) {
  std::size_t at = 0;
  while (bytes.size() - at >= kTofHeaderBytes) {
    const auto rest = bytes.subspan(at);
    const auto packet = parse_tof_header(rest, description_.size);
    if (!packet) {
      count_damage();
      ++at;
      continue;
    }
    const std::size_t length = kTofHeaderBytes + packet->payload_bytes;
    if (rest.size() < length) break;
    const auto payload = rest.subspan(kTofHeaderBytes, packet->payload_bytes);
    if (tof_crc32(payload) != packet->payload_crc) {
      // Bytes were lost: the next header may lie within what was read as payload.
      count_damage();
      ++at;
      continue;
    }
    in_sync_ = true;
    take(*packet, payload);
    at += length;
  }
  return at;
}

/// Counts one error for a run of bad bytes.
void TofUsbDecoder::count_damage() {
  if (std::exchange(in_sync_, false)) ++health_.link_errors;
}

void TofUsbDecoder::take(const TofPacket& packet, std::span<const std::uint8_t> payload) {
  if (packet.temperature != kTofNoTemperature)
    depth_health_.temperature_c = static_cast<std::int16_t>(packet.temperature) / 100.0;
  const auto ahead = static_cast<std::int32_t>(packet.frame - frame_);
  if (!open_ || ahead != 0) {
    if (!first_ && ahead <= 0) return;  // a late packet of a finished frame
    finish();
    begin(packet);
  }
  const bool distance = packet.kind == TofKind::kDistance;
  auto& rows = distance ? distance_rows_ : amplitude_rows_;
  const auto target = distance ? draft_.bytes() : draft_.amplitude();
  const std::size_t row_size = 2 * static_cast<std::size_t>(description_.size.width);
  for (int i = 0; i < packet.rows; ++i) rows.set(static_cast<std::size_t>(packet.first_row + i));
  const std::size_t offset = static_cast<std::size_t>(packet.first_row) * row_size;
  if (draft_ && offset + payload.size() <= target.size())
    std::copy(payload.begin(), payload.end(), target.begin() + static_cast<std::ptrdiff_t>(offset));
  if (!distance) {
    for (std::size_t i = 0; i + 1 < payload.size(); i += 2)
      amplitude_sum_ += static_cast<std::uint64_t>(payload[i] | payload[i + 1] << 8);
    amplitude_count_ += payload.size() / 2;
  }
  if (whole()) finish();
}

void TofUsbDecoder::begin(const TofPacket& packet) {
  open_ = true;
  frame_ = packet.frame;
  time_us_ = packet.time_us;
  distance_rows_.reset();
  amplitude_rows_.reset();
  amplitude_sum_ = amplitude_count_ = 0;
  draft_ = pool_.take();
  // Rows that do not arrive must not show an older frame.
  const int unknown = description_.depth.unknown_steps.front();
  auto bytes = draft_.bytes();
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    bytes[i] = static_cast<std::uint8_t>(unknown & 0xFF);
    bytes[i + 1] = static_cast<std::uint8_t>(unknown >> 8);
  }
  std::fill(draft_.amplitude().begin(), draft_.amplitude().end(), std::uint8_t{0});
}

bool TofUsbDecoder::whole() const {
  const auto rows = static_cast<std::size_t>(description_.size.height);
  return distance_rows_.count() == rows &&
         (!description_.amplitude || amplitude_rows_.count() == rows);
}

void TofUsbDecoder::finish() {
  if (!open_) return;
  open_ = false;
  Frame frame{.format = PixelFormat::kDepth16,
              .size = description_.size,
              .stride_bytes = 2 * static_cast<std::size_t>(description_.size.width),
              .sequence = frame_,
              .device_time = DeviceTime(std::chrono::microseconds(time_us_)),
              .received = now_};
  if (!whole()) {
    frame.flags |= kFrameIncomplete;
    ++health_.incomplete;
  }
  if (!first_ && frame_ - last_frame_ > 1) {
    frame.flags |= kFrameAfterGap;
    health_.lost += frame_ - last_frame_ - 1;
  }
  if (std::exchange(after_restart_, false)) frame.flags |= kFrameRestarted;
  first_ = false;
  last_frame_ = frame_;
  if (amplitude_count_ > 0)
    depth_health_.mean_amplitude =
        static_cast<double>(amplitude_sum_) / static_cast<double>(amplitude_count_);
  if (!draft_) return void(++health_.overrun);
  ++health_.frames;
  const std::size_t used = draft_.bytes().size(), amplitude_used = draft_.amplitude().size();
  (*sink_)(std::move(draft_).publish(frame, used, amplitude_used));
  draft_ = FramePool::Draft();
}

}  // namespace mixrig::device
