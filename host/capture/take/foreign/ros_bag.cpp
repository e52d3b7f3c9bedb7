// SPDX-License-Identifier: Apache-2.0
// ROS 1 bags with colour, depth and camera_info. Topics are told apart by what their pictures are.
#include <algorithm>
#include <fstream>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/capture/take/foreign/foreign_take.h"
#include "host/capture/take/foreign/mapped_file.h"
#include "host/capture/take/foreign/ros_messages.h"
#include "host/capture/take/foreign/ros_records.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char *kImageType = "sensor_msgs/Image",
                     *kCompressedType = "sensor_msgs/CompressedImage",
                     *kInfoType = "sensor_msgs/CameraInfo";
constexpr double kMillimetre_m = 0.001, kFloatStep_m = 0.00025;

struct PictureTopic {
  bool depth = false;
  std::string frame, encoding;
};

/// What a bag has, before its pictures are read.
struct BagOverview {
  std::map<std::string, PictureTopic> pictures;
  std::map<std::string, RosCamera> cameras;
  std::map<std::string, RosTransform> parents;  ///< by child
  bool is_whole = true;
};

std::optional<RosPicture> picture_of(const BagMessage& message) {
  const bool compressed = message.from.type == kCompressedType;
  if (!compressed && message.from.type != kImageType) return std::nullopt;
  return parse_picture(message.bytes, compressed);
}

Result<BagOverview> look_through(std::span<const std::uint8_t> bag) {
  BagOverview all;
  const auto look = [&](const BagMessage& message) -> Result<void> {
    const std::string& topic = message.from.topic;
    if (message.from.type == kInfoType && !all.cameras.contains(topic))
      if (auto camera = parse_camera_info(message.bytes)) all.cameras.emplace(topic, *camera);
    if (topic == "/tf_static")
      if (auto parents = parse_transforms(message.bytes))
        for (RosTransform& one : *parents) all.parents.insert_or_assign(one.child, one);
    if (all.pictures.contains(topic)) return {};
    if (const auto picture = picture_of(message))
      all.pictures.emplace(
          topic, PictureTopic{is_depth(*picture), picture->header.frame, picture->encoding});
    return {};
  };
  MIXRIG_ASSIGN(all.is_whole, each_message(bag, look));
  return all;
}

/// The one topic of colour or depth. Where a picture is stored twice the uncompressed one is taken,
/// and depth in the view of the colour camera before other depth.
Result<std::string> topic_of(const BagOverview& all, bool depth) {
  std::vector<std::string> found, aligned;
  for (const auto& [topic, picture] : all.pictures) {
    const bool is_gray = picture.encoding.starts_with("mono8") || picture.encoding == "8UC1";
    const bool is_again = std::ranges::any_of(found, [&topic = topic](const std::string& shorter) {
      return topic.starts_with(shorter + "/");
    });
    if (picture.depth != depth || is_gray || is_again) continue;
    found.push_back(topic);
    if (topic.find("aligned") != std::string::npos) aligned.push_back(topic);
  }
  if (found.size() == 1) return found[0];
  if (aligned.size() == 1) return aligned[0];
  const char* what = depth ? "depth" : "colour";
  if (found.empty())
    return Error{ErrorCode::kData, fmt::format("has no pictures of {}: a take needs both", what)};
  return Error{ErrorCode::kData, fmt::format("has {} topics of {} ({}): keep one, by rosbag filter",
                                             found.size(), what, fmt::join(found, ", "))};
}

/// camera_info beside the pictures, or where RealSense puts it.
Result<RosCamera> camera_info_of(const BagOverview& all, const std::string& topic) {
  const auto up = [](std::string name) { return name.substr(0, name.rfind('/')); };
  std::string folder = up(topic);
  for (const char* ending : {"/compressed", "/compressedDepth"})
    if (topic.ends_with(ending)) folder = up(folder);
  for (const std::string& name : {folder + "/camera_info", up(folder) + "/info/camera_info"})
    if (const auto at = all.cameras.find(name); at != all.cameras.end()) return at->second;
  return Error{ErrorCode::kData, fmt::format("has no {}/camera_info: record it too", folder)};
}

Result<geometry::CameraModel> camera_model_of(const RosCamera& info, const std::string& topic) {
  geometry::CameraModel camera;
  camera.pinhole = {info.size_px, info.k[0], info.k[4], info.k[2], info.k[5]};
  const bool is_ideal = std::ranges::all_of(info.d, [](double d) { return d == 0; });
  const bool is_brown = info.lens == "plumb_bob" || info.lens == "rational_polynomial";
  if (!is_ideal && !is_brown)
    return Error{
        ErrorCode::kUnsupported,
        fmt::format("{}: its lens is \"{}\": rectify the pictures first", topic, info.lens)};
  geometry::Lens::Coefficients lens{};
  if (!is_ideal) std::copy_n(info.d.begin(), std::min(info.d.size(), lens.size()), lens.begin());
  camera.lens = geometry::Lens(lens);
  if (const auto valid = geometry::validate(camera); !valid)
    return Error{ErrorCode::kData, topic + ": camera_info: " + valid.error().context};
  return camera;
}

/// The pose of a frame in the root of its tree, and the root's name.
std::pair<std::string, geometry::Pose> in_root(const BagOverview& all, std::string frame) {
  geometry::Pose root_from_frame;
  for (std::size_t steps = 0; steps <= all.parents.size(); ++steps) {
    const auto at = all.parents.find(frame);
    if (at == all.parents.end()) break;
    root_from_frame = at->second.parent_from_child * root_from_frame;
    frame = at->second.parent;
  }
  return {frame, root_from_frame};
}

Result<geometry::Pose> color_from_depth(const BagOverview& all, const std::string& color,
                                        const std::string& depth) {
  if (color == depth) return geometry::Pose{};
  const auto [root, root_from_color] = in_root(all, color);
  const auto [other, root_from_depth] = in_root(all, depth);
  if (root == other) return geometry::inverse(root_from_color) * root_from_depth;
  return Error{ErrorCode::kData,
               fmt::format("does not say in /tf_static where \"{}\" stands in \"{}\": record "
                           "/tf_static too, or depth in the view of the colour camera",
                           depth, color)};
}

/// The PNG of a compressedDepth message, which stands behind twelve bytes.
std::optional<std::span<const std::uint8_t>> png_of(const RosPicture& picture) {
  constexpr std::size_t kHead = 12;
  if (!picture.encoding.starts_with("16UC1") || picture.data.size() <= kHead) return std::nullopt;
  return picture.data.subspan(kHead);
}

struct BagPictures {
  std::string color, depth;
  Image<Rgb8> plate;
  Image<std::uint16_t> steps;

  Result<void> add(const BagMessage& message, ForeignTake& take) {
    const std::string& topic = message.from.topic;
    if (topic != color && topic != depth) return {};
    const auto picture = picture_of(message);
    if (!picture) return Error{ErrorCode::kFormat, topic + ": a picture is cut off"};
    const double time_s = picture->header.time_s;
    const auto bad = [&] {
      return Error{ErrorCode::kUnsupported,
                   fmt::format("{}: cannot read pictures of \"{}\"", topic, picture->encoding)};
    };
    if (message.from.type == kCompressedType) {
      if (topic == color) return take.add(ForeignTake::Stream::kColor, time_s, picture->data);
      const auto png = png_of(*picture);
      return png ? take.add(ForeignTake::Stream::kDepth, time_s, *png) : bad();
    }
    if (topic == color)
      return decode_color(*picture, plate) ? take.add_color(time_s, plate.view()) : bad();
    return decode_depth(*picture, take.info.depth_unit_m, steps)
               ? take.add_depth(time_s, steps.view())
               : bad();
  }
};

Result<void> read_bag(std::span<const std::uint8_t> bag, ForeignTake& take) {
  MIXRIG_ASSIGN(const BagOverview all, look_through(bag));
  BagPictures pictures;
  MIXRIG_ASSIGN(pictures.color, topic_of(all, false));
  MIXRIG_ASSIGN(pictures.depth, topic_of(all, true));
  MIXRIG_ASSIGN(const RosCamera color, camera_info_of(all, pictures.color));
  MIXRIG_ASSIGN(const RosCamera depth, camera_info_of(all, pictures.depth));
  MIXRIG_ASSIGN(take.info.target, camera_model_of(color, pictures.color));
  MIXRIG_ASSIGN(take.info.tof, camera_model_of(depth, pictures.depth));
  const PictureTopic& of_depth = all.pictures.at(pictures.depth);
  MIXRIG_ASSIGN(take.info.target_from_tof,
                color_from_depth(all, all.pictures.at(pictures.color).frame, of_depth.frame));
  const bool is_float = of_depth.encoding == "32FC1";
  take.info.depth_unit_m = is_float ? kFloatStep_m : kMillimetre_m;
  if (is_float) take.told.lost.push_back("depth below a quarter of a millimetre");
  for (const auto& [topic, picture] : all.pictures)
    if (topic != pictures.color && topic != pictures.depth)
      take.told.lost.push_back("the pictures of " + topic);
  if (!all.is_whole) take.told.lost.push_back("the end of the bag, which is cut off");
  const auto added =
      each_message(bag, [&](const BagMessage& message) { return pictures.add(message, take); });
  return added ? Result<void>() : Result<void>(added.error());
}

}  // namespace

bool is_ros_bag(const fs::path& source) {
  std::ifstream file(source, std::ios::binary);
  std::string begin(kBagBegin.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file && begin == kBagBegin;
}

Result<void> read_ros_bag(const fs::path& source, ForeignTake& take) {
  MIXRIG_ASSIGN(const MappedFile file, MappedFile::open(source));
  take.told.kind = "a ROS 1 bag";
  return named(source, file.if_whole(read_bag(file.bytes(), take)));
}

}  // namespace mixrig::take
