// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>

#include "host/render/gles/gl/gl_convention.h"
#include "host/render/gles/gl/gl_program.h"
#include "shaders/shaders.h"
#include "tests/gl/gl_fixture.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

class EglContextTest : public GlTest {};

TEST_F(EglContextTest, offers_gles_3_1_with_float_targets) {
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  EXPECT_GE(10 * major + minor, 31);
  EXPECT_TRUE(context_->has_extension("GL_EXT_color_buffer_float"));
  EXPECT_FALSE(context_->has_extension("GL_EXT_color_buffer"));  // no prefix of a name
}

TEST_F(EglContextTest, second_context_leaves_the_first_usable) {
  {
    auto second = EglContext::create();
    ASSERT_TRUE(second);
  }
  ASSERT_TRUE(context_->make_current());
  EXPECT_NE(glGetString(GL_VERSION), nullptr);
}

TEST_F(EglContextTest, one_that_another_thread_made_and_released_is_usable_here) {
  std::optional<EglContext> made;
  std::thread([&] {
    auto second = EglContext::create();
    if (!second) return;
    second->release();
    made.emplace(std::move(*second));
  }).join();
  ASSERT_TRUE(made);
  ASSERT_TRUE(made->make_current());
  EXPECT_NE(glGetString(GL_VERSION), nullptr);
  made.reset();
  ASSERT_TRUE(context_->make_current());
}

TEST(IsSoftware, knows_software_renderers_by_name) {
  EXPECT_TRUE(is_software("llvmpipe (LLVM 15.0.6, 256 bits)"));
  EXPECT_TRUE(is_software("Google SwiftShader"));
  EXPECT_TRUE(is_software("softpipe"));
  EXPECT_FALSE(is_software("Mali-G610"));
  EXPECT_FALSE(is_software("V3D 4.2"));
  EXPECT_FALSE(is_software("NVIDIA Tegra Orin (nvgpu)/integrated"));
}

TEST(MayHaveGpu, by_device_files) {
  const TemporaryFolder dev;
  EXPECT_FALSE(may_have_gpu(dev.path()));
  EXPECT_FALSE(may_have_gpu(dev.path() / "missing"));
  std::filesystem::create_directory(dev.path() / "dri");
  std::ofstream(dev.path() / "dri" / "card0");  // a display device without a render node
  EXPECT_FALSE(may_have_gpu(dev.path()));
  std::ofstream(dev.path() / "mali0");
  EXPECT_TRUE(may_have_gpu(dev.path()));
  std::filesystem::remove(dev.path() / "mali0");
  std::ofstream(dev.path() / "dri" / "renderD128");
  EXPECT_TRUE(may_have_gpu(dev.path()));
}

TEST_F(EglContextTest, compile_error_names_file_and_line) {
  const std::string_view text =
      "#version 310 es\nprecision highp float;\n#line 1 1\nfloat f() { return 1.0; }\n"
      "#line 4 0\nout vec4 c;\nvoid main() { c = vec4(missing); }\n";
  const auto shader = compile(GL_FRAGMENT_SHADER, text, "mix.frag", {"mix.frag", "common/f.glsl"});
  ASSERT_FALSE(shader);
  EXPECT_NE(shader.error().context.find("mix.frag:5"), std::string::npos) << shader.error().context;
  EXPECT_NE(shader.error().context.find("missing"), std::string::npos);
  EXPECT_EQ(shader.error().context.find('\n'), std::string::npos);
}

TEST_F(EglContextTest, every_stage_compiles) {
  for (const shaders::Stage& stage : shaders::all_stages()) {
    const GLenum kind = stage.name.ends_with(".vert")   ? GL_VERTEX_SHADER
                        : stage.name.ends_with(".frag") ? GL_FRAGMENT_SHADER
                                                        : GL_COMPUTE_SHADER;
    const auto shader = compile(kind, stage.text, stage.name, stage.files);
    EXPECT_TRUE(shader) << shader.error().context;
  }
  EXPECT_GE(shaders::all_stages().size(), 10U);
}

TEST(NameFiles, turns_numbers_into_names_in_every_drivers_style) {
  const std::vector<std::string_view> files = {"mix.frag", "common/key.glsl"};
  EXPECT_EQ(shaders::name_files("0:12(5): error", files), "mix.frag:12(5): error");
  EXPECT_EQ(shaders::name_files("ERROR: 1:7: 'x'", files), "ERROR: common/key.glsl:7: 'x'");
  EXPECT_EQ(shaders::name_files("1(33) : error C1", files), "common/key.glsl:33) : error C1");
  EXPECT_EQ(shaders::name_files("9:1: vec3 a", files), "9:1: vec3 a");
}

TEST(Convention, pixel_centres_become_clip_coordinates) {
  // A point at pixel (0,0) of a 4 x 2 picture is half a pixel inside the corner.
  const render::PinholeParams camera{{2, 2}, {1.5F, 0.5F}};
  const glm::vec4 corner = clip_from_camera(camera, {4, 2}) * glm::vec4(-0.75F, -0.25F, 1, 1);
  EXPECT_FLOAT_EQ(corner.x / corner.w, -0.75F);
  EXPECT_FLOAT_EQ(corner.y / corner.w, -0.5F);
  const glm::vec4 near = clip_from_camera(camera, {4, 2}) * glm::vec4(0, 0, kNearM, 1);
  EXPECT_FLOAT_EQ(near.z / near.w, 1);
  const glm::vec4 two = clip_from_camera(camera, {4, 2}) * glm::vec4(0, 0, 2, 1);
  EXPECT_NEAR(z_from_window_depth(0.5F * two.z / two.w + 0.5F), 2, 1e-4);
  // Coordinates are homogeneous: (x, y, z, w) and (x, y, z) / w are the same point.
  const glm::vec4 scaled = clip_from_camera(camera, {4, 2}) * glm::vec4(0, 0, 1, 0.5F);
  EXPECT_FLOAT_EQ(scaled.z / scaled.w, two.z / two.w);
}

TEST(Convention, window_samples_lie_at_quarter_pixels) {
  const render::PinholeParams camera{{10, 10}, {5, 5}};
  const render::PinholeParams window = window_of(camera, {2, 3}, 2);
  // A ray of 0.1 is at pixel 6, whose samples 2 (6 - 2) + {0, 1} lie at 5.75 and 6.25.
  const float at = window.focal_px.x * 0.075F + window.center_px.x;
  EXPECT_FLOAT_EQ(at, 8);
  EXPECT_FLOAT_EQ(window.focal_px.y * 0.125F + window.center_px.y, 7);
}

}  // namespace
}  // namespace mixrig::test
