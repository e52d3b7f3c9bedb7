// SPDX-License-Identifier: Apache-2.0
// Follows the scene file of a run: what is saved there is composited from the next frames on.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/render/contract/compositor.h"
#include "host/run/session/scene_setup.h"

namespace mixrig::session {

struct Session;

/// A version of the scene that a compositor can be made of.
struct EditedScene {
  scene::Scene scene;
  std::vector<MeshArrays> meshes;  ///< of the scene
};
using EditedScenePtr = std::shared_ptr<const EditedScene>;

/// What a frame is composited with in place of the setup's.
struct FrameScene {
  std::vector<geometry::Pose> world_from_object;  ///< of the objects of the scene in use
  std::vector<glm::vec3> lamp_intensity;          ///< of its lamps
  render::FrameLight light;                       ///< points to lamp_intensity
};

/// Versions of the scene file in a run.
struct SceneEdits {
  std::uint64_t taken = 0;    ///< composited, or about to be
  std::uint64_t refused = 0;  ///< with an error
};

/// A live run watches the file in a thread of its own; that of a recording looks at it before each
/// frame, so that the same edits give the same pictures. Objects (with their models), light and key
/// can change; other keys are warned of, and taken at the next start. Where people touch or push
/// objects, those stay the same and may only be moved. A file that cannot be read is warned of, and
/// the run goes on with the scene before.
class SceneFollower {
 public:
  /// `session` outlives it.
  SceneFollower(const Session& session, bool live);
  ~SceneFollower();
  SceneFollower(const SceneFollower&) = delete;
  SceneFollower& operator=(const SceneFollower&) = delete;

  /// Any thread: where an object stands, and how bright a lamp is, from the next frame on and until
  /// the file is read again. Names that the scene does not have are ignored.
  void preview_object(std::string_view name, const geometry::Pose& world_from_object);
  void preview_lamp(std::string_view name, const Eigen::Vector3f& intensity);
  /// Whoever changes the file holds it from reading to writing, so that no change is lost.
  std::mutex& edit_mutex() { return edit_mutex_; }
  /// Any thread: the newest version; null where the session's own is.
  EditedScenePtr newest() const;
  SceneEdits edits() const;

  /// For the compositing thread, before a frame: the version that came since the last call; null:
  /// none.
  EditedScenePtr take_edited();
  /// For the same thread: poses and light of now, for the objects and lamps of `in_use`. False
  /// where they are as `in_use` has them, and were at the last call. Allocates only where `in_use`
  /// has more objects or lamps than before.
  bool fill(const scene::Scene& in_use, FrameScene& frame);

 private:
  using Stamp = std::vector<std::pair<std::filesystem::file_time_type, std::uintmax_t>>;

  void watch();
  void look();
  Stamp stamp_of(const scene::Scene& scene) const;
  void read();
  void adopt(scene::Scene scene);
  const scene::Scene& newest_scene() const;

  const Session& session_;
  const bool live_;
  Stamp read_stamp_, last_stamp_;  ///< of the watching thread
  std::mutex edit_mutex_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_;
  bool ends_ = false;
  EditedScenePtr newest_;
  bool is_new_ = false;
  std::vector<std::pair<std::string, geometry::Pose>> object_previews_;
  std::vector<std::pair<std::string, Eigen::Vector3f>> lamp_previews_;
  bool previewed_ = false;  ///< fill() gave something other than the scene in use has
  SceneEdits edits_;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace mixrig::session
