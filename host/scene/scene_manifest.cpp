// SPDX-License-Identifier: Apache-2.0
// Reads scene.toml.
#include "host/scene/scene_manifest.h"

#include <charconv>
#include <cmath>
#include <numbers>

#include "host/capture/calibration_file/tables.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"
#include "host/scene/read_camera.h"
#include "host/scene/read_outputs.h"
#include "host/scene/read_quality.h"

namespace mixrig::scene {
namespace {

using config::Range;
using config::Table;

constexpr Range kPlace_m{-1e4, 1e4};
constexpr Range kLight{0.0, 1e6};

Eigen::Vector3d vector_or(const Table& table, const char* key, const Eigen::Vector3d& fallback,
                          Range range) {
  if (!table.has(key)) return fallback;
  const auto v = table.numbers(key, 3, 3, range);
  return {v[0], v[1], v[2]};
}

Eigen::Vector3d vector(const Table& table, const char* key) {
  const auto v = table.numbers(key, 3, 3, kPlace_m);
  return {v[0], v[1], v[2]};
}

/// Reads three numbers, or one for all three.
Eigen::Vector3f color_or(const Table& table, const char* key, const Eigen::Vector3f& fallback) {
  if (!table.has(key)) return fallback;
  if (table.is_number(key))
    return Eigen::Vector3f::Constant(static_cast<float>(table.number(key, kLight)));
  return vector_or(table, key, {}, kLight).cast<float>();
}

Eigen::Quaterniond read_rotation(const Table& table) {
  const double yaw_rad = table.number_or("yaw_deg", 0.0, {-3600, 3600}) * std::numbers::pi / 180.0;
  if (!table.has("rotation_xyzw"))
    return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  const auto q = table.numbers("rotation_xyzw", 4, 4, {-2, 2});
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (table.has("yaw_deg")) table.fail("yaw_deg", "given beside rotation_xyzw: remove one of them");
  if (std::abs(rotation.norm() - 1.0) > 0.01)
    table.fail("rotation_xyzw", "its length is not 1: give a unit quaternion");
  return rotation.norm() > 0 ? rotation.normalized() : Eigen::Quaterniond::Identity();
}

/// Reads the key `model`.
void read_model(const Table& table, const std::filesystem::path& folder, bool load_model,
                Object& object) {
  object.model_path = config::path_at(table, "model", folder);
  if (!load_model || !table.has("model")) return;
  auto model = load_gltf(object.model_path);
  if (model)
    object.model = *std::move(model);
  else
    table.fail("model", model.error());
}

std::optional<ObjectPhysics> read_physics(const Table& table) {
  ObjectPhysics physics;
  if (!table.present()) return std::nullopt;
  physics.mass_kg = table.number("mass_kg", {0.001, 1000});
  physics.bounce = table.number_or("bounce", physics.bounce, {0, 1});
  physics.friction = table.number_or("friction", physics.friction, {0, 10});
  physics.drag = table.number_or("drag", physics.drag, {0, 1});
  physics.is_ball = table.one_of("shape", {"hull", "ball"}, 0) == 1;
  if (table.has("velocity_m_s")) {
    const auto v = table.numbers("velocity_m_s", 3, 3, {-12, 12});
    physics.velocity_m_s = {v[0], v[1], v[2]};
  }
  return physics;
}

/// Reads "HOST:PORT"; empty if the key is absent.
std::string read_udp(const Table& table, const char* key) {
  const std::string udp = table.text_or(key, "");
  const std::size_t colon = udp.rfind(':');
  int port = 0;
  const char* const end = udp.data() + udp.size();
  const bool is_address = colon != std::string::npos && colon > 0 && colon < 64 &&
                          std::from_chars(udp.data() + colon + 1, end, port).ptr == end &&
                          port >= 1 && port <= 65535;
  if (!udp.empty() && !is_address)
    table.fail(key, "is no address: give HOST:PORT, such as 127.0.0.1:7420");
  return udp;
}

std::optional<EventSettings> read_events(const Table& table) {
  if (!table.present()) return std::nullopt;
  EventSettings events{read_udp(table, "udp"), read_udp(table, "osc"),
                       table.boolean_or("people", false)};
  if (events.people && events.udp.empty() && events.osc.empty())
    table.fail("people", "has no receiver: give udp or osc too");
  return events;
}

PoseOut read_pose_out(const Table& table) {
  PoseOut out;
  const int protocol = table.one_of("protocol", {"freed", "opentrackio", "opentrackio-cbor"}, 0);
  out.protocol = static_cast<PoseOut::Protocol>(protocol);
  out.udp = read_udp(table, "udp");
  if (out.udp.empty()) table.fail("udp", "is missing: give HOST:PORT of the receiver");
  const Range cameras = protocol == 0 ? Range{0, 255} : Range{1, 200};
  out.camera = table.integer_or("camera", out.camera, cameras);
  out.sensor_width_mm = table.number_or("sensor_width_mm", out.sensor_width_mm, {0.1, 1000});
  out.clock = static_cast<PoseOut::ClockSource>(table.one_of("clock", {"system", "ptp", "ntp"}, 0));
  return out;
}

Object read_object(const Table& table, std::size_t number, const std::filesystem::path& folder,
                   bool load_model) {
  Object object;
  object.name = table.text_or("name", "object " + std::to_string(number));
  object.world_from_object = {read_rotation(table), vector(table, "position_m")};
  object.scale = table.number_or("scale", 1.0, {1e-6, 1e6});
  object.casts_shadow = table.boolean_or("casts_shadow", true);
  object.hidden = table.boolean_or("hidden", false);
  object.physics = read_physics(table.table("physics"));
  read_model(table, folder, load_model, object);
  return object;
}

void check_set_size(const Table& table, const Model& model) {
  constexpr std::size_t kMostTriangles = 2'000'000;
  std::size_t triangles = 0;
  for (const Mesh& mesh : model.meshes) triangles += mesh.indices.size() / 3;
  if (triangles > kMostTriangles)
    table.fail("model", "has " + std::to_string(triangles) + " triangles, a set may have " +
                            std::to_string(kMostTriangles) + ": simplify it");
}

std::optional<VirtualSet> read_set(const Table& table, const std::filesystem::path& folder,
                                   bool load_models) {
  VirtualSet set;
  Object model;
  model.name = "set";
  model.world_from_object = {read_rotation(table),
                             vector_or(table, "position_m", Eigen::Vector3d::Zero(), kPlace_m)};
  model.scale = table.number_or("scale", 1.0, {1e-6, 1e6});
  model.casts_shadow = table.boolean_or("casts_shadow", false);
  if (table.has("model")) {
    read_model(table, folder, load_models, model);
    check_set_size(table, model.model);
    set.model = std::move(model);
  }
  if (table.has("picture")) set.picture_path = config::path_at(table, "picture", folder);
  if (load_models && table.has("picture"))
    if (auto read = image_io::read_rgb8(set.picture_path, set.picture); !read)
      table.fail("picture", read.error());
  if (!table.present()) return std::nullopt;
  return set;
}

Lamp read_lamp(const Table& table, std::size_t number) {
  Lamp lamp;
  lamp.name = table.text_or("name", "lamp " + std::to_string(number));
  lamp.position_m = vector(table, "position_m");
  if (table.has("direction")) {
    const Eigen::Vector3d direction = vector(table, "direction");
    if (direction.norm() < 1e-9)
      table.fail("direction", "has no length: give where the lamp faces");
    lamp.direction = direction.normalized();
  }
  if (table.has("size_m")) {
    const auto size = table.numbers("size_m", 2, 2, {0.0, 100.0});
    lamp.size_m = {size[0], size[1]};
  }
  lamp.intensity = color_or(table, "intensity", lamp.intensity);
  return lamp;
}

Light read_light(const Table& table) {
  Light light;
  light.ambient = color_or(table, "ambient", light.ambient);
  light.exposure = table.number_or("exposure", light.exposure, {1e-6, 1e6});
  light.by_direction = table.one_of("ambient_by", {"constant", "room"}, 1) == 1;
  light.contact = table.boolean_or("contact", light.by_direction);
  light.follow = table.boolean_or("follow", light.follow);
  for (const Table& lamp : table.tables("lamp"))
    light.lamps.push_back(read_lamp(lamp, light.lamps.size() + 1));
  light.find_lamps = table.one_of("lamps", {"given", "find"}, 0) == 1;
  if (light.find_lamps && !light.lamps.empty())
    table.fail("lamps", "\"find\" beside [[light.lamp]]: both give lamps, remove one of the two");
  return light;
}

LookSettings read_look(const Table& table) {
  LookSettings look;
  look.grain = table.boolean_or("grain", look.grain);
  look.blur = table.boolean_or("blur", look.blur);
  look.chroma = table.boolean_or("chroma", look.chroma);
  look.sharpening = table.boolean_or("sharpening", look.sharpening);
  look.motion = table.boolean_or("motion", look.motion);
  look.follow = table.boolean_or("follow", look.follow);
  look.exposure_ms = table.number_or("exposure_ms", look.exposure_ms, {0.0, 1e4});
  return look;
}

Background read_background(const Table& table, const std::filesystem::path& folder) {
  Background background;
  if (table.has("learn")) {
    const auto frames = table.numbers("learn", 2, 2, {1, 1e7});
    background.learn = {static_cast<int>(frames[0]), static_cast<int>(frames[1])};
    if (frames[0] != std::floor(frames[0]) || frames[1] != std::floor(frames[1]) ||
        frames[0] > frames[1])
      table.fail("learn", "must be the first and the last frame: write [1, 25]");
  }
  if (table.has("model")) background.model = config::path_at(table, "model", folder);
  const Table base = table.table("world_from_base");
  const geometry::Pose world_from_base = calibration_file::parse_pose(base);
  if (base.present()) background.world_from_base = world_from_base;
  if (base.present() && !background.model)
    base.fail("translation_m",
              "places a scanned room, and there is none: give model, or remove it");
  background.open_walls = table.one_of("walls", {"closed", "open"}, 0) == 1;
  if (table.present() && !background.learn && !background.model && !table.has("walls"))
    table.fail("learn", "give learn, model, or both for a scanned room");
  return background;
}

KeySettings read_key(const Table& table) {
  KeySettings key;
  key.threshold_m = table.number_or("threshold_m", key.threshold_m, {0.0, 10.0});
  key.noise_factor = table.number_or("noise_factor", key.noise_factor, {0.0, 100.0});
  key.steady = table.boolean_or("steady", key.steady);
  return key;
}

}  // namespace

Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& path,
                          bool load_models) {
  MIXRIG_ASSIGN(auto document, config::Document::parse(text, path.string()));
  const Table root = document.root();
  const std::filesystem::path folder = path.parent_path();
  Scene scene;
  scene.path = path;
  if (root.has("calibration")) scene.calibration = config::path_at(root, "calibration", folder);
  read_camera(root.table("camera"), folder, scene);
  scene.background = read_background(root.table("background"), folder);
  const Table set = root.table("set");
  scene.set = read_set(set, folder, load_models);
  const bool keys = scene.background.learn || scene.background.model || scene.capture_volume;
  if (scene.set && !keys)
    root.fail("set",
              "people cannot be separated from the background: give camera.capture_volume, or "
              "a background to learn");
  for (const Table& object : root.tables("object"))
    scene.objects.push_back(read_object(object, scene.objects.size() + 1, folder, load_models));
  scene.light = read_light(root.table("light"));
  scene.key = read_key(root.table("key"));
  scene.follow_people = root.table("people").boolean_or("follow", false);
  scene.events = read_events(root.table("events"));
  for (const Table& table : root.tables("pose_out"))
    scene.pose_outs.push_back(read_pose_out(table));
  for (const Table& table : root.tables("stream_out"))
    scene.stream_outs.push_back(read_stream_out(table, folder));
  scene.focus = read_focus(root.table("focus"));
  scene.quality = read_quality(root);
  scene.look = read_look(root.table("look"));
  MIXRIG_TRY(document.finish());
  return scene;
}

}  // namespace mixrig::scene
