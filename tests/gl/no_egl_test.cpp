// SPDX-License-Identifier: Apache-2.0
// A machine without an EGL driver. This is a separate program, since a process loads its drivers
// once.
#include <cstdlib>

#include <gtest/gtest.h>

#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/gl/egl_context.h"

namespace mixrig::test {
namespace {

TEST(NoEgl, is_one_clear_line) {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent/egl_vendor.json", 1);
  const auto context = render::gles::EglContext::create();
  ASSERT_FALSE(context);
  EXPECT_EQ(context.error().code, ErrorCode::kDevice);
  const std::string& line = context.error().context;
  EXPECT_NE(line.find("EGL"), std::string::npos) << line;
  EXPECT_NE(line.find("--backend cpu"), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

}  // namespace
}  // namespace mixrig::test
