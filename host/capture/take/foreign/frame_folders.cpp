// SPDX-License-Identifier: Apache-2.0
// Folders of pictures: those with lists of stamped files (TUM, Bonn, ETH3D), and those of numbered
// frames with a 4x4 pose each (7-Scenes, ScanNet).
#include <charconv>
#include <set>
#include <string>

#include <fmt/format.h>

#include "host/capture/take/foreign/foreign_take.h"
#include "host/capture/take/tum_folder.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

using Stream = ForeignTake::Stream;

constexpr std::size_t kMostMatrixBytes = 4096, kMostFrameListBytes = std::size_t{64} << 20;
constexpr double kSensorRate_hz = 30;  ///< of the cameras of 7-Scenes and ScanNet

/// Where the files of frame N stand: folder, then begin, number with at least so many digits, end.
struct NumberedFile {
  const char *folder, *begin;
  int digits;
  const char* end;

  fs::path path(const fs::path& source, int number) const {
    return source / folder / fmt::format("{}{:0{}}{}", begin, number, digits, end);
  }
};
struct FolderLayout {
  NumberedFile color, depth, pose;
};
constexpr FolderLayout kSevenScenes{{"", "frame-", 6, ".color.png"},
                                    {"", "frame-", 6, ".depth.png"},
                                    {"", "frame-", 6, ".pose.txt"}};
constexpr FolderLayout kScanNet{
    {"color", "", 1, ".jpg"}, {"depth", "", 1, ".png"}, {"pose", "", 1, ".txt"}};

std::set<int> frame_numbers(const fs::path& source, const NumberedFile& file) {
  std::set<int> numbers;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(source / file.folder, error)) {
    const std::string name = entry.path().filename();
    const std::string_view begin = file.begin;
    int number = 0;
    if (!name.starts_with(begin)) continue;
    const char* const end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + begin.size(), end, number);
    if (read.ec == std::errc() && number >= 0 && std::string_view(read.ptr, end) == file.end)
      numbers.insert(number);
  }
  return numbers;
}

Result<std::vector<double>> matrix_of(const fs::path& file) {
  MIXRIG_ASSIGN(const std::string text, config::read_text(file, kMostMatrixBytes));
  const auto numbers = parse_numbers(text);
  if (numbers && numbers->size() == 16) return *numbers;
  return Error{ErrorCode::kFormat, "'" + file.string() + "' is not a matrix of 4x4 finite numbers"};
}

Result<geometry::Pose> pose_of(const fs::path& file) {
  MIXRIG_ASSIGN(const auto m, matrix_of(file));
  const auto matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  return geometry::pose_from_matrix(matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 1>(),
                                    1e-2);
}

/// Copies all frames. The poses are those of the depth camera. What has no pose is told.
Result<void> add_frames(const fs::path& source, const FolderLayout& layout, ForeignTake& take) {
  int without_pose = 0;
  std::error_code error;
  for (const int number : frame_numbers(source, layout.color)) {
    const double time_s = number / kSensorRate_hz;
    MIXRIG_TRY(take.copy(Stream::kColor, time_s, layout.color.path(source, number)));
    if (const fs::path depth = layout.depth.path(source, number); fs::exists(depth, error))
      MIXRIG_TRY(take.copy(Stream::kDepth, time_s, depth));
    if (const auto pose = pose_of(layout.pose.path(source, number)))
      take.add_pose(time_s, *pose * geometry::inverse(take.info.target_from_tof));
    else
      ++without_pose;
  }
  if (without_pose > 0)
    take.told.lost.push_back(
        fmt::format("poses of {} frames, which are not there or no rotation", without_pose));
  take.told.assumed.push_back("frames come at 30 Hz: their times are not stated");
  return {};
}

Result<Size> color_size(const fs::path& source, const NumberedFile& file) {
  Image<Rgb8> picture;
  MIXRIG_TRY(image_io::read_rgb8(file.path(source, *frame_numbers(source, file).begin()), picture));
  return picture.size();
}

Result<Size> depth_size(const fs::path& source, const NumberedFile& file) {
  const auto numbers = frame_numbers(source, file);
  if (numbers.empty())
    return Error{ErrorCode::kData, "'" + source.string() + "' has no depth pictures"};
  Image<std::uint16_t> picture;
  MIXRIG_TRY(image_io::read_gray16(file.path(source, *numbers.begin()), picture));
  return picture.size();
}

Result<geometry::CameraModel> camera_of(const fs::path& matrix, Size size) {
  MIXRIG_ASSIGN(const auto m, matrix_of(matrix));
  geometry::CameraModel camera;
  camera.pinhole = {size, m[0], m[5], m[2], m[6]};
  if (const auto valid = geometry::validate(camera); !valid)
    return Error{ErrorCode::kFormat, "'" + matrix.string() + "': " + valid.error().context};
  return camera;
}

}  // namespace

bool is_stamped_folder(const fs::path& source) { return is_tum_folder(source); }

Result<void> read_stamped_folder(const fs::path& source, ForeignTake& take) {
  take.told.kind = "a folder of stamped pictures as TUM, Bonn and ETH3D have it";
  MIXRIG_ASSIGN(const Manifest manifest, tum_manifest(source));
  const std::string name = take.info.name;
  take.info = manifest.info, take.info.name = name;
  take.info.camera_tables.clear();
  for (const auto& [list, stream] :
       {std::pair("rgb.txt", Stream::kColor), std::pair("depth.txt", Stream::kDepth)}) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(source / list, kMostFrameListBytes));
    MIXRIG_ASSIGN(const FileList files, parse_file_list(text, (source / list).string()));
    for (const StampedFile& file : files.files)
      MIXRIG_TRY(take.copy(stream, file.time_s, source / file.path));
  }
  if (manifest.pose_file.empty()) return {};
  const fs::path poses = source / manifest.pose_file;
  MIXRIG_ASSIGN(const std::string text, config::read_text(poses, kMostFrameListBytes));
  MIXRIG_ASSIGN(const auto track, parse_trajectory(text, poses.string()));
  for (const StampedPose& pose : track) take.add_pose(pose.time_s, pose.world_from_target);
  return {};
}

bool is_seven_scenes_folder(const fs::path& source) {
  return !frame_numbers(source, kSevenScenes.color).empty();
}

Result<void> read_seven_scenes_folder(const fs::path& source, ForeignTake& take) {
  take.told.kind = "a sequence of 7-Scenes";
  MIXRIG_ASSIGN(const Size color, color_size(source, kSevenScenes.color));
  MIXRIG_ASSIGN(const Size depth, depth_size(source, kSevenScenes.depth));
  const auto scaled = [](Size size, double f) {
    return geometry::Pinhole{size, f * size.width / 640, f * size.width / 640, 0.5 * size.width,
                             0.5 * size.height};
  };
  take.info.target.pinhole = scaled(color, 525), take.info.tof.pinhole = scaled(depth, 585);
  take.info.target_from_tof.translation_m.x() = -0.025;
  take.info.depth_unit_m = 0.001, take.further_unknown = {65535};
  take.told.assumed = {"the depth camera has the 585 px that the data set states",
                       "the colour camera has the Kinect's nominal 525 px, and stands 25 mm beside "
                       "the depth camera: the data set has no calibration of it"};
  return add_frames(source, kSevenScenes, take);
}

bool is_scannet_folder(const fs::path& source) {
  std::error_code error;
  return fs::exists(source / "intrinsic" / "intrinsic_color.txt", error) &&
         !frame_numbers(source, kScanNet.color).empty();
}

Result<void> read_scannet_folder(const fs::path& source, ForeignTake& take) {
  take.told.kind = "a scene of ScanNet";
  MIXRIG_ASSIGN(const Size color, color_size(source, kScanNet.color));
  MIXRIG_ASSIGN(const Size depth, depth_size(source, kScanNet.depth));
  const fs::path folder = source / "intrinsic";
  MIXRIG_ASSIGN(take.info.target, camera_of(folder / "intrinsic_color.txt", color));
  MIXRIG_ASSIGN(take.info.tof, camera_of(folder / "intrinsic_depth.txt", depth));
  take.info.depth_unit_m = 0.001;
  for (const char* name : {"extrinsic_color.txt", "extrinsic_depth.txt"}) {
    const auto pose = pose_of(folder / name);
    if (!pose || !pose->matrix().isIdentity(1e-6))
      take.told.assumed.push_back(fmt::format(
          "both cameras stand at one place: {} is not there, or not the identity", name));
  }
  return add_frames(source, kScanNet, take);
}

}  // namespace mixrig::take
