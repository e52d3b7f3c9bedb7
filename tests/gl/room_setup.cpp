// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/room_setup.h"

#include <cmath>
#include <utility>

namespace mixrig::test {
namespace {

float to_linear(std::uint8_t byte) {
  const float c = static_cast<float>(byte) / 255;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

geometry::CameraModel model_of(const Camera& camera) {
  geometry::CameraModel model;
  model.pinhole = {camera.size_px, camera.f_px, camera.f_px, camera.cx_px(), camera.cy_px()};
  model.lens = geometry::Lens({camera.k1, 0, 0, 0, 0, 0, 0, 0});
  return model;
}

}  // namespace

RoomSetup::RoomSetup(const Options& o) {
  target = {o.view, 0.9 * o.view.width, {0, 0, 0}, o.lens_k1};
  tof = {o.tof, 0.8 * o.tof.width, {0.06, 0.01, 0.02}, 0};
  setup.target = model_of(target);
  setup.view = geometry::ideal_view(setup.target);
  setup.tof = model_of(tof);
  setup.target_from_tof.translation_m = tof.position_m;
  plate = render_plate(scene, target, 1);
  depth = render_tof(scene, tof, 2, 0.004);
  if (o.second_tof) {
    tof2 = {{o.tof.width - 8, o.tof.height - 4}, 0.75 * o.tof.width, {-0.07, -0.01, 0.01}, 0};
    render::SecondTof& second = setup.tof2.emplace();
    second.model = model_of(tof2);
    second.target_from_tof.translation_m = tof2.position_m;
    depth2 = render_tof(scene, tof2, 3, 0.006);
  }
  setup.light.ambient = {0.3F, 0.28F, 0.26F};
  if (o.lamps) {
    setup.light.lamps.push_back(
        {{-1.2, -1.3, 2.0}, Eigen::Vector3d::UnitY(), {0.5, 0.5}, {1.5F, 1.4F, 1.2F}});
    setup.light.lamps.push_back({{1.5, -1.2, 1.0}, std::nullopt, {0.2, 0.2}, {1.0F, 1.1F, 1.3F}});
  }
  if (o.background) learn(o.background_color);
  if (o.objects) add_box(o.box_m);
}

void RoomSetup::learn(bool with_color) {
  AnalyticScene empty = scene;
  empty.person = false;
  const geometry::Pinhole& view = setup.view;
  const Camera ideal{view.size_px, view.fx_px, {0, 0, 0}, 0};
  Image<std::uint8_t> nobody;
  render_truth(empty, ideal, background_m_, nobody);
  background_sigma_m_.reset(view.size_px, 0.005F);
  setup.background.depth_m = background_m_;
  setup.background.depth_sigma_m = background_sigma_m_;
  if (!with_color) return;
  const Image<Rgb8> seen = render_plate(empty, ideal, 3);
  color_.reset(view.size_px);
  color_sigma_.reset(view.size_px, 0.01F);
  for (int y = 0; y < seen.height(); ++y)
    for (int x = 0; x < seen.width(); ++x) {
      const Rgb8 p = seen.at(x, y);
      color_.at(x, y) = {to_linear(p.r), to_linear(p.g), to_linear(p.b)};
    }
  setup.background.color = color_;
  setup.background.color_sigma = color_sigma_;
}

void RoomSetup::put_board(const Eigen::Vector3d& at_m, double half_m) {
  for (int y = 0; y < background_m_.height(); ++y)
    for (int x = 0; x < background_m_.width(); ++x) {
      const Eigen::Vector2d ray = setup.view.unproject({x, y});
      const double z = at_m.y() / ray.y();  // y points down; the eye is at the origin
      const bool hit =
          z > 0 && std::abs(z - at_m.z()) < half_m && std::abs(ray.x() * z - at_m.x()) < half_m;
      if (hit && z < background_m_.at(x, y)) background_m_.at(x, y) = static_cast<float>(z);
    }
}

void RoomSetup::put_mirror() {
  const Size size = background_m_.size();
  for (int y = size.height / 4; y < size.height / 2; ++y)
    for (int x = size.width / 2; x < size.width * 3 / 4; ++x) {
      background_m_.at(x, y) = 2.5F;
      background_sigma_m_.at(x, y) = 0.05F;
    }
}

void RoomSetup::draw_background_for_each_pose() {
  render::BackgroundModel model{
      setup.view, {geometry::Pose()}, background_m_, background_sigma_m_, {}};
  if (!color_.empty()) {
    learned_ = learned_colors(color_, color_sigma_);
    model.color = learned_;
  }
  setup.background_models = {std::move(model)};
  setup.background = {};
}

/// A cube with a textured skin, normals outwards, counter-clockwise from outside.
void RoomSetup::add_box(const Eigen::Vector3d& center_m) {
  texture_.reset({8, 8});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      texture_.at(x, y) = (x + y) % 2 ? Rgb8{220, 190, 60} : Rgb8{60, 110, 200};
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 n(0), a(0), b(0);
      n[axis] = side;
      a[(axis + 1) % 3] = 1;
      b[(axis + 2) % 3] = side;  // a x b = n
      const auto first = static_cast<std::uint32_t>(positions_.size());
      for (const glm::vec2& c : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        positions_.push_back(0.3F * (n + c.x * a + c.y * b));
        normals_.push_back(n);
        uv_.push_back(0.5F * c + 0.5F);
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) indices_.push_back(first + i);
    }
  render::VirtualObject box;
  box.meshes.push_back({positions_, normals_, uv_, indices_, glm::vec3(0.9F), texture_, false});
  box.world_from_object.translation_m = center_m;
  box.world_from_object.rotation =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.1, 1, 0.05).normalized());
  setup.objects.push_back(box);
}

}  // namespace mixrig::test
