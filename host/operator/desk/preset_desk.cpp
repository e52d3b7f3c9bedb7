// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/preset_desk.h"

#include <algorithm>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/scene/preset_text.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPresetBytes = std::size_t{1} << 20, kMostPresets = 200;

}  // namespace

PresetDesk::PresetDesk(const Session& session, SceneDesk& scene)
    : session_(session), scene_(scene), folder_(session.scene.path.parent_path() / "presets") {}

fs::path PresetDesk::file_of(const std::string& name) const { return folder_ / (name + ".toml"); }

Result<void> PresetDesk::apply(const page::StorePreset& store) {
  const fs::path file = file_of(store.name);
  std::error_code code;
  if (!store.replace && fs::exists(file, code))
    return Error{ErrorCode::kUsage,
                 "there is a preset \"" + store.name + "\": give another name, or replace it"};
  MIXRIG_ASSIGN(const std::string text, scene_.snapshot());
  fs::create_directories(folder_, code);
  if (code)
    return system_error(ErrorCode::kIo, "cannot make folder " + folder_.string(), code.value());
  const std::lock_guard lock(mutex_);
  read_ = {};
  return write_file(file, text);
}

Result<void> PresetDesk::apply(const page::RecallPreset& recall) {
  const auto text = config::read_text(file_of(recall.name), kMostPresetBytes);
  if (!text) return Error{ErrorCode::kNotFound, "there is no preset \"" + recall.name + "\""};
  auto done = scene_.recall(*text, recall.name);
  if (done) return done;
  return Error{done.error().code,
               "the preset \"" + recall.name + "\" cannot be used: " + done.error().context};
}

Result<void> PresetDesk::apply(const page::RemovePreset& remove) {
  std::error_code code;
  const std::lock_guard lock(mutex_);
  read_ = {};
  if (!fs::remove(file_of(remove.name), code) && !code)
    return Error{ErrorCode::kNotFound, "there is no preset \"" + remove.name + "\""};
  if (code) return system_error(ErrorCode::kIo, "cannot remove the preset", code.value());
  return {};
}

/// Reads the files if the folder has changed. Precondition: mutex_ is held.
void PresetDesk::read_files() const {
  std::error_code code;
  const auto stamp = fs::last_write_time(folder_, code);
  if (!code && stamp == read_) return;
  read_ = code ? fs::file_time_type{} : stamp;
  texts_.clear(), is_compared_ = false;
  if (code) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, code)) {
    if (entry.path().extension() != ".toml" || texts_.size() >= kMostPresets) continue;
    if (auto text = config::read_text(entry.path(), kMostPresetBytes))
      texts_.emplace_back(entry.path().stem().string(), *std::move(text));
  }
  std::sort(texts_.begin(), texts_.end());
}

/// Precondition: mutex_ is held.
void PresetDesk::compare(const scene::Scene& now) const {
  states_.clear();
  for (const auto& [name, text] : texts_) {
    page::PresetState& state = states_.emplace_back();
    state.name = name;
    const auto there = scene::parse_scene(text, session_.scene.path, false);
    if (there)
      state.differences = scene::differences(now, *there);
    else
      state.differences = {"cannot be read: " + there.error().context};
  }
}

std::vector<page::PresetState> PresetDesk::presets() const {
  const EditedScenePtr now = scene_.newest();
  const std::lock_guard lock(mutex_);
  read_files();
  if (is_compared_ && now == compared_with_) return states_;
  compare(now ? now->scene : session_.scene);
  compared_with_ = now, is_compared_ = true;
  return states_;
}

}  // namespace mixrig::session
