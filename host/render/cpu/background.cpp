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
/// Pixels along an axis that share the spread of the depth: it differs little from one to the next.
constexpr int kSpreadStep = 2;

Size spread_size(Size view) {
  return {(view.width + kSpreadStep - 1) / kSpreadStep,
          (view.height + kSpreadStep - 1) / kSpreadStep};
}

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

/// Faces of the model below one another, each with a border of one: its pixel (x, y) lies at
/// (x + 1, y + 1).
template <typename T, typename Make>
Image<T> padded(Size images, int face_rows, T border, Make&& make) {
  const int faces = images.height / face_rows;
  Image<T> out({images.width + 2, faces * (face_rows + 2)}, border);
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) out.row(y + 1 + y / face_rows * 2)[x + 1] = make(x, y);
  return out;
}

/// Linear colours and, as x, their spread or kUnknownColor.
Image<Rgbx16> linear_table(ImageView<const Rgbx8> colors, int face_rows) {
  const auto& linear = srgb_to_linear();
  constexpr float kPerByte = kLinearOne * kMostColorSpread / (kUnknownColorByte - 1);
  const auto decoded = [&](int x, int y) -> Rgbx16 {
    const Rgbx8& c = colors.row(y)[x];
    const auto spread = static_cast<std::uint16_t>(kPerByte * c.x + 0.5F);
    return {linear[c.r], linear[c.g], linear[c.b],
            c.x == kUnknownColorByte ? kUnknownColor : spread};
  };
  Image<Rgbx16> out = padded<Rgbx16>(colors.size, face_rows, {0, 0, 0, kUnknownColor}, decoded);
  // The colours of the borders only serve interpolation.
  const auto repeat = [&](int x, int y, int from_x, int from_y) {
    const Rgbx16 c = out.at(from_x, from_y);
    out.at(x, y) = {c.r, c.g, c.b, c.x};
  };
  const int right = out.width() - 1;
  for (int top = 0; top < out.height(); top += face_rows + 2) {
    const int bottom = top + face_rows + 1;
    for (int x = 1; x < right; ++x) repeat(x, top, x, top + 1), repeat(x, bottom, x, bottom - 1);
    for (int y = top; y <= bottom; ++y) repeat(0, y, 1, y), repeat(right, y, right - 1, y);
  }
  return out;
}

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

// One index serves the tables of depth, spread and normals.
static_assert(sizeof(float) == sizeof(PackedNormal));

/// Where up to kRun pixels of a row of the view lie in the faces of a model.
struct MovingBackground::Run {
  alignas(64) std::array<float, kRun> u_px, v_px;
  alignas(64) std::array<float, kRun> z_m;    ///< in axes of the face
  alignas(64) std::array<float, kRun> score;  ///< of models, the larger the better it saw the pixel
  alignas(64) std::array<std::int32_t, kRun> face;
  alignas(64) std::array<std::int32_t, kRun> part;  ///< which model
  alignas(64)
      std::array<std::int32_t, kRun> at;  ///< nearest pixel of the tables of 4-byte values; 0: none
  std::size_t count = 0;
};

/// What of a Run is found: `z_m`, `score` and `part` too, or only where it lies.
enum class MovingBackground::Find { kPlace, kAll };

MovingBackground::Part MovingBackground::make_part(Crew& crew, const CompositorSetup& setup,
                                                   const BackgroundModel& from, Normals normals) {
  ModelTables tables = make_model_tables(setup, from, normals == Normals::kMake);
  const Size grid = tables.grid.tof_size;
  Part part{std::move(tables), {}, WarpScratch(grid), {}, from.color_factor, {}, {}, {}};
  ModelTables& t = part.tables;
  part.faces.reserve(from.world_from_face.size());
  for (std::size_t i = 0; i < from.world_from_face.size(); ++i) {
    Face& face = part.faces.emplace_back(Face{from.world_from_face[i], TofGrid(grid)});
    correct(crew, t.grid.correct, t.grid.tof_ray, t.depth_m[i], face.grid);
  }
  const Size size = from.depth_m.size;
  const int rows = t.face_rows;
  part.w = padded(size, rows, 0.0F, [&](int x, int y) { return t.w.row(y)[x]; });
  part.sigma_m = padded(size, rows, 0.0F, [&](int x, int y) {
    return from.depth_sigma_m.empty() ? 0 : from.depth_sigma_m.row(y)[x];
  });
  if (normals == Normals::kMake)
    part.normal =
        padded(size, rows, PackedNormal{}, [&](int x, int y) { return t.normal.row(y)[x]; });
  t.depth_m.clear();
  t.w = {};
  t.normal = {};
  if (!from.color.empty()) part.color = linear_table(from.color, from.color_factor * rows);
  return part;
}

MovingBackground::MovingBackground(Crew& crew, const CompositorSetup& setup, Normals normals)
    : key_(setup.key),
      noise_(noise_params(setup.noise)),
      has_color_(has_model_color(setup)),
      w_(with_margin(setup.view.size_px)),
      row_most_w_(setup.view.size_px),
      depth_sigma_m_(spread_size(setup.view.size_px)),
      depth_m_(setup.view.size_px) {
  for (const BackgroundModel& model : setup.background_models) {
    parts_.push_back(make_part(crew, setup, model, normals));
    limit_radius_px_ = std::max(limit_radius_px_, parts_.back().tables.limit_radius_px);
  }
  if (!has_color_) return;
  color_.reset(setup.view.size_px, {-1, -1, -1});
  color_sigma_.reset(setup.view.size_px);
}

void MovingBackground::see_through(const CompositorSetup& setup) {
  limit_radius_px_ = 1;
  for (Part& part : parts_) {
    set_view(setup, part.tables);
    limit_radius_px_ = std::max(limit_radius_px_, part.tables.limit_radius_px);
  }
}

void MovingBackground::draw(Crew& crew, const geometry::Pose& world_from_camera, Tables& tables) {
  Before before = Before::kNothing;
  for (Part& part : parts_)
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
      Face& face = part.faces[i];
      const FacePose pose = face_pose(face.world_from_face, world_from_camera);
      face.from_camera = glm::mat3(pose.face_from_camera);
      face.camera_m = glm::vec3(pose.face_from_camera[3]);
      if (!may_show(part.tables, i, pose)) continue;
      part.tables.grid.warp.camera_from_tof = pose.camera_from_face;
      warp(crew, part.tables.grid, face.grid, part.scratch, w_, before);
      before = Before::kSurfaces;
    }
  if (before == Before::kNothing) w_.fill(0);
  const int height = depth_m_.height(), width = depth_m_.width();
  crew.rows(height, kBackgroundGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      look_up(y);
      most_within(w_.row(y), width, limit_radius_px_, row_most_w_.row(y));
    }
  });
  crew.rows(height, kBackgroundGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) limit_row(y, tables.key_limit_w.row(y));
  });
}

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
  const std::size_t count = std::min(kRun, static_cast<std::size_t>(pixels.count));
  const std::int32_t face_rows = in.tables.face_rows;
  run.count = count;
  const PinholeParams view = in.tables.grid.warp.view, model = in.tables.camera;
  const float ray_y = (static_cast<float>(pixels.y) - view.center_px.y) / view.focal_px.y;
  const float to_ray = 1 / view.focal_px.x, step = static_cast<float>(pixels.step);
  const float first_x = static_cast<float>(pixels.x0) - view.center_px.x;
  alignas(64) std::array<float, kRun> w;
  const float* from_w = w_.row(pixels.y) + pixels.x0;
  for (std::size_t i = 0; i < count; ++i) w[i] = from_w[i * static_cast<std::size_t>(pixels.step)];
  // The face whose axis is nearest: the largest z of the point times its own w.
  alignas(64) std::array<float, kRun> qx, qy, qz;
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

/// Depths of a row; of every other row and column the spread.
void MovingBackground::look_up(int y) {
  const int width = depth_m_.width();
  const float* w = w_.row(y);
  float* depth_m = depth_m_.row(y);
  for (int x = 0; x < width; ++x) depth_m[x] = w[x] > 0 ? 1 / w[x] : 0;
  if (y % kSpreadStep != 0) return;
  float* sigma_m = depth_sigma_m_.row(y / kSpreadStep);
  Run run;
  constexpr int kColumns = kMostColumns * kSpreadStep;
  for (int x0 = 0; x0 < width; x0 += kColumns, sigma_m += kMostColumns) {
    const int pixels = std::min(kColumns, width - x0);
    find({x0, y, (pixels + kSpreadStep - 1) / kSpreadStep, kSpreadStep}, run);
    if (parts_.size() == 1) {
      const float* model_sigma_m = parts_[0].sigma_m.row(0);
      for (std::size_t i = 0; i < run.count; ++i) sigma_m[i] = model_sigma_m[run.at[i]];
      continue;
    }
    for (std::size_t i = 0; i < run.count; ++i)
      sigma_m[i] = parts_[static_cast<std::size_t>(run.part[i])].sigma_m.row(0)[run.at[i]];
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
    std::array<PackedNormal, kRun> turned{};
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
  std::array<Tap, kRun> taps;
  std::array<bool, kRun> known;
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
  std::fill_n(taps.begin() + run.count, (kRun - run.count) % kBlendPx, Tap{});
  for (std::size_t i = 0; i < run.count; i += kBlendPx)
    blend_run(&taps[i], table, part.color.stride(), &out[i]);
  for (std::size_t i = 0; i < run.count; ++i)
    if (!known[i]) out[i].x = kUnknownColor;
}

void MovingBackground::draw_color(int x0, int y, int width) {
  Rgbf* color = color_.row(y) + x0;
  float* color_sigma = color_sigma_.row(y) + x0;
  const std::size_t count = std::min(kRun, static_cast<std::size_t>(width));
  std::fill_n(color, count, Rgbf{-1, -1, -1});
  std::fill_n(color_sigma, count, 0.0F);
  std::array<float, kRun> best;  // score of the model whose colour a pixel has
  std::fill_n(best.begin(), count, 0.0F);
  std::array<Rgbx16, kRun> found;
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

/// As key_limit(), with the largest w of the rows around.
void MovingBackground::limit_row(int y, float* limit_w) const {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  // What is stored cannot change these, which g++ does not know of members.
  const NoiseParams noise = noise_;
  const float least_m = key_.threshold_m, noise_factor = key_.noise_factor;
  const int width = depth_m_.width(), height = depth_m_.height();
  const int first = std::max(0, y - limit_radius_px_);
  const int last = std::min(height - 1, y + limit_radius_px_);
  std::copy_n(row_most_w_.row(first), width, limit_w);
  for (int j = first + 1; j <= last; ++j) {
    const float* other = row_most_w_.row(j);
    for (int x = 0; x < width; ++x) limit_w[x] = limit_w[x] < other[x] ? other[x] : limit_w[x];
  }
  const float* w = w_.row(y);
  const float* spread_m = depth_sigma_m_.row(y / kSpreadStep);
  std::array<float, kRun> spread;
  for (int x0 = 0; x0 < width; x0 += kMostColumns) {
    const int count = std::min(kMostColumns, width - x0);
    for (int i = 0; i < kMostColumns; ++i) spread[i] = spread_m[(x0 + i) / kSpreadStep];
    for (int i = 0; i < count; ++i) {
      float& limit = limit_w[x0 + i];
      const float z = 1 / limit;
      const float sigma = noise.sigma_m(z);
      const float by_noise = noise_factor * std::sqrt(spread[i] * spread[i] + sigma * sigma);
      const float threshold = least_m > by_noise ? least_m : by_noise;
      limit = (w[x0 + i] > 0) & (threshold < z) ? 1 / (z - threshold) : kNever;
    }
  }
}

}  // namespace mixrig::render::cpu
