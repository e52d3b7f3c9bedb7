// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "host/render/cpu/background/background_run.h"
#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/warp/draw_quads.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kBackgroundGrain = 16;
/// Pixels along an axis that share one sigma of the depth, which differs little between neighbours.
constexpr int kSpreadStep = 2;

Size spread_size(Size view) {
  return {(view.width + kSpreadStep - 1) / kSpreadStep,
          (view.height + kSpreadStep - 1) / kSpreadStep};
}

/// Loads kLanes / 2 values of 4 bytes and repeats each twice. What follows them may belong to the
/// row of another thread.
template <std::size_t... i>
FloatLanes twice_each(const void* from, std::index_sequence<i...>) {
  using Half = float __attribute__((vector_size(4 * kLanes / kSpreadStep)));
  const auto half = load<Half>(from);
  return __builtin_shufflevector(half, half, static_cast<int>(i / kSpreadStep)...);
}

/// Term of each lane's plane; mostly one plane serves all lanes.
FloatLanes plane_term(const std::vector<float>& terms, IntLanes number) {
  if (!any(number != number[0])) return FloatLanes{} + terms[static_cast<std::size_t>(number[0])];
  return gather(terms.data(), number);
}

/// Largest value of each column over the rows [first, last]. Rows are padded to whole registers.
void most_of_columns(const Image<float>& from, int width, int first, int last, float* to) {
  for (int x = 0; x < width; x += kLanes) {
    FloatLanes most = load<FloatLanes>(from.row(first) + x);
    for (int y = first + 1; y <= last; ++y) most = max(most, load<FloatLanes>(from.row(y) + x));
    store(to + x, most);
  }
}

/// Largest value of `from` within `radius` of each of the kLanes pixels from x on, along the row.
FloatLanes most_within(const float* from, int x, int width, int radius) {
  if (x >= radius && x + kLanes + radius <= width) {
    FloatLanes most = load<FloatLanes>(from + x - radius);
    for (int d = 1 - radius; d <= radius; ++d) most = max(most, load<FloatLanes>(from + x + d));
    return most;
  }
  FloatLanes most = float_lanes(from, x - radius, width);
  for (int d = 1 - radius; d <= radius; ++d) most = max(most, float_lanes(from, x + d, width));
  return most;
}

/// Copies the model's faces, one below the other, and gives each a border of one pixel: its pixel
/// (x, y) lies at (x + 1, y + 1).
template <typename T, typename Make>
Image<T> padded(Size images, int face_rows, T border, Make&& make) {
  const int faces = images.height / face_rows;
  Image<T> out({images.width + 2, faces * (face_rows + 2)}, border);
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) out.row(y + 1 + y / face_rows * 2)[x + 1] = make(x, y);
  return out;
}

/// Converts to linear colours with, as x, their sigma or kUnknownColor.
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
  // The borders' colours only serve interpolation.
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

}  // namespace

// One index serves the tables of depth, sigma and normals.
static_assert(sizeof(float) == sizeof(PackedNormal));

MovingBackground::Part MovingBackground::make_part(Crew& crew, const CompositorSetup& setup,
                                                   const BackgroundModel& from,
                                                   DrawnFor drawn_for) {
  const bool composites = drawn_for == DrawnFor::kComposites;
  ModelTables tables = make_model_tables(setup, from, composites);
  const Size grid = tables.grid.tof_size;
  Part part{std::move(tables), {}, WarpScratch(grid), {}, from.color_factor, {}, {}, {}, 0};
  ModelTables& t = part.tables;
  part.faces.reserve(from.world_from_face.size());
  for (std::size_t i = 0; i < from.world_from_face.size(); ++i) {
    Face& face = part.faces.emplace_back(Face{from.world_from_face[i], TofGrid(grid)});
    correct(crew, t.grid.correct, t.grid.tof_ray, t.depth_m[i], face.grid);
  }
  const Size size = from.depth_m.size;
  const int rows = t.face_rows;
  part.w = padded(size, rows, 0.0F, [&](int x, int y) { return t.w.row(y)[x]; });
  if (composites) {
    part.sigma_m = padded(size, rows, 0.0F, [&](int x, int y) {
      return from.depth_sigma_m.empty() ? 0 : from.depth_sigma_m.row(y)[x];
    });
    part.normal =
        padded(size, rows, PackedNormal{}, [&](int x, int y) { return t.normal.row(y)[x]; });
  }
  t.depth_m.clear();
  t.w = {};
  t.normal = {};
  if (!from.color.empty()) part.color = linear_table(from.color, from.color_factor * rows);
  return part;
}

MovingBackground::MovingBackground(Crew& crew, const CompositorSetup& setup, DrawnFor drawn_for)
    : key_(setup.key),
      noise_(noise_params(setup.noise)),
      has_color_(has_model_color(setup)),
      w_(with_margin(setup.view.size_px)),
      depth_m_(setup.view.size_px) {
  for (const BackgroundModel& model : setup.background_models) {
    parts_.push_back(make_part(crew, setup, model, drawn_for));
    parts_.back().first_plane = static_cast<std::int32_t>(plane_w_[0].size());
    const std::size_t planes = parts_.back().tables.planes.size();
    for (std::vector<float>& w : plane_w_) w.resize(w.size() + planes + 1);
    limit_radius_px_ = std::max(limit_radius_px_, parts_.back().tables.limit_radius_px);
  }
  if (drawn_for == DrawnFor::kPictures) return;
  column_most_w_.reset({setup.view.size_px.width, crew.threads()});
  depth_sigma_m_.reset(spread_size(setup.view.size_px));
  if (plane_w_[0].size() > parts_.size()) {
    plane_.reset(spread_size(setup.view.size_px));
    light_depth_m_.reset(setup.view.size_px);
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

void MovingBackground::draw_surfaces(Crew& crew, const geometry::Pose& world_from_camera) {
  Before before = Before::kNothing;
  for (Part& part : parts_)
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
      Face& face = part.faces[i];
      const FacePose pose = face_pose(face.world_from_face, world_from_camera);
      face.pose = pose;
      face.from_camera = glm::mat3(pose.face_from_camera);
      face.camera_m = glm::vec3(pose.face_from_camera[3]);
      if (!may_show(part.tables, i, pose)) continue;
      part.tables.grid.warp.camera_from_tof = pose.camera_from_face;
      warp(crew, part.tables.grid, face.grid, part.scratch, w_, before);
      before = Before::kSurfaces;
    }
  if (before == Before::kNothing) w_.fill(0);
}

void MovingBackground::draw(Crew& crew, const geometry::Pose& world_from_camera) {
  draw_surfaces(crew, world_from_camera);
  crew.rows(depth_m_.height(), kBackgroundGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) find_depth(y);
  });
}

void MovingBackground::draw(Crew& crew, const geometry::Pose& world_from_camera, Tables& tables,
                            bool with_light) {
  static_assert(kBackgroundGrain % kSpreadStep == 0);
  draw_surfaces(crew, world_from_camera);
  with_light = with_light && !light_depth_m_.empty();
  if (with_light) place_planes();
  crew.rows_by_worker(depth_m_.height(), kBackgroundGrain, [&](int worker, int begin, int end) {
    for (int y = begin; y < end; ++y) {
      find_depth(y);
      if (y % kSpreadStep == 0) find_spread(y);
      if (with_light) light_row(y);
      limit_row(y, column_most_w_.row(worker), tables.key_limit_w.row(y));
    }
  });
}

/// Writes the depth of a row; rows are padded to whole registers.
void MovingBackground::find_depth(int y) {
  const int width = depth_m_.width();
  const float* w = w_.row(y);
  float* depth_m = depth_m_.row(y);
  for (int x = 0; x < width; x += kLanes) {
    const FloatLanes w_lanes = load<FloatLanes>(w + x);
    store(depth_m + x, w_lanes > 0 ? 1 / w_lanes : FloatLanes{});
  }
}

/// Writes the sigma for every kSpreadStep-th column of a row.
void MovingBackground::find_spread(int y) {
  const int width = depth_m_.width();
  float* sigma_m = depth_sigma_m_.row(y / kSpreadStep);
  Run run;
  constexpr int kColumns = kMostColumns * kSpreadStep;
  for (int x0 = 0; x0 < width; x0 += kColumns, sigma_m += kMostColumns) {
    const int pixels = std::min(kColumns, width - x0);
    find({x0, y, (pixels + kSpreadStep - 1) / kSpreadStep, kSpreadStep}, run);
    if (!plane_.empty()) find_planes(run, plane_.row(y / kSpreadStep) + x0 / kSpreadStep);
    if (parts_.size() == 1) {
      const float* model_sigma_m = parts_[0].sigma_m.row(0);
      for (std::size_t i = 0; i < run.count; i += kLanes)
        store(sigma_m + i, gather(model_sigma_m, run.places(i)));
      continue;
    }
    for (std::size_t i = 0; i < run.count; ++i)
      sigma_m[i] = parts_[static_cast<std::size_t>(run.part[i])].sigma_m.row(0)[run.at[i]];
  }
}

void MovingBackground::place_planes() {
  std::array<glm::vec3, kMostLightPlanes + 1> planes;
  std::array<FacePose, kMostFaces> poses;
  for (const Part& part : parts_) {
    for (std::size_t f = 0; f < part.faces.size(); ++f) poses[f] = part.faces[f].pose;
    planes_in_camera(part.tables, std::span(poses).first(part.faces.size()), planes);
    const auto first = static_cast<std::size_t>(part.first_plane);
    for (std::size_t k = 0; k <= part.tables.planes.size(); ++k)
      for (int i = 0; i < 3; ++i) plane_w_[static_cast<std::size_t>(i)][first + k] = planes[k][i];
  }
}

void MovingBackground::find_planes(const Run& run, std::int32_t* plane) const {
  for (std::size_t i = 0; i < run.count; ++i) {
    const Part& part = parts_[parts_.size() == 1 ? 0 : static_cast<std::size_t>(run.part[i])];
    const std::int32_t number = part.normal.row(0)[run.at[i]].w;
    plane[i] = number < 0 ? number - part.first_plane : number + part.first_plane;
  }
}

/// Writes a row's depth for light, and moves wrapped depth to its plane; the depth is drawn before.
void MovingBackground::light_row(int y) {
  constexpr auto kNearestW = static_cast<float>(1 / kNearestM);
  constexpr float kFarthestW = 1 / kFarthestM;
  const int width = depth_m_.width();
  const PinholeParams view = parts_.front().tables.grid.warp.view;
  const float ray_y = (static_cast<float>(y) - view.center_px.y) / view.focal_px.y;
  const float* w = w_.row(y);
  const std::int32_t* of_squares = plane_.row(y / kSpreadStep);
  float *light_m = light_depth_m_.row(y), *depth_m = depth_m_.row(y);
  for (int x = 0; x < width; x += kLanes) {
    const FloatLanes drawn = load<FloatLanes>(w + x);
    const IntLanes plane = std::bit_cast<IntLanes>(
        twice_each(of_squares + x / kSpreadStep, std::make_index_sequence<kLanes>{}));
    const IntLanes wrapped = plane < 0, number = wrapped ? -plane : plane;
    const FloatLanes ray_x =
        (lane_numbers() + (static_cast<float>(x) - view.center_px.x)) / view.focal_px.x;
    const auto term = [&](std::size_t i) { return plane_term(plane_w_[i], number); };
    const FloatLanes on = term(0) * ray_x + (term(1) * ray_y + term(2));
    const IntLanes near = abs(on - drawn) <= kLightPlanePart * drawn;
    const IntLanes known = (drawn > 0) & (on > kFarthestW) & (on < kNearestW);
    const IntLanes behind = known & wrapped & (on < drawn);
    const FloatLanes lit = (known & near) | behind ? on : drawn;
    store(light_m + x, drawn > 0 ? 1 / lit : FloatLanes{});
    store(depth_m + x, behind ? 1 / on : load<FloatLanes>(depth_m + x));
  }
}

/// Writes a row of the key's limit, as key_limit(), from the largest w around. `column_most_w`:
/// memory for a row.
void MovingBackground::limit_row(int y, float* column_most_w, float* limit_w) const {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  // Local copies: g++ cannot know that stores do not change the members.
  const NoiseParams noise = noise_;
  const float least_m = key_.threshold_m, noise_factor = key_.noise_factor;
  const int width = depth_m_.width(), height = depth_m_.height();
  const int radius = limit_radius_px_;
  most_of_columns(w_, width, std::max(0, y - radius), std::min(height - 1, y + radius),
                  column_most_w);
  const float* w = w_.row(y);
  const float* spread_m = depth_sigma_m_.row(y / kSpreadStep);
  // Rows are padded to whole registers.
  for (int x = 0; x < width; x += kLanes) {
    const FloatLanes z = 1 / most_within(column_most_w, x, width, radius);
    const FloatLanes sigma = noise.floor_m + z * (noise.linear + z * noise.quadratic_per_m);
    const FloatLanes spread =
        twice_each(spread_m + x / kSpreadStep, std::make_index_sequence<kLanes>{});
    const FloatLanes threshold =
        max(FloatLanes{} + least_m, noise_factor * sqrt(spread * spread + sigma * sigma));
    const IntLanes known = (load<FloatLanes>(w + x) > 0) & (threshold < z);
    store(limit_w + x, known ? 1 / (z - threshold) : FloatLanes{} + kNever);
  }
}

}  // namespace mixrig::render::cpu
