// SPDX-License-Identifier: Apache-2.0
// Follows the scene file of a run: saved changes are composited from the next frames on.
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

#include "hal/base/clock.h"
#include "host/render/contract/compositor.h"
#include "host/run/controls/edit_history.h"
#include "host/run/session/scene_setup.h"

namespace mixrig::session {

struct Session;

/// A version of the scene from which a compositor can be made.
struct EditedScene {
  scene::Scene scene;
  std::vector<MeshArrays> meshes;  ///< meshes of `scene`
};
using EditedScenePtr = std::shared_ptr<const EditedScene>;

/// Values of a frame that replace those of the setup.
struct FrameScene {
  std::vector<geometry::Pose> world_from_object;  ///< of the objects of the scene in use
  std::vector<glm::vec3> lamp_intensity;          ///< of the lamps of the scene in use
  render::FrameLight light;                       ///< points to lamp_intensity
};

/// Counts of the versions of the scene file in a run.
struct SceneEdits {
  std::uint64_t taken = 0;    ///< composited, or about to be
  std::uint64_t refused = 0;  ///< refused with an error
};

/// Reads new versions of the file. A live run watches it in a separate thread; a run of a recording
/// looks at it before each frame, so that the same edits give the same pictures. Objects (with
/// their models), light and key may change; other changes cause a warning and apply at the next
/// start. Where people touch or push objects, objects may only be moved. A file that cannot be read
/// causes a warning, and the previous scene stays.
class SceneFollower {
 public:
  /// `session` must outlive it.
  SceneFollower(const Session& session, bool live);
  ~SceneFollower();
  SceneFollower(const SceneFollower&) = delete;
  SceneFollower& operator=(const SceneFollower&) = delete;

  /// Shows an object at another place, or a lamp with another intensity, from the next frame on
  /// until the file is read again. Any thread. Names that the scene does not have are ignored.
  void preview_object(std::string_view name, const geometry::Pose& world_from_object);
  void preview_lamp(std::string_view name, const Eigen::Vector3f& intensity);
  /// Shows the scene as it is in the file again. Any thread.
  void drop_previews();
  /// To be held from reading to writing by whoever changes the file, so that no change is lost.
  std::mutex& edit_mutex() { return edit_mutex_; }
  /// Edits of whoever changes the file.
  EditHistory& history() { return history_; }
  /// The newest version; null if the session's own is. Any thread.
  EditedScenePtr newest() const;
  SceneEdits edits() const;

  /// Before a frame, in the compositing thread: the version that came since the last call; null:
  /// none.
  EditedScenePtr take_edited();
  /// In the compositing thread: sets `frame` to current poses and light for the objects and lamps
  /// of `in_use`. Returns false if these equal those of `in_use` and did so at the last call.
  /// Allocates only if `in_use` has more objects or lamps than before.
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
  Stamp read_stamp_, last_stamp_;  ///< used by the watching thread only
  std::mutex edit_mutex_;
  const SystemClock clock_;
  EditHistory history_{clock_};
  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable wake_;
  bool ends_ = false;
  EditedScenePtr newest_;
  bool is_new_ = false;
  std::vector<std::pair<std::string, geometry::Pose>> object_previews_;
  std::vector<std::pair<std::string, Eigen::Vector3f>> lamp_previews_;
  bool previewed_ = false;  ///< the last fill() gave values other than those of the scene in use
  SceneEdits edits_;
  std::thread thread_;  ///< last: it uses the other members
};

}  // namespace mixrig::session
