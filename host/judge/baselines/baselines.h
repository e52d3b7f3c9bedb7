// SPDX-License-Identifier: Apache-2.0
// Plain composites of a judged run and their errors, made outside the timed pass from the run's
// captures, its learned background and its virtual objects.
#pragma once

#include <memory>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/capture/capture.h"
#include "host/judge/baselines/judge.h"
#include "host/judge/measure/baselines.h"
#include "host/judge/measure/splat.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

struct BaselineErrors {
  measure::Baseline baseline;
  measure::Errors errors;
};

/// Composites each frame plainly and judges it. A cpu compositor of its own draws the virtual
/// objects, so that all composites of a run show the same objects; the rest shares nothing with the
/// compositor (host/judge/measure). Not movable: that compositor points into it.
class Baselines {
 public:
  Baselines() = default;
  Baselines(const Baselines&) = delete;
  Baselines& operator=(const Baselines&) = delete;

  /// `setup` has the background and must outlive this. Errors: kUsage without a learned background,
  /// or where the room is not shown; those of the back end.
  Result<void> open(const render::CompositorSetup& setup);
  /// Judges one frame. Errors: those of the back end and of Judge::add().
  Result<void> add(const capture::Capture& capture, const geometry::Pose& world_from_target,
                   bool objects_shown, const capture::Truth& truth);
  /// Errors so far, in the order of measure::kBaselines.
  std::vector<BaselineErrors> errors() const;

 private:
  struct PlatePlace {
    float x_px = -1, y_px = -1;  ///< negative where the lens has no pixel
  };
  void make_tables();
  Result<void> draw_objects(const render::FrameInput& input, bool objects_shown);
  void draw_plate(ImageView<const Rgb8> plate);
  void draw_depth(ImageView<const float> tof_depth_m);
  void draw_background(const geometry::Pose& world_from_target);

  const render::CompositorSetup* setup_ = nullptr;
  render::CompositorSetup objects_setup_;  ///< setup of the objects alone, over nothing
  std::unique_ptr<render::Compositor> compositor_;
  Image<PlatePlace> plate_px_;
  Image<measure::Ray> tof_rays_;
  std::vector<Image<measure::Ray>> background_rays_;  ///< one image for each background model
  Image<float> no_depth_m_;                           ///< unknown everywhere
  render::FrameOutput objects_;
  Image<Rgb8> plate_;
  Image<float> tof_z_m_, depth_m_, background_m_;
  measure::PlainComposite composite_;
  std::array<Judge, measure::kBaselines.size()> judges_;
};

}  // namespace mixrig::session
