// SPDX-License-Identifier: Apache-2.0
// Pass background: where pixels of the view lie in the models, their normals and colours.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/render/cpu/background_run.h"
#include "host/render/cpu/bilinear.h"

namespace mixrig::render::cpu {
namespace {

/// Of the values that a face's z times w takes on a run: an interval that holds them.
struct Interval {
  float least, most;
};
Interval sum_of(float constant, float a, float a_from, float a_to, float b, float b_from,
                float b_to) {
  // Of lists: of two temporaries it would be references.
  const auto [a0, a1] = std::minmax({a * a_from, a * a_to});
  const auto [b0, b1] = std::minmax({b * b_from, b * b_to});
  constexpr float kRounding = 1e-5F;
  const float slack =
      kRounding * (std::abs(constant) + std::abs(a0) + std::abs(a1) + std::abs(b0) + std::abs(b1));
  return {constant + a0 + b0 - slack, constant + a1 + b1 + slack};
}

/// Least and largest of numbers; none: precondition.
Interval range_of(std::span<const float> from) {
  float least = from[0], most = from[0];
#pragma omp simd reduction(min : least) reduction(max : most)
  for (std::size_t i = 0; i < from.size(); ++i) {
    least = std::min(least, from[i]);
    most = std::max(most, from[i]);
  }
  return {least, most};
}

}  // namespace

void MovingBackground::find(const Pixels& pixels, Run& run) const {
  if (parts_.size() == 1) return find_in(0, pixels, Find::kPlace, run);
  find_in(0, pixels, Find::kAll, run);
  for (std::size_t part = 1; part < parts_.size(); ++part) {
    Run other;
    find_in(part, pixels, Find::kAll, other);
    keep_better(other, run);
  }
  for (std::size_t i = 0; i < run.count; ++i)
    if (!shows(run, i)) run.at[i] = 0;
}

/// In the face of a model whose axis is nearest.
void MovingBackground::find_in(std::size_t part, const Pixels& pixels, Find what, Run& run) const {
  const Part& in = parts_[part];
  // Stores into the run cannot change these, which g++ does not know of members.
  const std::size_t count = std::min(kBackgroundRun, static_cast<std::size_t>(pixels.count));
  const std::int32_t face_rows = in.tables.face_rows;
  run.count = count;
  const PinholeParams view = in.tables.grid.warp.view, model = in.tables.camera;
  const float ray_y = (static_cast<float>(pixels.y) - view.center_px.y) / view.focal_px.y;
  const float to_ray = 1 / view.focal_px.x, step = static_cast<float>(pixels.step);
  const float first_x = static_cast<float>(pixels.x0) - view.center_px.x;
  alignas(64) std::array<float, kBackgroundRun> w;
  const float* from_w = w_.row(pixels.y) + pixels.x0;
  for (std::size_t i = 0; i < count; ++i) w[i] = from_w[i * static_cast<std::size_t>(pixels.step)];
  // The face whose axis is nearest: the largest z of the point times its own w.
  alignas(64) std::array<float, kBackgroundRun> qx, qy, qz;
  std::fill_n(run.face.begin(), count, 0);
  std::fill_n(qz.begin(), count, -std::numeric_limits<float>::infinity());
  const Interval range = range_of(std::span(w).first(count));
  const float last_x = first_x + step * static_cast<float>(static_cast<int>(count) - 1);
  const auto z_on_run = [&](const Face& face) {
    const glm::mat3& r = face.from_camera;
    return sum_of(r[1].z * ray_y + r[2].z, r[0].z, first_x * to_ray, last_x * to_ray,
                  face.camera_m.z, range.least, range.most);
  };
  float surely_z = -std::numeric_limits<float>::infinity();
  for (const Face& face : in.faces) surely_z = std::max(surely_z, z_on_run(face).least);
  for (std::size_t f = 0; f < in.faces.size(); ++f) {
    if (z_on_run(in.faces[f]).most < surely_z) continue;  // it is the nearest of no pixel
    const glm::mat3 r = in.faces[f].from_camera;
    const glm::vec3 t = in.faces[f].camera_m, row = r[1] * ray_y + r[2];
    const auto face = static_cast<std::int32_t>(f);
    for (std::size_t i = 0; i < count; ++i) {
      const float ray_x = (first_x + step * static_cast<float>(static_cast<int>(i))) * to_ray;
      const float face_x = r[0].x * ray_x + row.x + t.x * w[i];
      const float face_y = r[0].y * ray_x + row.y + t.y * w[i];
      const float face_z = r[0].z * ray_x + row.z + t.z * w[i];
      const bool nearer = face_z > qz[i];
      qx[i] = nearer ? face_x : qx[i];
      qy[i] = nearer ? face_y : qy[i];
      qz[i] = nearer ? face_z : qz[i];
      run.face[i] = nearer ? face : run.face[i];
    }
  }
  const float most_u = static_cast<float>(in.w.width() - 2) - 0.5F;
  const float most_v = static_cast<float>(face_rows) - 0.5F;
  const auto stride = static_cast<std::int32_t>(in.w.stride());
  for (std::size_t i = 0; i < count; ++i) {
    const float inverse = 1 / qz[i];
    const float u = model.focal_px.x * qx[i] * inverse + model.center_px.x;
    const float v = model.focal_px.y * qy[i] * inverse + model.center_px.y;
    const bool inside =
        (w[i] > 0) & (qz[i] > 0) & (u >= -0.5F) & (v >= -0.5F) & (u < most_u) & (v < most_v);
    run.u_px[i] = u;
    run.v_px[i] = v;
    // The tables have borders of one pixel that know nothing.
    const auto column = static_cast<std::int32_t>(inside ? u + 1.5F : 0.0F);
    const auto line = static_cast<std::int32_t>(inside ? v + 1.5F : 0.0F);
    const std::int32_t top = inside ? run.face[i] * (face_rows + 2) : 0;
    run.at[i] = (top + line) * stride + column;
  }
  if (what == Find::kPlace) return;
  std::fill_n(run.part.begin(), count, static_cast<std::int32_t>(part));
  for (std::size_t i = 0; i < count; ++i) {
    run.z_m[i] = qz[i] / w[i];
    run.score[i] = qz[i] / (qx[i] * qx[i] + qy[i] * qy[i] + qz[i] * qz[i]);
  }
}

/// Whether the model of a pixel saw its surface, not another one before it.
bool MovingBackground::shows(const Run& run, std::size_t i) const {
  if (run.at[i] == 0) return false;
  const float seen_w = parts_[static_cast<std::size_t>(run.part[i])].w.row(0)[run.at[i]];
  return seen_w > 0 && std::abs(1 - run.z_m[i] * seen_w) <= kHiddenPart;
}

void MovingBackground::keep_better(const Run& other, Run& run) const {
  for (std::size_t i = 0; i < run.count; ++i) {
    if (!shows(other, i) || (shows(run, i) && run.score[i] >= other.score[i])) continue;
    run.u_px[i] = other.u_px[i], run.v_px[i] = other.v_px[i], run.z_m[i] = other.z_m[i];
    run.face[i] = other.face[i], run.part[i] = other.part[i], run.at[i] = other.at[i];
    run.score[i] = other.score[i];
  }
}

void MovingBackground::normals(int x0, int y, std::span<PackedNormal> out, int step) const {
  Run run;
  find({x0, y, static_cast<int>(out.size()), step}, run);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const PackedNormal* model_normal = parts_[p].normal.row(0);
    const auto is_of = [&](std::size_t i) {
      return parts_.size() == 1 || run.part[i] == static_cast<std::int32_t>(p);
    };
    std::array<PackedNormal, kBackgroundRun> turned{};
    for (std::size_t i = 0; i < run.count; ++i)
      if (is_of(i)) turned[i] = model_normal[run.at[i]];
    rotate(glm::transpose(parts_[p].faces.front().from_camera), std::span(turned).first(run.count));
    for (std::size_t i = 0; i < run.count; ++i)
      if (is_of(i)) out[i] = turned[i];
  }
}

/// Colours of a run and, as x, their spread or kUnknownColor.
void MovingBackground::colors_of(const Part& part, const Run& run,
                                 std::array<Rgbx16, kMostColumns>& out) {
  const float* seen_w = part.w.row(0);
  // In the table of colours, whose faces have a border too.
  const auto factor = static_cast<float>(part.color_factor);
  const int table_rows = part.color_factor * part.tables.face_rows + 2;
  const auto stride = static_cast<std::uint32_t>(part.color.stride());
  const Rgbx16* table = part.color.row(0);
  std::array<Tap, kBackgroundRun> taps;
  std::array<bool, kBackgroundRun> known;
  for (std::size_t i = 0; i < run.count; ++i) {
    const std::int32_t at = run.at[i];
    // The model saw another surface before this one: that one's colour says nothing about it.
    const bool hidden = seen_w[at] > 0 && std::abs(1 - run.z_m[i] * seen_w[at]) > kHiddenPart;
    known[i] = at != 0 && !hidden;
    const float u_px = (run.u_px[i] + 0.5F) * factor + 0.5F;
    const float v_px =
        (run.v_px[i] + 0.5F) * factor + 0.5F + static_cast<float>(run.face[i] * table_rows);
    const float x = known[i] ? u_px : 0, y = known[i] ? v_px : 0;
    const Split u = split(x, part.color.width()), v = split(y, part.color.height());
    taps[i] = {v.pixel * stride + u.pixel, u.fraction, v.fraction};
    const auto column = static_cast<std::uint32_t>(static_cast<std::int32_t>(x + 0.5F));
    const auto line = static_cast<std::uint32_t>(static_cast<std::int32_t>(y + 0.5F));
    known[i] = known[i] && table[line * stride + column].x != kUnknownColor;
  }
  std::fill_n(taps.begin() + run.count, (kBackgroundRun - run.count) % kBlendPx, Tap{});
  for (std::size_t i = 0; i < run.count; i += kBlendPx)
    blend_run(&taps[i], table, part.color.stride(), &out[i]);
  for (std::size_t i = 0; i < run.count; ++i)
    if (!known[i]) out[i].x = kUnknownColor;
}

void MovingBackground::draw_color(int x0, int y, int width) {
  Rgbf* color = color_.row(y) + x0;
  float* color_sigma = color_sigma_.row(y) + x0;
  const std::size_t count = std::min(kBackgroundRun, static_cast<std::size_t>(width));
  std::fill_n(color, count, Rgbf{-1, -1, -1});
  std::fill_n(color_sigma, count, 0.0F);
  std::array<float, kBackgroundRun> best;  // score of the model whose colour a pixel has
  std::fill_n(best.begin(), count, 0.0F);
  std::array<Rgbx16, kBackgroundRun> found;
  Run run;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    if (parts_[part].color.empty()) continue;
    find_in(part, {x0, y, width, 1}, Find::kAll, run);
    colors_of(parts_[part], run, found);
    for (std::size_t i = 0; i < run.count; ++i) {
      if (parts_.size() > 1 && !(shows(run, i) && run.score[i] > best[i])) continue;
      const Rgbx16 c = found[i];
      if (c.x == kUnknownColor) continue;
      best[i] = run.score[i];
      color[i] = {c.r / kLinearOne, c.g / kLinearOne, c.b / kLinearOne};
      color_sigma[i] = c.x / kLinearOne;
    }
  }
}

}  // namespace mixrig::render::cpu
