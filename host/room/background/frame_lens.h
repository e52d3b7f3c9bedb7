// SPDX-License-Identifier: Apache-2.0
// The lens of each frame of a lens that zooms: as the compositor takes it, and what there is to say
// about it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/capture/capture/capture.h"
#include "host/render/contract/compositor.h"
#include "host/room/background/static_background.h"

namespace mixrig::session {

/// None where the lens of the setup holds.
std::optional<geometry::LensState> frame_lens(const capture::Capture& capture);
/// The view that a frame is composited in.
geometry::Pinhole frame_view(const render::CompositorSetup& setup, const capture::Capture& capture);
/// Pose of the centre of projection, for a pose of the target camera's frame.
geometry::Pose world_from_pupil(const geometry::Pose& world_from_target,
                                const capture::Capture& capture);

/// Frames of a lens that zooms.
struct LensReport {
  std::array<std::uint64_t, capture::kLensOrigins> frames{};  ///< by LensOrigin
  std::uint64_t changed = 0;               ///< frames whose lens is not that of the frame before
  std::uint64_t beyond_background = 0;     ///< whose view shows more than was learned of the room
  double least_fx_px = 0, most_fx_px = 0;  ///< of the lens
};

/// Counts the lenses of the frames, and warns once of each thing that is wrong. Nothing allocates
/// but for warnings. One thread.
class LensWatch {
 public:
  /// `learned`: the one view that people are keyed against; null where the room was scanned, or
  /// nothing was learned. It must outlive this.
  LensWatch(const render::CompositorSetup& setup, const model::StaticBackground* learned)
      : setup_(setup), learned_(learned) {}
  void add(const capture::Capture& capture, const geometry::Pose& world_from_target);
  /// None where the lens is that of the setup in all frames.
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
