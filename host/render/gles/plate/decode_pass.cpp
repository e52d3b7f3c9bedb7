// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/decode_pass.h"

#include <cstring>

namespace mixrig::render::gles {
namespace {

constexpr int kSampleValues = 256;

ImageView<const Rgbx8> row_of(const SampleTable& table) {
  return {table.data(), {kSampleValues, 1}, kSampleValues};
}

}  // namespace

Result<DecodePass> DecodePass::create() {
  DecodePass pass;
  for (std::size_t i = 0; i < pass.table_.size(); ++i) {
    const auto byte = static_cast<std::uint8_t>(i);
    pass.table_[i] = {byte, byte, byte, 255};
  }
  pass.ramp_ = make_texture(row_of(pass.table_), GL_SRGB8_ALPHA8);
  pass.samples_ = make_texture(row_of(pass.table_), GL_RGBA8);
  MIXRIG_ASSIGN(pass.program_, make_program("fullscreen.vert", "decode.frag"));
  const Program& program = pass.program_;
  pass.at_ = {program.location("is_yuyv"),    program.location("is_nv12"),
              program.location("is_bayer"),   program.location("has_samples"),
              program.location("size"),       program.location("red_at"),
              program.location("luma"),       program.location("red_blue"),
              program.location("green_shift")};
  return pass;
}

void DecodePass::set_layout(const RawPicture& picture) {
  const YuvToRgb& yuv = picture.yuv;
  set_uniform(at_.is_yuyv, picture.layout == RawLayout::kYuyv);
  set_uniform(at_.is_nv12, picture.layout == RawLayout::kNv12);
  set_uniform(at_.is_bayer, picture.layout == RawLayout::kBayer);
  set_uniform(at_.has_samples, picture.samples != nullptr);
  set_uniform(at_.size, glm::ivec2(picture.size.width, picture.size.height));
  set_uniform(at_.red_at, glm::ivec2(picture.red_x, picture.red_y));
  set_uniform(at_.luma, glm::ivec3(yuv.y_scale, yuv.y_shift, yuv.y_add));
  set_uniform(at_.red_blue, glm::ivec2(yuv.red_v, yuv.blue_u));
  set_uniform(at_.green_shift, glm::ivec3(yuv.green_u, yuv.green_v, yuv.shift));
}

void DecodePass::draw(const RawPicture& picture, const ImportedPlanes& planes,
                      const Target& plate) {
  if (picture.samples != nullptr &&
      std::memcmp(picture.samples->data(), table_.data(), sizeof(table_)) != 0) {
    table_ = *picture.samples;
    upload(samples_, row_of(table_));
  }
  program_.use();
  set_layout(picture);
  const bool two = picture.layout == RawLayout::kNv12;
  run_into(plate, program_, {planes.data(), two ? &planes[1] : nullptr, &samples_, &ramp_});
}

}  // namespace mixrig::render::gles
