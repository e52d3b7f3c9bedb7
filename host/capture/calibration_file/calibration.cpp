// SPDX-License-Identifier: Apache-2.0
// Entries by name, writing, and the hash of inputs.
#include "host/capture/calibration_file/calibration.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <fstream>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/partial_path.h"

namespace mixrig::calibration_file {
namespace {

template <typename T>
const T* named(const std::vector<T>& items, std::string_view name) {
  const auto at =
      std::find_if(items.begin(), items.end(), [&](const T& i) { return i.name == name; });
  return at == items.end() ? nullptr : &*at;
}

template <typename T>
void merge_named(std::vector<T>& into, const std::vector<T>& newer) {
  for (const T& item : newer) {
    const auto at =
        std::find_if(into.begin(), into.end(), [&](const T& i) { return i.name == item.name; });
    if (at == into.end())
      into.push_back(item);
    else
      *at = item;
  }
}

template <typename T>
void add_replaced(std::string& out, const std::string& what, const T* old) {
  if (old == nullptr) return;
  out += (out.empty() ? "" : ", ") + what;
  if (!old->origin.date.empty()) out += " of " + old->origin.date;
}

/// What merge() replaces: "camera target of 2026-01-31T10:00:00Z, pose tof"; may be empty.
std::string replaced(const Calibration& old, const Calibration& newer) {
  const auto both = [](const auto& a, const auto& b) { return a && b ? &*a : nullptr; };
  std::string out;
  for (const auto& camera : newer.cameras)
    add_replaced(out, "camera " + camera.name, old.camera(camera.name));
  for (const auto& pose : newer.poses) add_replaced(out, "pose " + pose.name, old.pose(pose.name));
  add_replaced(out, "depth_error", both(old.depth_error, newer.depth_error));
  add_replaced(out, "depth_error2", both(old.depth_error2, newer.depth_error2));
  add_replaced(out, "pan_tilt", both(old.pan_tilt, newer.pan_tilt));
  return out;
}

}  // namespace

const CalibratedCamera* Calibration::camera(std::string_view name) const {
  return named(cameras, name);
}
const CalibratedPose* Calibration::pose(std::string_view name) const { return named(poses, name); }

void merge(Calibration& into, const Calibration& newer) {
  const std::vector<CalibratedCamera> before = into.cameras;
  merge_named(into.cameras, newer.cameras);
  // A calibration at one lens setting knows neither the vignetting nor the other settings.
  for (CalibratedCamera& camera : into.cameras) {
    const auto* old = named(before, camera.name);
    if (old && camera.vignetting.is_none()) camera.vignetting = old->vignetting;
    const bool may = geometry::kind_of(camera.model) == geometry::LensKind::kPinhole;
    if (old && may && !camera.lens &&
        geometry::size_px(old->model) == geometry::size_px(camera.model))
      camera.lens = old->lens;
  }
  merge_named(into.poses, newer.poses);
  if (newer.depth_error) into.depth_error = newer.depth_error;
  if (newer.depth_error2) into.depth_error2 = newer.depth_error2;
  if (newer.pan_tilt) into.pan_tilt = newer.pan_tilt;
}

Result<void> write_calibration(const std::filesystem::path& path, const Calibration& calibration) {
  return write_file(path, calibration_text(calibration));
}

Result<void> update_calibration(const std::filesystem::path& path, const Calibration& newer) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return write_calibration(path, newer);
  MIXRIG_ASSIGN(Calibration whole, read_calibration(path));
  const std::string old = replaced(whole, newer);
  if (!old.empty()) log_warning("calibrate", path.string() + ": replaces " + old);
  merge(whole, newer);
  return write_calibration(path, whole);
}

Result<void> InputHash::add_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return system_error(ErrorCode::kNotFound, "cannot read '" + path.string() + "'", errno);
  char part[65536];
  while (file.read(part, sizeof(part)) || file.gcount() > 0)
    add_bytes({part, static_cast<std::size_t>(file.gcount())});
  return {};
}

void InputHash::add_bytes(std::string_view bytes) {
  for (const char c : bytes) state_ = (state_ ^ static_cast<unsigned char>(c)) * 0x100000001b3;
}

std::string InputHash::text() const { return fmt::format("{:016x}", state_); }

Origin origin_now(const InputHash& hash) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char date[32];
  std::strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return {date, "mixrig " MIXRIG_VERSION, hash.text()};
}

}  // namespace mixrig::calibration_file
