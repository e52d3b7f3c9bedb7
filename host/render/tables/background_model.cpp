// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/background_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "hal/base/order_statistics.h"
#include "host/render/tables/light_surface.h"
#include "host/render/tables/wrapped_areas.h"

namespace mixrig::render {
namespace {

constexpr int kMostStepPx = 16;
/// Factor of a measurement's sigma: a grid sample is the median of several model pixels.
constexpr float kMedianSigma = 0.5F;

/// Median of the known depths of a cell, if it knows at least half of them.
float cell_depth(ImageView<const float> depth_m, int x0, int y0, int step_px,
                 std::vector<float>& known) {
  known.clear();
  int all = 0;
  for (int y = y0; y < std::min(y0 + step_px, depth_m.size.height); ++y)
    for (int x = x0; x < std::min(x0 + step_px, depth_m.size.width); ++x, ++all)
      if (const float z = depth_m.row(y)[x]; z > 0 && std::isfinite(z)) known.push_back(z);
  if (known.empty() || 2 * static_cast<int>(known.size()) < all) return 0;
  return upper_median_in_place(std::span(known));
}

/// Depth one step beyond `z_m`, extrapolated from `before_m` as a plane; z_m where the change is
/// too large for one plane.
float continued_m(float z_m, float before_m) {
  constexpr float kMostChange = 0.2F;
  if (!(z_m > 0 && before_m > 0)) return z_m;
  const float w = 1 / z_m, change = w - 1 / before_m;
  return std::abs(change) < kMostChange * w ? 1 / (w + change) : z_m;
}

/// Fills the outer ring of cells, so that surfaces reach the borders of the images.
void continue_ring(Image<float>& depth_m) {
  const int right = depth_m.width() - 1, bottom = depth_m.height() - 1;
  if (right < 4 || bottom < 4) return;
  for (int y = 1; y < bottom; ++y) {
    float* row = depth_m.row(y);
    row[0] = continued_m(row[1], row[2]);
    row[right] = continued_m(row[right - 1], row[right - 2]);
  }
  for (int x = 0; x <= right; ++x) {
    depth_m.row(0)[x] = continued_m(depth_m.row(1)[x], depth_m.row(2)[x]);
    depth_m.row(bottom)[x] = continued_m(depth_m.row(bottom - 1)[x], depth_m.row(bottom - 2)[x]);
  }
}

/// Sets the rays of the grid samples, which lie in the middle of their cells; the outer samples are
/// the ring around the image.
void make_rays(const geometry::Pinhole& camera, ModelTables& t) {
  const int step = t.step_px;
  const auto samples = [&](int pixels) { return (pixels + step - 1) / step + 2; };
  t.grid.tof_size = {samples(camera.size_px.width), samples(camera.size_px.height)};
  t.grid.tof_ray.reset(t.grid.tof_size);
  const double middle = 0.5 * (step - 1);
  for (int y = 0; y < t.grid.tof_size.height; ++y)
    for (int x = 0; x < t.grid.tof_size.width; ++x) {
      const Eigen::Vector2d ray =
          camera.unproject({(x - 1) * step + middle, (y - 1) * step + middle});
      t.grid.tof_ray.row(y)[x] = glm::vec2(ray.x(), ray.y());
    }
}

Image<float> make_grid(ImageView<const float> face_m, const ModelTables& t) {
  Image<float> depth_m(t.grid.tof_size);
  std::vector<float> known;
  for (int y = 1; y + 1 < depth_m.height(); ++y)
    for (int x = 1; x + 1 < depth_m.width(); ++x)
      depth_m.row(y)[x] =
          cell_depth(face_m, (x - 1) * t.step_px, (y - 1) * t.step_px, t.step_px, known);
  continue_ring(depth_m);
  return depth_m;
}

FaceRange range_of(const Image<float>& depth_m) {
  FaceRange range;
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x) {
      const float z_m = depth_m.row(y)[x];
      if (z_m <= 0) continue;
      range.near_m = range.far_m > 0 ? std::min(range.near_m, z_m) : z_m;
      range.far_m = std::max(range.far_m, z_m);
    }
  return range;
}

/// View of face number `face` in the model's images.
template <typename T>
ImageView<T> face_of(ImageView<T> images, Size face_size, std::size_t face) {
  return {images.row(static_cast<int>(face) * face_size.height), face_size, images.stride};
}

/// Normals of each face, rotated to axes of the first face.
void make_normals(const BackgroundModel& model, int radius_px, Image<PackedNormal>& out) {
  out.reset(model.depth_m.size);
  const Size size = model.camera.size_px;
  const geometry::Pose first_from_world = geometry::inverse(model.world_from_face.front());
  for (std::size_t face = 0; face < model.world_from_face.size(); ++face) {
    Image<PackedNormal> made = normals(face_of(model.depth_m, size, face), model.camera, radius_px);
    const glm::mat3 first_from_face(
        to_glm((first_from_world * model.world_from_face[face]).matrix()));
    const ImageView<PackedNormal> to = face_of(out.view(), size, face);
    for (int y = 0; y < size.height; ++y) {
      const std::span<PackedNormal> row(made.row(y), static_cast<std::size_t>(size.width));
      if (face > 0) rotate(first_from_face, row);
      std::copy(row.begin(), row.end(), to.row(y));
    }
  }
}

bool takes_light(const CompositorSetup& setup) {
  return !setup.objects.empty() && (!setup.light.lamps.empty() || setup.light.contact);
}

/// The signed plane number of a pixel, as ModelTables::normal stores it.
std::int8_t plane_number(std::size_t number, float model_m, float room_m) {
  const auto counted = static_cast<std::int8_t>(1 + number);
  return room_m == model_m ? counted : static_cast<std::int8_t>(-counted);
}

/// Normals and planes of the light surface of each face, in axes of the first face.
void make_light(const CompositorSetup& setup, const BackgroundModel& model, int radius_px,
                ModelTables& t) {
  static_assert(kMostLightPlanes == kMostPlanes * std::size_t{kMostFaces});
  static_assert(kMostLightPlanes <= std::numeric_limits<std::int8_t>::max());
  t.normal.reset(model.depth_m.size);
  const Size size = model.camera.size_px;
  const geometry::Pose first_from_world = geometry::inverse(model.world_from_face.front());
  for (std::size_t face = 0; face < model.world_from_face.size(); ++face) {
    const geometry::Pose& world_from_face = model.world_from_face[face];
    const ImageView<const float> model_m = face_of(model.depth_m, size, face);
    const Image<float> room_m = without_wrapped(
        model_m, model.depth_sigma_m.empty() ? model.depth_sigma_m
                                             : face_of(model.depth_sigma_m, size, face));
    LightSurface made = light_surface(room_m, model.camera, noise_params(setup.noise), radius_px,
                                      feet_of(setup.objects, geometry::inverse(world_from_face)));
    const glm::mat3 first_from_face(to_glm((first_from_world * world_from_face).matrix()));
    const ImageView<PackedNormal> to = face_of(t.normal.view(), size, face);
    for (int y = 0; y < size.height; ++y) {
      const std::span<PackedNormal> row(made.normal.row(y), static_cast<std::size_t>(size.width));
      if (face > 0) rotate(first_from_face, row);
      for (int x = 0; x < size.width; ++x)
        if (const std::uint8_t plane = made.plane.row(y)[x]; plane != kNoPlane)
          row[static_cast<std::size_t>(x)].w =
              plane_number(t.planes.size() + plane, model_m.row(y)[x], room_m.row(y)[x]);
      std::copy(row.begin(), row.end(), to.row(y));
    }
    for (const WPlane& plane : made.planes) t.planes.push_back({face, plane});
  }
}

}  // namespace

void planes_in_camera(const ModelTables& tables, std::span<const FacePose> of_faces,
                      std::span<glm::vec3> out) {
  out[0] = glm::vec3(0);
  for (std::size_t k = 0; k < tables.planes.size(); ++k) {
    const ModelPlane& plane = tables.planes[k];
    const glm::mat4& m = of_faces[plane.face].face_from_camera;
    const glm::vec3 n(plane.plane.abc.x(), plane.plane.abc.y(), plane.plane.abc.z());
    const float ahead = 1 - glm::dot(n, glm::vec3(m[3]));  // of the camera; 0: it is on the plane
    out[k + 1] = ahead > 0 ? glm::transpose(glm::mat3(m)) * n / ahead : glm::vec3(0);
  }
}

void rotate(const glm::mat3& r, std::span<PackedNormal> normals) {
  const auto pack = [](float value) {
    return static_cast<std::int8_t>(static_cast<std::int32_t>(value + (value < 0 ? -0.5F : 0.5F)));
  };
  for (PackedNormal& n : normals) {
    const float x = n.x, y = n.y, z = n.z;
    n.x = pack(r[0].x * x + r[1].x * y + r[2].x * z);
    n.y = pack(r[0].y * x + r[1].y * y + r[2].y * z);
    n.z = pack(r[0].z * x + r[1].z * y + r[2].z * z);
  }
}

bool has_model_color(const CompositorSetup& setup) {
  return std::any_of(setup.background_models.begin(), setup.background_models.end(),
                     [](const BackgroundModel& model) { return !model.color.empty(); });
}

ModelTables make_model_tables(const CompositorSetup& setup, const BackgroundModel& model,
                              bool with_normals) {
  const geometry::Pinhole& camera = model.camera;
  ModelTables t;
  const double cell_px = std::max(1.0, camera.fx_px / setup.tof.pinhole.fx_px);
  t.step_px = std::clamp(static_cast<int>(std::lround(cell_px)), 1, kMostStepPx);
  t.face_rows = camera.size_px.height;
  make_rays(camera, t);
  for (std::size_t face = 0; face < model.world_from_face.size(); ++face)
    t.depth_m.push_back(make_grid(face_of(model.depth_m, camera.size_px, face), t));
  for (const Image<float>& depth_m : t.depth_m) t.range.push_back(range_of(depth_m));
  const NoiseParams noise = noise_params(setup.noise);
  t.grid.correct.noise = {kMedianSigma * noise.floor_m, kMedianSigma * noise.linear,
                          kMedianSigma * noise.quadratic_per_m};
  t.grid.view_size = setup.view.size_px;
  t.camera = {glm::vec2(camera.fx_px, camera.fy_px), glm::vec2(camera.cx_px, camera.cy_px)};
  t.camera_focal_px = camera.fx_px;
  set_view(setup, t);
  t.w.reset(model.depth_m.size);
  for (int y = 0; y < t.w.height(); ++y)
    for (int x = 0; x < t.w.width(); ++x) {
      const float z = model.depth_m.row(y)[x];
      t.w.row(y)[x] = z > 0 && std::isfinite(z) ? 1 / z : 0;
    }
  const int radius_px = static_cast<int>(std::ceil(cell_px));
  if (with_normals && takes_light(setup))
    make_light(setup, model, radius_px, t);
  else if (with_normals)
    make_normals(model, 2 * radius_px, t.normal);
  return t;
}

void set_view(const CompositorSetup& setup, ModelTables& t) {
  // The steps of the model were widened when it was learned.
  t.grid.warp.open_reach = t.grid.warp.shut_reach = 1;
  t.grid.warp.mixed_pixels = false;
  t.grid.warp.view = {glm::vec2(setup.view.fx_px, setup.view.fy_px),
                      glm::vec2(setup.view.cx_px, setup.view.cy_px)};
  t.grid.tof_footprint_px =
      static_cast<float>(std::max(1.0, t.step_px * setup.view.fx_px / t.camera_focal_px));
  // Edges of the model are known to one of its samples.
  const auto sample_px = static_cast<float>(setup.view.fx_px / t.camera_focal_px);
  t.limit_radius_px = limit_radius_px(tof_footprint_px(setup) + std::max(0.0F, sample_px - 1));
}

bool may_show(const ModelTables& t, std::size_t face, const FacePose& pose) {
  const FaceRange range = t.range[face];
  if (range.far_m <= 0) return false;
  const Size grid = t.grid.tof_size, view = t.grid.view_size;
  const PinholeParams camera = t.grid.warp.view;
  const float margin_px = 2 + t.grid.tof_footprint_px;  // cut cells reach over their samples
  const glm::vec2 least = (glm::vec2(-margin_px) - camera.center_px) / camera.focal_px;
  const glm::vec2 most =
      (glm::vec2(view.width, view.height) + margin_px - camera.center_px) / camera.focal_px;
  std::array<bool, 5> outside;  // all corners: left, right, above, below, behind
  outside.fill(true);
  for (const int x : {0, grid.width - 1})
    for (const int y : {0, grid.height - 1})
      for (const float z_m : {range.near_m, range.far_m}) {
        const glm::vec3 p(pose.camera_from_face *
                          glm::vec4(t.grid.tof_ray.row(y)[x] * z_m, z_m, 1));
        outside[0] = outside[0] && p.x < least.x * p.z;
        outside[1] = outside[1] && p.x > most.x * p.z;
        outside[2] = outside[2] && p.y < least.y * p.z;
        outside[3] = outside[3] && p.y > most.y * p.z;
        outside[4] = outside[4] && p.z < 0;
      }
  return std::none_of(outside.begin(), outside.end(), [](bool all) { return all; });
}

FacePose face_pose(const geometry::Pose& world_from_face, const geometry::Pose& world_from_camera) {
  const geometry::Pose camera_from_face = geometry::inverse(world_from_camera) * world_from_face;
  return {glm::mat4(to_glm(camera_from_face.matrix())),
          glm::mat4(to_glm(geometry::inverse(camera_from_face).matrix()))};
}

}  // namespace mixrig::render
