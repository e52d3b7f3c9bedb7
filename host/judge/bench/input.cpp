// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/input.h"

#include <algorithm>

#include "host/run/session/camera_pose.h"

namespace mixrig::bench {

Result<SessionPtr> open_input(const std::filesystem::path& take, Size size_px, const Clock& clock,
                              const ProgressFn& progress) {
  session::SessionOptions options{take / "scene.toml", "take:" + take.string(), {}, {}};
  if (!size_px.empty()) options.view_size = size_px;
  options.backend = {render::Backend::kCpu, 0};  // learns the background
  MIXRIG_ASSIGN(SessionPtr session, session::open_session(options));
  const bool on_floor = session->scene.pose_source == scene::PoseSource::kFloor;
  if (!on_floor) MIXRIG_TRY(session::prepare_poses(*session, clock));
  MIXRIG_TRY(session::prepare_background(*session, progress));
  if (on_floor) MIXRIG_TRY(session::prepare_poses(*session, clock));
  return session;
}

Result<std::vector<BenchFrame>> read_frames(const session::Session& session, int most) {
  const capture::SourceInfo& info = session.source->info();
  if (!info.has_truth || session.setup.lens_moves)
    return Error{ErrorCode::kUsage,
                 info.name + (info.has_truth ? " has a lens that zooms" : " has no truth") +
                     ": bench needs a take of mixrig studio, without --zoom"};
  const FrameRange range = session.default_frames();
  std::vector<BenchFrame> frames;
  for (int number = range.first; number <= std::min(range.second, range.first + most - 1);
       ++number) {
    BenchFrame& frame = frames.emplace_back();
    MIXRIG_ASSIGN(const bool there, session.source->read(number, frame.capture));
    if (!there) break;
    MIXRIG_TRY(session.source->read_truth(number, frame.truth));
    frame.world_from_target = session.world_from_target(frame.capture);
  }
  if (!frames.empty()) return frames;
  return Error{ErrorCode::kUsage, info.name + " has no frame after the learned ones"};
}

Result<std::vector<Image<Rgb8>>> read_empty_plates(const session::Session& session, int most) {
  std::vector<Image<Rgb8>> plates;
  if (!session.scene.background.learn) return plates;
  const auto [first, last] = *session.scene.background.learn;
  for (int number = first; number <= std::min(last, first + most - 1); ++number) {
    capture::Capture capture;
    MIXRIG_ASSIGN(const bool there, session.source->read(number, capture));
    if (!there) break;
    plates.push_back(std::move(capture.plate));
  }
  return plates;
}

}  // namespace mixrig::bench
