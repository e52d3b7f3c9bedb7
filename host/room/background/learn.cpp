// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/learn.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/order_statistics.h"
#include "host/capture/capture/capture_reader.h"
#include "host/room/background/flat_holes.h"
#include "host/room/background/frame_lens.h"
#include "host/room/background/frame_views.h"

namespace mixrig::session {
namespace {

/// Half of the field of view of a wide view has at most this tangent.
constexpr double kMostTan = 2.2;
constexpr int kMostSide_px = 8192;
/// Metres: no surface is nearer; bounds what a shift of the camera uncovers at the borders.
constexpr double kNearSurface_m = 1.5;

/// The frames of a range in order; how many were read stands in the error where the source ends.
class Frames {
 public:
  Frames(capture::CaptureSource& source, FrameRange range)
      : range_(range),
        // A live source may drop captures: it is read until enough were learned.
        reader_(source, range.first, source.info().is_live() ? capture::kEndless : range.second,
                false),
        number_(range.first) {}
  /// Null after the last.
  Result<capture::CapturePtr> next() {
    if (number_ > range_.second) return capture::CapturePtr();
    MIXRIG_ASSIGN(auto item, reader_.next());
    while (item && item->capture->depth_m.empty()) {  // the depth camera is lost for a while
      MIXRIG_ASSIGN(item, reader_.next());
    }
    if (!item)
      return Error{ErrorCode::kData,
                   fmt::format("the source ended or was stopped after {} of {} frames of the empty "
                               "room: nothing was learned",
                               number_ - range_.first, range_.second - range_.first + 1)};
    ++number_;
    return std::move(item->capture);
  }
  int done() const { return number_ - range_.first; }
  int total() const { return range_.second - range_.first + 1; }

 private:
  const FrameRange range_;
  capture::CaptureReader reader_;
  int number_;
};

/// The view of a frame; nullopt where its pose is not known. Without `poses` the camera stands
/// still at the origin.
std::optional<PosedView> posed_view(const render::CompositorSetup& setup,
                                    const capture::Capture& capture, capture::PoseSource* poses) {
  PosedView view{frame_view(setup, capture), {}};
  if (poses != nullptr) {
    const capture::CameraPose pose = poses->pose_of(capture);
    if (!pose.ok()) return std::nullopt;
    view.world_from_camera = pose.world_from_target;
  }
  view.world_from_camera = world_from_pupil(view.world_from_camera, capture);
  return view;
}

/// Says where people or things were in the frames, and what that cost.
void tell(const model::StaticBackground& background) {
  constexpr double kTold = 0.02;  // an empty room has 1 % at borders of depth
  if (background.covered_share < kTold && background.unseen_share < kTold) return;
  log_warning("room",
              fmt::format("people or things that come and go cover {:.1f} % of the picture in the "
                          "frames to learn from: they are left out; in {:.1f} % the room was never "
                          "seen: give more frames, or frames of the empty room",
                          100 * background.covered_share, 100 * background.unseen_share));
}

/// Says where depth varies otherwise from frame to frame than its noise is stated or assumed. The
/// warp takes the mean of neighbours, so a third is nothing to tell.
void tell_noise(const model::StaticBackground& background, const geometry::DepthNoise& stated) {
  constexpr int kStep = 4;
  constexpr float kMost = 3, kLeast = 0.1F;
  constexpr double kStill_m = 3e-4;  // depth that is drawn, or whose steps hide its noise
  std::vector<float> ratios, depths_m;
  for (int y = 0; y < background.depth_m.height(); y += kStep)
    for (int x = 0; x < background.depth_m.width(); x += kStep)
      if (const float z_m = background.depth_m.row(y)[x]; z_m > 0) {
        ratios.push_back(background.depth_sigma_m.row(y)[x] /
                         static_cast<float>(stated.sigma_m(z_m)));
        depths_m.push_back(z_m);
      }
  if (ratios.empty()) return;
  const float ratio = upper_median_in_place(std::span(ratios));
  const float z_m = upper_median_in_place(std::span(depths_m));
  log_info("room", fmt::format("depth noise: {:.2f} times what is stated", ratio));
  const double stated_m = stated.sigma_m(z_m);
  const bool varies = ratio * stated_m > kStill_m;
  if (!varies || (ratio <= kMost && ratio >= kLeast)) return;
  log_warning("room",
              fmt::format("at {:.1f} m depth varies by {:.1f} mm from frame to frame, and "
                          "depth.noise, stated or by default, is {:.1f} mm: people are "
                          "keyed by that: measure it by mixrig info --depth, and correct it",
                          z_m, 1e3 * ratio * stated_m, 1e3 * stated_m));
}

/// Reads the same frames again, and draws each in one wide view.
Result<model::StaticBackground> learn_moving(capture::CaptureSource& source,
                                             const render::CompositorSetup& setup, FrameRange range,
                                             BackendChoice backend, const ProgressFn& progress,
                                             capture::PoseSource* poses,
                                             std::span<const PosedView> known) {
  MIXRIG_ASSIGN(const WideView wide, view_of_all(known));
  model::StaticBackgroundBuilder builder(wide.camera, 32, model::Views::kDifferent);
  {  // the memory of what draws is given back before the background is found
    MIXRIG_ASSIGN(FrameViews views, FrameViews::make(setup, backend));
    Crew crew;
    WideFrame drawn(setup, wide, crew);
    Frames frames(source, range);
    for (;;) {
      MIXRIG_ASSIGN(const capture::CapturePtr capture, frames.next());
      if (!capture) break;
      const std::optional<PosedView> view = posed_view(setup, *capture, poses);
      if (!view) continue;
      MIXRIG_ASSIGN(const render::FrameOutput* const seen, views.of(*capture));
      drawn.draw(view->camera, view->world_from_camera, seen->color,
                 model::with_flat_holes(seen->warped_depth_m, view->camera));
      MIXRIG_TRY(builder.add(drawn.depth_m(), drawn.color()));
      if (progress) progress("background, as the camera moves", frames.done(), frames.total());
    }
  }
  MIXRIG_ASSIGN(model::StaticBackground background, builder.finish());
  tell(background);
  background.world_from_view = wide.world_from_camera;
  return background;
}

}  // namespace

Result<void> check_empty_frames(const capture::SourceInfo& info, FrameRange range) {
  const auto [first, last] = range;
  if (first >= 1 && first <= last && last <= info.frames) return {};
  return Error{ErrorCode::kFormat,
               fmt::format("frames {}-{} are not in the take, which has 1-{}: give frames of the "
                           "empty room",
                           first, last, info.frames)};
}

Result<WideView> view_of_all(std::span<const PosedView> views) {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), ahead = position_m, down = position_m;
  geometry::Pinhole finest = views.front().camera;
  for (const PosedView& view : views) {
    const geometry::Pose& pose = view.world_from_camera;
    position_m += pose.translation_m / static_cast<double>(views.size());
    ahead += pose.rotation * Eigen::Vector3d::UnitZ();
    down += pose.rotation * Eigen::Vector3d::UnitY();
    if (view.camera.fx_px > finest.fx_px) finest = view.camera;
  }
  const Error too_wide{ErrorCode::kData,
                       "the camera turns too far for one view while the empty room is learned: "
                       "learn from frames that turn less"};
  if (!(ahead.norm() > 1e-3 && down.cross(ahead).norm() > 1e-3)) return too_wide;
  WideView wide;
  wide.world_from_camera = geometry::look_at(position_m, position_m + ahead, -down);
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  for (const PosedView& view : views) {
    const geometry::Pose wide_from =
        geometry::inverse(wide.world_from_camera) * view.world_from_camera;
    const int w = view.camera.size_px.width, h = view.camera.size_px.height;
    for (int i = 0; i < 9; ++i) {
      const double u = (i % 3) * 0.5 * w - 0.5, v = (i / 3) * 0.5 * h - 0.5;
      const Eigen::Vector2d ray = view.camera.unproject({u, v});
      for (const double z_m : {kNearSurface_m, 1e3}) {
        const Eigen::Vector3d p = wide_from * (Eigen::Vector3d(ray.x(), ray.y(), 1) * z_m);
        if (!(p.z() > 0)) return too_wide;
        x0 = std::min(x0, p.x() / p.z()), x1 = std::max(x1, p.x() / p.z());
        y0 = std::min(y0, p.y() / p.z()), y1 = std::max(y1, p.y() / p.z());
      }
    }
  }
  if (std::max({-x0, x1, -y0, y1}) > kMostTan) return too_wide;
  const auto pixels = [](double low, double high, double f_px) {
    return std::clamp(static_cast<int>(std::ceil((high - low) * f_px)) + 1, 1, kMostSide_px);
  };
  wide.camera = {{pixels(x0, x1, finest.fx_px), pixels(y0, y1, finest.fy_px)},
                 finest.fx_px,
                 finest.fy_px,
                 -x0 * finest.fx_px,
                 -y0 * finest.fy_px};
  return wide;
}

Result<model::StaticBackground> learn_background(capture::CaptureSource& source,
                                                 const render::CompositorSetup& setup,
                                                 FrameRange range, BackendChoice backend,
                                                 const ProgressFn& progress,
                                                 capture::PoseSource* poses) {
  MIXRIG_TRY(check_empty_frames(source.info(), range));
  std::optional<model::StaticBackgroundBuilder> builder;
  std::vector<PosedView> known;
  bool moves = false;
  {  // the compositor's memory is given back before the background is found
    MIXRIG_ASSIGN(FrameViews views, FrameViews::make(setup, backend));
    Frames frames(source, range);
    for (;;) {
      MIXRIG_ASSIGN(const capture::CapturePtr capture, frames.next());
      if (!capture) break;
      if (const auto view = posed_view(setup, *capture, poses)) {
        known.push_back(*view);
        moves |= capture::moved(known.front().world_from_camera, view->world_from_camera) ||
                 !(known.front().camera == view->camera);
      }
      if (!moves) {
        MIXRIG_ASSIGN(const render::FrameOutput* const seen, views.of(*capture));
        if (!builder) builder.emplace(frame_view(setup, *capture));
        MIXRIG_TRY(builder->add(seen->warped_depth_m, seen->color));
      }
      if (progress) progress("background", frames.done(), frames.total());
    }
  }
  if (!moves) {
    if (!builder) builder.emplace(setup.view);
    MIXRIG_ASSIGN(model::StaticBackground background, builder->finish());
    tell(background);
    tell_noise(background, setup.noise);
    if (!known.empty() && (poses != nullptr || setup.lens_moves))
      background.world_from_view = known.front().world_from_camera;
    return background;
  }
  if (source.info().is_live())
    return Error{ErrorCode::kData,
                 "the camera or its lens moved while the empty room was learned: keep it still "
                 "until the frames to composite, or use a scanned background"};
  return learn_moving(source, setup, range, backend, progress, poses, known);
}

}  // namespace mixrig::session
