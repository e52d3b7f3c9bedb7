// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO 1.0.1 (SMPTE RIS OSVP): a camera's pose and lens, a sample for each frame, as JSON or
// CBOR in UDP datagrams, as they are sent; opentrackio_reader.h reads them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "extras/broadcast/packets/camera_angles.h"

namespace mixrig::stream {

inline constexpr std::size_t kOpenTrackHeaderBytes = 16;
inline constexpr std::size_t kOpenTrackPayloadBytes = 1400;  ///< most of a segment that is sent

enum class OpenTrackEncoding : std::uint8_t { kJson = 1, kCbor = 2 };

using Uuid = std::array<std::uint8_t, 16>;

/// A sample. The picture has no distortion.
struct OpenTrackSample {
  Uuid sample_id{}, source_id{};
  int source = 1;            ///< 1..200
  std::uint64_t number = 0;  ///< counts the samples
  std::int64_t time_ns = 0;  ///< time of mid-exposure since 1970, TAI of PTP, else UTC
  /// Kind and state of the clock of `time_ns`.
  struct Synchronization {
    enum class Source : std::uint8_t { kPtp, kNtp } source = Source::kPtp;
    bool locked = false;
  };
  std::optional<Synchronization> synchronization;
  std::string status;  ///< state of the tracker, such as "ok" or why there is no pose
  std::optional<CameraAngles> angles;  ///< absent: the pose is unknown
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double focal_length_mm = 0;                           ///< focal length of a pinhole
  Eigen::Vector2d offset_mm = Eigen::Vector2d::Zero();  ///< of the principal point, right and down
  std::optional<double> zoom, focus;                    ///< raw values of the lens's encoders
  /// Size of the sensor; sent now and then.
  struct Sensor {
    double width_mm = 0, height_mm = 0;
    int width_px = 0, height_px = 0;
  };
  std::optional<Sensor> sensor;
};

/// Encodes the sample as payload.
std::vector<std::byte> opentrack_payload(const OpenTrackSample& sample, OpenTrackEncoding encoding);

/// Contents of one datagram.
struct OpenTrackSegment {
  OpenTrackEncoding encoding = OpenTrackEncoding::kJson;
  std::uint16_t sequence = 0;  ///< sequence number of the sample
  std::uint32_t offset = 0;    ///< offset of this payload in the sample's payload
  bool last = true;
  std::span<const std::byte> payload;
};

/// Encodes header and payload of a segment. Precondition: payload of at most 32767 bytes.
std::vector<std::byte> opentrack_datagram(const OpenTrackSegment& segment);

/// Divides a payload into datagrams.
std::vector<std::vector<std::byte>> opentrack_datagrams(std::span<const std::byte> payload,
                                                        OpenTrackEncoding encoding,
                                                        std::uint16_t sequence);

}  // namespace mixrig::stream
