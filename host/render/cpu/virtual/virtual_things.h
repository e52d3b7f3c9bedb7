// SPDX-License-Identifier: Apache-2.0
// Virtual objects over time: their pixels, shadows of objects and people, shading, and the camera's
// look. Results that depend on the pose alone are kept while it stays.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/light/light.h"
#include "host/render/cpu/mix/look.h"
#include "host/render/cpu/stop_watch.h"
#include "host/render/frame/frame_motion.h"
#include "host/render/frame/look_filter.h"
#include "host/render/frame/used_look.h"

namespace mixrig::render::cpu {

/// Used by one compositor whose setup has objects; not thread-safe. Allocates in the first frames
/// only.
class VirtualThings {
 public:
  /// Borrows the first four. `background`: that of the setup, or the one drawn for each pose.
  VirtualThings(const CompositorSetup& setup, const BackgroundView& background,
                const Tables& tables, const FrameParams& frame, int threads);

  /// Takes the look of this frame, even if the frame does not show the objects.
  void take_look(const FrameInput& input);
  /// Draws and shades objects, shadow maps and the background's light if the pose has changed;
  /// moves the grain in each frame. `moving`: null unless the camera moves.
  void draw(Crew& crew, MovingBackground* moving, StopWatch& watch);
  /// Computes the light of what the plate shows, and people's shadows on the objects. Call it after
  /// pass key.
  void light_real(Crew& crew, MovingBackground* moving, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte);
  /// Blurs the objects by the lens, then by the camera's motion.
  void blur(Crew& crew, const std::optional<CameraMotion>& motion);

  /// The layer that this frame mixes. Call it after blur().
  const VirtualLayer& mixed() const { return *mixed_; }
  const GrainOf* grain() const { return grain_.any() ? &grain_ : nullptr; }
  /// Null if no object takes light from other surfaces.
  const LightLayer* light() const { return has_shadows(frame_) ? &light_ : nullptr; }

 private:
  bool people_cast() const { return !frame_.people_lamps.empty(); }
  LightInput light_input(MovingBackground* moving, const PeopleShadow* people) const;

  const CompositorSetup& setup_;
  const BackgroundView& background_;
  const Tables& tables_;
  const FrameParams& frame_;
  VirtualScratch scratch_;
  VirtualLayer objects_;
  std::vector<ShadowMap> shadow_maps_;
  LightLayer light_;
  PeopleShadow people_shadow_;
  UsedLook look_;
  std::optional<LookFilter> look_filter_;
  bool drawn_ = false;  ///< since they were last blurred
  BlurScratch blurred_;
  VirtualLayer moved_;  ///< blurred by motion, if the look has motion
  const VirtualLayer* mixed_ = &objects_;
  GrainOf grain_;
  std::uint32_t frames_ = 0;
};

}  // namespace mixrig::render::cpu
