// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_pass.h"

#include <algorithm>

#include "host/render/frame/frame_order.h"

namespace mixrig::render::gles {
namespace {

glm::vec2 focal_px(const geometry::Pinhole& camera) { return {camera.fx_px, camera.fy_px}; }
glm::vec2 center_px(const geometry::Pinhole& camera) { return {camera.cx_px, camera.cy_px}; }

/// Sets the factor against vignetting (geometry::Vignetting).
void set_gain(const Program& program, const CompositorSetup& setup) {
  const geometry::Pinhole& camera = setup.target.pinhole;
  const double radius2_of_px =
      geometry::Vignetting::radius2(camera, {camera.cx_px + 1, camera.cy_px});
  program.set("has_gain", !setup.vignetting.is_none());
  program.set("gain_terms", glm::vec2(setup.vignetting.a, setup.vignetting.b));
  program.set("gain_center_px", center_px(camera));
  program.set("gain_r2_per_px2", static_cast<float>(radius2_of_px));
}

}  // namespace

Result<PlatePass> PlatePass::create(const CompositorSetup& setup, bool plate_is_view) {
  PlatePass pass;
  pass.is_view_ = plate_is_view;
  const std::size_t views = joins_mattes(setup) ? 2 : 1, plates = plate_is_view ? views : 1;
  // sRGB bytes hold linear light as finely as the camera's bytes did; sampling filters in linear
  // light.
  for (std::size_t i = 0; i < plates; ++i)
    pass.plates_[i] = make_texture(setup.target.size_px(), GL_SRGB8_ALPHA8, Sampling::kLinear);
  if (plate_is_view) return pass;
  for (std::size_t i = 0; i < views; ++i) {
    pass.views_[i] = make_texture(setup.view.size_px, GL_SRGB8_ALPHA8);
    MIXRIG_ASSIGN(pass.view_targets_[i], make_target({&pass.views_[i]}));
  }
  MIXRIG_ASSIGN(pass.program_, make_program("fullscreen.vert", "plate.frag"));
  const Program& program = pass.program_;
  pass.at_ = {program.location("view_focal_px"), program.location("view_center_px"),
              program.location("focal_px"),      program.location("center_px"),
              program.location("lens"),          program.location("domain_r2")};
  set_gain(program, setup);
  pass.set_lens(setup.target, setup.view);
  return pass;
}

void PlatePass::set_lens(const geometry::CameraModel& target, const geometry::Pinhole& view) const {
  program_.use();
  set_uniform(at_.view_focal_px, focal_px(view));
  set_uniform(at_.view_center_px, center_px(view));
  set_uniform(at_.focal_px, focal_px(target.pinhole));
  set_uniform(at_.center_px, center_px(target.pinhole));
  std::array<float, 8> lens;
  std::ranges::transform(target.lens.coefficients(), lens.begin(),
                         [](double k) { return static_cast<float>(k); });
  set_uniform(at_.lens, lens);
  set_uniform(at_.domain_r2, static_cast<float>(target.lens.domain_r2()));
}

Result<void> PlatePass::prepare_decoding() {
  for (std::size_t i = 0; i < plates_.size(); ++i) {
    if (plates_[i].size != Size{}) {
      MIXRIG_ASSIGN(plate_targets_[i], make_target({&plates_[i]}));
    }
  }
  MIXRIG_ASSIGN(decode_, DecodePass::create());
  return {};
}

Result<void> PlatePass::upload_plate(ImageView<const Rgb8> plate) {
  return uploads_.upload(plates_[this->plate()], plate);
}

void PlatePass::decode(const RawPicture& picture, const ImportedPlanes& planes) {
  decode_->draw(picture, planes, plate_targets_[plate()]);
}

void PlatePass::draw() const { run_into(view_targets_[now_], program_, {&plates_[0]}); }

}  // namespace mixrig::render::gles
