// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/second_depth.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr auto kNearestZ_m = static_cast<float>(kNearestM);

/// Places of a surface point in the picture of the other camera.
struct Seen {
  bool inside = false;
  float x = 0, y = 0, z_m = 0;
};

class Agreement {
 public:
  Agreement(const AgreeTables& tables, const TofGrid& other) : t_(tables), other_(other) {}

  float z_m(glm::vec2 ray, float z, float step_m) const;

 private:
  Seen look(glm::vec2 ray, float z) const;
  bool looks_through(const float* corner, float limit_m) const;

  const AgreeTables& t_;
  const TofGrid& other_;
};

Seen Agreement::look(glm::vec2 ray, float z) const {
  const AgreeParams& p = t_.params;
  const glm::vec3 at = transform(p.other_from_tof, glm::vec3(ray * z, z));
  if (!(at.z > kNearestZ_m)) return {};
  const float inverse = 1 / at.z;
  const float u = p.other.focal_px.x * at.x * inverse + p.other.center_px.x;
  const float v = p.other.focal_px.y * at.y * inverse + p.other.center_px.y;
  const Size size = t_.other_px.size();
  const auto last_x = static_cast<float>(size.width - 1),
             last_y = static_cast<float>(size.height - 1);
  if (!(u >= 0 && v >= 0 && u <= last_x && v <= last_y)) return {};
  const auto column = static_cast<int>(u + 0.5F), row = static_cast<int>(v + 0.5F);
  const glm::vec2 px = t_.other_px.row(row)[column];
  const float x = px.x + (u - static_cast<float>(column)) * p.px_per_px;
  const float y = px.y + (v - static_cast<float>(row)) * p.px_per_px;
  if (!(x >= 0 && y >= 0 && x < last_x && y < last_y)) return {};
  return {true, x, y, at.z};
}

/// Whether all 4x4 pixels around are known and beyond a limit. `corner`: the upper left one of the
/// inner four.
bool Agreement::looks_through(const float* corner, float limit_m) const {
  const std::ptrdiff_t stride = other_.z_m.stride();
  float nearest = corner[0];
  for (std::ptrdiff_t j = -1; j <= 2; ++j)
    for (std::ptrdiff_t i = -1; i <= 2; ++i) nearest = std::min(nearest, corner[j * stride + i]);
  return nearest > limit_m;
}

float Agreement::z_m(glm::vec2 ray, float z, float step_m) const {
  if (!(z > 0)) return 0;
  const Seen seen = look(ray, z);
  if (!seen.inside) return z;
  const auto x = static_cast<int>(seen.x), y = static_cast<int>(seen.y);
  const std::ptrdiff_t stride = other_.z_m.stride();
  const float* a = other_.z_m.row(y + kFrame) + x + kFrame;
  const float* c = a + stride;
  const float nearest = std::min(std::min(a[0], a[1]), std::min(c[0], c[1]));
  const float farthest = std::max(std::max(a[0], a[1]), std::max(c[0], c[1]));
  if (!(nearest > 0)) return z;
  const float limit_m = std::max(step_m, other_.step_m.row(y + kFrame)[x + kFrame]);
  if (seen.z_m < nearest - limit_m) return looks_through(a, seen.z_m + limit_m) ? 0 : z;
  if (farthest - nearest > limit_m) return z;
  const float i = seen.x - static_cast<float>(x), j = seen.y - static_cast<float>(y);
  const float above = a[0] + i * (a[1] - a[0]), below = c[0] + i * (c[1] - c[0]);
  const float measured_m = above + j * (below - above);
  const float off_m = measured_m - seen.z_m;
  if (std::abs(off_m) > limit_m) return z;
  const float own_sigma = t_.params.noise.sigma_m(z);
  const float other_sigma = t_.params.other_noise.sigma_m(measured_m);
  const float own = own_sigma * own_sigma, sum = own + other_sigma * other_sigma;
  return sum > 0 ? z + off_m * (own / sum) : z + 0.5F * off_m;
}

}  // namespace

void agree(Crew& crew, const AgreeTables& tables, const Image<glm::vec2>& tof_ray,
           const TofGrid& other, TofGrid& own) {
  constexpr int kGrain = 16;
  const Agreement agreement(tables, other);
  crew.rows(tof_ray.height(), kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const glm::vec2* ray = tof_ray.row(y);
      const float* z = own.z_m.row(y + kFrame) + kFrame;
      const float* step = own.step_m.row(y + kFrame) + kFrame;
      float* out = own.agreed_z_m.row(y + kFrame) + kFrame;
      float* w = own.w.row(y + kFrame) + kFrame;
      for (int x = 0; x < tof_ray.width(); ++x) {
        out[x] = agreement.z_m(ray[x], z[x], step[x]);
        w[x] = out[x] > 0 ? 1 / out[x] : 0;
      }
    }
  });
}

SecondDepth::SecondDepth(const CompositorSetup& setup, TofGrid& first)
    : tables_(make_second_tables(setup)),
      grid_(tables_.tof.tof_size),
      scratch_(tables_.tof.tof_size) {
  for (TofGrid* grid : {&first, &grid_}) grid->agreed_z_m.reset(grid->z_m.size());
}

void SecondDepth::correct_both(Crew& crew, const Tables& tables, ImageView<const float> first_m,
                               ImageView<const float> second_m, TofGrid& first) {
  const CorrectParams& params = tables_.tof.correct;
  correct_depth(crew, tables.correct, tables.tof_ray, first_m, first);
  correct_depth(crew, params, tables_.tof.tof_ray, second_m, grid_);
  agree(crew, tables_.first, tables.tof_ray, grid_, first);
  agree(crew, tables_.second, tables_.tof.tof_ray, first, grid_);
  link_pixels(crew, tables.correct, first.agreed_z_m, first);
  link_pixels(crew, params, grid_.agreed_z_m, grid_);
}

void SecondDepth::add_to(Crew& crew, Image<float>& view_w) {
  warp(crew, tables_.tof, grid_, scratch_, view_w, Before::kSurfaces);
}

}  // namespace mixrig::render::cpu
