// SPDX-License-Identifier: Apache-2.0
// mixrig track --mocap: the pose of every frame of a motion capture, recorded or live.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "host/app/output_folder.h"
#include "host/camera_io/calibration.h"
#include "host/mocap/live.h"
#include "host/mocap/marker_file.h"
#include "host/mocap/track.h"
#include "host/tools/command.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct Words {
  std::string mocap, constellation, calibration, out, up = "y", version = "3.0";
  int body = 0;
  std::optional<double> duration_s;
  std::size_t frames = 0;
};

struct Frames {
  std::vector<stream::NatNetFrame> frames;
  std::optional<stream::NatNetCounts> live;
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

Result<Frames> receive(const Words& words, stream::NatNetVersion version) {
  MIXRIG_ASSIGN(const auto address, stream::parse_natnet_address(words.mocap));
  const SystemClock clock;
  MIXRIG_ASSIGN(auto receiver, stream::NatNetReceiver::open(address, version, clock));
  const StopOnSignal signals;
  MIXRIG_ASSIGN(auto frames, mocap::receive_frames(receiver, {words.duration_s, words.frames},
                                                   StopOnSignal::flag(), clock));
  return Frames{std::move(frames), receiver.counts()};
}

Result<Frames> read_frames(const Words& words) {
  const std::filesystem::path path = words.mocap;
  if (path.extension() == ".csv") {
    MIXRIG_ASSIGN(auto frames, mocap::read_mocap_csv(path));
    return Frames{std::move(frames), {}};
  }
  MIXRIG_ASSIGN(const stream::NatNetVersion version, parse_version(words.version));
  if (words.mocap == "natnet" || words.mocap.starts_with("natnet:") ||
      words.mocap.starts_with("natnet,"))
    return receive(words, version);
  MIXRIG_ASSIGN(const std::vector<std::byte> bytes, read_bytes(words.mocap));
  auto frames = stream::parse_capture(bytes, version);
  if (!frames) return Error{frames.error().code, words.mocap + ": " + frames.error().context};
  return Frames{*std::move(frames), {}};
}

Result<mocap::TrackOptions> track_options(const Words& words) {
  mocap::TrackOptions options;
  options.up = words.up == "z" ? mocap::Up::kZ : mocap::Up::kY;
  options.body_id = words.body;
  if (words.calibration.empty()) return options;
  MIXRIG_ASSIGN(const camera_io::Calibration known, camera_io::read_calibration(words.calibration));
  const auto* body = known.pose("body");
  if (body == nullptr)
    return Error{ErrorCode::kData, words.calibration +
                                       ": holds no pose of the body: make one by "
                                       "mixrig calibrate external"};
  options.body_from_camera = geometry::inverse(body->target_from);
  return options;
}

Result<std::optional<mocap::Constellation>> constellation_of(const Words& words) {
  if (words.constellation.empty()) return std::optional<mocap::Constellation>();
  MIXRIG_ASSIGN(auto body, mocap::read_constellation(words.constellation));
  return std::optional(std::move(body));
}

nlohmann::json to_json(const stream::NatNetCounts& live) {
  return {{"frames", live.frames},
          {"lost", live.lost},
          {"late", live.late},
          {"malformed", live.malformed},
          {"foreign", live.foreign}};
}

void print(const mocap::MocapTrack& track, const std::optional<stream::NatNetCounts>& live) {
  if (live)
    std::printf("%ld frames received, %ld lost, %ld late, %ld malformed, %ld from elsewhere\n",
                live->frames, live->lost, live->late, live->malformed, live->foreign);
  std::printf("%zu of %d frames have a pose\n", track.poses.size(), track.frames);
  if (track.residual_rms_m > 0)
    std::printf("markers are %.3f mm RMS from the body's shape\n", 1e3 * track.residual_rms_m);
  for (const auto& [reason, count] : track.refused)
    std::printf("%d without: %s\n", count, reason.c_str());
}

Result<nlohmann::json> track(const Words& words) {
  MIXRIG_ASSIGN(const auto options, track_options(words));
  MIXRIG_ASSIGN(const auto body, constellation_of(words));
  MIXRIG_ASSIGN(const Frames all, read_frames(words));
  const auto track = body ? mocap::track_markers(all.frames, *body, options)
                          : mocap::track_bodies(all.frames, options);
  if (!track) return Error{track.error().code, words.mocap + ": " + track.error().context};
  print(*track, all.live);
  if (track->poses.empty())
    return Error{ErrorCode::kData,
                 words.mocap + ": no frame has a pose" +
                     (track->refused.empty() ? "" : ": " + track->refused.begin()->first)};
  if (!words.out.empty()) MIXRIG_TRY(app::write_text(words.out, mocap::to_tum(*track)));
  return nlohmann::json{{"frames", track->frames},
                        {"poses", track->poses.size()},
                        {"residual_rms_m", track->residual_rms_m},
                        {"refused", track->refused},
                        {"live", all.live ? to_json(*all.live) : nlohmann::json()}};
}

}  // namespace

void add_track_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand("track", "the pose of every frame, as TUM lines");
  command
      ->add_option("--mocap", words->mocap,
                   "motion capture: CSV of markers or bodies, NatNet packets as sent, or live: "
                   "natnet[:HOST[:PORT]][,GROUP]")
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
  command
      ->add_option("--duration", words->duration_s,
                   "seconds of a live stream; until Ctrl-C or five silent seconds if not given")
      ->check(CLI::PositiveNumber);
  command->add_option("--frames", words->frames, "number of frames of a live stream");
  command->add_option("--out", words->out, "trajectory in TUM format, z up");
  command->callback([&context, words] { context.action = [words] { return track(*words); }; });
}

}  // namespace mixrig::tools
