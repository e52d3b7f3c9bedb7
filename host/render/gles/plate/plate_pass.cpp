// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_pass.h"

namespace mixrig::render::gles {

Result<PlatePass> PlatePass::create(const Tables& tables, bool keeps_last) {
  PlatePass pass;
  pass.is_view_ = tables.plate_is_view;
  const std::size_t views = keeps_last ? 2 : 1, plates = pass.is_view_ ? views : 1;
  // sRGB bytes hold linear light as finely as the camera's bytes did; sampling filters in linear
  // light.
  for (std::size_t i = 0; i < plates; ++i)
    pass.plates_[i] = make_texture(tables.plate_size, GL_SRGB8_ALPHA8, Sampling::kLinear);
  if (pass.is_view_) return pass;
  for (std::size_t i = 0; i < views; ++i) {
    pass.views_[i] = make_texture(tables.view_size, GL_SRGB8_ALPHA8);
    MIXRIG_ASSIGN(pass.view_targets_[i], make_target({&pass.views_[i]}));
  }
  pass.map_ = make_texture(tables.plate_px.view(), GL_RG32F);
  Image<float> none({1, 1}, 1.0F);
  const bool darkens = !tables.plate_gain.empty();
  pass.gain_ = make_texture(darkens ? tables.plate_gain.view() : none.view(), GL_R32F);
  MIXRIG_ASSIGN(pass.program_, make_program("fullscreen.vert", "plate.frag"));
  pass.program_.set("has_gain", darkens);
  return pass;
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

void PlatePass::draw() const {
  run_into(view_targets_[now_], program_, {&plates_[0], &map_, &gain_});
}

}  // namespace mixrig::render::gles
