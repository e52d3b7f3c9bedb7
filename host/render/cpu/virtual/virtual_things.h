// SPDX-License-Identifier: Apache-2.0
// Virtual objects from frame to frame: their pixels, what they and people hide of the lamps, the
// light that is left, and the camera's look. What depends on the pose alone stays while it does.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/light/light.h"
#include "host/render/cpu/mix/look.h"
#include "host/render/cpu/stop_watch.h"
#include "host/render/frame/frame_motion.h"
#include "host/render/frame/used_look.h"

namespace mixrig::render::cpu {

/// Memory of one compositor whose setup has objects; not thread-safe. Allocates in the first frames
/// only.
class VirtualThings {
 public:
  /// Borrows all four. `background`: of the setup, or drawn for each pose.
  VirtualThings(const CompositorSetup& setup, const BackgroundView& background,
                const Tables& tables, const FrameParams& frame, int threads);

  /// Takes the look of this frame, also where that does not show the objects.
  void take_look(const FrameInput& input);
  /// Draws and shades the objects, shadow maps and the background's light, where the pose has
  /// changed; grain moves in each frame. `moving`: of a camera that moves, else null.
  void draw(Crew& crew, MovingBackground* moving, StopWatch& watch);
  /// Light of what the plate shows, and people's shadows on the objects. After key.
  void light_real(Crew& crew, MovingBackground* moving, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte);
  /// Blurs by the lens, then by the camera's motion.
  void blur(Crew& crew, const std::optional<CameraMotion>& motion);

  /// As they are mixed in this frame. After blur().
  const VirtualLayer& mixed() const { return *mixed_; }
  const GrainOf* grain() const { return grain_.any() ? &grain_ : nullptr; }
  /// Null where objects take light from nothing.
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
  bool drawn_ = false;  ///< since they were blurred
  BlurScratch blurred_;
  VirtualLayer moved_;  ///< where the look has motion: blurred by it
  const VirtualLayer* mixed_ = &objects_;
  GrainOf grain_;
  std::uint32_t frames_ = 0;
};

}  // namespace mixrig::render::cpu
