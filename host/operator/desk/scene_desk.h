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
  Result<void> apply(const page::RemoveObject& remove);
  Result<void> apply(const page::SetLamp& set);
  Result<void> apply(const page::AddLamp& add, const SeenFrom* from);
  Result<void> apply(const page::RemoveLamp& remove);
  Result<void> apply(const page::SetFocus& set);
  /// Sets the background of the next start: a path as in scene.toml, relative to the file.
  Result<void> use_background(const std::filesystem::path& model);
  Result<void> save();

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
  Result<void> write_lamps(std::string text, const std::vector<scene::Lamp>& lamps) const;
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
