// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/camera_desk.h"

#include <memory>

#include "hal/base/partial_path.h"
#include "host/capture/live/rig/camera_settings.h"
#include "host/capture/live/rig/rig_edit.h"
#include "host/math/config/table.h"

namespace mixrig::session {
namespace {

constexpr std::size_t kMostRigBytes = std::size_t{1} << 20;

/// Controls and values in their own units, of names and units of rig.toml.
std::vector<std::pair<device::CameraControl, double>> controls_of(const page::SetCamera& set) {
  std::vector<std::pair<device::CameraControl, double>> values;
  for (const auto& [name, value] : set.values)
    for (int i = 0; i < device::kCameraControls; ++i) {
      const auto control = static_cast<device::CameraControl>(i);
      const live::ControlKey key = live::control_key(control);
      if (key.key == name) values.emplace_back(control, value / key.unit);
    }
  return values;
}

}  // namespace

/// Notes the value in force, unless a preview has replaced it already.
void CameraDesk::keep_settled(const std::string& camera, device::CameraControl control) {
  for (const live::CameraSetup& setup : session_.cameras->cameras())
    for (const live::CameraSetting& setting : setup.settings)
      if (setup.name == camera && setting.range.control == control && setting.value)
        settled_.try_emplace({camera, control}, *setting.value);
}

CameraDesk::Values CameraDesk::take_settled(const std::string& camera, const Values& changed) {
  Values before;
  for (const auto& [control, value] : changed)
    if (const auto found = settled_.find({camera, control}); found != settled_.end()) {
      before.emplace_back(control, found->second);
      settled_.erase(found);
    }
  return before;
}

Result<void> CameraDesk::apply(const page::SetCamera& set) {
  if (!session_.cameras)
    return Error{ErrorCode::kUnsupported,
                 "this run has no cameras that can be set: a recording is "
                 "played"};
  const std::filesystem::path& rig = session_.source->info().file;
  MIXRIG_ASSIGN(const std::string before, config::read_text(rig, kMostRigBytes));
  std::string text = before;
  const Values wanted = controls_of(set);
  for (const auto& [control, value] : wanted) {
    keep_settled(set.name, control);
    MIXRIG_TRY(session_.cameras->set(set.name, control, value));
    zoomed_ = zoomed_ || control == device::CameraControl::kZoom;
    focused_ = focused_ || control == device::CameraControl::kFocus;
    if (set.preview) continue;
    MIXRIG_ASSIGN(text, live::with_control(text, rig.string(), set.name, control, value));
  }
  if (set.preview) return {};
  MIXRIG_TRY(write_file(rig, text));
  const auto to = [cameras = session_.cameras, name = set.name](const Values& values) {
    return [cameras, name, values]() -> Result<void> {
      for (const auto& [control, value] : values) MIXRIG_TRY(cameras->set(name, control, value));
      return {};
    };
  };
  history_.add({"set camera " + set.name, rig, before, text, to(take_settled(set.name, wanted)),
                to(wanted)});
  return {};
}

Result<void> CameraDesk::discard() {
  for (const auto& [key, value] : settled_)
    if (session_.cameras) MIXRIG_TRY(session_.cameras->set(key.first, key.second, value));
  settled_.clear();
  return {};
}

}  // namespace mixrig::session
