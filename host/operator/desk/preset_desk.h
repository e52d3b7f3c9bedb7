// SPDX-License-Identifier: Apache-2.0
// Presets beside a scene: files presets/NAME.toml with tables of its objects, light, focus and
// look.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "host/operator/desk/scene_desk.h"
#include "host/operator/page/operator.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Thread-safe.
class PresetDesk {
 public:
  /// Both must outlive it.
  PresetDesk(const Session& session, SceneDesk& scene);

  /// Errors: kUsage where the name is taken; kIo.
  Result<void> apply(const page::StorePreset& store);
  /// Errors: kNotFound; those of SceneDesk::recall().
  Result<void> apply(const page::RecallPreset& recall);
  Result<void> apply(const page::RemovePreset& remove);
  /// Presets by name, with what differs from the newest version of the scene. Files are read again
  /// when a preset or the scene has changed.
  std::vector<page::PresetState> presets() const;

 private:
  using Text = std::pair<std::string, std::string>;  ///< name, text
  std::filesystem::path file_of(const std::string& name) const;
  void read_files() const;
  void compare(const scene::Scene& now) const;

  const Session& session_;
  SceneDesk& scene_;
  const std::filesystem::path folder_;
  mutable std::mutex mutex_;  ///< guards the members below
  mutable std::filesystem::file_time_type read_{};
  mutable std::vector<Text> texts_;
  mutable EditedScenePtr compared_with_;
  mutable bool is_compared_ = false;
  mutable std::vector<page::PresetState> states_;
};

}  // namespace mixrig::session
