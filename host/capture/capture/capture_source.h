// SPDX-License-Identifier: Apache-2.0
// Where captures come from: a recorded take, the virtual studio rendered on the fly, live devices.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/capture/bracket.h"
#include "host/capture/capture/capture.h"
#include "host/capture/capture/source_report.h"
#include "host/capture/capture/truth.h"
#include "host/math/geometry/vignetting.h"

namespace mixrig::capture {

/// Number of captures of a source that ends when its devices do.
inline constexpr int kEndless = std::numeric_limits<int>::max();

struct SourceInfo : RigCameras {
  std::string name;
  double rate_hz = 0;               ///< of the plate; 0 where unknown
  double exposure_s = 0;            ///< of the plate; 0 where unknown
  double depth_unit_m = 0.001;      ///< one step of 16-bit depth
  double depth_offset_m = 0;        ///< depth of step 0 of 16-bit depth; captures contain it
  bool amplitude_is_light = false;  ///< amplitudes fall with the square of the distance: they are
                                    ///< those of the light that comes back, not a confidence
  int frames = 0;                   ///< kEndless for live devices
  bool is_live() const { return frames == kEndless; }
  Size fisheye_px;                    ///< of its fisheye's pictures; empty where unknown or none
  double fisheye_rate_hz = 0;         ///< of them; 0 where unknown or none
  geometry::Vignetting vignetting;    ///< of the plate; only a calibration file has it
  std::filesystem::path calibration;  ///< file that replaces the cameras, or empty
  std::filesystem::path file;         ///< take.toml or rig.toml; empty for the studio
  std::vector<std::string> camera_tables;  ///< tables of `file` with the cameras
  bool reported = false;  ///< the devices, or the recording that they play, report intrinsics
  bool has_lens_values = false;  ///< its captures have the values of the lens's encoders
  /// The target camera's lens by its encoders: each capture has the lens in force.
  std::shared_ptr<const geometry::LensTable> lens;
  bool has_poses = false;
  bool moves = false;  ///< its poses differ
  bool has_truth = false;
  bool true_poses = false;  ///< its poses are the true ones
};

/// How a head stands and turns at one time.
struct HeadMotion {
  device::PanTiltAngles angles;
  device::PanTiltAngles rate_rad_s;
  double swing_rad = 0;  ///< of the pan axis, not seen by its encoder
};

/// The head of a source whose captures are rendered as it stands. Calls come from the thread that
/// reads.
class RenderedHead {
 public:
  virtual ~RenderedHead() = default;
  virtual device::PanTiltInfo limits() const = 0;  ///< without its URI
  /// At mid-exposure of the captures that are read from now on.
  virtual void turn(const HeadMotion& motion) = 0;
};

/// The exposure of the plates of a source whose captures are rendered. Calls come from the thread
/// that reads.
class RenderedExposure {
 public:
  virtual ~RenderedExposure() = default;
  virtual ExposureLimits limits() const = 0;
  virtual double rest_s() const = 0;  ///< before the first call of set()
  /// Within limits(); of captures that are read some calls later.
  virtual void set(double exposure_s) = 0;
};

struct RenderedRig {
  RenderedHead* head = nullptr;          ///< null: no head can be moved
  RenderedExposure* exposure = nullptr;  ///< null: it cannot be set
};

/// In which forms captures of live devices have their plates, where the camera shares its memory
/// (device::Frame::memory); of others they are decoded.
struct PlateForms {
  bool shared = false;  ///< as Capture::picture
  bool decoded = true;  ///< as Capture::plate; false: only where `shared` cannot be
  bool operator==(const PlateForms&) const = default;
};

/// Captures by number, 1..info().frames. Calls come from one thread at a time.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;
  virtual const SourceInfo& info() const = 0;
  /// Reads and decodes capture `number`; live devices give the next one, whatever the number.
  /// False when the source has ended: nothing was read.
  /// Errors: kData for anything wrong with the capture; kDevice.
  virtual Result<bool> read(int number, Capture& capture) = 0;
  /// Call after read() of the same number, and only where info().has_truth. Errors as read.
  virtual Result<void> read_truth(int number, Truth& truth) = 0;
  /// From one of the next captures on. Any thread.
  virtual void share_plates(PlateForms) {}
  /// What of the rig can be moved and set where the captures are rendered.
  virtual RenderedRig rendered() { return {}; }
  /// Counts of live devices; empty for other sources. Any thread.
  virtual std::optional<SourceReport> report() const { return std::nullopt; }
};

}  // namespace mixrig::capture
