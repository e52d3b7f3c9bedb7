// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/second_depth.h"

#include <algorithm>
#include <cstring>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kNearestZ_m = static_cast<float>(kNearestM);

/// Loads the first `count` lanes; 0 in the others.
FloatLanes load_first(const float* from, int count) {
  FloatLanes v{};
  std::memcpy(&v, from, sizeof(float) * static_cast<std::size_t>(count));
  return v;
}
void store_first(float* to, FloatLanes v, int count) {
  std::memcpy(to, &v, sizeof(float) * static_cast<std::size_t>(count));
}

/// Surface points in the other camera's picture.
struct SeenLanes {
  IntLanes inside;
  FloatLanes x, y, z_m;
};

class Agreement {
 public:
  Agreement(const AgreeScratch& scratch, const TofGrid& other)
      : s_(scratch),
        other_z_m_(other.z_m.row(kFrame) + kFrame),
        other_step_m_(other.step_m.row(kFrame) + kFrame),
        stride_(static_cast<std::int32_t>(other.z_m.stride())) {}

  /// Agreed z of `count` pixels from (x, y) on.
  FloatLanes z_m(int x, int y, int count, FloatLanes z, FloatLanes step_m) const;

 private:
  SeenLanes look(int x, int y, int count, FloatLanes z) const;
  bool looks_through(std::int32_t corner, float limit_m) const;

  const AgreeScratch& s_;
  const float *other_z_m_, *other_step_m_;
  std::int32_t stride_;
};

SeenLanes Agreement::look(int x, int y, int count, FloatLanes z) const {
  const AgreeParams& p = s_.params;
  const glm::vec4& t = p.other_from_tof[3];
  const FloatLanes at_x = load_first(s_.ray_x.row(y) + x, count) * z + t.x;
  const FloatLanes at_y = load_first(s_.ray_y.row(y) + x, count) * z + t.y;
  const FloatLanes at_z = load_first(s_.ray_z.row(y) + x, count) * z + t.z;
  const Size size = s_.other_x.size();
  const auto last_x = static_cast<float>(size.width - 1),
             last_y = static_cast<float>(size.height - 1);
  const FloatLanes inverse = 1 / at_z;
  const FloatLanes u = p.other.focal_px.x * at_x * inverse + p.other.center_px.x;
  const FloatLanes v = p.other.focal_px.y * at_y * inverse + p.other.center_px.y;
  IntLanes inside =
      (z > 0) & (at_z > kNearestZ_m) & (u >= 0) & (v >= 0) & (u <= last_x) & (v <= last_y);
  const IntLanes column = truncate(inside ? u + 0.5F : FloatLanes{});
  const IntLanes row = truncate(inside ? v + 0.5F : FloatLanes{});
  const IntLanes at = row * static_cast<std::int32_t>(s_.other_x.stride()) + column;
  const FloatLanes px = gather(s_.other_x.row(0), at) + (u - to_float(column)) * p.px_per_px;
  const FloatLanes py = gather(s_.other_y.row(0), at) + (v - to_float(row)) * p.px_per_px;
  inside &= (px >= 0) & (py >= 0) & (px < last_x) & (py < last_y);
  return {inside, inside ? px : FloatLanes{}, inside ? py : FloatLanes{}, at_z};
}

/// Whether all 4x4 pixels around are known and beyond a limit. `corner`: index of the upper left of
/// the inner four.
bool Agreement::looks_through(std::int32_t corner, float limit_m) const {
  const float* at = other_z_m_ + corner;
  float nearest = *at;
  for (int j = -1; j <= 2; ++j)
    for (int i = -1; i <= 2; ++i) nearest = std::min(nearest, at[j * stride_ + i]);
  return nearest > limit_m;
}

FloatLanes Agreement::z_m(int x, int y, int count, FloatLanes z, FloatLanes step_m) const {
  const SeenLanes seen = look(x, y, count, z);
  const IntLanes column = truncate(seen.x), row = truncate(seen.y);
  const IntLanes corner = row * stride_ + column;
  const FloatLanes a = gather(other_z_m_, corner), b = gather(other_z_m_ + 1, corner);
  const FloatLanes c = gather(other_z_m_ + stride_, corner),
                   d = gather(other_z_m_ + stride_ + 1, corner);
  const FloatLanes nearest = min(min(a, b), min(c, d)), farthest = max(max(a, b), max(c, d));
  const FloatLanes limit_m = max(step_m, gather(other_step_m_, corner));
  const IntLanes known = seen.inside & (nearest > 0);
  const IntLanes before = known & (seen.z_m < nearest - limit_m);

  const FloatLanes part_x = seen.x - to_float(column), part_y = seen.y - to_float(row);
  const FloatLanes above = a + part_x * (b - a), below = c + part_x * (d - c);
  const FloatLanes measured_m = above + part_y * (below - above);
  const FloatLanes off_m = measured_m - seen.z_m;
  const IntLanes agrees = known & (farthest - nearest <= limit_m) & (abs(off_m) <= limit_m);
  const auto variance = [](const NoiseParams& noise, FloatLanes at_m) {
    const FloatLanes sigma = noise.floor_m + at_m * (noise.linear + at_m * noise.quadratic_per_m);
    return sigma * sigma;
  };
  const FloatLanes own = variance(s_.params.noise, z);
  const FloatLanes sum = own + variance(s_.params.other_noise, measured_m);
  const FloatLanes weight = sum > 0 ? own / sum : FloatLanes{} + 0.5F;
  FloatLanes out = agrees ? z + off_m * weight : z;
  if (any(before))
    for (int i = 0; i < count; ++i)
      if (before[i] != 0 && looks_through(corner[i], seen.z_m[i] + limit_m[i])) out[i] = 0;
  return out;
}

}  // namespace

AgreeScratch::AgreeScratch(const AgreeTables& tables, const Image<glm::vec2>& tof_ray)
    : params(tables.params) {
  for (Image<float>* image : {&ray_x, &ray_y, &ray_z}) image->reset(tof_ray.size());
  for (Image<float>* image : {&other_x, &other_y}) image->reset(tables.other_px.size());
  const glm::mat3 rotation(params.other_from_tof);
  for (int y = 0; y < tof_ray.height(); ++y)
    for (int x = 0; x < tof_ray.width(); ++x) {
      const glm::vec3 ray = rotation * glm::vec3(tof_ray.row(y)[x], 1);
      ray_x.row(y)[x] = ray.x, ray_y.row(y)[x] = ray.y, ray_z.row(y)[x] = ray.z;
    }
  for (int y = 0; y < other_x.height(); ++y)
    for (int x = 0; x < other_x.width(); ++x) {
      const glm::vec2 px = tables.other_px.row(y)[x];
      other_x.row(y)[x] = px.x, other_y.row(y)[x] = px.y;
    }
}

void agree(Crew& crew, const AgreeScratch& scratch, const TofGrid& other, TofGrid& own) {
  constexpr int kGrain = 16;
  const Agreement agreement(scratch, other);
  const Size size = scratch.ray_x.size();
  crew.rows(size.height, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const float* z = own.z_m.row(y + kFrame) + kFrame;
      const float* step = own.step_m.row(y + kFrame) + kFrame;
      float* out = own.agreed_z_m.row(y + kFrame) + kFrame;
      float* w = own.w.row(y + kFrame) + kFrame;
      for (int x = 0; x < size.width; x += kLanes) {
        const int count = std::min(kLanes, size.width - x);
        const FloatLanes agreed =
            agreement.z_m(x, y, count, load_first(z + x, count), load_first(step + x, count));
        store_first(out + x, agreed, count);
        store_first(w + x, agreed > 0 ? 1 / agreed : FloatLanes{}, count);
      }
    }
  });
}

SecondDepth::SecondDepth(const CompositorSetup& setup, const Tables& tables, TofGrid& first)
    : tables_(make_second_tables(setup)),
      grid_(tables_.tof.tof_size),
      first_by_second_(tables_.first, tables.tof_ray),
      second_by_first_(tables_.second, tables_.tof.tof_ray),
      scratch_(tables_.tof.tof_size) {
  for (TofGrid* grid : {&first, &grid_}) grid->agreed_z_m.reset(grid->z_m.size());
  tables_.first.other_px = tables_.second.other_px = {};
}

void SecondDepth::correct_both(Crew& crew, const Tables& tables, ImageView<const float> first_m,
                               ImageView<const float> second_m, TofGrid& first) {
  const CorrectParams& params = tables_.tof.correct;
  correct_depth(crew, tables.correct, tables.tof_ray, first_m, first);
  correct_depth(crew, params, tables_.tof.tof_ray, second_m, grid_);
  agree(crew, first_by_second_, grid_, first);
  agree(crew, second_by_first_, first, grid_);
  link_pixels(crew, tables.correct, first.agreed_z_m, first);
  link_pixels(crew, params, grid_.agreed_z_m, grid_);
}

void SecondDepth::add_to(Crew& crew, Image<float>& view_w) {
  warp(crew, tables_.tof, grid_, scratch_, view_w, Before::kSurfaces);
}

}  // namespace mixrig::render::cpu
