// SPDX-License-Identifier: Apache-2.0
// Writes a take with truth and a scene from the virtual studio.
#include "studio/io/studio_take.h"

#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "hal/base/partial_path.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/image_io.h"
#include "host/scene/gltf/glb_writer.h"
#include "studio/io/bracket.h"
#include "studio/io/fisheye_pictures.h"
#include "studio/io/moving_rig.h"
#include "studio/io/stopped.h"
#include "studio/stage/court.h"

namespace mixrig::studio_io {
namespace {

using config::Writer;

geometry::Pinhole pinhole_of(const studio::Optics& o) {
  return {o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px};
}

geometry::CameraModel camera_of(const studio::Optics& o) {
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  return {pinhole_of(o), geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})};
}

/// Digits in scene.toml: enough for half a micrometre at 5 m.
constexpr int kSceneDigits = 7;
constexpr int kTimeDigits = 9;  ///< microseconds at 100 s

template <typename Vector>
std::vector<double> rounded_values(const Vector& v) {
  std::vector<double> values;
  for (int i = 0; i < v.size(); ++i) values.push_back(config::rounded(v[i], kSceneDigits));
  return values;
}

Writer pose_table(const geometry::Pose& pose) {
  Writer table;
  table.set("rotation_xyzw", rounded_values(Eigen::Vector4d(pose.rotation.coeffs())));
  table.set("translation_m", rounded_values(pose.translation_m));
  return table;
}

Writer object_table(const studio::VirtualObject& object) {
  const geometry::Pose& pose = object.world_from_object;
  Writer table;
  table.set("name", object.name).set("model", "models/" + object.name + ".glb");
  table.set("position_m", rounded_values(pose.translation_m));
  table.set("rotation_xyzw", rounded_values(Eigen::Vector4d(pose.rotation.coeffs())));
  table.set("scale", 1.0).set("casts_shadow", true);
  return table;
}

Writer lamp_table(const studio::Panel& lamp) {
  Writer table;
  table.set("name", lamp.name).set("position_m", rounded_values(lamp.position_m));
  table.set("direction", rounded_values(lamp.direction));
  table.set("size_m", rounded_values(lamp.size_m));
  table.set("intensity", rounded_values(lamp.intensity));
  return table;
}

/// The tables that every scene has.
void add_object_light_and_key(const studio::StudioInfo& info, Writer& root) {
  Writer light, key;
  light.set("ambient", rounded_values(info.light.ambient));
  light.set("exposure", config::rounded(info.light.exposure, 6));
  // Only in the plain look does the same ambient light come from all sides.
  if (!info.light.by_direction) light.set("ambient_by", "constant");
  for (const studio::Panel& lamp : info.light.lamps) light.add("lamp", lamp_table(lamp));
  key.set("threshold_m", 0.05).set("noise_factor", 4.0);
  root.add("object", object_table(info.object));
  root.set("light", std::move(light)).set("key", std::move(key));
}

/// `camera` says where the pose comes from; `calibration` may be empty.
std::string scene_text(const studio::StudioInfo& info, Writer camera,
                       const std::string& calibration = {}) {
  Writer root, background;
  if (!calibration.empty()) root.set("calibration", calibration);
  background.set("learn", std::array<int, 2>{1, info.empty_frames});
  root.set("camera", std::move(camera)).set("background", std::move(background));
  add_object_light_and_key(info, root);
  return root.text();
}

/// Text of a scene that learns nothing: the capture volume keys, and a set replaces the room.
std::string set_scene_text(const studio::StudioInfo& info, const std::string& set_name) {
  Writer root, camera, volume, set;
  volume.set("min_m", rounded_values(info.capture_volume.min_m));
  volume.set("max_m", rounded_values(info.capture_volume.max_m));
  camera.set("pose", "take").set("capture_volume", std::move(volume));
  set.set("model", "models/" + set_name + ".glb").set("picture", "models/sky.png");
  root.set("camera", std::move(camera)).set("set", std::move(set));
  add_object_light_and_key(info, root);
  return root.text();
}

Result<void> write_object(const studio::VirtualObject& object, const std::filesystem::path& path) {
  scene::Model model;
  for (const studio::ObjectMesh& part : object.meshes) {
    scene::Mesh mesh;
    mesh.positions_m = part.positions_m, mesh.normals = part.normals, mesh.uv = part.uv;
    mesh.roughness = part.roughness;
    mesh.specular = part.glossy ? 1 : 0;
    mesh.indices = part.indices, mesh.texture = static_cast<int>(model.textures.size());
    model.meshes.push_back(std::move(mesh));
    model.textures.push_back(part.texture);
  }
  return scene::write_glb(model, object.name, path);
}

Result<void> write_set(const studio::StudioInfo& info, const std::filesystem::path& folder) {
  constexpr Size kSky{512, 410};
  const studio::VirtualObject court = studio::build_court();
  MIXRIG_TRY(write_object(court, folder / "models" / (court.name + ".glb")));
  MIXRIG_TRY(image_io::write_png(folder / "models" / "sky.png", studio::paint_sky(kSky)));
  return write_file(folder / "scene_set.toml", set_scene_text(info, court.name));
}

/// The encoders' values, and scene_zoom.toml, which uses the true table of the lens; scene.toml has
/// the lens at rest in all frames.
Result<void> write_lens(const studio::StudioOptions& options, const studio::StudioInfo& info,
                        const std::filesystem::path& folder) {
  std::string rows = "time_ns,zoom,focus\n";
  for (const studio::LensSample& sample : studio::record_lens(options, info))
    fmt::format_to(std::back_inserter(rows), "{},{},{}\n", std::llround(1e9 * sample.time_s),
                   sample.at.zoom, sample.at.focus);
  MIXRIG_TRY(write_file(folder / "lens.csv", rows));
  Writer camera;
  camera.set("pose", "take");
  return write_file(folder / "scene_zoom.toml",
                    scene_text(info, std::move(camera), "truth/calibration.toml"));
}

/// A raw frame, with the first one the device's tables, and the true distances of the ToF camera's
/// picture in steps of 0.25 mm.
Result<void> write_raw(const studio::StudioInfo& info, const studio::Frame& frame,
                       const std::filesystem::path& folder) {
  constexpr float kStepsPerMetre = 4000;
  const auto text = [](const std::vector<std::uint8_t>& bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const std::filesystem::path raw = folder / "raw", truth = folder / "truth/tof_distance";
  std::error_code failed;
  std::filesystem::create_directories(raw, failed);
  if (!failed) std::filesystem::create_directories(truth, failed);
  if (failed) return system_error(ErrorCode::kIo, "cannot create " + raw.string(), failed.value());
  if (frame.number == 1) {
    MIXRIG_TRY(write_file(raw / "phase_offsets.bin", text(info.raw->phase_offsets)));
    MIXRIG_TRY(write_file(raw / "infrared.bin", text(info.raw->infrared)));
  }
  MIXRIG_TRY(write_file(raw / fmt::format("{:06d}.bin", frame.number), text(frame.raw)));
  Image<std::uint16_t> steps(frame.tof_true_m.size());
  for (int y = 0; y < steps.height(); ++y)
    for (int x = 0; x < steps.width(); ++x)
      steps.row(y)[x] = static_cast<std::uint16_t>(
          std::min(65535L, std::lround(kStepsPerMetre * frame.tof_true_m.row(y)[x])));
  return image_io::write_png(truth / fmt::format("{:06d}.png", frame.number),
                             std::as_const(steps).view());
}

/// Distances to the room from the foot of the unit, where the panorama of a scan has its origin.
Result<void> write_room_truth(const studio::Studio& studio, const std::filesystem::path& folder) {
  image_io::Channel distance{"distance_m", Image<float>(Size{1440, 720})};
  studio.room_distances(world_from_base(studio.info()), distance.pixels);
  return image_io::write_exr(folder / "truth/room.exr", {distance});
}

capture::SecondDepthCamera second_camera(const studio::TofInfo& tof) {
  return {.model = camera_of(tof.optics),
          .target_from_tof = tof.target_from_tof,
          .kind = capture::DepthKind::kDistance,
          .noise = {tof.noise.floor_m, tof.noise.linear, tof.noise.quadratic_per_m},
          .unit_m = tof.depth_unit_m,
          .amplitude_is_light = true};
}

/// Exposure time of a picture `delay_s` after the frame's mid-exposure.
HostTime exposed_at(const capture::Capture& capture, double delay_s) {
  return capture.mid_exposure + Duration(std::llround(1e9 * delay_s));
}

}  // namespace

take::TakeInfo studio_take_info(const studio::StudioInfo& info) {
  take::TakeInfo take;
  take.name = info.name;
  take.rate_hz = take.color.rate_hz = take.depth.rate_hz = info.rate_hz;
  take.color.count = take.depth.count = info.frames;
  take.depth.delay_s = info.tof.delay_s;
  if (info.raw)
    take.raw_depth = "kinect2";
  else
    take.amplitude = take.depth;
  if (info.fisheye_pictures > 0)
    take.fisheye = take::StreamInfo{{}, 1, info.fisheye_pictures, info.fisheye_rate_hz};
  take.target = camera_of(info.target);
  take.tof = camera_of(info.tof.optics);
  take.view = pinhole_of(info.view);
  take.target_from_tof = info.tof.target_from_tof;
  take.depth_kind = capture::DepthKind::kDistance;
  take.amplitude_is_light = true;
  take.depth_unit_m = info.tof.depth_unit_m;
  take.noise = {info.tof.noise.floor_m, info.tof.noise.linear, info.tof.noise.quadratic_per_m};
  if (info.tof2) {
    take.tof2 = second_camera(*info.tof2);
    take.depth2 = take::SecondDepthStream{take.depth, take.depth};
    take.depth2->depth.delay_s = info.tof2->delay_s;
    take.depth2->amplitude->delay_s = 0;
  }
  take.has_poses = take.has_truth = take.true_poses = true;
  take.moves = info.camera_moves;
  take.frames = info.frames;
  return take;
}

void swap_into(const studio::StudioInfo& info, studio::Frame& from, capture::Capture& to) {
  using capture::Stream;
  using capture::StreamStatus;
  to.number = from.number;
  to.time_s = from.time_s;
  to.mid_exposure = HostTime(Duration(std::llround(from.time_s * 1e9)));
  to.world_from_target = from.world_from_target;
  to.pose_origin = capture::PoseOrigin::kRecorded;
  to.tick = 0;
  to.pan_tilt.reset();
  to.encoders.reset(), to.lens.reset();
  to.status = {};
  to.set_status(Stream::kPlate, StreamStatus::kFresh);
  to.set_status(Stream::kDepth, StreamStatus::kFresh);
  if (from.head) {
    to.tick = tick_of(from.number);
    to.pan_tilt = device::PanTiltAngles{from.head->pan_rad, from.head->tilt_rad};
    to.set_status(Stream::kPanTilt, StreamStatus::kFresh);
  }
  std::swap(from.color, to.plate);
  std::swap(from.tof_distance_m, to.depth_m);
  std::swap(from.tof_amplitude, to.amplitude);
  to.depth_mid_exposure = exposed_at(to, info.tof.delay_s);
  if (!info.tof2) return;
  to.set_status(Stream::kDepth2, StreamStatus::kFresh);
  std::swap(from.tof2_distance_m, to.depth2.depth_m);
  std::swap(from.tof2_amplitude, to.depth2.amplitude);
  to.depth2.mid_exposure = exposed_at(to, info.tof2->delay_s);
}

void swap_into(studio::Truth& from, capture::Truth& to) {
  std::swap(from.depth_m, to.depth_m);
  std::swap(from.matte, to.matte);
  std::swap(from.light, to.light);
  std::swap(from.composite, to.composite);
  std::swap(from.labels, to.labels);
  to.people.clear();
  for (const studio::PersonTruth& p : from.people)
    to.people.push_back({static_cast<int>(to.people.size()), p.on_floor_m.x(), p.on_floor_m.y(),
                         p.top_m, p.visible_m2});
  to.lens.reset();
  if (from.view) to.lens = capture::TrueLens{pinhole_of(*from.view), from.pupil_shift_m};
}

Result<void> write_scene(const studio::StudioInfo& info, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder / "models", failed);
  if (failed)
    return system_error(ErrorCode::kIo, "cannot create " + (folder / "models").string(),
                        failed.value());
  MIXRIG_TRY(write_object(info.object, folder / "models" / (info.object.name + ".glb")));
  Writer own;
  own.set("pose", "take");
  MIXRIG_TRY(write_file(folder / "scene.toml", scene_text(info, std::move(own))));
  MIXRIG_TRY(write_set(info, folder));
  if (info.pan_tilt) {
    Writer camera;
    camera.set("pose", "pan_tilt").set("world_from_base", pose_table(world_from_base(info)));
    MIXRIG_TRY(write_file(folder / "scene_pan_tilt.toml",
                          scene_text(info, std::move(camera), "truth/calibration.toml")));
  }
  if (!info.mocap) return {};
  Writer camera;
  camera.set("pose", "recorded").set("trajectory", "mocap_target.txt");
  camera.set("time_offset_s", config::rounded(mocap_time_offset_s(info), kTimeDigits));
  return write_file(folder / "scene_mocap.toml", scene_text(info, std::move(camera)));
}

namespace {

/// Writes all but the end of a take. `info` is that of the studio at rest: a lens may zoom.
Result<void> write_frames(const studio::StudioOptions& options, studio::Studio& studio,
                          const studio::StudioInfo& info, const take::TakeInfo& take,
                          take::TakeWriter& writer, const std::function<void(int)>& progress,
                          const std::atomic<bool>* stop) {
  MIXRIG_TRY(write_scene(info, writer.staging()));
  if (options.zoom > 1) MIXRIG_TRY(write_lens(options, info, writer.staging()));
  studio::Frame frame;
  studio::Truth truth;
  capture::Capture take_frame;
  capture::Truth take_truth;
  std::vector<studio::HeadAngles> head;
  FisheyePictures fisheye;
  std::vector<take::BracketRow> bracket;
  for (int number = 1; number <= info.frames; ++number) {
    studio.render(number, frame, &truth);
    if (frame.head) head.push_back(*frame.head);
    if (info.raw) MIXRIG_TRY(write_raw(info, frame, writer.staging()));
    swap_into(info, frame, take_frame);
    swap_into(truth, take_truth);
    fisheye.add_to(studio, take_frame);
    MIXRIG_TRY(writer.write(take_frame));
    MIXRIG_TRY(writer.write_truth(take_truth));
    if (options.sweep.bracket && number % options.sweep.frames_per_view == 0)
      MIXRIG_TRY(add_bracket(studio, number, take_frame.plate, writer.staging(), bracket));
    progress(number);
    MIXRIG_TRY(check_stop(stop, number, info.frames));
  }
  if (options.scenario == studio::Scenario::kSweep)
    MIXRIG_TRY(write_room_truth(studio, writer.staging()));
  if (options.sweep.bracket) MIXRIG_TRY(write_bracket(studio, bracket, writer.staging()));
  if (take.fisheye) {
    MIXRIG_TRY(write_file(writer.staging() / kFisheyeTruth, fisheye.truth()));
    MIXRIG_TRY(write_file(writer.staging() / kFisheyePeople, fisheye.people()));
  }
  return write_moving_rig(options, info, take, head, writer.staging());
}

}  // namespace

Result<studio::StudioInfo> write_studio_take(const studio::StudioOptions& options,
                                             const std::filesystem::path& folder,
                                             take::StreamFormat format,
                                             const std::function<void(int)>& progress,
                                             const std::atomic<bool>* stop) {
  MIXRIG_ASSIGN(studio::Studio studio, studio::Studio::create(options));
  const studio::StudioInfo info = studio.info();
  const take::TakeInfo take = studio_take_info(info);
  MIXRIG_ASSIGN(take::TakeWriter writer, take::TakeWriter::create(folder, take, format));
  const Result<void> done = write_frames(options, studio, info, take, writer, progress, stop);
  if (!done) {
    writer.discard();
    return done.error();
  }
  MIXRIG_TRY(writer.finish());
  return info;
}

}  // namespace mixrig::studio_io
