// SPDX-License-Identifier: Apache-2.0
// Applies an operator's changes to a scene: shown at once, and written into scene.toml.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/operator/desk/room_sight.h"
#include "host/operator/page/operator.h"
#include "host/run/controls/scene_follower.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Writes each change into the scene file whole or not at all; its other text stays, and the run
/// follows the file. Previews are shown without being written, until the file is read again.
/// Thread-safe; several desks on one follower wait for each other.
class SceneDesk {
 public:
  SceneDesk(const Session& session, std::shared_ptr<SceneFollower> follower);

  /// `from`: null before the first frame. Errors: those of page::Operator::apply().
  Result<void> apply(const page::SetObject& set, const SeenFrom* from);
  Result<void> apply(const page::AddObject& add, const SeenFrom* from);
  Result<void> apply(const page::CopyObject& copy, const SeenFrom* from);
  Result<void> apply(const page::RemoveObject& remove);
  Result<void> apply(const page::SetLamp& set);
  Result<void> apply(const page::AddLamp& add, const SeenFrom* from);
  Result<void> apply(const page::RemoveLamp& remove);
  Result<void> apply(const page::SetFocus& set);
  /// Sets the background of the next start: a path as in scene.toml, relative to the file.
  Result<void> use_background(const std::filesystem::path& model);
  Result<void> save();
  /// Objects, light, focus and look as they are shown, as scene::preset_of() makes them.
  Result<std::string> snapshot();
  /// Writes such a text into the scene; previews are dropped. Errors: those of
  /// scene::with_preset().
  Result<void> recall(const std::string& preset, const std::string& name);
  /// Shows the file again in place of previews.
  Result<void> discard();
  /// Takes the last edit of the follower's history back, or makes it again; previews are dropped.
  Result<void> undo();
  Result<void> redo();
  EditHistory& history() const { return follower_->history(); }
  EditedScenePtr newest() const { return follower_->newest(); }

  std::vector<page::ObjectState> objects(const SeenFrom* from) const;
  std::vector<page::LampState> lamps(const SeenFrom* from) const;
  /// Focus settings in the newest version of the file.
  std::optional<scene::FocusSettings> focus() const;

 private:
  /// Previews, and the version of the scene that they belong to.
  struct Previews {
    EditedScenePtr of;
    std::map<std::string, geometry::Pose> poses;
    std::map<std::string, Eigen::Vector3f> lamps;
  };
  /// The scene as it is in the file now, without models.
  struct Written {
    std::string text;
    scene::Scene scene;
  };
  Result<Written> written() const;
  const scene::Scene& shown_scene(const EditedScenePtr& newest) const;
  Previews previews() const;
  Previews& previews_of_now();
  Result<std::string> with_poses(std::string text, const std::string& but_object) const;
  std::vector<scene::Lamp> lamps_of(const scene::Scene& scene) const;
  Result<void> put(const Written& before, const std::string& text, std::string what) const;
  Result<void> write_lamps(const Written& before, const std::vector<scene::Lamp>& lamps,
                           std::string what) const;
  void forget_previews();
  void forget_preview(const std::string& object);
  Result<geometry::Pose> wanted_pose(const scene::Object& object, const page::SetObject& set,
                                     const SeenFrom* from) const;
  Result<Eigen::Vector3d> lamp_position(const page::AddLamp& add, const SeenFrom* from) const;
  Eigen::Vector3f wanted_intensity(const page::SetLamp& set, const Eigen::Vector3f& old);

  const Session& session_;
  std::shared_ptr<SceneFollower> follower_;
  mutable std::mutex mutex_;  ///< guards previews_, dark_
  Previews previews_;
  std::map<std::string, Eigen::Vector3f> dark_;  ///< intensities of lamps that were switched off
};

}  // namespace mixrig::session
