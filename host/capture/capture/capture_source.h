// SPDX-License-Identifier: Apache-2.0
// Sources of captures: a recorded take, the virtual studio rendered on the fly, live devices.
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
  Size fisheye_px;                         ///< size of fisheye pictures; empty: unknown or none
  double fisheye_rate_hz = 0;              ///< 0: unknown or none
  geometry::Vignetting vignetting;         ///< the plate's; only a calibration file has it
  std::filesystem::path calibration;       ///< file that replaces the cameras, or empty
  std::filesystem::path file;              ///< take.toml or rig.toml; empty for the studio
  std::vector<std::string> camera_tables;  ///< tables of `file` with the cameras
  bool reported = false;  ///< the devices, or the recording that they play, report intrinsics
  bool has_lens_values = false;  ///< its captures have encoder values of the lens
  /// The target camera's lens by its encoders, if it is calibrated: each capture then has the lens
  /// in force.
  std::shared_ptr<const geometry::LensTable> lens;
  bool has_poses = false;
  bool moves = false;  ///< its poses change
  bool has_truth = false;
  bool true_poses = false;  ///< its poses are the truth
};

/// Angles and angular rates of a pan-tilt head at one time.
struct HeadMotion {
  device::PanTiltAngles angles;
  device::PanTiltAngles rate_rad_s;
  double swing_rad = 0;  ///< swing of the pan axis, not seen by its encoder
};

/// The pan-tilt head of a source that renders its captures for the head's angles. Only the reading
/// thread calls it.
class RenderedHead {
 public:
  virtual ~RenderedHead() = default;
  virtual device::PanTiltInfo limits() const = 0;  ///< without its URI
  /// Sets the head's motion at mid-exposure of the captures read from now on.
  virtual void turn(const HeadMotion& motion) = 0;
};

/// The exposure control of a source that renders its captures. Only the reading thread calls it.
class RenderedExposure {
 public:
  virtual ~RenderedExposure() = default;
  virtual ExposureLimits limits() const = 0;
  virtual double rest_s() const = 0;  ///< exposure before the first call of set()
  /// Sets the exposure, within limits(). It takes effect some captures later.
  virtual void set(double exposure_s) = 0;
};

struct RenderedRig {
  RenderedHead* head = nullptr;          ///< null: no head to move
  RenderedExposure* exposure = nullptr;  ///< null: exposure cannot be set
};

/// Forms in which captures of live devices hold their plates, if the camera shares its memory
/// (device::Frame::memory). Other plates are always decoded.
struct PlateForms {
  bool shared = false;  ///< in Capture::picture
  bool decoded = true;  ///< in Capture::plate; false: only if `shared` is impossible
  bool operator==(const PlateForms&) const = default;
};

/// A source of captures, numbered 1..info().frames. Calls come from one thread at a time.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;
  virtual const SourceInfo& info() const = 0;
  /// Reads and decodes capture `number`; live devices give the next one, whatever the number.
  /// Returns false when the source has ended, and nothing was read. Errors: kData for anything
  /// wrong with the capture; kDevice.
  virtual Result<bool> read(int number, Capture& capture) = 0;
  /// Reads the truth of capture `number`. Call it after read() of the same number, and only if
  /// info().has_truth. Errors: those of read().
  virtual Result<void> read_truth(int number, Truth& truth) = 0;
  /// Sets the forms of plates, from one of the next captures on. Any thread.
  virtual void share_plates(PlateForms) {}
  /// Returns the controls of a source that renders its captures.
  virtual RenderedRig rendered() { return {}; }
  /// Returns the counts of live devices; empty for other sources. Any thread.
  virtual std::optional<SourceReport> report() const { return std::nullopt; }
};

}  // namespace mixrig::capture
