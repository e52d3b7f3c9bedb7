// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/state_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::page {
namespace {

using nlohmann::json;

double to_digits(double value, double step) {
  // A product with the step would have digits beyond it: 11.700000000000001.
  const double steps = std::round(1 / step);
  return std::isfinite(value) ? std::round(value * steps) / steps : 0;
}

template <typename V>
json rounded_array(const V& v, double step) {
  json array = json::array();
  for (int i = 0; i < v.size(); ++i) array.push_back(to_digits(static_cast<double>(v[i]), step));
  return array;
}

json place_json(const std::optional<Eigen::Vector2d>& at) {
  return at ? rounded_array(*at, 1e-4) : json();
}

json object_json(const ObjectState& o) {
  return {{"name", o.name},
          {"position_m", rounded_array(o.position_m, 1e-4)},
          {"turn_deg", to_digits(o.turn_rad * 180 / std::numbers::pi, 0.01)},
          {"scale", to_digits(o.scale, 1e-4)},
          {"hidden", o.hidden},
          {"moves", o.moves},
          {"at", place_json(o.at)}};
}

json lamp_json(const LampState& l) {
  return {{"name", l.name},
          {"position_m", rounded_array(l.position_m, 1e-4)},
          {"intensity", rounded_array(l.intensity, 1e-4)},
          {"on", l.on},
          {"at", place_json(l.at)}};
}

json stream_json(const StreamState& s) {
  return {{"name", s.name},     {"uri", s.uri},   {"ok", s.ok},
          {"frames", s.frames}, {"lost", s.lost}, {"do", s.what_to_do}};
}

json preset_json(const PresetState& p) {
  return {{"name", p.name}, {"differences", p.differences}};
}

json take_json(const TakeState& t) {
  return {{"name", t.name},
          {"notes", t.notes},
          {"circled", t.circled},
          {"frames", t.frames},
          {"lost", t.lost},
          {"seconds", to_digits(t.seconds, 0.1)},
          {"megabytes", to_digits(t.megabytes, 0.1)},
          {"state", t.state}};
}

json recording_json(const RecordingState& r) {
  return {{"on", r.on},
          {"tally", r.on ? "record" : "preview"},
          {"possible", r.possible},
          {"name", r.name},
          {"notes", r.notes},
          {"frames", r.frames},
          {"lost", r.lost},
          {"seconds", to_digits(r.seconds, 0.1)},
          {"folder", r.folder},
          {"error", r.error}};
}

json sweep_json(const SweepState& s) {
  const char* const phases[] = {"idle", "sweeping", "modelling"};
  return {{"possible", s.possible},
          {"why_not", s.why_not},
          {"phase", phases[static_cast<std::size_t>(s.phase)]},
          {"name", s.name},
          {"done", s.done},
          {"total", s.total},
          {"left_s", to_digits(s.left_s, 1)},
          {"folder", s.folder},
          {"error", s.error}};
}

json focus_json(const FocusState& f) {
  return {{"on", f.on},
          {"at", place_json(f.at)},
          {"distance_m", f.distance_m ? json(to_digits(*f.distance_m, 1e-4)) : json()},
          {"f_number", to_digits(f.f_number, 1e-4)}};
}

json calibration_json(const CalibrationState& c) {
  const char* const verdicts[] = {"go", "no-go", "unknown"};
  return {{"file", c.file},
          {"why", c.why},
          {"age_s", c.age_s ? json(to_digits(*c.age_s, 60)) : json()},
          {"verdict", verdicts[static_cast<std::size_t>(c.verdict)]},
          {"reason", c.reason}};
}

template <typename T, typename F>
json list_json(const std::vector<T>& values, F&& one) {
  json array = json::array();
  for (const T& value : values) array.push_back(one(value));
  return array;
}

/// The values of a camera under the keys of rig.toml, with their ranges.
json camera_json(const CameraState& c) {
  json settings = json::array();
  for (const CameraValue& v : c.values)
    settings.push_back({{"name", v.name},
                        {"value", v.value ? json(to_digits(*v.value, 1e-4)) : json()},
                        {"minimum", to_digits(v.minimum, 1e-4)},
                        {"maximum", to_digits(v.maximum, 1e-4)},
                        {"step", v.step}});
  return {{"name", c.name}, {"settings", settings}};
}

}  // namespace

json to_json(const State& s, const PageState& page) {
  return {
      {"run", {{"scene", s.scene}, {"source", s.source}, {"backend", s.backend}, {"live", s.live}}},
      {"picture",
       {{"width", s.width},
        {"height", s.height},
        {"frames", s.frames},
        {"frame", s.frame},
        {"fps", to_digits(s.fps, 0.1)},
        {"frame_ms", to_digits(s.frame_ms, 0.1)},
        {"delay_ms", to_digits(s.delay_ms, 0.1)},
        {"since_frame_s", to_digits(s.since_frame_s, 0.1)}}},
      {"pose", {{"state", s.pose}, {"objects_shown", s.objects_shown}}},
      {"recording", recording_json(s.recording)},
      {"background", {{"possible", s.background_possible}, {"text", s.background}}},
      {"scan",
       {{"possible", s.scan.possible},
        {"done", s.scan.done},
        {"total", s.scan.total},
        {"why_not", s.scan.why_not}}},
      {"sweep", sweep_json(s.sweep)},
      {"focus", focus_json(s.focus)},
      {"disk",
       {{"free_gb", s.disk_free_gb ? json(to_digits(*s.disk_free_gb, 0.1)) : json()},
        {"record_minutes", s.record_minutes ? json(to_digits(*s.record_minutes, 1)) : json()}}},
      {"calibration", calibration_json(s.calibration)},
      {"streams", list_json(s.streams, stream_json)},
      {"cameras", list_json(s.cameras, camera_json)},
      {"objects", list_json(s.objects, object_json)},
      {"lamps", list_json(s.lamps, lamp_json)},
      {"presets", list_json(s.presets, preset_json)},
      {"takes", list_json(s.takes, take_json)},
      {"edits", {{"undo", s.edits.undo}, {"redo", s.edits.redo}}},
      {"log", s.log},
      {"view", name(page.view)},
      {"freeze", page.frozen},
      {"clients", page.clients}};
}

const std::vector<std::string_view>& parts() {
  static const std::vector<std::string_view> names{
      "run",   "picture", "pose",        "recording", "background", "scan",    "sweep",
      "focus", "disk",    "calibration", "streams",   "cameras",    "objects", "lamps",
      "log",   "view",    "freeze",      "clients",   "edits",      "presets", "takes"};
  return names;
}

bool is_part(std::string_view name) {
  const auto& all = parts();
  return std::find(all.begin(), all.end(), name) != all.end();
}

}  // namespace mixrig::page
