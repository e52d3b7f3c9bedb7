// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/compositor_cpu.h"
#include "host/render/cpu/key/key.h"
#include "host/render/cpu/warp/warp.h"
#include "tests/unit/render/back_end.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {

std::unique_ptr<render::Compositor> make_compositor(const render::CompositorSetup& setup,
                                                    int threads) {
  auto made = render::make_cpu_compositor(setup, threads);
  EXPECT_TRUE(made) << made.error().context;
  return made ? std::move(*made) : nullptr;
}

CorrectedDepth correct_depth(const render::Tables& tables, const Image<float>& depth_m) {
  Crew crew(1);
  render::cpu::TofGrid grid(depth_m.size());
  render::cpu::correct(crew, tables.correct, tables.tof_ray, depth_m, grid);
  constexpr int kFrame = render::cpu::kFrame;
  return {make_image<float>(depth_m.size(),
                            [&](int x, int y) { return grid.z_m.at(x + kFrame, y + kFrame); }),
          make_image<int>(depth_m.size(),
                          [&](int x, int y) { return grid.links.at(x + kFrame, y + kFrame); })};
}

WarpedDepth warp_depth(const render::Tables& tables, const Image<float>& depth_m, int threads) {
  Crew crew(threads);
  render::cpu::TofGrid grid(depth_m.size());
  render::cpu::WarpScratch scratch(depth_m.size());
  const Size view = tables.view_size;
  constexpr int kMargin = render::cpu::kViewMargin;
  Image<float> w({view.width + kMargin, view.height + kMargin}, 7.0F);
  render::cpu::correct(crew, tables.correct, tables.tof_ray, depth_m, grid);
  render::cpu::warp(crew, tables, grid, scratch, w);
  return {
      make_image<float>(view, [&](int x, int y) { return w.at(x, y); }),
      make_image<bool>(view, [&](int x, int y) { return render::cpu::from_cut_cell(w.at(x, y)); })};
}

Image<std::uint8_t> key_people(const render::CompositorSetup& setup, const Image<Rgbf>& plate,
                               Image<float>& w) {
  const Size view = plate.size();
  const render::Tables tables = render::make_tables(setup);
  render::FramePreparer preparer(setup);
  preparer.update({});
  render::cpu::KeyScratch scratch(view, tables.tof_footprint_px, 2);
  const auto fixed =
      make_image<render::cpu::Rgbx16>(view, [&](int x, int y) { return linear16(plate.at(x, y)); });
  Image<float> padded({view.width + 3, view.height + 3}, 0.25F);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const auto bits = std::bit_cast<std::uint32_t>(std::abs(w.at(x, y))) & ~1U;
      padded.at(x, y) = std::bit_cast<float>(bits | (w.at(x, y) < 0 ? 1U : 0U));
    }
  Image<std::uint8_t> matte(view, 77);
  Crew crew(2);
  render::cpu::key(crew, {tables, preparer.params().key, setup.background, fixed}, scratch, padded,
                   matte);
  for (int y = 0; y < view.height; ++y) std::copy_n(padded.row(y), view.width, w.row(y));
  return matte;
}

}  // namespace mixrig::test
