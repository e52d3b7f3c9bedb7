// SPDX-License-Identifier: Apache-2.0
// Decodes the byte stream of a USB ToF camera into frames (tof_usb_protocol.md).
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/depth_camera.h"
#include "hal/device/frame_pool.h"

namespace mixrig::device {

inline constexpr std::size_t kTofDescriptionBytes = 40;
inline constexpr std::size_t kTofHeaderBytes = 40;
inline constexpr std::size_t kTofMostPayload = 32768;
inline constexpr int kTofLongestSide = 1024;
inline constexpr std::uint16_t kTofNoTemperature = 0x7FFF;

enum class TofKind : std::uint16_t { kDistance = 1, kAmplitude = 2 };

struct TofDescription {
  Size size;
  double rate_hz = 0;
  bool amplitude = false;
  DepthInfo depth;
};

struct TofPacket {
  TofKind kind = TofKind::kDistance;
  std::uint16_t temperature = kTofNoTemperature;
  std::uint32_t frame = 0;
  int first_row = 0, rows = 0;
  Size size;
  std::uint32_t payload_bytes = 0, payload_crc = 0;
  std::uint64_t time_us = 0;
};

/// Returns the CRC-32 of IEEE 802.3, by zlib.
std::uint32_t tof_crc32(std::span<const std::uint8_t> bytes);
/// Parses a camera's description. Errors: kDevice; the line says what is wrong.
Result<TofDescription> parse_tof_description(std::span<const std::uint8_t> bytes);
/// Parses the header at the start of `bytes`; empty unless all of it is valid.
std::optional<TofPacket> parse_tof_header(std::span<const std::uint8_t> bytes, Size size);
/// Pack a description or a header; the inverse of the parsers, for emulators.
std::array<std::uint8_t, kTofDescriptionBytes> pack_tof_description(
    const TofDescription& description);
std::array<std::uint8_t, kTofHeaderBytes> pack_tof_header(const TofPacket& packet);

/// Takes the stream in parts of any length. Nothing allocates after construction. For one thread.
class TofUsbDecoder {
 public:
  /// `pool` holds frames of the description's size and must outlive the decoder.
  TofUsbDecoder(const TofDescription& description, FramePool& pool);

  void feed(std::span<const std::uint8_t> bytes, HostTime now, const FrameSink& sink);
  /// Drops the incomplete frame and buffered bytes: the device starts again.
  void restart();

  /// Health of the stream: fills frames, lost, incomplete, overrun and link_errors; the driver
  /// fills the others.
  const StreamHealth& health() const { return health_; }
  const DepthHealth& depth_health() const { return depth_health_; }

 private:
  std::size_t parse(std::span<const std::uint8_t> bytes);
  void count_damage();
  void take(const TofPacket& packet, std::span<const std::uint8_t> payload);
  void begin(const TofPacket& packet);
  void finish();
  bool whole() const;

  TofDescription description_;
  FramePool& pool_;
  std::vector<std::uint8_t> pending_;
  std::size_t pending_count_ = 0;
  bool in_sync_ = true;
  const FrameSink* sink_ = nullptr;
  HostTime now_{};

  FramePool::Draft draft_;
  bool open_ = false, first_ = true, after_restart_ = false;
  std::uint32_t frame_ = 0, last_frame_ = 0;
  std::uint64_t time_us_ = 0;
  std::bitset<kTofLongestSide> distance_rows_, amplitude_rows_;
  std::uint64_t amplitude_sum_ = 0, amplitude_count_ = 0;
  StreamHealth health_;
  DepthHealth depth_health_;
};

}  // namespace mixrig::device
