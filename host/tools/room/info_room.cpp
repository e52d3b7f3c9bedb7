// SPDX-License-Identifier: Apache-2.0
#include "host/tools/room/info_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/math/image_io/image_io.h"
#include "host/output/report/canvas.h"
#include "host/room/scan/room_file.h"
#include "host/room/scan/shape/room_planes.h"
#include "host/room/sweep/room_scan.h"
#include "host/tools/room/room_report.h"

namespace mixrig::tools {
namespace {

using Eigen::Vector3d;

constexpr int kRoomPanel_px = 420, kMargin_px = 40;

/// A pixel of the room.
struct Surface {
  Vector3d at_m;
  Rgb8 color;
};

std::vector<Surface> surfaces_of(const model::Panorama& p) {
  std::vector<Surface> surfaces;
  const model::Directions directions(p.size());
  const int factor = p.color.height() / p.size().height;
  for (int y = 0; y < p.size().height; ++y)
    for (int x = 0; x < p.size().width; ++x)
      if (const float d_m = p.distance_m.row(y)[x]; d_m > 0)
        surfaces.push_back({d_m * directions(x, y),
                            p.color.row(y * factor + factor / 2)[x * factor + factor / 2]});
  return surfaces;
}

/// Distances between opposite planes, the largest planes first.
struct Span {
  Vector3d axis;
  double length_m = 0;
};

std::vector<Span> spans_of(const std::vector<model::RoomPlane>& planes) {
  constexpr double kOpposite = -0.998;  // cosine, 3.6 degrees
  std::vector<Span> spans;
  std::vector<bool> used(planes.size(), false);
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t k = i + 1; k < planes.size() && !used[i]; ++k) {
      const Vector3d &a = planes[i].inverse_per_m, &b = planes[k].inverse_per_m;
      if (used[k] || a.normalized().dot(b.normalized()) > kOpposite) continue;
      spans.push_back({a.normalized(), 1 / a.norm() + 1 / b.norm()});
      used[i] = used[k] = true;
    }
  return spans;
}

/// An orthographic picture: `right` and `up` are axes of the picture, of points that are one behind
/// the other the one with the largest `nearest` counts.
class Drawing {
 public:
  Drawing(const Vector3d& right, const Vector3d& up, const Vector3d& nearest)
      : axes_{right, up, nearest}, pixels_({kRoomPanel_px, kRoomPanel_px}, Rgb8{255, 255, 255}) {}

  void fit(const std::vector<Surface>& surfaces) {
    for (const Surface& s : surfaces)
      for (std::size_t i = 0; i < 2; ++i) {
        low_[i] = std::min(low_[i], s.at_m.dot(axes_[i]));
        high_[i] = std::max(high_[i], s.at_m.dot(axes_[i]));
      }
    px_per_m_ = (kRoomPanel_px - 2) / std::max({high_[0] - low_[0], high_[1] - low_[1], 0.1});
  }
  void add(const Surface& s) {
    if (depth_.empty()) depth_.reset(pixels_.size(), -1e9F);
    const int x = static_cast<int>((s.at_m.dot(axes_[0]) - low_[0]) * px_per_m_);
    const int y =
        kRoomPanel_px - 2 - static_cast<int>((s.at_m.dot(axes_[1]) - low_[1]) * px_per_m_);
    const auto depth = static_cast<float>(s.at_m.dot(axes_[2]));
    for (int dy = 0; dy <= 1; ++dy)
      for (int dx = 0; dx <= 1; ++dx) {
        const int u = std::clamp(x + dx, 0, kRoomPanel_px - 1),
                  v = std::clamp(y + dy, 0, kRoomPanel_px - 1);
        if (depth <= depth_.row(v)[u]) continue;
        depth_.row(v)[u] = depth;
        pixels_.row(v)[u] = s.color;
      }
  }
  double px_per_m() const { return px_per_m_; }
  ImageView<const Rgb8> pixels() const { return pixels_; }

 private:
  std::array<Vector3d, 3> axes_;
  std::array<double, 2> low_{1e9, 1e9}, high_{-1e9, -1e9};
  double px_per_m_ = 1;
  Image<Rgb8> pixels_;
  Image<float> depth_;
};

/// Plan without the ceiling, and elevation of what is ahead, each with a metre beside it.
Image<Rgb8> plan_and_elevation(const std::vector<Surface>& surfaces) {
  constexpr double kBelowCeiling_m = 0.4;
  constexpr Rgb8 kMarks{40, 40, 40};
  double top_m = -1e9;
  for (const Surface& s : surfaces) top_m = std::max(top_m, s.at_m.z());
  Drawing plan(Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ());
  Drawing elevation(Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY());
  plan.fit(surfaces), elevation.fit(surfaces);
  for (const Surface& s : surfaces) {
    if (s.at_m.z() < top_m - kBelowCeiling_m) plan.add(s);
    if (s.at_m.y() > 0) elevation.add(s);
  }
  report::Canvas canvas({2 * kRoomPanel_px + 3 * kMargin_px, kRoomPanel_px + 2 * kMargin_px},
                        {255, 255, 255});
  const auto panel = [&](int left, const char* words, const Drawing& drawing) {
    canvas.text({static_cast<double>(left), kMargin_px - 12.0}, words, 14, kMarks);
    canvas.picture(left, kMargin_px, drawing.pixels());
    const double y = kMargin_px + kRoomPanel_px + 14, x = left;
    canvas.line({{x, y}, {x + drawing.px_per_m(), y}}, 2, kMarks);
    canvas.text({x + drawing.px_per_m() + 6, y + 4}, "1 m", 12, kMarks);
  };
  panel(kMargin_px, "plan, ceiling removed: x to the right, y (ahead) up", plan);
  panel(2 * kMargin_px + kRoomPanel_px, "elevation, what is ahead: x to the right, z up",
        elevation);
  return canvas.finish();
}

double median_sigma_mm(const model::Panorama& p) {
  std::vector<float> sigma_m;
  for (int y = 0; y < p.size().height; ++y)
    for (int x = 0; x < p.size().width; ++x)
      if (p.distance_m.row(y)[x] > 0) sigma_m.push_back(p.sigma_m.row(y)[x]);
  return 1e3 * upper_median_in_place(std::span(sigma_m));
}

nlohmann::json spans_json(const std::vector<Span>& spans) {
  nlohmann::json list = nlohmann::json::array();
  for (const Span& span : spans) {
    std::printf("  %.3f m between opposite planes along (%.2f, %.2f, %.2f)\n", span.length_m,
                span.axis.x(), span.axis.y(), span.axis.z());
    list.push_back(
        {{"length_m", span.length_m}, {"axis", {span.axis.x(), span.axis.y(), span.axis.z()}}});
  }
  return list;
}

/// Size, pose and sigma of each room of a joined one.
nlohmann::json joined_json(const std::vector<model::PlacedRoom>& rooms) {
  std::printf("%zu rooms joined\n", rooms.size());
  nlohmann::json list = nlohmann::json::array();
  for (const model::PlacedRoom& placed : rooms) {
    const model::Panorama& p = placed.room.panorama;
    const Vector3d& t = placed.first_from_base.translation_m;
    const double sigma_mm = median_sigma_mm(p), pose_mm = 1e3 * placed.sigma_m,
                 pose_deg = placed.sigma_rad / kDeg;
    std::printf(
        "  %zu: %d views, %dx%d pixels, median sigma %.1f mm, at (%.3f, %.3f, %.3f) m to "
        "%.1f mm and %.3f deg\n",
        list.size() + 1, placed.room.manifest.views, p.size().width, p.size().height, sigma_mm,
        t.x(), t.y(), t.z(), pose_mm, pose_deg);
    const Eigen::Quaterniond& q = placed.first_from_base.rotation;
    list.push_back({{"views", placed.room.manifest.views},
                    {"median_sigma_mm", sigma_mm},
                    {"translation_m", {t.x(), t.y(), t.z()}},
                    {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                    {"sigma_mm", pose_mm},
                    {"sigma_deg", pose_deg}});
  }
  return {{"kind", "joined room"}, {"rooms", list}};
}

}  // namespace

Result<nlohmann::json> info_room(const InfoRoomOptions& options) {
  MIXRIG_ASSIGN(const auto rooms, model::load_rooms(options.room));
  if (rooms.size() > 1) {
    if (!options.truth.empty() || !options.picture.empty())
      return Error{ErrorCode::kUsage, "'" + options.room.string() +
                                          "' is a joined room: --truth and --picture are for one "
                                          "of the rooms in it"};
    return joined_json(rooms);
  }
  const model::RoomFile& room = rooms.front().room;
  const model::Panorama& p = room.panorama;
  const model::RoomManifest& manifest = room.manifest;
  const std::vector<Surface> surfaces = surfaces_of(p);
  if (surfaces.empty())
    return Error{ErrorCode::kData, "'" + options.room.string() + "' knows no surface: scan again"};
  const double sigma_mm = median_sigma_mm(p);
  std::printf(
      "a room of %d views, %d frames: %dx%d pixels, %.2f %% of the field measured, %.2f %% "
      "known\n  median sigma %.1f mm, %d triangles to %.2f mm\n",
      manifest.views, manifest.frames, p.size().width, p.size().height, 100 * p.measured_share,
      100 * p.known_share, sigma_mm, manifest.triangles, 1e3 * manifest.mesh_tolerance_m);
  nlohmann::json report = {{"kind", "room"},
                           {"views", manifest.views},
                           {"frames", manifest.frames},
                           {"measured_pct", 100 * p.measured_share},
                           {"fill_pct", 100 * p.known_share},
                           {"median_sigma_mm", sigma_mm},
                           {"triangles", manifest.triangles},
                           {"calibration_hash", manifest.calibration_hash}};
  report["spans"] = spans_json(spans_of(model::find_planes(p)));
  if (!options.truth.empty()) {
    MIXRIG_ASSIGN(const session::JudgedRoom judged, session::judge_room(p, options.truth));
    report["evaluate"] = errors_json(judged.errors);
  }
  if (!options.picture.empty())
    MIXRIG_TRY(image_io::write_png(options.picture, plan_and_elevation(surfaces).view()));
  return report;
}

}  // namespace mixrig::tools
