// SPDX-License-Identifier: Apache-2.0
// Pass background: finds pixels of the view in the models, with their normals and colours.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "host/render/cpu/background/background_run.h"
#include "host/render/cpu/plate/bilinear.h"

namespace mixrig::render::cpu {
namespace {

/// An interval that holds all values that a face's z times w takes on a run.
struct Interval {
  float least, most;
};
Interval sum_of(float constant, float a, float a_from, float a_to, float b, float b_from,
                float b_to) {
  // By value: std::minmax of two temporaries would return dangling references.
  const auto [a0, a1] = std::minmax({a * a_from, a * a_to});
  const auto [b0, b1] = std::minmax({b * b_from, b * b_to});
  constexpr float kRounding = 1e-5F;
  const float slack =
      kRounding * (std::abs(constant) + std::abs(a0) + std::abs(a1) + std::abs(b0) + std::abs(b1));
  return {constant + a0 + b0 - slack, constant + a1 + b1 + slack};
}

/// Copies every `step`-th value of `from`, then repeats the last one up to a whole register;
/// returns the range. Precondition: `count` is not 0.
Interval read_every(const float* from, int step, std::size_t count,
                    std::array<float, kBackgroundRun>& to) {
  if (step == 1)
    std::copy_n(from, count, to.begin());
  else
    for (std::size_t i = 0; i < count; ++i) to[i] = from[i * static_cast<std::size_t>(step)];
  const std::size_t end = (count + kLanes - 1) / kLanes * kLanes;
  std::fill(to.begin() + count, to.begin() + end, to[count - 1]);
  FloatLanes least = load<FloatLanes>(to.data()), most = least;
  for (std::size_t i = kLanes; i < end; i += kLanes) {
    least = min(least, load<FloatLanes>(&to[i]));
    most = max(most, load<FloatLanes>(&to[i]));
  }
  return {least_of(least), -least_of(-most)};
}

/// Pixel and 1/256 fraction of each coordinate, as by split().
struct SplitLanes {
  IntLanes pixel, fraction;
};
SplitLanes split(FloatLanes at, int size) {
  const FloatLanes last = FloatLanes{} + static_cast<float>(size - 1);
  const FloatLanes scaled = 256 * min(max(at, FloatLanes{}), last);
  const IntLanes whole = truncate(scaled);
  const IntLanes fixed = whole - (scaled - to_float(whole) >= 0.5F);  // true is -1: rounds up
  const IntLanes most = IntLanes{} + std::max(0, size - 2), pixel = fixed >> 8;
  const IntLanes inside = pixel < most ? pixel : most;
  return {inside, fixed - 256 * inside};
}

/// Interleaves the values of a and b, from their first or second half.
template <int kFirst, std::size_t... i>
IntLanes in_turn(IntLanes a, IntLanes b, std::index_sequence<i...>) {
  return __builtin_shufflevector(a, b,
                                 (kFirst + static_cast<int>(i / 2) + (i % 2 == 0 ? 0 : kLanes))...);
}

/// Stores a tap for each lane.
void store_taps(const SplitLanes& x, const SplitLanes& y, std::int32_t stride, Tap* to) {
  static_assert(sizeof(Tap) == 2 * sizeof(std::int32_t));
  const IntLanes offset = y.pixel * stride + x.pixel, fractions = x.fraction | (y.fraction << 16);
  constexpr auto kAll = std::make_index_sequence<kLanes>{};
  store(to, in_turn<0>(offset, fractions, kAll));
  store(to + kLanes / 2, in_turn<kLanes / 2>(offset, fractions, kAll));
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

/// Finds pixels in a model, in the face whose axis is nearest.
void MovingBackground::find_in(std::size_t part, const Pixels& pixels, Find what, Run& run) const {
  const Part& in = parts_[part];
  // Local copies: g++ cannot know that stores into the run do not change these values.
  const std::size_t count = std::min(kBackgroundRun, static_cast<std::size_t>(pixels.count));
  const std::int32_t face_rows = in.tables.face_rows;
  run.count = count;
  const PinholeParams view = in.tables.grid.warp.view, model = in.tables.camera;
  const float ray_y = (static_cast<float>(pixels.y) - view.center_px.y) / view.focal_px.y;
  const float to_ray = 1 / view.focal_px.x, step = static_cast<float>(pixels.step);
  const float first_x = static_cast<float>(pixels.x0) - view.center_px.x;
  alignas(64) std::array<float, kBackgroundRun> w;
  const Interval range = read_every(w_.row(pixels.y) + pixels.x0, pixels.step, count, w);
  // Chooses the face with the nearest axis: the one with the largest z of the point (times its w).
  alignas(64) std::array<float, kBackgroundRun> qx, qy, qz;
  std::fill_n(run.face.begin(), count, 0);
  std::fill_n(qz.begin(), count, -std::numeric_limits<float>::infinity());
  const float last_x = first_x + step * static_cast<float>(static_cast<int>(count) - 1);
  const auto z_on_run = [&](const Face& face) {
    const glm::mat3& r = face.from_camera;
    return sum_of(r[1].z * ray_y + r[2].z, r[0].z, first_x * to_ray, last_x * to_ray,
                  face.camera_m.z, range.least, range.most);
  };
  float surely_z = -std::numeric_limits<float>::infinity();
  for (const Face& face : in.faces) surely_z = std::max(surely_z, z_on_run(face).least);
  for (std::size_t f = 0; f < in.faces.size(); ++f) {
    if (z_on_run(in.faces[f]).most < surely_z) continue;  // no pixel has this face as its nearest
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
    // The tables have borders of one unknown pixel.
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

/// Whether the model saw the pixel's surface and not another one before it.
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

/// Looks up the colours of a run with, as x, their sigma or kUnknownColor.
void MovingBackground::colors_of(const Part& part, const Run& run,
                                 std::array<Rgbx16, kMostColumns>& out) {
  // Rows in the table of colours, whose faces have a border too.
  const auto factor = static_cast<float>(part.color_factor);
  const auto table_rows = static_cast<float>(part.color_factor * part.tables.face_rows + 2);
  const auto stride = static_cast<std::int32_t>(part.color.stride());
  const Rgbx16* table = part.color.row(0);
  constexpr int kBytes = sizeof(Rgbx16), kBytesToX = offsetof(Rgbx16, b);
  std::array<Tap, kBackgroundRun> taps;
  alignas(64) std::array<std::int32_t, kBackgroundRun> known;
  for (std::size_t i = 0; i < run.count; i += kLanes) {
    const IntLanes at = run.places(i);
    // Where the model saw another surface in front, its colour is not this surface's.
    const FloatLanes seen_w = gather(part.w.row(0), at);
    const FloatLanes off = abs(1 - load<FloatLanes>(&run.z_m[i]) * seen_w);
    const IntLanes is_known = (at != 0) & ~((seen_w > 0) & (off > kHiddenPart));
    const auto in_table = [&](const auto& px) {
      return (load<FloatLanes>(&px[i]) + 0.5F) * factor + 0.5F;
    };
    const FloatLanes top = to_float(load<IntLanes>(&run.face[i])) * table_rows;
    const FloatLanes x = is_known ? in_table(run.u_px) : FloatLanes{};
    const FloatLanes y = is_known ? in_table(run.v_px) + top : FloatLanes{};
    store_taps(split(x, part.color.width()), split(y, part.color.height()), stride, &taps[i]);
    const IntLanes nearest = truncate(y + 0.5F) * stride + truncate(x + 0.5F);
    const IntLanes spread = (gather_bytes(table, nearest * kBytes + kBytesToX) >> 16) & 0xFFFF;
    store(&known[i], is_known & (spread != kUnknownColor));
  }
  for (std::size_t i = 0; i < run.count; i += kBlendPx)
    blend_run(&taps[i], table, part.color.stride(), &out[i]);
  for (std::size_t i = 0; i < run.count; ++i)
    if (known[i] == 0) out[i].x = kUnknownColor;
}

/// Writes colours one after another, negative where unknown, and their sigma.
void MovingBackground::find_colors(const Pixels& pixels, Rgbf* color, float* sigma) const {
  const std::size_t count = std::min(kBackgroundRun, static_cast<std::size_t>(pixels.count));
  std::fill_n(color, count, Rgbf{-1, -1, -1});
  std::fill_n(sigma, count, 0.0F);
  std::array<float, kBackgroundRun> best;  // score of the model that gave the colour
  std::fill_n(best.begin(), count, 0.0F);
  std::array<Rgbx16, kBackgroundRun> found;
  constexpr float kPerLinear = 1 / kLinearOne;
  Run run;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    if (parts_[part].color.empty()) continue;
    find_in(part, pixels, Find::kAll, run);
    colors_of(parts_[part], run, found);
    for (std::size_t i = 0; i < run.count; ++i) {
      if (parts_.size() > 1 && !(shows(run, i) && run.score[i] > best[i])) continue;
      const Rgbx16 c = found[i];
      if (c.x == kUnknownColor) continue;
      best[i] = run.score[i];
      color[i] = {c.r * kPerLinear, c.g * kPerLinear, c.b * kPerLinear};
      sigma[i] = c.x * kPerLinear;
    }
  }
}

void MovingBackground::draw_color(int x0, int y, int count, int step) {
  Rgbf* const color = color_.row(y) + x0;
  float* const sigma = color_sigma_.row(y) + x0;
  const Pixels pixels{x0, y, count, step};
  if (step == 1) return find_colors(pixels, color, sigma);
  std::array<Rgbf, kBackgroundRun> colors;
  std::array<float, kBackgroundRun> sigmas;
  find_colors(pixels, colors.data(), sigmas.data());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    color[i * static_cast<std::size_t>(step)] = colors[i],
              sigma[i * static_cast<std::size_t>(step)] = sigmas[i];
}

void MovingBackground::colors(int x0, int y, std::span<Rgbf> out) const {
  std::array<float, kBackgroundRun> sigmas;
  find_colors({x0, y, static_cast<int>(out.size()), 1}, out.data(), sigmas.data());
}

}  // namespace mixrig::render::cpu
