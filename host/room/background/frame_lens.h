// SPDX-License-Identifier: Apache-2.0
// The lens of each frame of a zooming lens, for the compositor and for the report.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/capture/capture/capture.h"
#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"

namespace mixrig::session {

/// Lens of a frame; nullopt where the setup's lens holds.
std::optional<geometry::LensState> frame_lens(const capture::Capture& capture);
/// The view in which a frame is composited.
geometry::Pinhole frame_view(const render::CompositorSetup& setup, const capture::Capture& capture);
/// Pose of the centre of projection for a pose of the target camera's frame.
geometry::Pose world_from_pupil(const geometry::Pose& world_from_target,
                                const capture::Capture& capture);

/// Counts frames of a zooming lens.
struct LensReport {
  std::array<std::uint64_t, capture::kLensOrigins> frames{};  ///< by LensOrigin
  std::uint64_t changed = 0;            ///< frames whose lens differs from that of the frame before
  std::uint64_t beyond_background = 0;  ///< frames whose view shows more than was learned
  double least_fx_px = 0, most_fx_px = 0;  ///< range of the focal length over all frames
};

/// Counts the lenses of frames, and warns once of each problem. Only warnings allocate. For one
/// thread.
class LensWatch {
 public:
  /// `learned`: the single view that people are keyed against; null if the room was scanned or
  /// nothing was learned. It must outlive this object.
  LensWatch(const render::CompositorSetup& setup, const model::StaticBackground* learned)
      : setup_(setup), learned_(learned) {}
  void add(const capture::Capture& capture, const geometry::Pose& world_from_target);
  /// Nullopt if all frames have the setup's lens.
  const std::optional<LensReport>& report() const { return report_; }

 private:
  bool beyond(const capture::Capture& capture, const geometry::Pose& world_from_target) const;
  void warn(capture::LensOrigin origin, const capture::Capture& capture);

  const render::CompositorSetup& setup_;
  const model::StaticBackground* const learned_;
  std::optional<LensReport> report_;
  std::optional<geometry::Pinhole> last_;
  std::array<bool, capture::kLensOrigins> warned_{};
};

}  // namespace mixrig::session
