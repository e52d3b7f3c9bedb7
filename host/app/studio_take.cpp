// SPDX-License-Identifier: Apache-2.0
// From the virtual studio to a take with truth and a scene beside it.
#include "host/app/studio_take.h"

#include <fstream>
#include <sstream>

#include "host/app/glb_writer.h"

namespace mixrig::app {
namespace {

geometry::Pinhole pinhole_of(const studio::Optics& o) {
  return {o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px};
}

geometry::CameraModel camera_of(const studio::Optics& o) {
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  return {pinhole_of(o), geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})};
}

/// "[a, b, c]"
template <typename Vector>
std::string list(const Vector& v) {
  std::ostringstream text;
  text << "[";
  for (int i = 0; i < v.size(); ++i) {
    std::ostringstream number;
    number.precision(7);
    number << std::showpoint << v[i];
    text << (i > 0 ? ", " : "") << number.str();
  }
  text << "]";
  return text.str();
}

std::string scene_text(const studio::StudioInfo& info) {
  const studio::VirtualObject& object = info.object;
  const Eigen::Quaterniond& turn = object.world_from_object.rotation;
  std::ostringstream text;
  text << "# Scene of the virtual studio's take \"" << info.name << "\".\n"
       << "[camera]\npose = \"take\"\n\n"
       << "[background]\nlearn = [1, " << info.empty_frames << "]\n\n"
       << "[[object]]\nname = \"" << object.name << "\"\nmodel = \"models/" << object.name
       << ".glb\"\n"
       << "position_m = " << list(object.world_from_object.translation_m) << "\n"
       << "rotation_xyzw = " << list(Eigen::Vector4d(turn.coeffs())) << "\n"
       << "scale = 1.0\ncasts_shadow = true\n\n"
       << "[light]\nambient = " << list(info.light.ambient)
       << "\nexposure = " << info.light.exposure << "\n";
  for (const studio::Panel& lamp : info.light.lamps)
    text << "\n[[light.lamp]]\nname = \"" << lamp.name
         << "\"\nposition_m = " << list(lamp.position_m) << "\ndirection = " << list(lamp.direction)
         << "\nsize_m = " << list(lamp.size_m) << "\nintensity = " << list(lamp.intensity) << "\n";
  text << "\n[key]\nthreshold_m = 0.05\nnoise_factor = 4.0\ncolor = true\n";
  return text.str();
}

}  // namespace

take::TakeInfo studio_take_info(const studio::StudioInfo& info) {
  take::TakeInfo take;
  take.name = info.name;
  take.color.rate_hz = take.depth.rate_hz = info.rate_hz;
  take.color.count = take.depth.count = info.frames;
  take.amplitude = take.depth;
  take.target = camera_of(info.target);
  take.tof = camera_of(info.tof.optics);
  take.view = pinhole_of(info.view);
  take.target_from_tof = info.tof.target_from_tof;
  take.depth_kind = take::DepthKind::kDistance;
  take.depth_unit_m = info.tof.depth_unit_m;
  take.noise = {info.tof.noise.floor_m, info.tof.noise.linear, info.tof.noise.quadratic_per_m};
  take.has_poses = take.has_truth = true;
  take.frames = info.frames;
  return take;
}

void swap_into(studio::Frame& from, take::TakeFrame& to) {
  to.number = from.number;
  to.time_s = from.time_s;
  to.world_from_target = from.world_from_target;
  std::swap(from.color, to.color);
  std::swap(from.tof_distance_m, to.depth_m);
  std::swap(from.tof_amplitude, to.amplitude);
}

void swap_into(studio::Truth& from, take::TruthFrame& to) {
  std::swap(from.depth_m, to.depth_m);
  std::swap(from.matte, to.matte);
  std::swap(from.light, to.light);
  std::swap(from.composite, to.composite);
  std::swap(from.labels, to.labels);
}

Result<void> write_scene(const studio::StudioInfo& info, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder / "models", failed);
  if (failed)
    return system_error(ErrorCode::kIo, "cannot create " + (folder / "models").string(),
                        failed.value());
  MIXRIG_TRY(write_glb(info.object, folder / "models" / (info.object.name + ".glb")));
  const std::filesystem::path path = folder / "scene.toml", partial = folder / "scene.toml.partial";
  std::ofstream file(partial);
  file << scene_text(info);
  file.close();
  if (file) std::filesystem::rename(partial, path, failed);
  if (!file || failed)
    return Error{ErrorCode::kIo, "cannot write " + path.string() + ": check the disk's free space"};
  return {};
}

Result<studio::StudioInfo> write_studio_take(const studio::StudioOptions& options,
                                             const std::filesystem::path& folder,
                                             take::StreamFormat format,
                                             const std::function<void(int)>& progress) {
  MIXRIG_ASSIGN(studio::Studio studio, studio::Studio::create(options));
  const studio::StudioInfo& info = studio.info();
  MIXRIG_ASSIGN(take::TakeWriter writer,
                take::TakeWriter::create(folder, studio_take_info(info), format));
  MIXRIG_TRY(write_scene(info, writer.staging()));
  studio::Frame frame;
  studio::Truth truth;
  take::TakeFrame take_frame;
  take::TruthFrame take_truth;
  for (int number = 1; number <= info.frames; ++number) {
    studio.render(number, frame, &truth);
    swap_into(frame, take_frame);
    swap_into(truth, take_truth);
    MIXRIG_TRY(writer.write(take_frame));
    MIXRIG_TRY(writer.write_truth(take_truth));
    progress(number);
  }
  MIXRIG_TRY(writer.finish());
  return info;
}

}  // namespace mixrig::app
