// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/map_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/tables.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::reconstruction {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "points.bin is little-endian");

constexpr std::string_view kMagic = "mixrigM1";
constexpr int kMostPoints = 2'000'000, kMostDescriptors = 8'000'000, kMostKeys = 10'000;

/// A point as it lies in the file.
struct PointRecord {
  double place[3];
  double covariance[6];  ///< xx xy xz yy yz zz
  double px[2];
  std::int32_t views, key;
};
static_assert(sizeof(PointRecord) == 96);

struct DescriptorRecord {
  std::int32_t point;
  Descriptor values;
};
static_assert(sizeof(DescriptorRecord) == 132);

constexpr std::size_t kHeader = 16;  ///< magic, number of points, number of descriptors

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
T value_at(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

std::string points_text(const LearnedMap& map) {
  std::string bytes(kMagic);
  append(bytes, static_cast<std::int32_t>(map.points.size()));
  append(bytes, static_cast<std::int32_t>(map.descriptors.size()));
  for (const MapPoint& p : map.points) {
    const Eigen::Matrix3d& c = p.covariance;
    append(bytes, PointRecord{{p.place.x(), p.place.y(), p.place.z()},
                              {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)},
                              {p.px.x(), p.px.y()},
                              p.views,
                              p.key});
  }
  for (const MapDescriptor& d : map.descriptors) append(bytes, DescriptorRecord{d.point, d.values});
  return bytes;
}

std::string manifest_text(const LearnedMap& map) {
  config::Writer root;
  root.set("format", 1).set("camera", map.camera);
  root.set("calibration_hash", map.calibration_hash);
  root.set("scale", map.scale ? "metric" : "unknown");
  if (map.scale)
    root.set("scale_sigma", config::rounded(map.scale->sigma, 4))
        .set("scale_measurements", map.scale->measurements);
  root.set("pictures", map.pictures).set("residual_px", config::rounded(map.residual_px, 4));
  root.set("axes", map.room ? "room" : "map");
  if (map.room) {
    root.set("room_sigma_mm", config::rounded(1e3 * map.room->sigma_m, 5));
    root.set("room_sigma_deg", config::rounded(map.room->sigma_rad / kDeg, 5));
  }
  root.set("keys", static_cast<int>(map.keys.size()));
  root.set("points", static_cast<int>(map.points.size()));
  root.set("descriptors", static_cast<int>(map.descriptors.size()));
  if (map.room && map.room->world_from_room)
    root.set("world_from_room", calibration_file::pose_table(*map.room->world_from_room));
  return root.text();
}

fs::path picture_of_key(const fs::path& folder, std::size_t key) {
  return folder / "keys" / fmt::format("{:04}.png", key + 1);
}

Error bad_points(const std::string& name, const std::string& what) {
  return {ErrorCode::kFormat, name + ": " + what + ": learn the map again"};
}

Result<MapPoint> point_of(const PointRecord& r, int keys, const std::string& name) {
  MapPoint p;
  p.place = Eigen::Vector3d(r.place);
  const double* c = r.covariance;
  p.covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  p.px = {r.px[0], r.px[1]};
  p.views = r.views, p.key = r.key;
  constexpr double kFarthest = 1e9;
  if (!(p.place.cwiseAbs().maxCoeff() < kFarthest) || !p.covariance.allFinite() ||
      !(p.px.cwiseAbs().maxCoeff() < kFarthest))
    return bad_points(name, "holds a value that is not finite");
  if (p.key < 0 || p.key >= keys || p.views < 0)
    return bad_points(name, "names a key picture that is not there");
  return p;
}

RoomAxes room_axes(const config::Table& root) {
  constexpr double kMost_mm = 1e4, kMost_deg = 180;
  RoomAxes room;
  room.sigma_m = 1e-3 * root.number("room_sigma_mm", {0, kMost_mm});
  room.sigma_rad = kDeg * root.number("room_sigma_deg", {0, kMost_deg});
  const config::Table pose = root.table("world_from_room");
  const geometry::Pose world_from_room = calibration_file::parse_pose(pose);
  if (pose.present()) room.world_from_room = world_from_room;
  return room;
}

}  // namespace

std::string tum_text(const std::vector<trajectory::TimedPose>& poses) {
  std::string text = "# t x y z qx qy qz qw of map_from_camera\n";
  for (const auto& pose : poses) {
    const auto& t = pose.world_from_body.translation_m;
    const auto& q = pose.world_from_body.rotation;
    text += fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.t_s,
                        t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

Result<MapManifest> parse_map_manifest(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(auto document, config::Document::parse(text, name));
  const config::Table root = document.root();
  MapManifest manifest;
  root.integer("format", {1, 1});
  manifest.map.camera = root.one_of("camera", {"fisheye", "target"}, 0) == 0 ? "fisheye" : "target";
  manifest.map.calibration_hash = root.text_or("calibration_hash", "");
  const bool metric = root.one_of("scale", {"unknown", "metric"}, 0) == 1;
  if (metric)
    manifest.map.scale =
        MapScale{root.number("scale_sigma", {0, 10}), root.integer("scale_measurements", {0, 1e9})};
  manifest.map.pictures = root.integer("pictures", {1, 1e9});
  manifest.map.residual_px = root.number("residual_px", {0, 1e3});
  if (root.one_of("axes", {"map", "room"}, 0) == 1) manifest.map.room = room_axes(root);
  manifest.keys = root.integer("keys", {1, kMostKeys});
  manifest.points = root.integer("points", {1, kMostPoints});
  manifest.descriptors = root.integer("descriptors", {0, kMostDescriptors});
  MIXRIG_TRY(document.finish());
  return manifest;
}

Result<MapPoints> parse_map_points(std::span<const std::byte> bytes, int keys,
                                   const std::string& name) {
  if (bytes.size() < kHeader || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
    return bad_points(name, "is no file of points");
  const auto points = value_at<std::int32_t>(bytes, kMagic.size());
  const auto descriptors = value_at<std::int32_t>(bytes, kMagic.size() + sizeof(std::int32_t));
  if (points < 0 || points > kMostPoints || descriptors < 0 || descriptors > kMostDescriptors)
    return bad_points(name, "states an impossible number of points");
  const std::size_t after_points = kHeader + static_cast<std::size_t>(points) * sizeof(PointRecord);
  if (bytes.size() !=
      after_points + static_cast<std::size_t>(descriptors) * sizeof(DescriptorRecord))
    return bad_points(name, fmt::format("has {} bytes, which is not the length of {} points and {} "
                                        "descriptors",
                                        bytes.size(), points, descriptors));
  MapPoints read;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points); ++i) {
    MIXRIG_ASSIGN(
        const MapPoint point,
        point_of(value_at<PointRecord>(bytes, kHeader + i * sizeof(PointRecord)), keys, name));
    read.points.push_back(point);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(descriptors); ++i) {
    const auto d = value_at<DescriptorRecord>(bytes, after_points + i * sizeof(DescriptorRecord));
    if (d.point < 0 || d.point >= points)
      return bad_points(name, "has a descriptor of a point that is not there");
    read.descriptors.push_back({d.point, d.values});
  }
  return read;
}

Result<void> write_map(const LearnedMap& map, const fs::path& folder) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, kMapManifest));
  std::error_code error;
  if (!fs::create_directory(partial.path() / "keys", error))
    return Error{ErrorCode::kIo, (partial.path() / "keys").string() + ": cannot be made"};
  std::vector<trajectory::TimedPose> keys;
  for (std::size_t k = 0; k < map.keys.size(); ++k) {
    keys.push_back({map.keys[k].time_s, map.keys[k].map_from_camera});
    MIXRIG_TRY(image_io::write_png(picture_of_key(partial.path(), k), map.keys[k].grey.view()));
  }
  MIXRIG_TRY(write_file(partial.path() / "points.bin", points_text(map)));
  MIXRIG_TRY(write_file(partial.path() / "keys.tum", tum_text(keys)));
  MIXRIG_TRY(write_file(partial.path() / "path.tum", tum_text(map.path)));
  MIXRIG_TRY(write_file(partial.path() / kMapManifest, manifest_text(map)));
  return partial.commit();
}

Result<LearnedMap> load_map(const fs::path& folder) {
  constexpr std::size_t kMostManifest = 1 << 16, kMostBytes = std::size_t{1} << 31;
  std::error_code error;
  const fs::path manifest_file = folder / kMapManifest, points_file = folder / "points.bin";
  if (!fs::is_regular_file(manifest_file, error))
    return Error{
        ErrorCode::kNotFound,
        folder.string() + ": is no learned map (it has no map.toml): make one by mixrig learn"};
  MIXRIG_ASSIGN(const std::string text, config::read_text(manifest_file, kMostManifest));
  MIXRIG_ASSIGN(MapManifest manifest, parse_map_manifest(text, manifest_file.string()));
  LearnedMap map = std::move(manifest.map);
  MIXRIG_ASSIGN(const std::string bytes, config::read_text(points_file, kMostBytes));
  MIXRIG_ASSIGN(MapPoints points, parse_map_points(std::as_bytes(std::span(bytes)), manifest.keys,
                                                   points_file.string()));
  if (static_cast<int>(points.points.size()) != manifest.points)
    return bad_points(points_file.string(), "has another number of points than map.toml says");
  map.points = std::move(points.points), map.descriptors = std::move(points.descriptors);
  MIXRIG_ASSIGN(const auto poses, trajectory::read_samples(folder / "keys.tum"));
  MIXRIG_ASSIGN(map.path, trajectory::read_samples(folder / "path.tum"));
  if (static_cast<int>(poses.size()) != manifest.keys)
    return Error{ErrorCode::kFormat, (folder / "keys.tum").string() +
                                         ": has another number of poses than map.toml says: learn "
                                         "the map again"};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const geometry::Pose& pose = poses[k].world_from_body;
    if (!pose.translation_m.allFinite() || !(std::abs(pose.rotation.norm() - 1) < 1e-3))
      return Error{ErrorCode::kFormat, (folder / "keys.tum").string() +
                                           ": holds a pose that is none: learn the map again"};
    MapKey key{poses[k].t_s, {pose.rotation.normalized(), pose.translation_m}, {}};
    MIXRIG_TRY(image_io::read_gray8(picture_of_key(folder, k), key.grey));
    map.keys.push_back(std::move(key));
  }
  return map;
}

}  // namespace mixrig::reconstruction
