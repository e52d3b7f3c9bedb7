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
  std::int64_t time_ns = 0;  ///< of mid-exposure, since 1970
  /// Of the clock that the time is of.
  struct Synchronization {
    enum class Source : std::uint8_t { kPtp, kNtp } source = Source::kPtp;
    bool locked = false;
  };
  std::optional<Synchronization> synchronization;
  std::string status;                  ///< of the tracker, such as "ok" or why there is no pose
  std::optional<CameraAngles> angles;  ///< none: the pose is not known
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double focal_length_mm = 0;                           ///< of a pinhole
  Eigen::Vector2d offset_mm = Eigen::Vector2d::Zero();  ///< of the principal point, right and down
  std::optional<double> zoom, focus;                    ///< raw values of the lens's encoders
  /// Of the sensor; sent now and then.
  struct Sensor {
    double width_mm = 0, height_mm = 0;
    int width_px = 0, height_px = 0;
  };
  std::optional<Sensor> sensor;
};

/// The sample's payload.
std::vector<std::byte> opentrack_payload(const OpenTrackSample& sample, OpenTrackEncoding encoding);

/// One datagram.
struct OpenTrackSegment {
  OpenTrackEncoding encoding = OpenTrackEncoding::kJson;
  std::uint16_t sequence = 0;  ///< of the sample that it is a part of
  std::uint32_t offset = 0;    ///< of its payload in the sample's
  bool last = true;
  std::span<const std::byte> payload;
};

/// The header and payload of a segment. Precondition: payload of at most 32767 bytes.
std::vector<std::byte> opentrack_datagram(const OpenTrackSegment& segment);

/// A payload cut into datagrams.
std::vector<std::vector<std::byte>> opentrack_datagrams(std::span<const std::byte> payload,
                                                        OpenTrackEncoding encoding,
                                                        std::uint16_t sequence);

}  // namespace mixrig::stream
