// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/room_update.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "hal/base/srgb.h"
#include "host/room/background/frame_views.h"

namespace mixrig::session {
namespace {

constexpr int kCropMargin_px = 3;
/// Surfaces within this of each other, or as many sigmas, are one.
constexpr double kSameSurface_m = 0.035, kSameSurfaceSigmas = 2.5;

/// Part of one face that shows a change, as fine as the face's colour.
struct Crop {
  std::size_t model = 0, face = 0;
  int x0 = 0, y0 = 0;  ///< of the face
  Size size;
  int factor = 1;
  WideView view;
  std::optional<WideFrame> drawn;
  std::optional<model::StaticBackgroundBuilder> builder;
};

/// Pixels of a face around the places; empty where it shows none.
void bound(std::span<const Eigen::Vector3d> places, const geometry::Pinhole& camera,
           const geometry::Pose& world_from_face, Crop& crop) {
  const geometry::Pose face_from_world = geometry::inverse(world_from_face);
  int x0 = camera.size_px.width, y0 = camera.size_px.height, x1 = 0, y1 = 0;
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3d p = face_from_world * place;
    if (!(p.z() > 0.05)) continue;
    const Eigen::Vector2d px = camera.project(p);
    if (!(px.x() > -0.5 && px.y() > -0.5 && px.x() < camera.size_px.width - 0.5 &&
          px.y() < camera.size_px.height - 0.5))
      continue;
    const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
    x0 = std::min(x0, x), y0 = std::min(y0, y), x1 = std::max(x1, x), y1 = std::max(y1, y);
  }
  if (x1 < x0 || y1 < y0) return;
  crop.x0 = std::max(0, x0 - kCropMargin_px), crop.y0 = std::max(0, y0 - kCropMargin_px);
  crop.size = {std::min(camera.size_px.width, x1 + kCropMargin_px + 1) - crop.x0,
               std::min(camera.size_px.height, y1 + kCropMargin_px + 1) - crop.y0};
}

geometry::Pinhole camera_of(const geometry::Pinhole& face, const Crop& crop) {
  const double f = crop.factor;
  return {{crop.size.width * crop.factor, crop.size.height * crop.factor},
          face.fx_px * f,
          face.fy_px * f,
          (face.cx_px - crop.x0 + 0.5) * f - 0.5,
          (face.cy_px - crop.y0 + 0.5) * f - 0.5};
}

void add_crops(const std::vector<render::BackgroundModel>& models,
               std::span<const Eigen::Vector3d> places, const render::CompositorSetup& setup,
               Crew& crew, std::deque<Crop>& crops) {
  for (std::size_t m = 0; m < models.size(); ++m)
    for (std::size_t f = 0; f < models[m].world_from_face.size(); ++f) {
      Crop crop;
      crop.model = m, crop.face = f, crop.factor = models[m].color_factor;
      bound(places, models[m].camera, models[m].world_from_face[f], crop);
      if (crop.size.empty()) continue;
      crop.view = {camera_of(models[m].camera, crop), models[m].world_from_face[f]};
      Crop& kept = crops.emplace_back(std::move(crop));
      kept.drawn.emplace(setup, kept.view, crew);
      kept.builder.emplace(kept.view.camera, 32, model::Views::kDifferent);
    }
}

Rgbf without_gain(const Rgbf& c, const Eigen::Array3d& factor) {
  const Eigen::Array3f f = factor.cast<float>();
  return {c.r / f.x(), c.g / f.y(), c.b / f.z()};
}

/// Writes what a crop learned into its model.
class Merge {
 public:
  Merge(const model::RoomWatch& watch, const render::BackgroundModel& model, const Crop& crop,
        const model::StaticBackground& learned, KeptBackground& background)
      : watch_(watch), model_(model), crop_(crop), learned_(learned), background_(background) {}
  void run() {
    for (int y = 0; y < crop_.size.height; ++y)
      for (int x = 0; x < crop_.size.width; ++x) pixel(x, y);
  }

 private:
  enum class Verdict { kKeep, kColor, kReplace, kForget };

  Eigen::Vector3d world(int x, int y, float z_m) const {
    const Eigen::Vector2d ray = model_.camera.unproject({crop_.x0 + x, crop_.y0 + y});
    return crop_.view.world_from_camera * (Eigen::Vector3d(ray.x(), ray.y(), 1) * double{z_m});
  }
  Verdict judge(int x, int y, float before_m, float now_m) const {
    using Kind = model::ChangeCells::Kind;
    const double z_m = double{std::max(before_m, now_m)};
    const double step_m =
        std::max(kSameSurface_m, kSameSurfaceSigmas * background_.setup.noise.sigma_m(z_m));
    const double nearer_m = double{before_m} - double{now_m};
    if (before_m > 0 && now_m > 0 && std::abs(nearer_m) <= step_m) return Verdict::kColor;
    if (now_m > 0 && (before_m <= 0 || nearer_m > 0) &&
        watch_.is_open(Kind::kSurface, world(x, y, now_m), 1))
      return Verdict::kReplace;
    if (!(before_m > 0)) return Verdict::kKeep;
    const Eigen::Vector3d was_m = world(x, y, before_m);
    if (now_m > before_m && watch_.is_open(Kind::kHole, was_m, 1)) return Verdict::kReplace;
    const bool forget = now_m <= 0 && watch_.is_open(Kind::kHole, was_m, 0);
    return forget ? Verdict::kForget : Verdict::kKeep;
  }
  void pixel(int x, int y) {
    const int row = static_cast<int>(crop_.face) * model_.camera.size_px.height + crop_.y0 + y;
    const int f = crop_.factor, fine_x = x * f + f / 2, fine_y = y * f + f / 2;
    const float before_m = model_.depth_m.row(row)[crop_.x0 + x];
    const Verdict verdict = judge(x, y, before_m, learned_.depth_m.row(fine_y)[fine_x]);
    if (verdict == Verdict::kKeep) return;
    if (verdict == Verdict::kForget)
      set_depth(background_, crop_.model, crop_.x0 + x, row, {});
    else if (verdict == Verdict::kReplace)
      set_depth(background_, crop_.model, crop_.x0 + x, row,
                {learned_.depth_m.row(fine_y)[fine_x], learned_.depth_sigma_m.row(fine_y)[fine_x]});
    colors(x, y, row, verdict);
  }
  void colors(int x, int y, int row, Verdict verdict) {
    const int f = crop_.factor;
    for (int j = 0; j < f; ++j)
      for (int i = 0; i < f; ++i) {
        KeptColor c;
        if (verdict != Verdict::kForget) {
          c = {learned_.color.row(y * f + j)[x * f + i],
               learned_.color_sigma.row(y * f + j)[x * f + i]};
          if (c.color.r >= 0) c.color = without_gain(c.color, watch_.light_factor());
        }
        if (verdict == Verdict::kColor && c.color.r < 0) continue;
        set_color(background_, crop_.model, (crop_.x0 + x) * f + i, row * f + j, c);
      }
  }

  const model::RoomWatch& watch_;
  const render::BackgroundModel& model_;
  const Crop& crop_;
  const model::StaticBackground& learned_;
  KeptBackground& background_;
};

/// Background learned from a crop; unknown where no frame saw it.
model::StaticBackground learned_of(Crop& crop) {
  if (auto learned = crop.builder->finish()) return std::move(*learned);
  model::StaticBackground none;
  const Size size = crop.view.camera.size_px;
  none.depth_m.reset(size), none.depth_sigma_m.reset(size), none.color_sigma.reset(size);
  none.color.reset(size, {-1, -1, -1});
  return none;
}

}  // namespace

Result<void> learn_changes(const model::RoomWatch& watch, std::span<const SeenFrame> frames,
                           const geometry::Pose& world_from_view, KeptBackground& background) {
  if (frames.size() < 3)
    return Error{ErrorCode::kData, "a change is learned from 3 frames or more"};
  std::vector<Eigen::Vector3d> places = watch.open_places(model::ChangeCells::Kind::kSurface);
  const auto holes = watch.open_places(model::ChangeCells::Kind::kHole);
  places.insert(places.end(), holes.begin(), holes.end());
  Crew crew(1);
  const std::vector<render::BackgroundModel> models = background.models(world_from_view);
  std::deque<Crop> crops;
  add_crops(models, places, background.setup, crew, crops);
  MIXRIG_ASSIGN(FrameViews views, FrameViews::make(background.setup, {render::Backend::kCpu, 1}));
  for (const SeenFrame& frame : frames) {
    MIXRIG_ASSIGN(const render::FrameOutput* const seen, views.of(*frame.capture));
    for (Crop& crop : crops) {
      crop.drawn->draw(background.setup.view, frame.world_from_target, seen->color,
                       seen->warped_depth_m);
      MIXRIG_TRY(crop.builder->add(crop.drawn->depth_m(), crop.drawn->color()));
    }
  }
  for (Crop& crop : crops) {
    crop.drawn.reset();
    const model::StaticBackground learned = learned_of(crop);
    Merge(watch, models[crop.model], crop, learned, background).run();
  }
  return {};
}

}  // namespace mixrig::session
