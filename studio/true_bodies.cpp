// SPDX-License-Identifier: Apache-2.0
#include "studio/true_bodies.h"

#include <algorithm>
#include <cmath>

#include "studio/people/cast.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

constexpr int kFramesWithoutPeople = 25;  ///< as takes begin, or half of a shorter one

void sample(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& out) {
  const float longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / TrueBodies::kSpacing_m)));
  for (int i = 0; i <= steps; ++i)
    for (int k = 0; k <= steps - i; ++k) {
      const float u = static_cast<float>(i) / static_cast<float>(steps);
      const float v = static_cast<float>(k) / static_cast<float>(steps);
      out.push_back(a + u * (b - a) + v * (c - a));
    }
}

}  // namespace

struct TrueBodies::State {
  explicit State(const StudioOptions& options)
      : layout(make_layout(options)),
        cast(options, layout, std::min(kFramesWithoutPeople, options.frames / 2) / kFrameRate_hz) {}
  Layout layout;
  Cast cast;
};

TrueBodies::TrueBodies(const StudioOptions& options) : state_(std::make_unique<State>(options)) {}
TrueBodies::~TrueBodies() = default;

std::vector<std::vector<Eigen::Vector3f>> TrueBodies::surfaces(double frame) const {
  Mesh mesh;
  state_->cast.build((frame - 1) / kFrameRate_hz, mesh);
  std::vector<std::vector<Eigen::Vector3f>> out(state_->cast.people().size());
  for (std::size_t t = 0; t < mesh.materials.size(); ++t) {
    const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * t + k]]; };
    sample(corner(0), corner(1), corner(2), out[mesh.materials[t].person]);
  }
  return out;
}

BoxDistance distance_to_box(const std::vector<Eigen::Vector3f>& surface_m,
                            const geometry::Pose& world_from_box, const Eigen::Vector3d& half_m) {
  const Eigen::Matrix3f turn = world_from_box.rotation.conjugate().toRotationMatrix().cast<float>();
  const Eigen::Vector3f at = world_from_box.translation_m.cast<float>();
  const Eigen::Vector3f half = half_m.cast<float>();
  BoxDistance nearest{1e9, {}};
  for (const Eigen::Vector3f& p : surface_m) {
    const Eigen::Vector3f q = (turn * (p - at)).cwiseAbs() - half;
    const float d = q.cwiseMax(0.0F).norm() + std::min(q.maxCoeff(), 0.0F);
    if (d < nearest.m) nearest = {d, p.cast<double>()};
  }
  return nearest;
}

}  // namespace mixrig::studio
