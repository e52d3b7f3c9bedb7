// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/desk_state.h"

#include <algorithm>
#include <chrono>

#include "host/capture/live/rig/rig_edit.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

page::StreamState stream_state(const capture::StreamReport& report) {
  const device::StreamHealth& health = report.health;
  page::StreamState state;
  state.name = report.name, state.uri = report.uri;
  state.frames = health.frames;
  state.lost = health.lost + health.overrun + report.pairing.missing;
  state.ok = health.state == device::DeviceState::kStreaming;
  if (!state.ok)
    state.what_to_do = "delivers nothing: check cable and power; mixrig diag says more";
  return state;
}

}  // namespace

std::optional<double> free_gb(fs::path folder) {
  std::error_code code;
  folder = fs::absolute(folder, code);
  while (!fs::exists(folder, code) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, code);
  if (code) return std::nullopt;
  return static_cast<double>(space.available) / 1e9;
}

std::vector<page::CameraState> cameras_of(const Session& session) {
  std::vector<page::CameraState> states;
  if (!session.cameras) return states;
  for (const live::CameraSetup& camera : session.cameras->cameras()) {
    if (camera.settings.empty()) continue;
    page::CameraState& state = states.emplace_back();
    state.name = camera.name;
    for (const live::CameraSetting& setting : camera.settings) {
      const live::ControlKey key = live::control_key(setting.range.control);
      page::CameraValue& value = state.values.emplace_back();
      value.name = key.key;
      if (setting.value) value.value = *setting.value * key.unit;
      value.minimum = setting.range.minimum * key.unit;
      value.maximum = setting.range.maximum * key.unit;
      value.step = setting.range.step * key.unit;
    }
  }
  return states;
}

page::CalibrationState calibration_of(const Session& session, bool zoomed, bool focused) {
  using calibration_file::CalibrationOrigin;
  const calibration_file::CalibrationChoice& choice = session.calibration;
  page::CalibrationState state;
  state.file = choice.where, state.why = choice.why;
  std::error_code code;
  const auto written = fs::last_write_time(choice.file, code);
  if (!code && !choice.file.empty())
    state.age_s = std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
  const bool guessed = choice.origin == CalibrationOrigin::kGuess;
  state.verdict = guessed ? page::Verdict::kNoGo : page::Verdict::kGo;
  state.reason = guessed
                     ? "the camera values are guesses: run mixrig calibrate, or name a calibration"
                     : "the cameras are calibrated";
  if (guessed || !(zoomed || focused)) return state;
  state.verdict = zoomed ? page::Verdict::kNoGo : page::Verdict::kUnknown;
  state.reason = zoomed ? "the zoom was changed: the calibration is for another lens setting"
                        : "the focus was changed: the calibration may not hold";
  return state;
}

std::vector<page::StreamState> streams_of(const Session& session) {
  std::vector<page::StreamState> states;
  const auto report = session.source->report();
  if (!report) {
    page::StreamState& played = states.emplace_back();
    played.name = session.source->info().name, played.uri = "recording";
    return states;
  }
  for (const capture::StreamReport& stream : report->streams)
    states.push_back(stream_state(stream));
  return states;
}

page::FocusState focus_of(const std::optional<scene::FocusSettings>& focus,
                          const std::optional<glm::ivec2>& clicked, Size view) {
  page::FocusState state;
  if (!focus) return state;
  state.on = true, state.f_number = focus->f_number;
  std::optional<std::pair<int, int>> pixel = focus->pixel;
  if (clicked) pixel = {clicked->x, clicked->y};
  if (pixel)
    state.at =
        Eigen::Vector2d((pixel->first + 0.5) / view.width, (pixel->second + 0.5) / view.height);
  else
    state.distance_m = focus->distance_m;
  return state;
}

}  // namespace mixrig::session
