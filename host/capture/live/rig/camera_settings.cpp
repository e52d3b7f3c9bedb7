// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/camera_settings.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/capture/live/rig/rig_edit.h"

namespace mixrig::live {
namespace {

constexpr auto kReadEvery = std::chrono::seconds(2);

std::string range_words(const std::string& camera, const device::ControlRange& range) {
  const ControlKey key = control_key(range.control);
  return fmt::format("{}: {} must be {:g} to {:g}", camera, key.key, range.minimum * key.unit,
                     range.maximum * key.unit);
}

}  // namespace

void CameraSettings::follow(std::vector<Named> cameras) {
  end();
  cameras_ = std::move(cameras);
  {
    const std::lock_guard lock(mutex_);
    ends_ = false;
    fault_.reset();
    for (const Named& one : cameras_) {
      CameraSetup& setup = setups_.emplace_back();
      setup.name = one.name;
      for (const device::ControlRange& range : one.camera->info().controls)
        setup.settings.push_back({range, std::nullopt});
    }
  }
  thread_ = guarded_thread(
      "setting the cameras", [this] { run(); }, [this](const Error& error) { fail(error); });
}

/// Called by the thread that ends: no setting waits for ever.
void CameraSettings::fail(const Error& error) {
  log_warning("rig", error.context + ": the cameras keep their settings");
  const std::lock_guard lock(mutex_);
  fault_ = error;
  wish_.reset();
  answer_ = error;
  answered_.notify_all();
}

void CameraSettings::end() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    setups_.clear();
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  cameras_.clear();
}

std::vector<CameraSetup> CameraSettings::cameras() const {
  const std::lock_guard lock(mutex_);
  return setups_;
}

/// Returns the index of the camera after checking the value. Precondition: mutex_ is held.
Result<std::size_t> CameraSettings::check(const std::string& camera, device::CameraControl control,
                                          double value) const {
  const auto setup = std::find_if(setups_.begin(), setups_.end(),
                                  [&](const CameraSetup& one) { return one.name == camera; });
  if (setup == setups_.end())
    return Error{ErrorCode::kNotFound, "no camera \"" + camera + "\" runs"};
  const auto found =
      std::find_if(setup->settings.begin(), setup->settings.end(),
                   [&](const CameraSetting& one) { return one.range.control == control; });
  if (found == setup->settings.end())
    return Error{ErrorCode::kUnsupported,
                 camera + ": " + std::string(device::name(control)) + " is not on this camera"};
  if (!(value >= found->range.minimum && value <= found->range.maximum))
    return Error{ErrorCode::kUsage, range_words(camera, found->range)};
  return static_cast<std::size_t>(setup - setups_.begin());
}

Result<void> CameraSettings::set(const std::string& camera, device::CameraControl control,
                                 double value) {
  std::unique_lock lock(mutex_);
  MIXRIG_ASSIGN(const std::size_t index, check(camera, control, value));
  if (fault_) return *fault_;
  if (std::exchange(waits_, true))
    return Error{ErrorCode::kData,
                 camera + ": another setting of the camera is being changed: try again"};
  wish_ = {index, control, value};
  answer_.reset();
  wake_.notify_all();
  answered_.wait(lock, [this] { return answer_.has_value(); });
  waits_ = false;
  return *std::exchange(answer_, std::nullopt);
}

/// Reads all settings; called by the thread.
void CameraSettings::read() {
  std::vector<CameraSetup> now = cameras();
  for (std::size_t i = 0; i < now.size(); ++i)
    for (CameraSetting& setting : now[i].settings) {
      const auto value = cameras_[i].camera->get(setting.range.control);
      setting.value = value ? std::optional(*value) : std::nullopt;
    }
  const std::lock_guard lock(mutex_);
  if (!ends_) setups_ = std::move(now);
}

void CameraSettings::run() {
  for (;;) {
    read();
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kReadEvery, [this] { return ends_ || wish_; });
    const auto wish = std::exchange(wish_, std::nullopt);
    if (ends_) {
      if (wish) answer_ = Error{ErrorCode::kDevice, "the cameras are being stopped"};
      answered_.notify_all();
      return;
    }
    if (!wish) continue;
    lock.unlock();
    Result<void> done = cameras_[wish->camera].camera->set(wish->control, wish->value);
    if (done) read();  // the new values are visible before the answer
    lock.lock();
    answer_ = std::move(done);
    answered_.notify_all();
  }
}

}  // namespace mixrig::live
