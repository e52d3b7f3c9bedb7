// SPDX-License-Identifier: Apache-2.0
// Reads the takes of a folder of segments as one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "host/capture/take/segments/segments.h"
#include "host/capture/take/take_state.h"
#include "host/capture/take/tell_once.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

/// From the last frame of a take to the first of the next one, where the clock began again.
constexpr Duration kAfterRestart = std::chrono::seconds(1);

bool is_like(const geometry::Pinhole& a, const geometry::Pinhole& b) {
  constexpr double kSame_px = 1e-3;
  return a.size_px == b.size_px && std::abs(a.fx_px - b.fx_px) < kSame_px &&
         std::abs(a.fy_px - b.fy_px) < kSame_px && std::abs(a.cx_px - b.cx_px) < kSame_px &&
         std::abs(a.cy_px - b.cy_px) < kSame_px;
}

/// Whether two takes have the same cameras and units, as far as their manifests keep digits.
bool is_like(const TakeInfo& a, const TakeInfo& b) {
  constexpr double kSame_m = 1e-5, kSame_rad = 1e-5, kSameUnit = 1e-9;
  const geometry::Pose &pose_a = a.target_from_tof, &pose_b = b.target_from_tof;
  return is_like(a.target.pinhole, b.target.pinhole) && is_like(a.tof.pinhole, b.tof.pinhole) &&
         (pose_a.translation_m - pose_b.translation_m).norm() < kSame_m &&
         pose_a.rotation.angularDistance(pose_b.rotation) < kSame_rad &&
         a.depth_kind == b.depth_kind && std::abs(a.depth_unit_m - b.depth_unit_m) < kSameUnit &&
         std::abs(a.depth_offset_m - b.depth_offset_m) < kSameUnit &&
         a.tof2.has_value() == b.tof2.has_value() && a.raw_depth == b.raw_depth;
}

void add_counts(const TakeInfo& from, TakeInfo& to) {
  to.frames += from.frames;
  to.color.count += from.color.count, to.depth.count += from.depth.count;
  if (to.amplitude && from.amplitude) to.amplitude->count += from.amplitude->count;
  if (to.fisheye && from.fisheye) to.fisheye->count += from.fisheye->count;
  if (to.depth2 && from.depth2) to.depth2->depth.count += from.depth2->depth.count;
}

void shift(capture::Capture& capture, const JoinedTake& take) {
  capture.time_s += take.later_s;
  capture.mid_exposure += take.later, capture.depth_mid_exposure += take.later;
  for (HostTime* at : {&capture.depth2.mid_exposure, &capture.fisheye_mid_exposure})
    if (*at != HostTime{}) *at += take.later;  // 0: there is none
}

}  // namespace

/// Adds a take to those before it. Its times go on by the host's clock, or a second later where
/// that began again, such as after a restart of the machine.
Result<void> TakeReader::State::add_joined(const TakeReader& reader) {
  State& of = *reader.state_;
  if (joined.empty()) {
    manifest = of.manifest;
    cameras = of.cameras;
  } else if (!is_like(of.info(), info())) {
    return Error{ErrorCode::kData,
                 "'" + of.info().path.string() + "' has other cameras or streams than '" +
                     joined.front().path.string() + "': open each of these takes alone"};
  }
  if (of.info().frames > std::numeric_limits<int>::max() - info().frames)
    return Error{ErrorCode::kData, "'" + of.info().path.string() +
                                       "' and the takes before it have too many frames: open "
                                       "each of them alone"};
  JoinedTake take{of.info().path, 1, of.info().frames, {}, 0};
  capture::Capture first, last;
  of.describe(1, first), of.describe(take.frames, last);
  if (!joined.empty()) {
    take.first = info().frames + 1;
    add_counts(of.info(), info());
    info().moves = info().moves || of.info().moves ||
                   capture::moved(joined_begin.world_from_target, first.world_from_target);
    if (first.mid_exposure <= joined_end)
      take.later = joined_end + kAfterRestart - first.mid_exposure;
    take.later_s = joined_begin.time_s - first.time_s +
                   seconds(first.mid_exposure + take.later - joined_begin.mid_exposure);
  } else {
    joined_begin = first;
  }
  joined_end = last.mid_exposure + take.later;
  joined.push_back(std::move(take));
  return {};
}

Result<std::unique_ptr<TakeReader::State>> TakeReader::State::join(
    const fs::path& folder, const std::vector<Segment>& segments) {
  auto state = std::make_unique<State>();
  for (const Segment& segment : segments) {
    auto reader = TakeReader::open(segment.path);
    // A take that was cut off before its first frame does not hide the others.
    if (!reader && segment.is_partial && segments.size() > 1) {
      tell_once(to_line(reader.error()) + ": left out");
      continue;
    }
    if (!reader) return reader.error();
    MIXRIG_TRY(state->add_joined(*reader));
  }
  if (state->joined.empty())
    return Error{ErrorCode::kData, "'" + folder.string() + "' holds no take with a whole frame"};
  state->info().path = folder;
  state->info().segments = static_cast<int>(state->joined.size());
  return state;
}

/// The take that has frame `number`, which is opened if it is not.
Result<const JoinedTake*> TakeReader::State::open_joined(int number) {
  const auto after = std::upper_bound(joined.begin(), joined.end(), number,
                                      [](int n, const JoinedTake& take) { return n < take.first; });
  const JoinedTake& take = *std::prev(after);
  if (joined_reader && joined_reader->info().path.stem() == take.path.stem()) return &take;
  joined_reader.reset();
  std::error_code error;
  fs::path path = take.path;
  if (!fs::exists(path, error)) path.replace_extension();  // it was completed meanwhile
  MIXRIG_ASSIGN(joined_reader, TakeReader::open(path));
  return &take;
}

Result<void> TakeReader::State::read_joined(int number, capture::Capture& capture) {
  MIXRIG_ASSIGN(const JoinedTake* const take, open_joined(number));
  MIXRIG_TRY(joined_reader->read(number - take->first + 1, capture));
  capture.number = number;
  shift(capture, *take);
  return {};
}

Result<void> TakeReader::State::read_joined_truth(int number, capture::Truth& truth) {
  MIXRIG_ASSIGN(const JoinedTake* const take, open_joined(number));
  return joined_reader->read_truth(number - take->first + 1, truth);
}

}  // namespace mixrig::take
