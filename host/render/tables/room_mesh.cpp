// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/room_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/tables/prepare.h"
#include "host/render/tables/wrapped_areas.h"

namespace mixrig::render {
namespace {
constexpr double kMostVertices = 40000;  // most vertices of a picture
/// Neighbours whose depths differ by a larger part are two surfaces, unless they continue as a
/// plane: at a grazing angle its depth changes fast.
constexpr float kLargestStep = 0.06F;
constexpr float kLargestChange = 1.25F;
constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

/// A depth picture, subsampled.
class CoarsePicture {
 public:
  CoarsePicture(ImageView<const float> depth_m, const geometry::Pinhole& camera)
      : depth_m_(depth_m),
        camera_(camera),
        step_(std::max(1, static_cast<int>(std::lround(std::sqrt(
                              static_cast<double>(depth_m.size.area()) / kMostVertices))))) {}
  int columns() const { return (depth_m_.size.width + step_ - 1) / step_; }
  int rows() const { return (depth_m_.size.height + step_ - 1) / step_; }
  /// z of a sample; 0 if unknown or outside.
  float z(int i, int j) const {
    if (i < 0 || j < 0 || i >= columns() || j >= rows()) return 0;
    const float z_m = depth_m_.row(j * step_)[i * step_];
    return z_m > static_cast<float>(kNearestM) && z_m < kFarthestM ? z_m : 0;
  }
  glm::dvec3 point_m(int i, int j) const {
    const Eigen::Vector2d ray = camera_.unproject({i * step_, j * step_});
    return static_cast<double>(z(i, j)) * glm::dvec3(ray.x(), ray.y(), 1);
  }
  /// Whether (i, j) and the next sample along (di, dj) lie on one surface.
  bool linked(int i, int j, int di, int dj) const {
    const float a = z(i - di, j - dj), b = z(i, j), c = z(i + di, j + dj),
                d = z(i + 2 * di, j + 2 * dj);
    if (!(b > 0 && c > 0)) return false;
    return std::abs(b - c) <= kLargestStep * std::min(b, c) || in_plane(a, b, c) ||
           in_plane(b, c, d);
  }

 private:
  /// Whether three depths in line lie on a plane, whose inverse depth is affine over the picture.
  static bool in_plane(float a, float b, float c) {
    const float low = std::min({a, b, c}), high = std::max({a, b, c});
    return low > 0 && high <= kLargestChange * low &&
           std::abs(1 / a - 2 / b + 1 / c) * low <= 0.5F * kLargestStep;
  }

  ImageView<const float> depth_m_;
  const geometry::Pinhole& camera_;
  int step_;
};

/// Adds the surfaces of one depth picture to the mesh.
void add_picture(const CoarsePicture& picture, const glm::dmat4& world_from_picture,
                 RoomMesh& mesh) {
  Image<std::uint32_t> vertex({picture.columns(), picture.rows()}, kNoVertex);
  for (int j = 0; j < vertex.height(); ++j)
    for (int i = 0; i < vertex.width(); ++i) {
      if (!(picture.z(i, j) > 0)) continue;
      vertex.row(j)[i] = static_cast<std::uint32_t>(mesh.positions_m.size());
      mesh.positions_m.emplace_back(world_from_picture * glm::dvec4(picture.point_m(i, j), 1));
    }
  for (int j = 0; j + 1 < vertex.height(); ++j)
    for (int i = 0; i + 1 < vertex.width(); ++i) {
      if (!picture.linked(i, j, 1, 0) || !picture.linked(i, j, 0, 1) ||
          !picture.linked(i + 1, j, 0, 1) || !picture.linked(i, j + 1, 1, 0))
        continue;
      const std::array<std::uint32_t, 4> corners = {vertex.row(j)[i], vertex.row(j)[i + 1],
                                                    vertex.row(j + 1)[i], vertex.row(j + 1)[i + 1]};
      for (const std::size_t k : {0U, 1U, 2U, 2U, 1U, 3U}) mesh.indices.push_back(corners[k]);
    }
}

}  // namespace

RoomMesh make_room_mesh(const CompositorSetup& setup, const geometry::Pose& world_from_camera) {
  RoomMesh mesh;
  const BackgroundView& background = setup.background;
  if (!background.depth_m.empty()) {
    const Image<float> depth_m = without_wrapped(background.depth_m, background.depth_sigma_m);
    add_picture({depth_m, setup.view}, to_glm(world_from_camera.matrix()), mesh);
  }
  for (const BackgroundModel& model : setup.background_models)
    for (std::size_t face = 0; face < model.world_from_face.size(); ++face) {
      const Size size = model.camera.size_px;
      const auto of_face = [&](ImageView<const float> faces) {
        return faces.empty()
                   ? faces
                   : ImageView<const float>{faces.row(static_cast<int>(face) * size.height), size,
                                            faces.stride};
      };
      const Image<float> depth_m =
          without_wrapped(of_face(model.depth_m), of_face(model.depth_sigma_m));
      add_picture({depth_m, model.camera}, to_glm(model.world_from_face[face].matrix()), mesh);
    }
  return mesh;
}

}  // namespace mixrig::render
