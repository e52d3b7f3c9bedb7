// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/foreign/import.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr ForeignKind kKinds[] = {{is_kinect_file, read_kinect_file},
                                  {is_ros_bag, read_ros_bag},
                                  {is_stamped_folder, read_stamped_folder},
                                  {is_seven_scenes_folder, read_seven_scenes_folder},
                                  {is_scannet_folder, read_scannet_folder}};

constexpr const char* kKnown =
    "an Azure Kinect or Orbbec .mkv, a ROS 1 .bag, a TUM, Bonn or ETH3D folder "
    "(rgb.txt, depth.txt), a 7-Scenes sequence (frame-000000.color.png) or a ScanNet scene "
    "(color, depth, pose, intrinsic)";

/// What to do with a recording of a kind that is not imported.
std::string advice_for(const fs::path& source) {
  const std::string ending = source.extension().string();
  if (ending == ".oni") return "name it as openni2:FILE in rig.toml and record it";
  if (ending == ".sens") return "unpack it with ScanNet's SensReader, and import that folder";
  if (ending == ".db3" || ending == ".mcap")
    return "convert it to a ROS 1 bag with rosbags-convert, and import that";
  if (ending == ".r3d")
    return "its depth is LZFSE: export PNG or EXR pictures, and write take.toml";
  return std::string("import reads ") + kKnown;
}

}  // namespace

Result<Imported> import_recording(const fs::path& source, const fs::path& out) {
  std::error_code error;
  if (!fs::exists(source, error))
    return Error{ErrorCode::kNotFound, "there is no recording '" + source.string() + "'"};
  if (fs::exists(source / "take.toml", error))
    return Error{ErrorCode::kUsage, "'" + source.string() + "' is a take already: use it as it is"};
  for (const ForeignKind& kind : kKinds) {
    if (!kind.matches(source)) continue;
    MIXRIG_ASSIGN(ForeignTake take, ForeignTake::create(out));
    MIXRIG_TRY(kind.read(source, take));
    return take.finish();
  }
  return Error{ErrorCode::kFormat,
               "'" + source.string() + "' is of no kind that is known: " + advice_for(source)};
}

}  // namespace mixrig::take
