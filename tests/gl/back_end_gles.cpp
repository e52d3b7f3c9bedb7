// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/gl/egl_context.h"
#include "host/render/gles/key/key_pass.h"
#include "host/render/gles/plate/correct_pass.h"
#include "host/render/gles/warp/warp_pass.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/render/back_end.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

/// A GL context that lasts for one call.
struct PassContext {
  Result<EglContext> context = EglContext::create();
  PassContext() { EXPECT_TRUE(context) << context.error().context; }
};

}  // namespace

std::unique_ptr<render::Compositor> make_compositor(const render::CompositorSetup& setup, int) {
  auto made = render::make_gles_compositor(setup);
  EXPECT_TRUE(made) << made.error().context;
  return made ? std::move(*made) : nullptr;
}

CorrectedDepth correct_depth(const render::Tables& tables, const Image<float>& depth_m) {
  const PassContext context;
  auto pass = CorrectPass::create(tables);
  EXPECT_TRUE(pass) << pass.error().context;
  pass->upload_depth(depth_m);
  pass->draw();
  const auto z_m = read(pass->z_m()), vertices = read(pass->vertices());
  return {make_image<float>(depth_m.size(), [&](int x, int y) { return z_m.at(x, y).r; }),
          make_image<int>(depth_m.size(),
                          [&](int x, int y) { return static_cast<int>(vertices.at(x, y).a); })};
}

WarpedDepth warp_depth(const render::Tables& tables, const Image<float>& depth_m, int) {
  const PassContext context;
  auto correct = CorrectPass::create(tables);
  auto warp = WarpPass::create(tables);
  EXPECT_TRUE(correct && warp);
  correct->upload_depth(depth_m);
  correct->draw();
  warp->draw(correct->vertices(), correct->tof_ray(), correct->raw_z_m());
  const auto w = read(warp->w());
  return {make_image<float>(w.size(), [&](int x, int y) { return std::abs(w.at(x, y).r); }),
          make_image<bool>(w.size(), [&](int x, int y) { return w.at(x, y).r < 0; })};
}

Image<std::uint8_t> key_people(const render::CompositorSetup& setup, const Image<Rgbf>& plate,
                               Image<float>& w) {
  const PassContext context;
  const render::Tables tables = render::make_tables(setup);
  render::FramePreparer preparer(setup);
  preparer.update({});
  const render::KeyPassParams& params = preparer.params().key;
  auto pass = KeyPass::create(tables, {true, true}, params);
  EXPECT_TRUE(pass) << pass.error().context;
  const Texture view_w = make_texture(w.view(), GL_R32F);
  const Texture colors = make_texture(plate.view(), GL_RGB32F);
  const Texture learned = make_texture(setup.background.color, GL_RGB16F);
  const Texture spread = make_texture(setup.background.color_sigma, GL_R16F);
  pass->draw(params, {view_w, colors, learned, spread});
  const auto matte = read(pass->matte()), visible_w = read(pass->visible_w());
  w = make_image<float>(w.size(), [&](int x, int y) { return visible_w.at(x, y).r; });
  return make_image<std::uint8_t>(w.size(), [&](int x, int y) {
    return static_cast<std::uint8_t>(std::lround(255 * matte.at(x, y).r));
  });
}

}  // namespace mixrig::test
