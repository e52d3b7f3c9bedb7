// SPDX-License-Identifier: Apache-2.0
#include "extras/people/report/plan_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/output/report/canvas.h"

namespace mixrig::session {
namespace {

using report::Canvas;
using report::Point;
/// Pixel of a place on the floor; nullopt outside the picture.
using OnPicture = std::function<std::optional<Point>(const Eigen::Vector2d&)>;

constexpr int kPlan_px = 900;  ///< its longer side, at least
constexpr int kPlanMargin_px = 40;
constexpr Rgb8 kInk{40, 40, 40}, kPaper{255, 255, 255}, kPlaceInk{20, 110, 40};
constexpr std::array<Rgb8, 6> kPathInks{{{214, 39, 40},
                                         {31, 119, 180},
                                         {255, 127, 14},
                                         {148, 103, 189},
                                         {23, 150, 160},
                                         {140, 86, 75}}};

void draw_path(const PersonPath& path, const OnPicture& on_picture, double width_px,
               Canvas& canvas) {
  const Rgb8 ink = kPathInks[static_cast<std::size_t>(path.id) % kPathInks.size()];
  double next_dot_s = path.first_s;
  for (std::size_t i = 0; i < path.places.size(); ++i) {
    const PathPlace& place = path.places[i];
    const std::optional<Point> at = on_picture(place.on_floor_m);
    if (!at) continue;
    if (i > 0 && (place.was_seen || i % 2 == 0))
      if (const auto before = on_picture(path.places[i - 1].on_floor_m))
        canvas.line({*before, *at}, width_px, ink);
    if (i == 0)
      canvas.text({at->x + 8, at->y - 8}, fmt::format("{}: {:.2f} m", path.id, path.height_m), 16,
                  ink);
    if (place.time_s < next_dot_s) continue;
    canvas.dot(*at, 2 * width_px, ink);
    next_dot_s = std::floor(place.time_s) + 1;
  }
}

void draw_place(const plan::FreePlace& place, const plan::Footprint& box, int number,
                const OnPicture& on_picture, Canvas& canvas) {
  const Eigen::Rotation2Dd turn(place.yaw_rad);
  std::vector<Point> outline;
  for (const auto& [x, y] :
       {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}})
    if (const auto at =
            on_picture(place.at_m + turn * box.size_m.cwiseProduct(Eigen::Vector2d(x, y))))
      outline.push_back(*at);
  canvas.line(outline, 2, kPlaceInk);
  if (const auto at = on_picture(place.at_m))
    canvas.text({at->x - 4, at->y + 5}, fmt::format("{}", number), 14, kPlaceInk);
}

void draw_all(const PlanDrawing& drawing, const OnPicture& on_picture, double width_px,
              Canvas& canvas) {
  for (const PersonPath& path : drawing.people) draw_path(path, on_picture, width_px, canvas);
  for (std::size_t i = 0; i < drawing.places.size(); ++i)
    draw_place(drawing.places[i], drawing.box, static_cast<int>(i) + 1, on_picture, canvas);
}

/// Map in pale colours, so that paths stand out; free floor greenish, less so within the margin.
Image<Rgb8> map_picture(const plan::FloorMap& map, double margin_m, int cell_px) {
  const Size size = map.size();
  const Image<std::uint8_t> blocked = plan::grown(plan::not_free(map), margin_m / map.cell_m);
  Image<Rgb8> picture({size.width * cell_px, size.height * cell_px});
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const int cx = x / cell_px, cy = size.height - 1 - y / cell_px;
      const Rgb8 c = map.color.at(cx, cy);
      const int dim = blocked.at(cx, cy) == 0 ? 205 : map.top_m.at(cx, cy) == 0 ? 235 : 255;
      const auto pale = [](int value, int to) {
        return static_cast<std::uint8_t>((value + to) / 2);
      };
      picture.at(x, y) = {pale(c.r, dim), pale(c.g, 255), pale(c.b, dim)};
    }
  return picture;
}

/// Draws the camera, and half a metre along the left and right border of its picture.
void draw_camera(const PlanDrawing& drawing, const OnPicture& on_picture, Canvas& canvas) {
  constexpr double kSide_m = 0.5;
  const geometry::Pinhole& view = drawing.view;
  const auto border = [&](double x_px) -> Eigen::Vector3d {
    const Eigen::Vector2d ray = view.unproject({x_px, view.cy_px});
    return kSide_m * Eigen::Vector3d(ray.x(), ray.y(), 1).normalized();
  };
  std::vector<Point> outline;
  for (const Eigen::Vector3d& at :
       {border(0), Eigen::Vector3d(Eigen::Vector3d::Zero()), border(view.size_px.width - 1.0)})
    if (const auto p = on_picture((drawing.world_from_camera * at).head<2>()))
      outline.push_back(*p);
  canvas.line(outline, 2, kInk);
}

/// The room from above, to draw on.
struct PlanSheet {
  const plan::FloorMap& map;
  int cell_px;
  double px_per_m, height_px;
  Canvas canvas;

  explicit PlanSheet(const PlanDrawing& drawing)
      : map(drawing.map),
        cell_px(cell_size_px(map)),
        px_per_m(cell_px / map.cell_m),
        height_px(cell_px * map.size().height),
        canvas({cell_px * map.size().width + 2 * kPlanMargin_px,
                cell_px * map.size().height + 2 * kPlanMargin_px},
               kPaper) {
    canvas.picture(kPlanMargin_px, kPlanMargin_px, map_picture(map, drawing.margin_m, cell_px));
  }
  Point at(const Eigen::Vector2d& at_m) const {
    const Eigen::Vector2d p = px_per_m * (at_m - map.corner_m);
    return {kPlanMargin_px + p.x(), kPlanMargin_px + height_px - p.y()};
  }
  OnPicture on_picture() const {
    return [this](const Eigen::Vector2d& at_m) { return std::optional<Point>(at(at_m)); };
  }
  void scale_bar(const std::string& legend) {
    const double base_px = kPlanMargin_px + height_px + 18;
    canvas.line({{kPlanMargin_px, base_px}, {kPlanMargin_px + px_per_m, base_px}}, 2, kInk);
    canvas.text({kPlanMargin_px + px_per_m + 8, base_px + 5}, "1 m; " + legend, 14, kInk);
  }

 private:
  static int cell_size_px(const plan::FloorMap& map) {
    const int longer = std::max({map.size().width, map.size().height, 1});
    return std::max(1, (kPlan_px + longer - 1) / longer);
  }
};

}  // namespace

Image<Rgb8> draw_plan(const PlanDrawing& drawing) {
  PlanSheet sheet(drawing);
  draw_all(drawing, sheet.on_picture(), 2, sheet.canvas);
  draw_camera(drawing, sheet.on_picture(), sheet.canvas);
  sheet.scale_bar("dots: seconds; green: free floor");
  return sheet.canvas.finish();
}

Image<Rgb8> draw_dwell(const PlanDrawing& drawing, const plan::DwellGrid& dwell) {
  PlanSheet sheet(drawing);
  float longest_s = 0;
  const auto each_cell = [&](auto&& use) {
    for (int y = 0; y < dwell.time_s.height(); ++y)
      for (int x = 0; x < dwell.time_s.width(); ++x) use(x, y, dwell.time_s.at(x, y));
  };
  each_cell([&](int, int, float time_s) { longest_s = std::max(longest_s, time_s); });
  const int side_px = std::max(1, static_cast<int>(std::ceil(dwell.cell_m * sheet.px_per_m)));
  each_cell([&](int x, int y, float time_s) {
    if (!(time_s > 0)) return;
    const double share = std::sqrt(time_s / longest_s);  // short times can be told from none
    const auto fading = static_cast<std::uint8_t>(225 * (1 - share));
    Image<Rgb8> cell({side_px, side_px});
    for (int j = 0; j < side_px; ++j)
      std::fill(cell.row(j), cell.row(j) + side_px, Rgb8{235, fading, fading});
    const Point at = sheet.at(dwell.corner_m + dwell.cell_m * Eigen::Vector2d(x, y + 1));
    sheet.canvas.picture(static_cast<int>(at.x), static_cast<int>(at.y), cell);
  });
  draw_camera(drawing, sheet.on_picture(), sheet.canvas);
  sheet.scale_bar(fmt::format("red: {:.1f} s in a cell of {:.1f} m", longest_s, dwell.cell_m));
  return sheet.canvas.finish();
}

Image<Rgb8> draw_in_picture(const PlanDrawing& drawing, ImageView<const Rgb8> picture) {
  Canvas canvas(picture.size, kPaper);
  canvas.picture(0, 0, picture);
  const geometry::Pose camera_from_world = geometry::inverse(drawing.world_from_camera);
  const OnPicture on_picture = [&](const Eigen::Vector2d& at_m) -> std::optional<Point> {
    const Eigen::Vector3d at = camera_from_world * Eigen::Vector3d(at_m.x(), at_m.y(), 0);
    if (at.z() < 0.2) return std::nullopt;
    const Eigen::Vector2d px = drawing.view.project(at);
    return Point{px.x(), px.y()};
  };
  draw_all(drawing, on_picture, std::max(1.0, picture.size.width / 640.0), canvas);
  return canvas.finish();
}

}  // namespace mixrig::session
