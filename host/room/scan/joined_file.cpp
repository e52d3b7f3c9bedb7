// SPDX-License-Identifier: Apache-2.0
// Joined rooms: a manifest over folders of rooms.
#include "hal/base/angles.h"
#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/tables.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"
#include "host/room/scan/room_file.h"

namespace mixrig::model {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJoinedManifest = "manifest.toml";
constexpr double kJoinedMm = 1000;

/// Whether the manifest is one of a joined room; what else is wrong in it, the readers tell.
bool is_joined(config::Document& document) { return document.root().has("room"); }

Result<std::vector<JoinedPlace>> parse_joined(config::Document& document) {
  const config::Table root = document.root();
  root.integer("format", {1, 1});
  root.one_of("projection", {"joined"}, 0);
  root.integer("triangles", {0, 1e9});
  const std::vector<config::Table> tables = root.tables("room");
  if (tables.size() < 2 || tables.size() > kMostJoined)
    root.fail("room", "a joined room has 2 to 4 rooms: join them again by mixrig scan --merge");
  std::vector<JoinedPlace> places;
  for (const config::Table& table : tables) {
    JoinedPlace place;
    place.folder = table.text("folder");
    // The name of a folder beside the manifest, and no path out of it.
    if (place.folder.empty() || place.folder.starts_with('.') ||
        place.folder.find_first_of("/\\") != std::string::npos)
      table.fail("folder", "must be the name of a folder beside manifest.toml");
    place.first_from_base = calibration_file::parse_pose(table.required_table("first_from_base"));
    place.sigma_m = table.number("sigma_mm", {0, 1e6}) / kJoinedMm;
    place.sigma_rad = table.number("sigma_deg", {0, 360}) * kDeg;
    places.push_back(std::move(place));
  }
  MIXRIG_TRY(document.finish());
  return places;
}

}  // namespace

Result<void> write_joined(std::span<const JoinedPlace> rooms, int triangles,
                          const fs::path& folder) {
  config::Writer root;
  root.set("format", 1).set("projection", "joined").set("triangles", triangles);
  for (const JoinedPlace& place : rooms) {
    config::Writer table;
    table.set("folder", place.folder);
    table.set("sigma_mm", config::rounded(kJoinedMm * place.sigma_m, 4));
    table.set("sigma_deg", config::rounded(place.sigma_rad / kDeg, 4));
    table.set("first_from_base", calibration_file::pose_table(place.first_from_base));
    root.add("room", std::move(table));
  }
  return write_file(folder / kJoinedManifest, root.text());
}

Result<std::vector<PlacedRoom>> load_rooms(const fs::path& folder) {
  MIXRIG_ASSIGN(auto document, config::Document::read(folder / kJoinedManifest));
  std::vector<PlacedRoom> rooms;
  if (!is_joined(document)) {
    MIXRIG_ASSIGN(RoomFile room, load_room(folder));
    rooms.push_back({std::move(room), {}});
    return rooms;
  }
  MIXRIG_ASSIGN(const auto places, parse_joined(document));
  for (const JoinedPlace& place : places) {
    MIXRIG_ASSIGN(RoomFile room, load_room(folder / place.folder));
    rooms.push_back({std::move(room), place.first_from_base, place.sigma_m, place.sigma_rad});
  }
  return rooms;
}

}  // namespace mixrig::model
