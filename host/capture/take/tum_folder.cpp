// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D folders.
#include "host/capture/take/tum_folder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <tuple>

#include "host/capture/take/tell_once.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

bool is_tum_folder(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "rgb.txt", error) &&
         fs::is_regular_file(folder / "depth.txt", error);
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, std::min(text.substr(0, end).find('#'), end));
    text.remove_prefix(std::min(end + 1, text.size()));
    while (true) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r,"), line.size()));
      if (line.empty()) break;
      double value = 0;
      const auto [stop, fault] = std::from_chars(line.data(), line.data() + line.size(), value);
      if (fault != std::errc() || !std::isfinite(value)) return std::nullopt;
      numbers.push_back(value);
      line.remove_prefix(static_cast<std::size_t>(stop - line.data()));
    }
  }
  return numbers;
}

namespace {

constexpr std::size_t kMostCameraBytes = 4096, kMostTumListBytes = std::size_t{64} << 20;
constexpr const char* kCameraFile = "calibration.txt";

/// Cameras of 640x480 that data sets publish beside their folders, not in them: fx fy cx cy, and
/// k1 k2 p1 p2 k3.
struct PublishedCamera {
  std::string_view begin, set;
  double fx, fy, cx, cy;
  geometry::Lens::Coefficients lens;
};
constexpr PublishedCamera kPublished[] = {
    {"rgbd_dataset_freiburg1",
     "TUM freiburg1",
     517.306408,
     516.469215,
     318.643040,
     255.313989,
     {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}},
    {"rgbd_dataset_freiburg2",
     "TUM freiburg2",
     520.908620,
     521.007327,
     325.141442,
     249.701764,
     {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}},
    {"rgbd_dataset_freiburg3", "TUM freiburg3", 535.4, 539.2, 320.1, 247.6, {}},
    {"rgbd_bonn_",
     "Bonn",
     542.822841,
     542.576870,
     315.593520,
     237.756098,
     {0.039903, -0.099343, -0.000730, -0.000144, 0}}};

const PublishedCamera* published_camera(const fs::path& folder) {
  const std::string name =
      folder.has_filename() ? folder.filename() : folder.parent_path().filename();
  for (const PublishedCamera& camera : kPublished)
    if (name.starts_with(camera.begin)) return &camera;
  return nullptr;
}

/// The size of the first colour picture that can be read.
Result<Size> first_size(const fs::path& folder) {
  MIXRIG_ASSIGN(const std::string text, config::read_text(folder / "rgb.txt", kMostTumListBytes));
  MIXRIG_ASSIGN(const FileList list, parse_file_list(text, (folder / "rgb.txt").string()));
  if (list.files.empty())
    return Error{ErrorCode::kFormat, (folder / "rgb.txt").string() +
                                         ": has no picture: write lines of a time and a file name"};
  Image<Rgb8> picture;
  MIXRIG_TRY(image_io::read_rgb8(folder / list.files.front().path, picture));
  return picture.size();
}

Result<geometry::CameraModel> read_camera(const fs::path& folder) {
  const fs::path path = folder / kCameraFile;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostCameraBytes));
  const auto numbers = parse_numbers(text);
  const std::vector<double> n = numbers.value_or(std::vector<double>());
  const bool matrix =
      n.size() == 9 && n[1] == 0 && n[3] == 0 && n[6] == 0 && n[7] == 0 && n[8] == 1;
  if (n.size() != 4 && n.size() != 8 && n.size() != 9)
    return Error{ErrorCode::kFormat, path.string() +
                                         ": must be fx fy cx cy, with or without k1 k2 p1 p2 k3, "
                                         "or a 3x3 matrix: correct it, or write take.toml"};
  geometry::CameraModel camera;
  MIXRIG_ASSIGN(const Size size, first_size(folder));
  camera.pinhole = matrix ? geometry::Pinhole{size, n[0], n[4], n[2], n[5]}
                          : geometry::Pinhole{size, n[0], n[1], n[2], n[3]};
  if (!matrix && n.size() > 4)
    camera.lens = geometry::Lens({n[4], n[5], n[6], n[7], n.size() == 9 ? n[8] : 0, 0, 0, 0});
  if (const auto valid = geometry::validate(camera); !valid)
    return Error{ErrorCode::kFormat, path.string() + ": " + valid.error().context};
  return camera;
}

/// Files of a camera by the names that data sets give them, which are not read.
std::string unread_camera_file(const fs::path& folder) {
  std::error_code error;
  for (const char* name :
       {"calib.txt", "camera.txt", "intrinsics.txt", "intrinsic.txt", "camera_intrinsics.txt",
        "camera-intrinsics.txt", "calibration.yaml", "calibration.yml", "camera.yaml", "camera.yml",
        "intrinsics.yaml", "calibration.xml", "calibration.json", "camera.json", "intrinsics.json"})
    if (fs::is_regular_file(folder / name, error)) return name;
  return {};
}

}  // namespace

Result<Manifest> tum_manifest(const fs::path& folder) {
  Manifest manifest;
  TakeInfo& info = manifest.info;
  info.path = info.root = folder;
  info.name = folder.filename().string();
  info.color.path = "rgb.txt";
  info.depth.path = "depth.txt";
  info.depth_unit_m = 1.0 / 5000.0;
  manifest.without_tables = true;
  std::error_code error;
  const std::string where = folder.string() + ": no take.toml: ";
  if (fs::is_regular_file(folder / kCameraFile, error)) {
    MIXRIG_ASSIGN(info.target, read_camera(folder));
    info.file = folder / kCameraFile;
    info.camera_tables = {"fx fy cx cy"};
    tell_once(where +
              "the camera is that of calibration.txt; depth in its view, in steps of 1/5000 "
              "m, is assumed");
  } else if (const PublishedCamera* camera = published_camera(folder)) {
    info.target.pinhole = {{640, 480}, camera->fx, camera->fy, camera->cx, camera->cy};
    info.target.lens = geometry::Lens(camera->lens);
    tell_once(where + "the camera published for " + std::string(camera->set) +
              ", by the folder's name, and depth in its view, in steps of 1/5000 m, are assumed");
  } else {
    info.target.pinhole = {{640, 480}, 525.0, 525.0, 319.5, 239.5};
    const std::string unread = unread_camera_file(folder);
    tell_once(where +
              "the Kinect's nominal camera (f 525 px at 640x480) and depth in steps of "
              "1/5000 m are assumed: write take.toml, or calibration.txt with fx fy cx cy" +
              (unread.empty() ? "" : "; " + unread + " is not read"));
  }
  info.tof = info.target;
  info.has_poses = fs::is_regular_file(folder / "groundtruth.txt", error);
  if (info.has_poses) manifest.pose_file = "groundtruth.txt";
  return manifest;
}

std::vector<std::pair<int, int>> associate(const std::vector<StampedFile>& color,
                                           const std::vector<StampedFile>& depth,
                                           double max_difference_s) {
  std::vector<std::pair<double, int>> depth_times;
  for (std::size_t d = 0; d < depth.size(); ++d)
    depth_times.emplace_back(depth[d].time_s, static_cast<int>(d));
  std::sort(depth_times.begin(), depth_times.end());

  std::vector<std::tuple<double, int, int>> candidates;
  for (std::size_t c = 0; c < color.size(); ++c) {
    const double t = color[c].time_s;
    // A few neighbours in time are enough, and bound the cost for lists of equal stamps.
    constexpr std::ptrdiff_t kNeighbours = 4;
    const auto here = std::lower_bound(depth_times.begin(), depth_times.end(), std::pair(t, 0));
    auto at = here - std::min(kNeighbours, here - depth_times.begin());
    const auto end = here + std::min(kNeighbours, depth_times.end() - here);
    for (; at != end; ++at)
      if (const double difference = std::abs(at->first - t); difference <= max_difference_s)
        candidates.emplace_back(difference, static_cast<int>(c), at->second);
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<bool> color_taken(color.size()), depth_taken(depth.size());
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [difference, c, d] : candidates) {
    if (color_taken[static_cast<std::size_t>(c)] || depth_taken[static_cast<std::size_t>(d)])
      continue;
    color_taken[static_cast<std::size_t>(c)] = depth_taken[static_cast<std::size_t>(d)] = true;
    pairs.emplace_back(c, d);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace mixrig::take
