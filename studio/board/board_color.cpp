// SPDX-License-Identifier: Apache-2.0
// Renders the board and the room behind it for a colour camera.
#include <cmath>

#include "studio/board/board_light.h"
#include "studio/board/board_state.h"
#include "studio/srgb.h"

namespace mixrig::studio {
namespace {

constexpr float kBoardFullWell_e = 12000, kBoardReadNoise_e = 8;
constexpr float kPaper = 0.80F, kInk = 0.06F;
constexpr float kRoomLight = 0.55F;  ///< irradiance on the room behind the board

}  // namespace

Vec3 BoardStudio::State::background_color(const Eigen::Vector3f& ray,
                                          const geometry::Pose& world_from_camera) const {
  const Vec3 eye = world_from_camera.translation_m.cast<float>();
  const Vec3 direction = (world_from_camera.rotation * ray.cast<double>()).cast<float>();
  Hit hit;
  if (!room.intersect(eye, direction, 1e9F, hit)) return Vec3::Zero();
  const Vec3 albedo = materials.albedo(hit.material, hit.uv, eye + hit.t * direction);
  return hit.material.kind == Kind::kLamp ? albedo : Vec3(kRoomLight * albedo);
}

void BoardStudio::State::draw_color(BoardCamera& camera, const geometry::Pose& target_from_camera,
                                    Poses poses, int number, int salt, BehindBoard<Vec3>& behind,
                                    Image<Rgb8>& picture) {
  const geometry::Pose world_from_camera = world_from_target * target_from_camera;
  const Size size = camera.size_px();
  const auto exposure = static_cast<float>(light.exposure);
  const auto noise = static_cast<float>(info.options.noise);
  const float share = 1.0F / static_cast<float>(poses.size());
  picture.reset(size);
  light_sum.assign(size.area(), Vec3::Zero());
  for (const geometry::Pose& target_from_board : poses) {
    camera.trace(board, pattern, geometry::inverse(target_from_camera) * target_from_board,
                 steps_of(poses), crew, pixels);
    const BoardLight on_board(info.options.board, world_from_target * target_from_board, lamps,
                              light.ambient.mean());
    crew.rows(size.height, kBoardBand, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        for (int x = 0; x < size.width; ++x) {
          if (camera.ray(x, y).isZero()) continue;
          const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
          const BoardPixel& p = pixels[index];
          Vec3 color = Vec3::Zero();
          if (p.board < 1)
            color = (1 - p.board) * behind.at(index, [&] {
              return background_color(camera.ray(x, y), world_from_camera);
            });
          if (p.board > 0)
            color += on_board.at(p.u_m, p.v_m) * (kInk * (p.board - p.paper) + kPaper * p.paper) *
                     lamps.tint();
          light_sum[index] += share * color;
        }
    });
  }
  crew.rows(size.height, kBoardBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (camera.ray(x, y).isZero()) continue;
        const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
        Vec3 color = light_sum[index];
        const std::uint64_t bits = hash_key(hash_key(info.options.seed, 0xB0C0 + salt),
                                            static_cast<std::uint64_t>(number), index);
        for (int c = 0; c < 3; ++c) {
          const float charge = kBoardFullWell_e * exposure * color[c];
          color[c] = (charge + noise * std::sqrt(charge + kBoardReadNoise_e * kBoardReadNoise_e) *
                                   normal(bits >> (12 * c))) /
                     kBoardFullWell_e;
        }
        picture.at(x, y) = srgb_from_linear(color);
      }
  });
}

}  // namespace mixrig::studio
