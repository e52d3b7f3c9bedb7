// SPDX-License-Identifier: Apache-2.0
// Views of a calibration board by every camera of a rig.
#include "host/studio/board/board_studio.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "host/studio/board/behind_board.h"
#include "host/studio/board/board_camera.h"
#include "host/studio/board/board_hand.h"
#include "host/studio/board/board_poses.h"
#include "host/studio/sensors/lens.h"
#include "host/studio/sensors/tof.h"
#include "host/studio/srgb.h"
#include "host/studio/stage/layout.h"
#include "host/studio/stage/light.h"
#include "host/studio/stage/materials.h"

namespace mixrig::studio {
namespace {

constexpr int kBoardBand = 8;
constexpr float kBoardFullWell_e = 12000, kBoardReadNoise_e = 8;
constexpr float kPaper = 0.80F, kInk = 0.06F, kPaperInfrared = 0.75F, kInkInfrared = 0.10F;
constexpr float kRoomLight = 0.55F;         ///< irradiance on the room behind the board
constexpr int kLightSide = 9;               ///< samples of the light on the board, per side
constexpr double kBoardExposure_s = 0.008;  ///< of the colour cameras
constexpr int kBlurSlices = 4;
constexpr double kSharp_m = 2e-4;  ///< a board that moves less within an exposure is not blurred
constexpr double kFar_m = 2e-3;

Error wrong(const std::string& what) { return {ErrorCode::kUsage, "studio: " + what}; }

Result<void> check_range(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return wrong(fmt::format("{} must be {} to {}, not {}", what, low, high, value));
}

Result<void> check(const BoardOptions& o) {
  MIXRIG_TRY(check_range("views", o.views, 1, 500));
  MIXRIG_TRY(check_range("width of the target picture", o.size_px.width, 64, 4096));
  MIXRIG_TRY(check_range("height of the target picture", o.size_px.height, 64, 4096));
  MIXRIG_TRY(check_range("threads", o.threads, 0, 256));
  MIXRIG_TRY(check_range("board columns", o.board.columns, 3, 40));
  MIXRIG_TRY(check_range("board rows", o.board.rows, 3, 40));
  MIXRIG_TRY(check_range("square", o.board.square_m, 0.005, 0.5));
  MIXRIG_TRY(check_range("board bend", o.board.bend_m, -0.02, 0.02));
  MIXRIG_TRY(check_range("most distance", o.far_m, 0.5, 10));
  MIXRIG_TRY(check_range("width of the fisheye's picture", o.fisheye_px.width, 64, 4096));
  MIXRIG_TRY(check_range("height of the fisheye's picture", o.fisheye_px.height, 64, 4096));
  MIXRIG_TRY(check_range("rest of the board", o.hand.rest_s, 0.1, 10));
  MIXRIG_TRY(check_range("move of the board", o.hand.move_s, 0.1, 10));
  MIXRIG_TRY(check_range("tremor", o.hand.tremor_m, 0, 0.01));
  MIXRIG_TRY(check_range("blur", o.blur_px, 0, 10));
  MIXRIG_TRY(check_range("noise", o.noise, 0, 100));
  MIXRIG_TRY(check_range("tolerance", o.tolerance, 0, 2));
  MIXRIG_TRY(check_range("lens error", o.lens_error_px, 0, 5));
  MIXRIG_TRY(check_range("depth error", o.depth_error_m.value_or(0), 0, 0.1));
  MIXRIG_TRY(check_range("amplitude error", o.amplitude_error_m, -0.1, 0.1));
  MIXRIG_TRY(check_range("pixel error", o.pixel_error_m, -0.1, 0.1));
  const bool markers = o.board.kind == BoardKind::kCharuco;
  const auto most = static_cast<int>(marker_bits().size());
  if (markers && o.board.columns * o.board.rows / 2 > most)
    return wrong(fmt::format("a ChArUco board of dictionary 4x4_50 has at most {} squares, not {}",
                             2 * most, o.board.columns * o.board.rows));
  if (markers &&
      !(o.board.marker_m > 0.3 * o.board.square_m && o.board.marker_m < 0.95 * o.board.square_m))
    return wrong(fmt::format("a marker must be 0.3 to 0.95 of a square, not {:.4g}",
                             o.board.marker_m / o.board.square_m));
  return {};
}

BoardInfo make_info(const BoardOptions& o) {
  BoardInfo info;
  info.name = fmt::format("board {}, {}", o.seed, name(o.rig));
  info.options = o;
  info.rig = rig_of_seed(o.rig, o.seed, o.size_px, o.tolerance);
  if (o.fisheye_px != info.rig.fisheye.size_px)
    info.rig.fisheye = scaled(info.rig.fisheye, o.fisheye_px);
  if (o.lens_error_px > 0) info.rig.target = with_lens_error(info.rig.target, o.lens_error_px);
  TofSensor& tof = info.rig.tof;
  if (o.depth_error_m)
    set_depth_error(tof, *o.depth_error_m);
  else if (!o.raw_depth)
    tof.wiggle_rad *= tof.wiggle_left;
  return info;
}

/// The room without furniture within 3.2 m of the camera, which could occlude the board.
Mesh unoccluding_room(const Vec3& eye) {
  const Mesh full = build_room({});
  Mesh mesh = full;
  mesh.indices.clear(), mesh.materials.clear();
  for (std::size_t t = 0; t < full.materials.size(); ++t) {
    const Kind kind = full.materials[t].kind;
    bool stays = kind == Kind::kFloor || kind == Kind::kWall || kind == Kind::kCeiling ||
                 kind == Kind::kLamp;
    if (!stays) {
      stays = true;
      for (int k = 0; k < 3; ++k)
        stays = stays && (full.positions[full.indices[3 * t + k]] - eye).norm() > 3.2F;
    }
    if (!stays) continue;
    mesh.materials.push_back(full.materials[t]);
    mesh.indices.insert(mesh.indices.end(), full.indices.begin() + 3 * t,
                        full.indices.begin() + 3 * t + 3);
  }
  return mesh;
}

RayFunction pinhole_rays(const Optics& optics) {
  return [optics](double u, double v, Eigen::Vector3d& ray) {
    const Eigen::Vector2d ideal =
        undistort(optics, {(u - optics.cx_px) / optics.fx_px, (v - optics.cy_px) / optics.fy_px});
    ray = Eigen::Vector3d(ideal.x(), ideal.y(), 1).normalized();
    return true;
  };
}

RayFunction fisheye_rays(const FisheyeOptics& optics) {
  return
      [optics](double u, double v, Eigen::Vector3d& ray) { return fisheye_ray(optics, u, v, ray); };
}

/// Irradiance on the board, interpolated bilinearly between samples.
class BoardLight {
 public:
  BoardLight(const BoardPlan& plan, const geometry::Pose& world_from_board, const LampSet& lamps,
             float ambient)
      : plan_(plan) {
    const Eigen::Matrix3d turn = world_from_board.rotation.toRotationMatrix();
    const Vec3 normal = (-turn.col(2)).cast<float>();
    for (int j = 0; j < kLightSide; ++j)
      for (int i = 0; i < kLightSide; ++i) {
        const Eigen::Vector3d place(u_of(i), v_of(j), 0);
        const Vec3 at = (world_from_board * place).cast<float>();
        values_[static_cast<std::size_t>(j) * kLightSide + i] =
            ambient + lamps.irradiance(at, normal, lamps.facing(at, normal));
      }
  }
  float at(float u_m, float v_m) const {
    const float x = cell(u_m, plan_.width_m()), y = cell(v_m, plan_.height_m());
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const float* row = &values_[static_cast<std::size_t>(j) * kLightSide + i];
    return (1 - t) * ((1 - s) * row[0] + s * row[1]) +
           t * ((1 - s) * row[kLightSide] + s * row[kLightSide + 1]);
  }

 private:
  static float cell(float at_m, double size_m) {
    const float x = at_m / static_cast<float>(size_m) * (kLightSide - 3) + 1;
    return std::clamp(x, 0.0F, kLightSide - 1.001F);
  }
  double u_of(int i) const { return plan_.width_m() * (i - 1) / (kLightSide - 3); }
  double v_of(int j) const { return plan_.height_m() * (j - 1) / (kLightSide - 3); }

  BoardPlan plan_;
  std::array<float, static_cast<std::size_t>(kLightSide) * kLightSide> values_;
};

/// The same sensor with `factor` times the relative noise: it collects 1 / factor^2 times the
/// electrons.
TofSensor noisier(TofSensor sensor, double factor) {
  const auto gain = static_cast<float>(1 / std::pow(std::max(factor, 0.01), 2));
  for (float* charge :
       {&sensor.signal_e, &sensor.background_e, &sensor.full_well_e, &sensor.least_amplitude_e})
    *charge *= gain;
  sensor.read_noise_e *= std::sqrt(gain);
  return sensor;
}

Light room_light() {
  StudioOptions options;
  options.scenario = Scenario::kStill;
  return make_layout(options).light;
}

}  // namespace

struct BoardStudio::State {
  using Poses = std::span<const geometry::Pose>;
  State(const BoardOptions& o, const TraceDevice& device)
      : info(make_info(o)),
        light(room_light()),
        lamps(light),
        materials(o.seed, choose_wardrobe(o.seed, false), nullptr),
        pattern(o.board),
        crew(o.threads),
        room(device),
        board(device),
        target(o.size_px, pinhole_rays(info.rig.target), o.blur_px),
        fisheye(info.rig.fisheye.size_px, fisheye_rays(info.rig.fisheye), o.blur_px),
        tof(info.rig.tof.optics.size_px, pinhole_rays(info.rig.tof.optics), o.blur_px),
        behind_target(o.size_px),
        behind_fisheye(info.rig.fisheye.size_px),
        behind_tof(info.rig.tof.optics.size_px) {
    const StudioOptions options;
    const Layout layout = make_layout(options);
    rest = geometry::look_at(layout.eye_m, layout.look_at_m, Eigen::Vector3d::UnitZ());
    Mesh shell = unoccluding_room(layout.eye_m.cast<float>()), sheet = build_board(o.board);
    room.set(shell);
    board.set(sheet);
    sensor = noisier(info.rig.tof, o.noise);
  }

  /// Linear colour of the room behind the board.
  Vec3 background_color(const Eigen::Vector3f& ray, const geometry::Pose& world_from_camera) const;
  /// `poses` of the board in the slices of the exposure, target_from_board.
  void draw_color(BoardCamera& camera, const geometry::Pose& target_from_camera, Poses poses,
                  int number, int salt, BehindBoard<Vec3>& behind, Image<Rgb8>& picture);
  /// `poses` at the four taps, or one for all.
  void draw_tof(Poses poses, BoardView& view);
  /// The outline of a board that may move tells nothing; one that moves far within an exposure is
  /// blurred by more than its samples show.
  SampleSteps steps_of(Poses poses) const {
    const bool far = moved_m(poses.front(), poses.back()) > kFar_m;
    return {coarse_border ? 9 : 1, far ? 9 : 1};
  }
  /// Most that a corner of the board moves between two poses.
  double moved_m(const geometry::Pose& from, const geometry::Pose& to) const {
    const Eigen::Vector3d corner(info.options.board.width_m(), info.options.board.height_m(), 0);
    return std::max((to.translation_m - from.translation_m).norm(),
                    (to * corner - from * corner).norm());
  }
  std::vector<geometry::Pose> poses_about(double time_s, double exposure_s, int slices) const;
  BoardPlace place_before(const HeadMotion& head) const;
  Echo board_echo(const BoardPixel& p, std::size_t index, int x, int y,
                  const geometry::Pose& world_from_tof);
  void turn_to(const BoardPlace& place);
  Echo background_echo(const Eigen::Vector3f& ray, const geometry::Pose& world_from_tof) const;
  float with_depth_error(const TofValue& value, int x, int y) const;

  BoardInfo info;
  Light light;
  LampSet lamps;
  Materials materials;
  BoardPattern pattern;
  Crew crew;
  TraceScene room, board;
  BoardCamera target, fisheye, tof;
  BehindBoard<Vec3> behind_target, behind_fisheye;
  BehindBoard<Echo> behind_tof;
  double pan_rad = 0, tilt_rad = 0;
  bool coarse_border = false;  ///< of moments
  geometry::Pose rest;         ///< world_from_target at pan = tilt = 0
  geometry::Pose world_from_target;
  TofSensor sensor;
  NormalTable normal;
  std::vector<BoardPixel> pixels;
  std::vector<Vec3> light_sum;
  std::array<std::vector<Echo>, 4> taps;
};

BoardStudio::BoardStudio(std::unique_ptr<State> state) : state_(std::move(state)) {}
BoardStudio::BoardStudio(BoardStudio&&) noexcept = default;
BoardStudio& BoardStudio::operator=(BoardStudio&&) noexcept = default;
BoardStudio::~BoardStudio() = default;

Result<BoardStudio> BoardStudio::create(const BoardOptions& options) {
  MIXRIG_TRY(check(options));
  MIXRIG_ASSIGN(const TraceDevice device, TraceDevice::create());
  return BoardStudio(std::make_unique<State>(options, device));
}

const BoardInfo& BoardStudio::info() const { return state_->info; }

Vec3 BoardStudio::State::background_color(const Eigen::Vector3f& ray,
                                          const geometry::Pose& world_from_camera) const {
  const Vec3 eye = world_from_camera.translation_m.cast<float>();
  const Vec3 direction = (world_from_camera.rotation * ray.cast<double>()).cast<float>();
  Hit hit;
  if (!room.intersect(eye, direction, 1e9F, hit)) return Vec3::Zero();
  const Vec3 albedo = materials.albedo(hit.material, hit.uv, eye + hit.t * direction);
  return hit.material.kind == Kind::kLamp ? albedo : Vec3(kRoomLight * albedo);
}

void BoardStudio::State::draw_color(BoardCamera& camera, const geometry::Pose& target_from_camera,
                                    Poses poses, int number, int salt, BehindBoard<Vec3>& behind,
                                    Image<Rgb8>& picture) {
  const geometry::Pose world_from_camera = world_from_target * target_from_camera;
  const Size size = camera.size_px();
  const auto exposure = static_cast<float>(light.exposure);
  const auto noise = static_cast<float>(info.options.noise);
  const float share = 1.0F / static_cast<float>(poses.size());
  picture.reset(size);
  light_sum.assign(size.area(), Vec3::Zero());
  for (const geometry::Pose& target_from_board : poses) {
    camera.trace(board, pattern, geometry::inverse(target_from_camera) * target_from_board,
                 steps_of(poses), crew, pixels);
    const BoardLight on_board(info.options.board, world_from_target * target_from_board, lamps,
                              light.ambient.mean());
    crew.rows(size.height, kBoardBand, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        for (int x = 0; x < size.width; ++x) {
          if (camera.ray(x, y).isZero()) continue;
          const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
          const BoardPixel& p = pixels[index];
          Vec3 color = Vec3::Zero();
          if (p.board < 1)
            color = (1 - p.board) * behind.at(index, [&] {
              return background_color(camera.ray(x, y), world_from_camera);
            });
          if (p.board > 0)
            color += on_board.at(p.u_m, p.v_m) * (kInk * (p.board - p.paper) + kPaper * p.paper) *
                     lamps.tint();
          light_sum[index] += share * color;
        }
    });
  }
  crew.rows(size.height, kBoardBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (camera.ray(x, y).isZero()) continue;
        const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
        Vec3 color = light_sum[index];
        const std::uint64_t bits = hash_key(hash_key(info.options.seed, 0xB0C0 + salt),
                                            static_cast<std::uint64_t>(number), index);
        for (int c = 0; c < 3; ++c) {
          const float charge = kBoardFullWell_e * exposure * color[c];
          color[c] = (charge + noise * std::sqrt(charge + kBoardReadNoise_e * kBoardReadNoise_e) *
                                   normal(bits >> (12 * c))) /
                     kBoardFullWell_e;
        }
        picture.at(x, y) = srgb_from_linear(color);
      }
  });
}

Echo BoardStudio::State::background_echo(const Eigen::Vector3f& ray,
                                         const geometry::Pose& world_from_tof) const {
  const Vec3 eye = world_from_tof.translation_m.cast<float>();
  const Vec3 direction = (world_from_tof.rotation * ray.cast<double>()).cast<float>();
  Hit hit;
  if (!room.intersect(eye, direction, 1e9F, hit)) return {};
  const Vec3 visible = materials.albedo(hit.material, hit.uv, eye + hit.t * direction);
  return echo_of(sensor, hit.t, materials.infrared(hit.material, visible),
                 -hit.normal.dot(direction));
}

/// The measured distance with the errors that depend on amplitude and pixel position.
float BoardStudio::State::with_depth_error(const TofValue& value, int x, int y) const {
  const Size size = sensor.optics.size_px;
  const double dx = 2.0 * x / (size.width - 1) - 1, dy = 2.0 * y / (size.height - 1) - 1;
  const double bright = 0.25 * sensor.signal_e;  // about the amplitude of paper at 1 m
  const double weak = 1 / (1 + 9 * std::max(value.amplitude_e, 0.0F) / bright);
  const double error = info.options.amplitude_error_m * weak * 1.9 +
                       info.options.pixel_error_m * 0.5 * (dx * dx + dy * dy);
  const double unit = sensor.unit_m;
  return static_cast<float>(unit * std::round((value.distance_m + error) / unit));
}

Echo BoardStudio::State::board_echo(const BoardPixel& p, std::size_t index, int x, int y,
                                    const geometry::Pose& world_from_tof) {
  Echo echo;
  if (p.board < 1)
    echo += behind_tof.at(index, [&] { return background_echo(tof.ray(x, y), world_from_tof); }) *
            (1 - p.board);
  if (p.board > 0)
    echo += echo_of(sensor, p.distance_m,
                    kInkInfrared * (p.board - p.paper) + kPaperInfrared * p.paper, p.cosine);
  return echo;
}

void BoardStudio::State::draw_tof(Poses poses, BoardView& view) {
  const geometry::Pose tof_from_target = geometry::inverse(sensor.target_from_tof);
  const geometry::Pose world_from_tof = world_from_target * sensor.target_from_tof;
  const Size size = tof.size_px();
  view.tof_distance_m.reset(size), view.tof_amplitude.reset(size);
  for (std::size_t t = 0; t < poses.size(); ++t) {
    tof.trace(board, pattern, tof_from_target * poses[t], steps_of(poses), crew, pixels);
    taps[t].resize(size.area());
    crew.rows(size.height, kBoardBand, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        for (int x = 0; x < size.width; ++x) {
          const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
          taps[t][index] = board_echo(pixels[index], index, x, y, world_from_tof);
        }
    });
  }
  const auto tap = [&](std::size_t t, std::size_t index) {
    return taps[poses.size() == 1 ? 0 : t][index];
  };
  const float counts_per_e = 65535.0F / sensor.full_well_e;
  crew.rows(size.height, kBoardBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
        const TofValue value = read_taps(
            sensor, {tap(0, index), tap(1, index), tap(2, index), tap(3, index)},
            hash_key(info.options.seed, static_cast<std::uint64_t>(view.number) + 0xB070F0, index),
            true, normal);
        view.tof_distance_m.at(x, y) = value.distance_m > 0 ? with_depth_error(value, x, y) : 0;
        view.tof_amplitude.at(x, y) = std::round(counts_per_e * value.amplitude_e);
      }
  });
}

void BoardStudio::State::turn_to(const BoardPlace& place) {
  world_from_target = rest * rest_from_turned(info.rig.pan_tilt, place.pan_rad, place.tilt_rad);
  if (place.pan_rad == pan_rad && place.tilt_rad == tilt_rad) return;
  pan_rad = place.pan_rad, tilt_rad = place.tilt_rad;
  behind_target.forget(), behind_fisheye.forget(), behind_tof.forget();
}

std::vector<geometry::Pose> BoardStudio::State::poses_about(double time_s, double exposure_s,
                                                            int slices) const {
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < slices; ++i) {
    const double at_s = time_s + exposure_s * ((i + 0.5) / slices - 0.5);
    poses.push_back(hand_pose(info, std::max(at_s, 0.0)));
  }
  if (moved_m(poses.front(), poses.back()) < kSharp_m) poses.assign(1, hand_pose(info, time_s));
  return poses;
}

/// Where the head stands, with the play that its encoders do not show: that of the first view at
/// angles zero, else its own at each place.
BoardPlace BoardStudio::State::place_before(const HeadMotion& head) const {
  const PanTiltUnit& unit = info.rig.pan_tilt;
  const auto step = [&](double angle_rad) {
    return static_cast<std::uint64_t>(std::llround(angle_rad / unit.step_rad) + (1LL << 32));
  };
  const auto play = [&](std::uint64_t axis) {
    const std::uint64_t key = hash_key(hash_key(info.options.seed, 0x91A7 + axis),
                                       step(head.angles.pan_rad), step(head.angles.tilt_rad));
    return std::sqrt(3.0) * unit.repeatability_rad * (2 * uniform(key) - 1);
  };
  BoardPlace place;
  place.pan_rad = whole_steps(unit, head.angles.pan_rad);
  place.tilt_rad = whole_steps(unit, head.angles.tilt_rad);
  place.target_from_board =
      geometry::inverse(rest_from_turned(unit, head.angles.pan_rad + head.swing_rad + play(0),
                                         head.angles.tilt_rad + play(1))) *
      board_place(info, 1).target_from_board;
  return place;
}

void BoardStudio::render_moment(int number, double time_s, const HeadMotion& head,
                                BoardView& view) {
  State& s = *state_;
  view.number = number;
  s.coarse_border = true;
  std::vector<geometry::Pose> color, taps;
  if (s.info.options.pan_tilt) {
    const BoardPlace place = s.place_before(head);
    view.pan_rad = place.pan_rad, view.tilt_rad = place.tilt_rad;
    color = taps = {place.target_from_board};
    s.turn_to(place);
  } else {
    view.pan_rad = view.tilt_rad = 0;
    color = s.poses_about(time_s, kBoardExposure_s, kBlurSlices);
    taps = s.poses_about(time_s + s.sensor.delay_s, s.sensor.exposure_s, 4);
    s.turn_to({});
  }
  view.target_from_board = color[color.size() / 2];
  s.draw_color(s.target, {}, color, number, 1, s.behind_target, view.target);
  s.draw_tof(taps, view);
}

void BoardStudio::render_fisheye(int number, double time_s, const HeadMotion& head,
                                 Image<Rgb8>& picture) {
  State& s = *state_;
  s.coarse_border = true;
  std::vector<geometry::Pose> poses;
  if (s.info.options.pan_tilt) {
    const BoardPlace place = s.place_before(head);
    poses = {place.target_from_board};
    s.turn_to(place);
  } else {
    poses = s.poses_about(time_s, kBoardExposure_s, kBlurSlices);
    s.turn_to({});
  }
  s.draw_color(s.fisheye, s.info.rig.target_from_fisheye, poses, number, 2, s.behind_fisheye,
               picture);
}

void BoardStudio::render(int number, BoardView& view) {
  State& s = *state_;
  const BoardPlace place = board_place(s.info, number);
  const State::Poses pose(&place.target_from_board, 1);
  view.number = number;
  s.coarse_border = false;
  view.pan_rad = place.pan_rad, view.tilt_rad = place.tilt_rad;
  view.target_from_board = place.target_from_board;
  s.turn_to(place);
  s.draw_color(s.target, {}, pose, number, 1, s.behind_target, view.target);
  s.draw_color(s.fisheye, s.info.rig.target_from_fisheye, pose, number, 2, s.behind_fisheye,
               view.fisheye);
  s.draw_tof(pose, view);
}

}  // namespace mixrig::studio
