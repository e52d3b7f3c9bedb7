// SPDX-License-Identifier: Apache-2.0
// mixrig track --mocap: the pose of every frame of a motion-capture recording.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "host/app/output_folder.h"
#include "host/camera_io/calibration.h"
#include "host/mocap/marker_file.h"
#include "host/mocap/track.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string mocap, constellation, calibration, out, up = "y", version = "3.0";
  int body = 0;
};

Result<std::vector<std::byte>> read_bytes(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return Error{ErrorCode::kNotFound, path + ": no such recording"};
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  if (!file.eof() && !file) return Error{ErrorCode::kIo, path + ": reading failed"};
  const auto bytes = std::as_bytes(std::span(text));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<stream::NatNetVersion> parse_version(const std::string& text) {
  stream::NatNetVersion version;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%2d.%2d%c", &version.major, &version.minor, &rest) != 2 ||
      !version.at_least(3, 0))
    return Error{ErrorCode::kUsage, "--natnet " + text + ": expected a version such as 3.0 or 4.1"};
  return version;
}

Result<std::vector<stream::NatNetFrame>> read_frames(const Words& words) {
  if (words.mocap.ends_with(".csv")) return mocap::read_mocap_csv(words.mocap);
  MIXRIG_ASSIGN(const stream::NatNetVersion version, parse_version(words.version));
  MIXRIG_ASSIGN(const std::vector<std::byte> bytes, read_bytes(words.mocap));
  auto frames = stream::parse_capture(bytes, version);
  if (!frames) return Error{frames.error().code, words.mocap + ": " + frames.error().context};
  return frames;
}

Result<mocap::MocapTrack> track_of(const Words& words,
                                   const std::vector<stream::NatNetFrame>& frames) {
  mocap::TrackOptions options;
  options.up = words.up == "z" ? mocap::Up::kZ : mocap::Up::kY;
  options.body_id = words.body;
  if (!words.calibration.empty()) {
    MIXRIG_ASSIGN(const camera_io::Calibration known,
                  camera_io::read_calibration(words.calibration));
    const auto* body = known.pose("body");
    if (body == nullptr)
      return Error{ErrorCode::kData, words.calibration +
                                         ": holds no pose of the body: make one by "
                                         "mixrig calibrate external"};
    options.body_from_camera = geometry::inverse(body->target_from);
  }
  if (words.constellation.empty()) return mocap::track_bodies(frames, options);
  MIXRIG_ASSIGN(const mocap::Constellation body, mocap::read_constellation(words.constellation));
  return mocap::track_markers(frames, body, options);
}

void print(const mocap::MocapTrack& track) {
  std::printf("%zu of %d frames have a pose\n", track.poses.size(), track.frames);
  if (track.residual_rms_m > 0)
    std::printf("markers are %.3f mm RMS from the body's shape\n", 1e3 * track.residual_rms_m);
  for (const auto& [reason, count] : track.refused)
    std::printf("%d without: %s\n", count, reason.c_str());
}

Result<nlohmann::json> track(const Words& words) {
  MIXRIG_ASSIGN(const std::vector<stream::NatNetFrame> frames, read_frames(words));
  const auto track = track_of(words, frames);
  if (!track) return Error{track.error().code, words.mocap + ": " + track.error().context};
  print(*track);
  if (track->poses.empty())
    return Error{ErrorCode::kData,
                 words.mocap + ": no frame has a pose" +
                     (track->refused.empty() ? "" : ": " + track->refused.begin()->first)};
  if (!words.out.empty()) MIXRIG_TRY(app::write_text(words.out, mocap::to_tum(*track)));
  return nlohmann::json{{"frames", track->frames},
                        {"poses", track->poses.size()},
                        {"residual_rms_m", track->residual_rms_m},
                        {"refused", track->refused}};
}

}  // namespace

void add_track_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand("track", "the pose of every frame, as TUM lines");
  command
      ->add_option("--mocap", words->mocap,
                   "motion capture: CSV of markers or bodies, or NatNet packets as sent")
      ->required();
  command->add_option("--constellation", words->constellation,
                      "TOML of the body's markers: poses are found from markers alone");
  command->add_option("--body", words->body, "number of the rigid body; 0: the only one")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--calibration", words->calibration,
                      "calibration.yaml with the body: poses of the target camera come out");
  command->add_option("--up", words->up, "axis of the recording that points up")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  command->add_option("--natnet", words->version, "version of packets that do not state theirs")
      ->capture_default_str();
  command->add_option("--out", words->out, "trajectory in TUM format, z up");
  command->callback([&context, words] { context.action = [words] { return track(*words); }; });
}

}  // namespace mixrig::tools
