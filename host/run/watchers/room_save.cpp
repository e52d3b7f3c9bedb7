// SPDX-License-Identifier: Apache-2.0
#include "hal/base/partial_path.h"
#include "host/room/scan/room_file.h"
#include "host/room/sweep/room_scan.h"
#include "host/run/watchers/change_sink.h"
#include "host/run/watchers/room_keeper.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

Result<void> save_kept_room(const fs::path& from, const model::RoomFaces& before,
                            const model::RoomFaces& after, const fs::path& folder) {
  MIXRIG_ASSIGN(model::RoomFile room, model::load_room(from));
  model::take_changes(before, after, room.panorama);
  Crew crew;
  room.manifest.mesh_tolerance_m = model::mesh_tolerance_m(room.panorama);
  const model::RoomMesh mesh = model::simplified(
      model::grid_mesh(room.panorama), room.panorama.size(), room.manifest.mesh_tolerance_m, crew);
  room.manifest.triangles = static_cast<int>(mesh.indices.size() / 3);
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, "manifest.toml"));
  MIXRIG_TRY(write_mesh(mesh, room.panorama.color, partial.path() / "room.glb"));
  MIXRIG_TRY(model::write_room(room.panorama, room.manifest, partial.path()));
  return partial.commit();
}

}  // namespace

Result<void> check_save(const Session& session, const fs::path& folder) {
  if (!ChangeSink::can_watch(session))
    return Error{ErrorCode::kUsage,
                 "--save-room " + folder.string() +
                     ": this run does not watch its background: it needs background.model or "
                     "background.learn, and a lens that stands still"};
  if (session.rooms.size() > 1 || (!session.rooms.empty() && session.background))
    return Error{ErrorCode::kUsage,
                 "--save-room " + folder.string() +
                     ": the scene joins several backgrounds, and one is written: run with one of "
                     "them alone as background.model"};
  return {};
}

Result<void> save_kept(const Session& session, const KeptBackground& kept, const fs::path& folder) {
  if (session.rooms.empty()) return model::save(*kept.view, folder);
  return save_kept_room(*session.scene.background.model, session.rooms.front(), kept.rooms.front(),
                        folder);
}

}  // namespace mixrig::session
