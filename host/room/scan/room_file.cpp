// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/room_file.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/tables.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/exr_channel.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::model {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRoomManifest = "manifest.toml";
constexpr const char* kLightFile = "color.exr";
constexpr double kPct = 100, kRoomMm = 1000;
constexpr int kMostColorFactor = 8;

std::string room_text(const Panorama& p, const RoomManifest& manifest) {
  config::Writer root;
  root.set("format", 1).set("projection", "equirectangular").set("origin", "base");
  root.set("size_px", std::array<int, 2>{p.size().width, p.size().height});
  root.set("views", manifest.views).set("frames", manifest.frames);
  root.set("measured_pct", config::rounded(kPct * p.measured_share, 6));
  root.set("fill_pct", config::rounded(kPct * p.known_share, 6));
  root.set("triangles", manifest.triangles);
  root.set("mesh_tolerance_mm", config::rounded(kRoomMm * manifest.mesh_tolerance_m, 6));
  root.set("calibration_hash", manifest.calibration_hash);
  if (manifest.distance_sigma > 0)
    root.set("distance_sigma_pct", config::rounded(kPct * manifest.distance_sigma, 6));
  calibration_file::set_vignetting(root, manifest.vignetting);
  if (manifest.world_from_base)
    root.set("world_from_base", calibration_file::pose_table(*manifest.world_from_base));
  return root.text();
}

/// The manifest, and of the panorama its size and shares.
Result<RoomFile> read_room_manifest(const fs::path& path) {
  MIXRIG_ASSIGN(auto document, config::Document::read(path));
  const config::Table root = document.root();
  RoomFile room;
  root.integer("format", {1, 1});
  root.one_of("projection", {"equirectangular"}, 0);
  root.one_of("origin", {"base"}, 0);
  const auto size = root.numbers("size_px", 2, 2, {2, 16384});
  const Size size_px{static_cast<int>(size[0]), static_cast<int>(size[1])};
  if (size_px.width != 2 * size_px.height || size_px.height % 2 != 0)
    root.fail("size_px", "must be twice as wide as high, and of even height: scan the room again");
  room.manifest.views = root.integer("views", {1, 1e6});
  room.manifest.frames = root.integer("frames", {1, 1e9});
  room.panorama.measured_share = root.number("measured_pct", {0, 100.001}) / kPct;
  room.panorama.known_share = root.number("fill_pct", {0, 100.001}) / kPct;
  room.manifest.triangles = root.integer("triangles", {0, 1e9});
  room.manifest.mesh_tolerance_m = root.number("mesh_tolerance_mm", {0, 1e6}) / kRoomMm;
  room.manifest.calibration_hash = root.text_or("calibration_hash", "");
  room.manifest.distance_sigma = root.number_or("distance_sigma_pct", 0, {0, 50}) / kPct;
  room.manifest.vignetting = calibration_file::parse_vignetting(root);
  const config::Table pose = root.table("world_from_base");
  const geometry::Pose world_from_base = calibration_file::parse_pose(pose);
  if (pose.present()) room.manifest.world_from_base = world_from_base;
  MIXRIG_TRY(document.finish());
  room.panorama.distance_m.reset(size_px);
  return room;
}

}  // namespace

bool is_room(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / kRoomManifest, error);
}

Result<void> write_room(const Panorama& p, const RoomManifest& manifest, const fs::path& folder) {
  image_io::Channel views{"views", Image<float>(p.size())};
  Image<std::uint16_t> distance_mm(p.size());
  for (int y = 0; y < p.size().height; ++y)
    for (int x = 0; x < p.size().width; ++x) {
      views.pixels.row(y)[x] = p.views.row(y)[x];
      distance_mm.row(y)[x] = static_cast<std::uint16_t>(
          std::clamp(static_cast<float>(kRoomMm) * p.distance_m.row(y)[x], 0.0F, 65535.0F));
    }
  MIXRIG_TRY(image_io::write_exr(
      folder / "room.exr",
      {{"distance_m", p.distance_m}, {"sigma_m", p.sigma_m}, std::move(views)}));
  MIXRIG_TRY(image_io::write_png(folder / "color.png", p.color.view()));
  MIXRIG_TRY(image_io::write_png(folder / "distance.png",
                                 ImageView<const std::uint16_t>(distance_mm.view())));
  if (!p.light.empty())
    MIXRIG_TRY(image_io::write_light_exr(folder / kLightFile, p.light, p.light_saturated));
  return write_file(folder / kRoomManifest, room_text(p, manifest));
}

Result<void> load_light(const fs::path& folder, Panorama& p) {
  const fs::path path = folder / kLightFile;
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  MIXRIG_ASSIGN(auto channels, image_io::read_exr(path));
  const Size size = p.color.size();
  MIXRIG_ASSIGN(const auto red, take_channel(channels, "R", size, path));
  MIXRIG_ASSIGN(const auto green, take_channel(channels, "G", size, path));
  MIXRIG_ASSIGN(const auto blue, take_channel(channels, "B", size, path));
  MIXRIG_ASSIGN(const auto saturated, take_channel(channels, "saturated", size, path));
  p.light.reset(size), p.light_saturated.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      p.light.row(y)[x] = {half_of_float(red.row(y)[x]), half_of_float(green.row(y)[x]),
                           half_of_float(blue.row(y)[x])};
      p.light_saturated.row(y)[x] = saturated.row(y)[x] > 0 ? 1 : 0;
    }
  return {};
}

Result<RoomManifest> read_manifest(const fs::path& folder) {
  MIXRIG_ASSIGN(RoomFile room, read_room_manifest(folder / kRoomManifest));
  return std::move(room.manifest);
}

Result<RoomFile> load_room(const fs::path& folder) {
  MIXRIG_ASSIGN(RoomFile room, read_room_manifest(folder / kRoomManifest));
  Panorama& p = room.panorama;
  const Size size = p.size();
  const fs::path path = folder / "room.exr";
  MIXRIG_ASSIGN(auto channels, image_io::read_exr(path));
  MIXRIG_ASSIGN(p.distance_m, take_channel(channels, "distance_m", size, path));
  MIXRIG_ASSIGN(p.sigma_m, take_channel(channels, "sigma_m", size, path));
  MIXRIG_ASSIGN(const auto views, take_channel(channels, "views", size, path));
  p.views.reset(size);
  p.field.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      p.views.row(y)[x] = static_cast<std::uint8_t>(std::min(views.row(y)[x], 255.0F));
      p.field.row(y)[x] = p.distance_m.row(y)[x] > 0 ? 1 : 0;
    }
  const fs::path color = folder / "color.png";
  MIXRIG_TRY(image_io::read_rgb8(color, p.color));
  const int factor = p.color.height() / size.height;
  if (factor < 1 || factor > kMostColorFactor ||
      p.color.size() != Size{factor * size.width, factor * size.height})
    return Error{ErrorCode::kData, "'" + color.string() +
                                       "' is not one to eight times as large as size_px in " +
                                       kRoomManifest + " says: scan the room again"};
  return room;
}

}  // namespace mixrig::model
