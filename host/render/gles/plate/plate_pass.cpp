// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_pass.h"

namespace mixrig::render::gles {

Result<PlatePass> PlatePass::create(const Tables& tables) {
  PlatePass pass;
  pass.is_view_ = tables.plate_is_view;
  pass.plate_ = make_texture(tables.plate_size, GL_SRGB8_ALPHA8, Sampling::kLinear);
  if (pass.is_view_) return pass;
  pass.map_ = make_texture(tables.plate_px.view(), GL_RG32F);
  Image<float> none({1, 1}, 1.0F);
  const bool darkens = !tables.plate_gain.empty();
  pass.gain_ = make_texture(darkens ? tables.plate_gain.view() : none.view(), GL_R32F);
  // sRGB bytes hold linear light as finely as the plate's bytes did.
  pass.view_ = make_texture(tables.view_size, GL_SRGB8_ALPHA8);
  MIXRIG_ASSIGN(pass.step_, make_step("plate.frag", {&pass.view_}));
  pass.step_.program.set("has_gain", darkens);
  return pass;
}

Result<void> PlatePass::prepare_decoding() {
  MIXRIG_ASSIGN(decode_, DecodePass::create(plate_.size));
  return {};
}

Result<void> PlatePass::upload_plate(ImageView<const Rgb8> plate) {
  is_decoded_ = false;
  return uploads_.upload(plate_, plate);
}

void PlatePass::decode(const RawPicture& picture, const ImportedPlanes& planes) {
  decode_->draw(picture, planes);
  is_decoded_ = true;
}

}  // namespace mixrig::render::gles
