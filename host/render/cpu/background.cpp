// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/background.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/render/cpu/bilinear.h"
#include "host/render/cpu/draw_quads.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kBackgroundGrain = 16;
constexpr std::size_t kRun = MovingBackground::kMostColumns;
constexpr std::uint16_t kUnknownColor = 65535;

/// Largest of `from` within `radius` along a row.
void most_within(const float* from, int width, int radius, float* to) {
  const int last = width - 1;
  for (int x = 0; x < std::min(radius, width); ++x)
    to[x] = *std::max_element(from, from + std::min(x + radius, last) + 1);
  for (int x = radius; x < width - radius; ++x) to[x] = from[x];
  for (int d = -radius; d <= radius; ++d)
    for (int x = radius; x < width - radius; ++x) to[x] = to[x] < from[x + d] ? from[x + d] : to[x];
  for (int x = std::max(radius, width - radius); x < width; ++x)
    to[x] = *std::max_element(from + std::max(0, x - radius), from + width);
}

/// A table of the model's pixels with a border of one: pixel (x, y) lies at (x + 1, y + 1).
template <typename T, typename Make>
Image<T> padded(Size size, T border, Make&& make) {
  Image<T> out({size.width + 2, size.height + 2}, border);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) out.row(y + 1)[x + 1] = make(x, y);
  return out;
}

Image<Rgbx16> packed_color(const BackgroundView& images) {
  const auto to_u16 = [](float value) {
    return static_cast<std::uint16_t>(std::lround(kLinearOne * std::clamp(value, 0.0F, 1.0F)));
  };
  Image<Rgbx16> out =
      padded<Rgbx16>(images.color.size, {0, 0, 0, kUnknownColor}, [&](int x, int y) -> Rgbx16 {
        const Rgbf& c = images.color.row(y)[x];
        const float sigma = images.color_sigma.empty() ? 0 : images.color_sigma.row(y)[x];
        const auto spread = std::min<std::uint16_t>(to_u16(sigma), kUnknownColor - 1);
        return {to_u16(c.r), to_u16(c.g), to_u16(c.b), c.r < 0 ? kUnknownColor : spread};
      });
  // The colours of the border only serve interpolation.
  const int right = out.width() - 1, bottom = out.height() - 1;
  const auto repeat = [&](int x, int y, int from_x, int from_y) {
    const Rgbx16 c = out.at(from_x, from_y);
    out.at(x, y) = {c.r, c.g, c.b, c.x};
  };
  for (int x = 1; x < right; ++x) repeat(x, 0, x, 1), repeat(x, bottom, x, bottom - 1);
  for (int y = 0; y <= bottom; ++y) repeat(0, y, 1, y), repeat(right, y, right - 1, y);
  return out;
}

/// Turns unit normals; what is unknown stays so.
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

}  // namespace

// One index serves the tables of depth, spread and normals.
static_assert(sizeof(float) == sizeof(PackedNormal));

/// Where up to kRun pixels of a row of the view lie in the model camera.
struct MovingBackground::Run {
  alignas(64) std::array<float, kRun> u_px, v_px;
  alignas(64) std::array<float, kRun> z_m;  ///< in model axes
  alignas(64)
      std::array<std::int32_t, kRun> at;  ///< nearest pixel of the tables of 4-byte values; 0: none
  std::size_t count = 0;
};

MovingBackground::MovingBackground(Crew& crew, const CompositorSetup& setup, Normals normals)
    : key_(setup.key),
      noise_(noise_params(setup.noise)),
      world_from_model_(setup.background_model->world_from_camera),
      model_(make_model_tables(setup, normals == Normals::kMake)),
      grid_(model_.grid.tof_size),
      scratch_(model_.grid.tof_size),
      w_(with_margin(setup.view.size_px)),
      row_most_w_(setup.view.size_px),
      depth_sigma_m_(setup.view.size_px),
      depth_m_(setup.view.size_px) {
  correct(crew, model_.grid.correct, model_.grid.tof_ray, model_.depth_m, grid_);
  const BackgroundView& images = setup.background_model->images;
  const Size size = images.depth_m.size;
  model_w_ = padded(size, 0.0F, [&](int x, int y) { return model_.w.row(y)[x]; });
  model_sigma_m_ = padded(size, 0.0F, [&](int x, int y) {
    return images.depth_sigma_m.empty() ? 0 : images.depth_sigma_m.row(y)[x];
  });
  if (normals == Normals::kMake)
    model_normal_ =
        padded(size, PackedNormal{}, [&](int x, int y) { return model_.normal.row(y)[x]; });
  model_.depth_m = model_.w = {};
  model_.normal = {};
  if (images.color.empty()) return;
  model_color_ = packed_color(images);
  color_.reset(setup.view.size_px, {-1, -1, -1});
  color_sigma_.reset(setup.view.size_px);
}

void MovingBackground::draw(Crew& crew, const geometry::Pose& world_from_camera, Tables& tables) {
  const ModelPose pose = model_pose(world_from_model_, world_from_camera);
  model_from_camera_ = glm::mat3(pose.model_from_camera);
  camera_in_model_m_ = glm::vec3(pose.model_from_camera[3]);
  model_.grid.warp.camera_from_tof = pose.camera_from_model;
  warp(crew, model_.grid, grid_, scratch_, w_);
  const int height = depth_m_.height(), width = depth_m_.width();
  crew.rows(height, kBackgroundGrain, [&](int begin, int end) {
    Run run;
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < width; x += static_cast<int>(kRun)) {
        find_in_model(x, y, width - x, run);
        look_up(x, y, run);
      }
      most_within(w_.row(y), width, model_.limit_radius_px, row_most_w_.row(y));
    }
  });
  crew.rows(height, kBackgroundGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) limit_row(y, tables.key_limit_w.row(y));
  });
}

void MovingBackground::find_in_model(int x0, int y, int width, Run& run) const {
  run.count = std::min(kRun, static_cast<std::size_t>(width));
  const PinholeParams view = model_.grid.warp.view, model = model_.camera;
  const glm::mat3 r = model_from_camera_;
  const glm::vec3 t = camera_in_model_m_;
  const float ray_y = (static_cast<float>(y) - view.center_px.y) / view.focal_px.y;
  const glm::vec3 row = r[1] * ray_y + r[2];
  const float to_ray = 1 / view.focal_px.x;
  const float first_x = static_cast<float>(x0) - view.center_px.x;
  const float most_u = static_cast<float>(model_w_.width() - 2) - 0.5F;
  const float most_v = static_cast<float>(model_w_.height() - 2) - 0.5F;
  const auto stride = static_cast<std::int32_t>(model_w_.stride());
  const float* w = w_.row(y) + x0;
  for (std::size_t i = 0; i < run.count; ++i) {
    const float ray_x = (first_x + static_cast<float>(static_cast<int>(i))) * to_ray;
    const float qx = r[0].x * ray_x + row.x + t.x * w[i];
    const float qy = r[0].y * ray_x + row.y + t.y * w[i];
    const float qz = r[0].z * ray_x + row.z + t.z * w[i];
    const float inverse = 1 / qz;
    const float u = model.focal_px.x * qx * inverse + model.center_px.x;
    const float v = model.focal_px.y * qy * inverse + model.center_px.y;
    const bool inside =
        (w[i] > 0) & (qz > 0) & (u >= -0.5F) & (v >= -0.5F) & (u < most_u) & (v < most_v);
    run.u_px[i] = u;
    run.v_px[i] = v;
    run.z_m[i] = qz / w[i];
    // The tables have a border of one pixel that knows nothing.
    const auto column = static_cast<std::int32_t>(inside ? u + 1.5F : 0.0F);
    const auto line = static_cast<std::int32_t>(inside ? v + 1.5F : 0.0F);
    run.at[i] = line * stride + column;
  }
}

void MovingBackground::look_up(int x0, int y, const Run& run) {
  const float* w = w_.row(y) + x0;
  float* depth_m = depth_m_.row(y) + x0;
  float* sigma_m = depth_sigma_m_.row(y) + x0;
  for (std::size_t i = 0; i < run.count; ++i) depth_m[i] = w[i] > 0 ? 1 / w[i] : 0;
  const float* model_sigma_m = model_sigma_m_.row(0);
  for (std::size_t i = 0; i < run.count; ++i) sigma_m[i] = model_sigma_m[run.at[i]];
}

void MovingBackground::normals(int x0, int y, std::span<PackedNormal> out) const {
  Run run;
  find_in_model(x0, y, static_cast<int>(out.size()), run);
  const PackedNormal* model_normal = model_normal_.row(0);
  for (std::size_t i = 0; i < run.count; ++i) out[i] = model_normal[run.at[i]];
  rotate(glm::transpose(model_from_camera_), out.first(run.count));
}

/// Of the nearest pixel of the model. Rows of this table have another stride than the others'.
bool MovingBackground::color_is_unknown(float u_px, float v_px) const {
  const int x = static_cast<int>(u_px + 1.5F), y = static_cast<int>(v_px + 1.5F);
  return model_color_.row(y)[x].x == kUnknownColor;
}

void MovingBackground::draw_color(int x0, int y, int width) {
  Run run;
  Rgbf* color = color_.row(y) + x0;
  float* color_sigma = color_sigma_.row(y) + x0;
  find_in_model(x0, y, width, run);
  const std::ptrdiff_t stride = model_color_.stride();
  for (std::size_t i = 0; i < run.count; ++i) {
    const std::int32_t at = run.at[i];
    const float seen_w = model_w_.row(0)[at];
    // The model saw another surface before this one: that one's colour says nothing about it.
    const bool hidden = seen_w > 0 && std::abs(1 - run.z_m[i] * seen_w) > kHiddenPart;
    if (at == 0 || hidden || color_is_unknown(run.u_px[i], run.v_px[i])) {
      color[i] = {-1, -1, -1};
      color_sigma[i] = 0;
      continue;
    }
    const Split u = split(run.u_px[i] + 1, model_color_.width()),
                v = split(run.v_px[i] + 1, model_color_.height());
    const Rgbx16* p = model_color_.row(static_cast<int>(v.pixel)) + u.pixel;
    const F4 c =
        __builtin_convertvector(blend(p, p + stride, u.fraction, v.fraction), F4) / kLinearOne;
    color[i] = {c[0], c[1], c[2]};
    color_sigma[i] = c[3];
  }
}

/// As key_limit(), with the largest w of the rows around.
void MovingBackground::limit_row(int y, float* limit_w) const {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  const int width = depth_m_.width(), height = depth_m_.height();
  const int first = std::max(0, y - model_.limit_radius_px);
  const int last = std::min(height - 1, y + model_.limit_radius_px);
  std::copy_n(row_most_w_.row(first), width, limit_w);
  for (int j = first + 1; j <= last; ++j) {
    const float* other = row_most_w_.row(j);
    for (int x = 0; x < width; ++x) limit_w[x] = limit_w[x] < other[x] ? other[x] : limit_w[x];
  }
  const float* w = w_.row(y);
  const float* spread_m = depth_sigma_m_.row(y);
  for (int x = 0; x < width; ++x) {
    const float z = 1 / limit_w[x];
    const float sigma = noise_.sigma_m(z);
    const float by_noise = key_.noise_factor * std::sqrt(spread_m[x] * spread_m[x] + sigma * sigma);
    const float threshold = key_.threshold_m > by_noise ? key_.threshold_m : by_noise;
    limit_w[x] = (w[x] > 0) & (threshold < z) ? 1 / (z - threshold) : kNever;
  }
}

}  // namespace mixrig::render::cpu
