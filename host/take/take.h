// SPDX-License-Identifier: Apache-2.0
// Takes: recordings of a rig with their calibration. docs/formats.md describes take.toml.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/geometry/camera_model.h"
#include "host/geometry/pose.h"

namespace mixrig::take {

/// What a depth value means: along the optical axis, or along the ray.
enum class DepthKind { kZ, kDistance };

/// One stream as the manifest tells it. `path` holds one %d conversion (numbered pictures) or
/// names a Matroska file.
struct StreamInfo {
  std::string path;
  int first = 1;  ///< number in the first file's name
  int count = 0;
  double rate_hz = 0;  ///< 0 where unknown
  bool operator==(const StreamInfo&) const = default;
};

/// Standard deviation of a depth value at z: floor + linear z + quadratic z^2, metres.
struct DepthNoise {
  double floor_m = 0.005, linear = 0.002, quadratic_per_m = 0.001;
  double sigma_m(double z_m) const { return floor_m + z_m * (linear + z_m * quadratic_per_m); }
};

struct TakeInfo {
  std::filesystem::path path;  ///< folder or manifest that was opened
  std::filesystem::path root;  ///< folder that stream paths start at
  std::filesystem::path calibration;  ///< calibration.yaml in place of the cameras below, or empty
  std::string name;
  StreamInfo color, depth;
  std::optional<StreamInfo> amplitude;
  geometry::CameraModel target, tof;
  std::optional<geometry::Pinhole> view;  ///< ideal view of truth and compositing, where given
  geometry::Pose target_from_tof;
  DepthKind depth_kind = DepthKind::kZ;
  double depth_unit_m = 0.001;
  int depth_unknown = 0;
  DepthNoise noise;
  bool has_poses = false;
  bool has_truth = false;
  double truth_depth_unit_m = 0.00025;
  int frames = 0;  ///< colour frames that have a depth partner
};

/// One moment: colour, the depth that belongs to it, and where the camera was.
struct TakeFrame {
  int number = 0;  ///< 1-based
  double time_s = 0;
  Image<Rgb8> color;
  Image<float> depth_m;    ///< as the sensor gives it (DepthKind), 0 = unknown
  Image<float> amplitude;  ///< empty where the take has none
  geometry::Pose world_from_target;
};

/// What really was there, in the ideal view (studio takes). Bits of `labels`:
struct TruthFrame {
  static constexpr std::uint8_t kLayerMask =
      3;                                       ///< visible layer: 0 background, 1 person, 2 virtual
  static constexpr std::uint8_t kTofSees = 4;  ///< the ToF camera sees the real surface
  static constexpr std::uint8_t kVirtual =
      8;                      ///< inside the virtual objects' silhouette, occluded or not
  Image<float> depth_m;       ///< of the real scene
  Image<std::uint8_t> matte;  ///< coverage by people, 255 = all
  Image<float> light;         ///< light with / light without virtual objects
  Image<Rgb8> composite;
  Image<std::uint8_t> labels;
};

/// Reads a take folder, a take.toml, or a TUM RGB-D folder. Not thread-safe.
class TakeReader {
 public:
  /// Errors: kNotFound, kFormat (file:line: key ...), kData (calibration, sizes, no frames).
  static Result<TakeReader> open(const std::filesystem::path& path);
  TakeReader(TakeReader&&) noexcept;
  TakeReader& operator=(TakeReader&&) noexcept;
  ~TakeReader();

  const TakeInfo& info() const;
  /// Reads frame `number` (1..frames), reusing the memory of `frame`.
  /// Errors: kNotFound, kFormat, kData; the line names the file.
  Result<void> read(int number, TakeFrame& frame);
  /// Reads the truth of frame `number`. Errors as read; kNotFound where the take has none.
  Result<void> read_truth(int number, TruthFrame& truth);

 private:
  struct State;
  explicit TakeReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

enum class StreamFormat { kPng, kMatroska };

/// Writes a take folder. Everything lands in OUT.partial, which finish() renames to OUT;
/// a writer that is dropped unfinished leaves nothing. Not thread-safe.
class TakeWriter {
 public:
  /// `info` gives cameras, rig, depth units and rates; counts and paths are set by the writer; the
  /// file of info.calibration is copied into the take.
  /// Errors: kUsage where `folder` exists and is not a take, kIo, kNotFound.
  static Result<TakeWriter> create(const std::filesystem::path& folder, const TakeInfo& info,
                                   StreamFormat format);
  TakeWriter(TakeWriter&&) noexcept;
  TakeWriter& operator=(TakeWriter&&) noexcept;
  ~TakeWriter();

  Result<void> write(const TakeFrame& frame);
  Result<void> write_truth(const TruthFrame& truth);  ///< after write() of the same frame
  /// Folder to put further files in (scene.toml, models) before finish().
  const std::filesystem::path& staging() const;
  Result<void> finish();

 private:
  struct State;
  explicit TakeWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::take
