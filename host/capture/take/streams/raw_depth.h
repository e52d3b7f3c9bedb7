// SPDX-License-Identifier: Apache-2.0
// Depth that is decoded from a sensor's raw pictures (docs/reference/take.md). Private to this
// module.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/wire/camera/kinect2_raw.h"
#include "host/capture/depth/phase_decoder.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

inline constexpr const char* kRawKinect2 = "kinect2";
inline constexpr const char* kRawPattern = "raw/%06d.bin";
/// Tables of the device, in the folder of the frames.
inline constexpr const char* kRawOffsets = "phase_offsets.bin";
inline constexpr const char* kRawInfrared = "infrared.bin";

/// Reads frames one by one. Not thread-safe.
class RawDepth {
 public:
  /// Opens the stream. Errors: kNotFound, kIo; kData for tables that are not the device's.
  static Result<RawDepth> open(const std::filesystem::path& root, const StreamInfo& stream);

  std::string name(int index) const { return path_of_(index).string(); }
  /// Reads distances along the ray, 0 where a pixel is not good, and amplitudes. Errors: those of
  /// reading the file; kData unless it holds one whole frame.
  Result<void> read(int index, Image<float>& distance_m, Image<float>& amplitude);

 private:
  explicit RawDepth(const depth::PhaseCamera& camera)
      : decoder_(std::make_unique<depth::PhaseDecoder>(camera)) {}
  std::function<std::filesystem::path(int)> path_of_;
  device::Kinect2DepthStream packets_;
  std::unique_ptr<depth::PhaseDecoder> decoder_;
  depth::PhaseDepth decoded_;
};

}  // namespace mixrig::take
