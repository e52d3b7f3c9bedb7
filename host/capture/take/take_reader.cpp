// SPDX-License-Identifier: Apache-2.0
// Reads takes frame by frame.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "host/capture/capture/fisheye.h"
#include "host/capture/capture/pose_source.h"
#include "host/capture/take/frame_pairs.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/depth_check.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/capture/take/streams/picture_files.h"
#include "host/capture/take/streams/raw_depth.h"
#include "host/capture/take/streams/stored_stream.h"
#include "host/capture/take/tell_once.h"
#include "host/capture/take/trajectory.h"
#include "host/capture/take/tum_folder.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxManifestBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxListBytes = std::size_t{64} << 20;
constexpr double kMaxPairDifference_s = 0.02;  // the default of TUM's own tools
constexpr double kMaxPoseGap_s = 0.1;

}  // namespace

/// Index of each part of a frame in its stream.
struct FrameIndex {
  int color = 0, depth = 0, depth2 = 0;
  double time_s = 0;
  double depth_after_s = 0, depth2_after_s = 0;  ///< mid-exposures after that of colour
  geometry::Pose world_from_target;
};

/// Colour and depth of TUM lists that belong together, and their files.
struct TumLists {
  std::vector<StampedFile> color, depth;
};

struct TakeReader::State {
  Manifest manifest;
  std::unique_ptr<PictureStream> color, depth, amplitude;  ///< depth is null if it is raw
  std::unique_ptr<PictureStream> depth2, amplitude2;       ///< null where the take has none
  std::unique_ptr<RawDepth> raw;
  std::unique_ptr<FisheyeStream> fisheye;  ///< null where the take has none
  std::vector<FrameIndex> frames;
  /// By frame number; empty if not recorded.
  std::map<int, FrameTick> ticks;
  /// By frame number; empty if not recorded.
  std::map<int, device::PanTiltAngles> pan_tilt;
  std::vector<capture::LensSample> lens;                   ///< by time; empty if not recorded
  std::map<int, std::vector<capture::TruePerson>> people;  ///< true people by frame number
  std::map<int, capture::TrueLens> true_lens;              ///< by frame number; empty if unknown
  std::shared_ptr<const capture::RigCameras> cameras;
  Image<std::uint16_t> steps;  ///< reused from frame to frame
  DepthCheck depth_check{""}, depth2_check{""};

  TakeInfo& info() { return manifest.info; }
  Result<void> open_streams();
  Result<TumLists> read_lists();
  std::vector<PicturePair> pair(StreamInfo stream, const StreamInfo* amplitudes);
  Result<void> index_numbered();
  Result<void> index_lists(const TumLists& lists);
  Result<std::vector<StampedPose>> read_poses();
  Result<void> read_tables();
  void take_times_from_ticks();
  void describe(int number, capture::Capture& capture) const;
  Result<void> read_steps(PictureStream& stream, int index, const Steps& meaning,
                          Image<float>& out);
  Result<void> read_depth(int index, Image<float>& out);
  Result<void> read_second_depth(int index, capture::DepthPicture& out);
  template <typename T>
  Result<void> check_size(const Image<T>& image, Size wanted, const std::string& name,
                          const char* table) const;
  fs::path truth_file(const char* what, int number) const;
};

Result<TumLists> TakeReader::State::read_lists() {
  TumLists lists;
  for (const auto& [stream, files] :
       {std::pair(&info().color, &lists.color), std::pair(&info().depth, &lists.depth)}) {
    const fs::path path = info().root / stream->path;
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
    MIXRIG_ASSIGN(FileList list, parse_file_list(text, path.string()));
    if (!list.guessed_unit.empty())
      tell_once(path.string() + ": times are read as " + list.guessed_unit +
                ", by their size: write seconds to be sure");
    *files = std::move(list.files);
    stream->count = static_cast<int>(files->size());
  }
  return lists;
}

Result<void> TakeReader::State::open_streams() {
  if (is_list(info().color)) {
    MIXRIG_ASSIGN(const TumLists lists, read_lists());
    const auto stream_of = [root = info().root](std::vector<StampedFile> files, bool is_depth) {
      const auto path_of = [root, files = std::move(files)](int index) {
        return root / files[static_cast<std::size_t>(index)].path;
      };
      return std::make_unique<PictureFiles>(path_of, is_depth);
    };
    color = stream_of(lists.color, false);
    depth = stream_of(lists.depth, true);
    return index_lists(lists);
  }
  MIXRIG_ASSIGN(color, open_stored(info().root, info().color, PixelKind::kRgb8));
  if (info().raw_depth.empty()) {
    MIXRIG_ASSIGN(depth, open_depth(info().root, info().depth));
  } else {
    MIXRIG_ASSIGN(RawDepth frames_of, RawDepth::open(info().root, info().depth));
    raw = std::make_unique<RawDepth>(std::move(frames_of));
  }
  if (info().amplitude) {
    MIXRIG_ASSIGN(amplitude, open_stored(info().root, *info().amplitude, PixelKind::kGray16));
  }
  if (info().depth2) {
    MIXRIG_ASSIGN(depth2, open_depth(info().root, info().depth2->depth));
    if (const auto& lit = info().depth2->amplitude) {
      MIXRIG_ASSIGN(amplitude2, open_stored(info().root, *lit, PixelKind::kGray16));
    }
  }
  return index_numbered();
}

Result<std::vector<StampedPose>> TakeReader::State::read_poses() {
  const fs::path path = info().root / manifest.pose_file;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
  return parse_trajectory(text, path.string());
}

/// Reads ticks.csv and pan_tilt.csv, which recordings of a live rig have, and the tables of a lens
/// that zooms.
Result<void> TakeReader::State::read_tables() {
  std::error_code error;
  if (const fs::path path = info().root / "ticks.csv"; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
    MIXRIG_ASSIGN(ticks, parse_ticks(text, path.string()));
  }
  if (const fs::path path = info().root / "pan_tilt.csv"; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
    MIXRIG_ASSIGN(pan_tilt, parse_pan_tilt(text, path.string()));
  }
  if (const fs::path path = info().root / kLensTable; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
    MIXRIG_ASSIGN(lens, parse_lens_samples(text, path.string()));
    info().has_lens_values = true;
  }
  const fs::path true_path = info().root / manifest.truth_path / kLensTable;
  if (info().has_truth && fs::exists(true_path, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(true_path, kMaxListBytes));
    MIXRIG_ASSIGN(true_lens, parse_true_lens(text, true_path.string(), info().target.size_px()));
  }
  const fs::path people_path = info().root / manifest.truth_path / kPeopleTable;
  if (info().has_truth && fs::exists(people_path, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(people_path, kMaxListBytes));
    MIXRIG_ASSIGN(people, parse_people(text, people_path.string()));
  }
  return {};
}

/// Takes the times of a recording without stamped poses from ticks.csv; a rate would only count
/// frames.
void TakeReader::State::take_times_from_ticks() {
  if (!manifest.pose_file.empty() || is_list(info().color)) return;
  const auto first = ticks.find(1);
  if (first == ticks.end()) return;
  for (const auto& [number, tick] : ticks)
    if (number >= 1 && number <= static_cast<int>(frames.size()))
      frames[static_cast<std::size_t>(number - 1)].time_s =
          seconds(tick.mid_exposure - first->second.mid_exposure);
}

/// Sets everything of a capture except its images.
void TakeReader::State::describe(int number, capture::Capture& capture) const {
  using capture::Stream;
  using capture::StreamStatus;
  const FrameIndex& index = frames[static_cast<std::size_t>(number - 1)];
  capture.number = number;
  capture.time_s = index.time_s;
  capture.mid_exposure = HostTime(Duration(std::llround(index.time_s * 1e9)));
  capture.tick = 0;
  if (const auto known = ticks.find(number); known != ticks.end()) {
    capture.tick = known->second.tick;
    capture.mid_exposure = known->second.mid_exposure;
  }
  const auto exposed = [&](double after_s) {
    return capture.mid_exposure + Duration(std::llround(1e9 * after_s));
  };
  capture.depth_mid_exposure = exposed(index.depth_after_s);
  if (depth2) capture.depth2.mid_exposure = exposed(index.depth2_after_s);
  capture.pan_tilt.reset();
  const auto angles = pan_tilt.find(number);
  if (angles != pan_tilt.end()) capture.pan_tilt = angles->second;
  capture.encoders = mixrig::capture::lens_at(lens, capture.mid_exposure);
  capture.lens.reset();
  capture.cameras = cameras;
  capture.world_from_target = index.world_from_target;
  capture.pose_origin = !manifest.pose_file.empty() ? capture::PoseOrigin::kRecorded
                        : manifest.fixed_pose       ? capture::PoseOrigin::kFixed
                                                    : capture::PoseOrigin::kUnknown;
  capture.status = {};
  capture.set_status(Stream::kPlate, StreamStatus::kFresh);
  capture.set_status(Stream::kDepth, StreamStatus::kFresh);
  if (depth2) capture.set_status(Stream::kDepth2, StreamStatus::kFresh);
  if (!pan_tilt.empty())
    capture.set_status(Stream::kPanTilt,
                       angles != pan_tilt.end() ? StreamStatus::kFresh : StreamStatus::kMissing);
}

/// Frames of a recording by mixrig are those of their numbers, whatever their rates.
std::vector<PicturePair> TakeReader::State::pair(StreamInfo stream, const StreamInfo* amplitudes) {
  std::error_code error;
  const bool recorded = fs::exists(info().root / kTicksTable, error);
  if (amplitudes != nullptr) stream.count = std::min(stream.count, amplitudes->count);
  if (!recorded && rates_differ(info().color, stream))
    tell_once(fmt::format("{}: colour at {} Hz and depth at {} Hz are paired by time",
                          info().path.string(), info().color.rate_hz, stream.rate_hz));
  return pair_numbered(info().color, stream, recorded);
}

Result<void> TakeReader::State::index_numbered() {
  const auto pairs = pair(info().depth, info().amplitude ? &*info().amplitude : nullptr);
  std::map<int, PicturePair> second;  // by colour
  if (info().depth2)
    for (const PicturePair& two :
         pair(info().depth2->depth, amplitude2 ? &*info().depth2->amplitude : nullptr))
      second.emplace(two.color, two);
  std::vector<StampedPose> poses;
  if (!manifest.pose_file.empty()) {
    MIXRIG_ASSIGN(poses, read_poses());
  }
  const double rate_hz = info().color.rate_hz;
  for (const PicturePair& two : pairs) {
    FrameIndex frame;
    frame.color = two.color, frame.depth = two.depth, frame.depth_after_s = two.depth_after_s;
    if (info().depth2) {
      const auto other = second.find(two.color);
      if (other == second.end()) continue;
      frame.depth2 = other->second.depth, frame.depth2_after_s = other->second.depth_after_s;
    }
    frame.time_s = rate_hz > 0 ? two.color / rate_hz : 0.0;
    frame.world_from_target = manifest.fixed_pose.value_or(geometry::Pose{});
    if (!manifest.pose_file.empty()) {
      if (static_cast<std::size_t>(two.color) >= poses.size()) break;
      const StampedPose& pose = poses[static_cast<std::size_t>(two.color)];
      frame.time_s = pose.time_s, frame.world_from_target = pose.world_from_target;
    }
    frames.push_back(frame);
  }
  return {};
}

Result<void> TakeReader::State::index_lists(const TumLists& lists) {
  std::vector<StampedPose> poses;
  if (!manifest.pose_file.empty()) {
    MIXRIG_ASSIGN(poses, read_poses());
    // Not stable_sort: libstdc++'s buffer for it is not aligned as Eigen's types need.
    std::sort(poses.begin(), poses.end(),
              [](const StampedPose& a, const StampedPose& b) { return a.time_s < b.time_s; });
  }
  const std::string name = (info().root / info().color.path).string();
  for (const std::string& line : odd_stamps(lists.color, name)) tell_once(line);
  for (const std::string& line :
       odd_stamps(lists.depth, (info().root / info().depth.path).string()))
    tell_once(line);
  const auto pairs = associate(lists.color, lists.depth, kMaxPairDifference_s);
  if (pairs.empty()) return no_pairs(lists.color, lists.depth, name, kMaxPairDifference_s);
  for (const auto& [c, d] : pairs) {
    const double time_s = lists.color[static_cast<std::size_t>(c)].time_s;
    std::optional<geometry::Pose> pose = manifest.fixed_pose.value_or(geometry::Pose{});
    if (!manifest.pose_file.empty()) pose = pose_at(poses, time_s, kMaxPoseGap_s);
    const double after_s = info().depth.delay_s;
    if (pose) frames.push_back({c, d, 0, time_s, after_s, 0, *pose});
  }
  if (frames.empty())
    return no_poses(poses, lists.color, (info().root / manifest.pose_file).string());
  return {};
}

/// Reads 16-bit steps (or EXR metres) as floats; `unknown` becomes 0.
Result<void> TakeReader::State::read_steps(PictureStream& stream, int index, const Steps& meaning,
                                           Image<float>& out) {
  if (stream.holds_float()) return stream.read(index, out);
  MIXRIG_TRY(stream.read(index, steps));
  from_steps(steps, meaning, out);
  return {};
}

fs::path TakeReader::State::truth_file(const char* what, int number) const {
  return manifest.info.root / manifest.truth_path / what / fmt::format("{:06d}.png", number);
}

namespace {

/// Streams of other lengths may be of other rates, which nobody told.
std::string rate_hint(const TakeInfo& info) {
  const bool told = info.color.rate_hz > 0 && info.depth.rate_hz > 0;
  if (told || is_list(info.color) || info.color.count == info.depth.count) return {};
  return ": pictures are paired by number: give color.rate_hz and depth.rate_hz if they differ";
}

Result<Manifest> open_manifest(const fs::path& path) {
  std::error_code error;
  fs::path file = path;
  if (fs::is_directory(path, error)) {
    file = path / "take.toml";
    if (!fs::exists(file, error) && is_tum_folder(path)) return tum_manifest(path);
  }
  MIXRIG_ASSIGN(const std::string text, config::read_text(file, kMaxManifestBytes));
  return parse_manifest(text, file);
}

}  // namespace

template <typename T>
Result<void> TakeReader::State::check_size(const Image<T>& image, Size wanted,
                                           const std::string& name, const char* table) const {
  if (image.size() == wanted) return {};
  const auto size_text = [](Size s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
  };
  const std::string is = "picture '" + name + "' is " + size_text(image.size());
  if (manifest.without_tables)
    return Error{ErrorCode::kData, is + ", the assumed camera " + size_text(wanted) + ": '" +
                                       manifest.info.path.string() +
                                       "' has no take.toml: write one with [target], [tof] and "
                                       "[target_from_tof]"};
  return Error{ErrorCode::kData, is + " but [" + table + "] size_px is " + size_text(wanted) +
                                     ": correct one of them"};
}

Result<void> TakeReader::State::read_second_depth(int index, capture::DepthPicture& out) {
  const Size size = info().tof2->model.size_px();
  const Steps meaning = depth_steps(*info().tof2, manifest.further_unknown2);
  MIXRIG_TRY(read_steps(*depth2, index, meaning, out.depth_m));
  if (depth2_check.wants_more() && !depth2->holds_float())
    depth2_check.look(steps, meaning, out.depth_m);
  MIXRIG_TRY(check_size(out.depth_m, size, depth2->name(index), "tof2"));
  if (!amplitude2) return {};
  MIXRIG_TRY(read_steps(*amplitude2, index, {}, out.amplitude));
  return check_size(out.amplitude, size, amplitude2->name(index), "tof2");
}

Result<void> TakeReader::State::read_depth(int index, Image<float>& out) {
  const Steps meaning = depth_steps(info(), manifest.further_unknown);
  MIXRIG_TRY(read_steps(*depth, index, meaning, out));
  if (!depth_check.wants_more()) return {};
  if (depth->holds_float())
    depth_check.look(out);
  else
    depth_check.look(steps, meaning, out);
  return {};
}

TakeReader::TakeReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
TakeReader::TakeReader(TakeReader&&) noexcept = default;
TakeReader& TakeReader::operator=(TakeReader&&) noexcept = default;
TakeReader::~TakeReader() = default;

Result<TakeReader> TakeReader::open(const fs::path& path) {
  auto state = std::make_unique<State>();
  MIXRIG_ASSIGN(state->manifest, open_manifest(path));
  MIXRIG_TRY(state->open_streams());
  MIXRIG_TRY(state->read_tables());
  if (state->info().fisheye) {
    MIXRIG_ASSIGN(state->fisheye, open_fisheye_stream(state->info()));
    state->info().fisheye_rate_hz = state->fisheye->rate_hz();
  }
  state->take_times_from_ticks();
  TakeInfo& info = state->info();
  info.rate_hz = info.color.rate_hz;
  if (info.file.empty()) info.file = path;
  if (!state->manifest.without_tables) info.camera_tables = {"target", "tof", "target_from_tof"};
  if (info.tof2) info.camera_tables.insert(info.camera_tables.end(), {"tof2", "target_from_tof2"});
  state->cameras = std::make_shared<capture::RigCameras>(info);
  info.path = path;
  info.frames = static_cast<int>(state->frames.size());
  if (info.frames == 0)
    return Error{
        ErrorCode::kData,
        "take '" + path.string() + "' has no frame with colour, depth and pose: check its streams"};
  const geometry::Pose& first = state->frames.front().world_from_target;
  info.moves = std::any_of(state->frames.begin(), state->frames.end(), [&](const FrameIndex& f) {
    return capture::moved(first, f.world_from_target);
  });
  state->depth_check = DepthCheck(path.string() + ": [depth]");
  state->depth2_check = DepthCheck(path.string() + ": [depth2]");
  const int longest = std::max(info.color.count, info.depth.count);
  if (longest > info.frames)
    tell_once(path.string() + ": " + std::to_string(longest - info.frames) +
              " frames have no partner and are left out" + rate_hint(info));
  return TakeReader(std::move(state));
}

const TakeInfo& TakeReader::info() const { return state_->manifest.info; }

Result<void> TakeReader::read(int number, capture::Capture& frame) {
  State& s = *state_;
  const TakeInfo& info = s.info();
  if (number < 1 || number > info.frames)
    return Error{ErrorCode::kNotFound, "take '" + info.path.string() + "' has no frame " +
                                           std::to_string(number) + ": it has 1 to " +
                                           std::to_string(info.frames)};
  const FrameIndex& index = s.frames[static_cast<std::size_t>(number - 1)];
  s.describe(number, frame);
  MIXRIG_TRY(s.color->read(index.color, frame.plate));
  MIXRIG_TRY(
      s.check_size(frame.plate, info.target.size_px(), s.color->name(index.color), "target"));
  if (s.raw)
    MIXRIG_TRY(s.raw->read(index.depth, frame.depth_m, frame.amplitude));
  else
    MIXRIG_TRY(s.read_depth(index.depth, frame.depth_m));
  MIXRIG_TRY(s.check_size(frame.depth_m, info.tof.size_px(),
                          s.raw ? s.raw->name(index.depth) : s.depth->name(index.depth), "tof"));
  if (s.fisheye)
    MIXRIG_TRY(s.fisheye->read(frame));
  else
    capture::clear_fisheye(frame);
  if (s.depth2) MIXRIG_TRY(s.read_second_depth(index.depth2, frame.depth2));
  if (!s.amplitude) return {};
  MIXRIG_TRY(s.read_steps(*s.amplitude, index.depth, {}, frame.amplitude));
  return s.check_size(frame.amplitude, info.tof.size_px(), s.amplitude->name(index.depth), "tof");
}

Result<void> TakeReader::read_truth(int number, capture::Truth& truth) {
  State& s = *state_;
  const TakeInfo& info = s.info();
  if (!info.has_truth || number < 1 || number > info.frames)
    return Error{ErrorCode::kNotFound, "take '" + info.path.string() + "' has no truth of frame " +
                                           std::to_string(number)};
  truth.people.clear();
  if (const auto known = s.people.find(number); known != s.people.end())
    truth.people = known->second;
  truth.lens.reset();
  if (const auto known = s.true_lens.find(number); known != s.true_lens.end())
    truth.lens = known->second;
  const int file = info.color.first + s.frames[static_cast<std::size_t>(number - 1)].color;
  const auto read_scaled = [&](const char* what, double unit, Image<float>& out) -> Result<void> {
    PictureFiles stream([&](int) { return s.truth_file(what, file); });
    MIXRIG_TRY(s.read_steps(stream, 0, {.unit = unit}, out));
    return s.check_size(out, info.target.size_px(), stream.name(0), "target");
  };
  MIXRIG_TRY(read_scaled("depth", info.truth_depth_unit_m, truth.depth_m));
  MIXRIG_TRY(read_scaled("light", 1.0 / 65535.0, truth.light));
  MIXRIG_TRY(image_io::read_gray8(s.truth_file("matte", file), truth.matte));
  MIXRIG_TRY(s.check_size(truth.matte, info.target.size_px(), s.truth_file("matte", file).string(),
                          "target"));
  MIXRIG_TRY(image_io::read_rgb8(s.truth_file("composite", file), truth.composite));
  MIXRIG_TRY(s.check_size(truth.composite, info.target.size_px(),
                          s.truth_file("composite", file).string(), "target"));
  MIXRIG_TRY(image_io::read_gray8(s.truth_file("labels", file), truth.labels));
  return s.check_size(truth.labels, info.target.size_px(), s.truth_file("labels", file).string(),
                      "target");
}

}  // namespace mixrig::take
