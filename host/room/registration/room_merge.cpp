// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/room_merge.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <system_error>

#include "hal/base/partial_path.h"
#include "host/room/registration/joined_mesh.h"
#include "host/scene/gltf/glb_writer.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool same_place(const fs::path& p, const fs::path& q) {
  std::error_code error;
  const fs::path left = fs::weakly_canonical(p, error), right = fs::weakly_canonical(q, error);
  return !error && left == right;
}

Error merge_usage(const std::string& why) { return {ErrorCode::kUsage, "scan --merge: " + why}; }

/// Checks the folders. An OUT that is a scanned room is refused: it may be the last room, and OUT
/// forgotten.
Result<void> check_folders(const std::vector<fs::path>& rooms, const fs::path& out) {
  if (out.empty() || rooms.size() < 2 || rooms.size() > model::kMostJoined)
    return merge_usage("give 2 to 4 scanned rooms and then OUT, the folder to write");
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    if (same_place(rooms[i], out))
      return merge_usage("OUT is '" + rooms[i].string() + "', one of the rooms: give another OUT");
    for (std::size_t k = 0; k < i; ++k)
      if (same_place(rooms[k], rooms[i]))
        return merge_usage("'" + rooms[i].string() +
                           "' is given twice: give rooms scanned from different positions");
  }
  if (model::is_room(out) && fs::exists(out / "room.exr"))
    return merge_usage(
        "OUT '" + out.string() +
        "' is a scanned room itself: give another OUT after the rooms, or remove it");
  return {};
}

Result<std::vector<model::RoomFile>> read_rooms(const std::vector<fs::path>& folders) {
  std::vector<model::RoomFile> rooms;
  for (const fs::path& folder : folders) {
    if (!model::is_room(folder))
      return merge_usage("'" + folder.string() +
                         "' is not a scanned room: give folders that scan --take or --rig wrote");
    MIXRIG_ASSIGN(auto read, model::load_rooms(folder));
    if (read.size() != 1)
      return merge_usage("'" + folder.string() +
                         "' is a joined room: give the rooms that it was made of, up to 4 at once");
    rooms.push_back(std::move(read.front().room));
  }
  return rooms;
}

Result<void> copy_room(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directory(to, error);
  for (const char* name : {"manifest.toml", "room.exr", "color.png", "distance.png"}) {
    if (!fs::exists(from / name)) continue;
    fs::copy_file(from / name, to / name, error);
    if (error)
      return system_error(ErrorCode::kIo, "cannot copy '" + (from / name).string() + "'",
                          error.value());
  }
  return {};
}

/// One glb, a material for each room.
Result<std::size_t> write_joined_mesh(std::vector<model::RoomFile>& rooms,
                                      const std::vector<model::JoinedPlace>& places,
                                      const fs::path& path, Crew& crew) {
  std::vector<model::JoinedPart> parts;
  for (std::size_t i = 0; i < rooms.size(); ++i)
    parts.push_back({&rooms[i].panorama, places[i].first_from_base});
  std::vector<model::RoomMesh> grids = model::joined_grids(parts, crew);
  scene::Model file;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    model::Panorama& panorama = rooms[i].panorama;
    if (grids[i].indices.empty()) continue;
    model::RoomMesh mesh =
        model::simplified(grids[i], panorama.size(), model::mesh_tolerance_m(panorama), crew);
    if (mesh.indices.empty()) continue;
    model::place(places[i].first_from_base, mesh);
    triangles += mesh.indices.size() / 3;
    scene::Mesh& out = file.meshes.emplace_back();
    out.positions_m = std::move(mesh.positions_m), out.normals = std::move(mesh.normals);
    out.uv = std::move(mesh.uv), out.indices = std::move(mesh.indices);
    out.texture = static_cast<int>(file.textures.size());
    file.textures.push_back(std::move(panorama.color));
  }
  if (!file.meshes.empty()) MIXRIG_TRY(scene::write_glb(file, "room", path));
  return triangles;
}

}  // namespace

Result<RoomMerge> merge_rooms(const RoomMergeOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  MIXRIG_TRY(check_folders(options.rooms, options.out));
  MIXRIG_ASSIGN(auto rooms, read_rooms(options.rooms));
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(options.out, "manifest.toml"));
  Crew crew(options.threads);
  RoomMerge merge;
  std::vector<model::JoinedPlace> places{{"room_1", {}}};
  const auto registering = std::chrono::steady_clock::now();
  for (std::size_t i = 1; i < rooms.size(); ++i) {
    model::RegistrationOptions how;
    if (i == 1) how.near_a_from_b = options.near_first_from_base;
    auto found = model::register_rooms(rooms[0].panorama, rooms[i].panorama, how, crew);
    if (!found)
      return Error{found.error().code, "'" + options.rooms[0].string() + "' and '" +
                                           options.rooms[i].string() +
                                           "': " + found.error().context};
    places.push_back(
        {"room_" + std::to_string(i + 1), found->a_from_b, found->sigma_m, found->sigma_rad});
    merge.registrations.push_back(std::move(*found));
  }
  merge.register_seconds = seconds_since(registering);
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    MIXRIG_TRY(copy_room(options.rooms[i], partial.path() / places[i].folder));
    merge.triangles_alone += static_cast<std::size_t>(rooms[i].manifest.triangles);
  }
  const auto meshing = std::chrono::steady_clock::now();
  MIXRIG_ASSIGN(merge.triangles,
                write_joined_mesh(rooms, places, partial.path() / "room.glb", crew));
  merge.mesh_seconds = seconds_since(meshing);
  MIXRIG_TRY(model::write_joined(places, static_cast<int>(merge.triangles), partial.path()));
  MIXRIG_TRY(partial.commit());
  merge.seconds = seconds_since(start);
  return merge;
}

}  // namespace mixrig::session
