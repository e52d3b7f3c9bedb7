// SPDX-License-Identifier: Apache-2.0
#include "host/judge/baselines/baselines.h"

#include <cmath>

#include "host/render/cpu/compositor_cpu.h"

namespace mixrig::session {
namespace {

measure::IdealView view_of(const geometry::Pinhole& view) {
  return {view.fx_px, view.fy_px, view.cx_px, view.cy_px};
}

measure::Motion motion_of(const geometry::Pose& pose) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = pose.translation_m;
  return {{r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)},
          {t.x(), t.y(), t.z()}};
}

/// Rays of all pixels of a camera; NaN where it has none.
template <typename Camera>
Image<measure::Ray> rays_of(const Camera& camera, Size size) {
  Image<measure::Ray> rays(size, {NAN, NAN});
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (const std::optional<Eigen::Vector2d> ray = camera.unproject(Eigen::Vector2d(x, y)))
        rays.row(y)[x] = {static_cast<float>(ray->x()), static_cast<float>(ray->y())};
  return rays;
}

std::uint8_t mean(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d, float tx,
                  float ty) {
  const float top = (1 - tx) * a + tx * b, bottom = (1 - tx) * c + tx * d;
  return static_cast<std::uint8_t>(std::lround((1 - ty) * top + ty * bottom));
}

/// Errors of colour of the ideal composite; all else of it is the truth itself.
measure::Errors colors_of(const measure::Errors& errors) {
  measure::Errors out;
  out.color_psnr_db = errors.color_psnr_db;
  out.contested.pixels_pct = errors.contested.pixels_pct;
  out.contested.color_psnr_db = errors.contested.color_psnr_db;
  return out;
}

}  // namespace

Result<void> Baselines::open(const render::CompositorSetup& setup) {
  if (setup.backdrop || (setup.background.depth_m.empty() && setup.background_models.empty()))
    return Error{ErrorCode::kUsage,
                 "baselines need a scene that learns its background and shows the room: use one, "
                 "or leave out --baselines"};
  setup_ = &setup;
  objects_setup_ = setup;
  objects_setup_.background = {};
  objects_setup_.look = {};
  objects_setup_.background_models.clear();
  objects_setup_.backdrop.emplace();  // nothing behind the objects
  // Without a background a volume has to tell people from it; without depth nobody is in it.
  objects_setup_.capture_box = render::CaptureBox{glm::dvec3(-1), glm::dvec3(1)};
  MIXRIG_ASSIGN(compositor_, render::make_cpu_compositor(objects_setup_, 0));
  make_tables();
  return {};
}

void Baselines::make_tables() {
  const Size size = setup_->view.size_px;
  plate_px_.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Eigen::Vector2d ray = setup_->view.unproject(Eigen::Vector2d(x, y));
      if (const auto px = setup_->target.project({ray.x(), ray.y(), 1.0}))
        plate_px_.row(y)[x] = {static_cast<float>(std::fmax(px->x(), 0.0)),
                               static_cast<float>(std::fmax(px->y(), 0.0))};
    }
  tof_rays_ = rays_of(setup_->tof, setup_->tof.size_px());
  for (const render::BackgroundModel& model : setup_->background_models)
    background_rays_.push_back(
        rays_of(geometry::CameraModel{model.camera, {}}, model.camera.size_px));
  no_depth_m_.reset(setup_->tof.size_px());
  depth_m_.reset(size);
  background_m_.reset(size);
  plate_.reset(size);
}

Result<void> Baselines::draw_objects(const render::FrameInput& input, bool objects_shown) {
  objects_.wanted = render::kColor | render::kMixedDepth | render::kAlpha;
  MIXRIG_TRY(compositor_->compose(input, objects_));
  if (!objects_shown) objects_.alpha.fill(0);
  return {};
}

void Baselines::draw_plate(ImageView<const Rgb8> plate) {
  for (int y = 0; y < plate_.height(); ++y) {
    for (int x = 0; x < plate_.width(); ++x) {
      const PlatePlace at = plate_px_.row(y)[x];
      plate_.row(y)[x] = {};
      if (at.x_px < 0) continue;
      const float u = std::fmin(at.x_px, static_cast<float>(plate.size.width - 1));
      const float v = std::fmin(at.y_px, static_cast<float>(plate.size.height - 1));
      const int x0 = static_cast<int>(u), x1 = std::min(x0 + 1, plate.size.width - 1);
      const int y0 = static_cast<int>(v), y1 = std::min(y0 + 1, plate.size.height - 1);
      const Rgb8 a = plate.row(y0)[x0], b = plate.row(y0)[x1];
      const Rgb8 c = plate.row(y1)[x0], d = plate.row(y1)[x1];
      const float tx = u - static_cast<float>(x0), ty = v - static_cast<float>(y0);
      plate_.row(y)[x] = {mean(a.r, b.r, c.r, d.r, tx, ty), mean(a.g, b.g, c.g, d.g, tx, ty),
                          mean(a.b, b.b, c.b, d.b, tx, ty)};
    }
  }
}

void Baselines::draw_depth(ImageView<const float> tof_depth_m) {
  tof_z_m_.reset(tof_depth_m.size);
  for (int y = 0; y < tof_depth_m.size.height; ++y)
    for (int x = 0; x < tof_depth_m.size.width; ++x) {
      const measure::Ray ray = tof_rays_.row(y)[x];
      const float along = setup_->depth_is_distance ? std::hypot(ray.x, ray.y, 1.0F) : 1.0F;
      tof_z_m_.row(y)[x] = tof_depth_m.row(y)[x] / along;
    }
  depth_m_.fill(0);
  measure::splat(tof_z_m_, tof_rays_, motion_of(setup_->target_from_tof), view_of(setup_->view),
                 depth_m_);
}

void Baselines::draw_background(const geometry::Pose& world_from_target) {
  const geometry::Pose target_from_world = geometry::inverse(world_from_target);
  background_m_.fill(0);
  for (std::size_t k = 0; k < setup_->background_models.size(); ++k) {
    const render::BackgroundModel& model = setup_->background_models[k];
    const Size face = model.camera.size_px;
    const ImageView<const float> all = model.depth_m;
    for (std::size_t i = 0; i < model.world_from_face.size(); ++i)
      measure::splat({all.row(static_cast<int>(i) * face.height), face, all.stride},
                     background_rays_[k], motion_of(target_from_world * model.world_from_face[i]),
                     view_of(setup_->view), background_m_);
  }
  if (!setup_->background_models.empty()) return;
  const ImageView<const float> learned_m = setup_->background.depth_m;
  for (int y = 0; y < learned_m.size.height; ++y)
    std::copy_n(learned_m.row(y), learned_m.size.width, background_m_.row(y));
}

Result<void> Baselines::add(const capture::Capture& capture,
                            const geometry::Pose& world_from_target, bool objects_shown,
                            const capture::Truth& truth) {
  MIXRIG_TRY(draw_objects({capture.plate, no_depth_m_, world_from_target}, objects_shown));
  draw_plate(capture.plate);
  draw_depth(capture.depth_m);
  draw_background(world_from_target);
  const measure::PlainInputs inputs{
      plate_, objects_.color, objects_.alpha, objects_.mixed_depth_m, depth_m_, background_m_};
  const geometry::DepthNoise& noise = setup_->noise;
  const measure::DepthSpread spread{noise.floor_m, noise.linear, noise.quadratic_per_m};
  for (std::size_t i = 0; i < judges_.size(); ++i) {
    if (measure::kBaselines[i] != measure::Baseline::kIdeal)
      measure::compose_plainly(measure::kBaselines[i], inputs, spread, composite_);
    else if (truth.composite.size() == plate_.size())
      measure::compose_ideally(
          plate_, {truth.composite, truth.depth_m, truth.matte, truth.light, truth.labels},
          composite_);
    else
      continue;
    MIXRIG_TRY(judges_[i].add(truth, composite_.view()));
  }
  return {};
}

std::vector<BaselineErrors> Baselines::errors() const {
  std::vector<BaselineErrors> out;
  for (std::size_t i = 0; i < judges_.size(); ++i) {
    measure::Errors errors = judges_[i].errors();
    if (measure::kBaselines[i] != measure::Baseline::kDepthKey)
      errors.depth_mae_mm = errors.depth_bad_pct = errors.band_bad_pct = {};
    errors.hidden_bad_pct = errors.hidden_wrong_pct = {};  // they have none
    if (measure::kBaselines[i] == measure::Baseline::kIdeal) errors = colors_of(errors);
    out.push_back({measure::kBaselines[i], errors});
  }
  return out;
}

}  // namespace mixrig::session
