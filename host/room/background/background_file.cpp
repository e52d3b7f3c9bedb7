// SPDX-License-Identifier: Apache-2.0
// Background folders: background.toml, two EXR files, two pictures to look at.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "hal/base/partial_path.h"
#include "hal/base/srgb.h"
#include "host/capture/calibration_file/tables.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"
#include "host/math/image_io/exr_channel.h"
#include "host/math/image_io/image_io.h"
#include "host/room/background/static_background.h"

namespace mixrig::model {
namespace fs = std::filesystem;
namespace {

using image_io::Channel;

constexpr float kUnknownColor = -1;

std::string manifest_text(const StaticBackground& background) {
  const geometry::Pinhole& v = background.view;
  config::Writer root;
  root.set("format", 1).set("frames", background.frames).set("size_px", v.size_px);
  root.set("view", std::array<double, 4>{v.fx_px, v.fy_px, v.cx_px, v.cy_px});
  if (background.world_from_view)
    root.set("pose", calibration_file::pose_table(*background.world_from_view));
  if (!background.floor) return root.text();
  // In camera axes: points p with normal . p + offset_m = 0.
  config::Writer floor;
  floor.set("normal", std::span<const double>(background.floor->normal.data(), 3));
  floor.set("offset_m", background.floor->offset_m);
  root.set("floor", std::move(floor));
  return root.text();
}

Result<void> write_previews(const StaticBackground& background, const fs::path& folder) {
  Image<Rgb8> color(background.view.size_px);
  Image<std::uint16_t> depth_mm(background.view.size_px);
  for (int y = 0; y < color.height(); ++y)
    for (int x = 0; x < color.width(); ++x) {
      const Rgbf& c = background.color.at(x, y);
      color.at(x, y) = {srgb_byte_from_linear(c.r), srgb_byte_from_linear(c.g),
                        srgb_byte_from_linear(c.b)};
      depth_mm.at(x, y) = static_cast<std::uint16_t>(
          std::clamp(1000.0F * background.depth_m.at(x, y), 0.0F, 65535.0F));
    }
  MIXRIG_TRY(image_io::write_png(folder / "color.png", std::as_const(color).view()));
  return image_io::write_png(folder / "depth.png", std::as_const(depth_mm).view());
}

Result<void> write_layers(const StaticBackground& background, const fs::path& folder) {
  MIXRIG_TRY(image_io::write_exr(folder / "depth.exr",
                                 {{"Z", background.depth_m}, {"sigma", background.depth_sigma_m}}));
  std::vector<Channel> color;
  for (const auto& [name, channel] :
       {std::pair("R", &Rgbf::r), std::pair("G", &Rgbf::g), std::pair("B", &Rgbf::b)}) {
    Image<float> plane(background.view.size_px);
    for (int y = 0; y < plane.height(); ++y)
      for (int x = 0; x < plane.width(); ++x) plane.at(x, y) = background.color.at(x, y).*channel;
    color.push_back({name, std::move(plane)});
  }
  color.push_back({"sigma", background.color_sigma});
  return image_io::write_exr(folder / "color.exr", color);
}

Result<StaticBackground> read_background_manifest(const fs::path& path) {
  MIXRIG_ASSIGN(auto document, config::Document::read(path));
  const config::Table root = document.root();
  StaticBackground background;
  root.integer("format", {1, 1});
  background.frames = root.integer("frames", {1, 1e9});
  const auto size = root.numbers("size_px", 2, 2, {1, 16384});
  const auto view = root.numbers("view", 4, 4);
  background.view = {
      {static_cast<int>(size[0]), static_cast<int>(size[1])}, view[0], view[1], view[2], view[3]};
  if (const auto valid = geometry::validate({background.view, {}}); !valid)
    root.fail("view", valid.error());
  const config::Table pose = root.table("pose");
  const geometry::Pose world_from_view = calibration_file::parse_pose(pose);
  if (pose.present()) background.world_from_view = world_from_view;
  const config::Table floor = root.table("floor");
  const auto n = floor.numbers("normal", 3, 3, {-1.01, 1.01});
  const double offset_m = floor.number("offset_m", {-1e4, 1e4});
  if (floor.present())
    background.floor = geometry::Plane{Eigen::Vector3d(n[0], n[1], n[2]), offset_m};
  if (floor.present() && std::abs(background.floor->normal.norm() - 1.0) > 1e-3)
    floor.fail("normal", "its length is not 1: scan the background again");
  MIXRIG_TRY(document.finish());
  return background;
}

}  // namespace

Result<void> save(const StaticBackground& background, const fs::path& folder) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(folder, "background.toml"));
  MIXRIG_TRY(write_layers(background, partial.path()));
  MIXRIG_TRY(write_previews(background, partial.path()));
  MIXRIG_TRY(write_file(partial.path() / "background.toml", manifest_text(background)));
  return partial.commit();
}

Result<StaticBackground> load_static_background(const fs::path& folder) {
  MIXRIG_ASSIGN(StaticBackground background, read_background_manifest(folder / "background.toml"));
  const Size size = background.view.size_px;
  const fs::path depth_path = folder / "depth.exr", color_path = folder / "color.exr";
  MIXRIG_ASSIGN(auto depth, image_io::read_exr(depth_path));
  MIXRIG_ASSIGN(background.depth_m, take_channel(depth, "Z", size, depth_path));
  MIXRIG_ASSIGN(background.depth_sigma_m, take_channel(depth, "sigma", size, depth_path));
  MIXRIG_ASSIGN(auto color, image_io::read_exr(color_path));
  MIXRIG_ASSIGN(const auto r, take_channel(color, "R", size, color_path, kUnknownColor));
  MIXRIG_ASSIGN(const auto g, take_channel(color, "G", size, color_path, kUnknownColor));
  MIXRIG_ASSIGN(const auto b, take_channel(color, "B", size, color_path, kUnknownColor));
  MIXRIG_ASSIGN(background.color_sigma, take_channel(color, "sigma", size, color_path));
  background.color.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      background.color.at(x, y) = {r.at(x, y), g.at(x, y), b.at(x, y)};
  return background;
}

}  // namespace mixrig::model
