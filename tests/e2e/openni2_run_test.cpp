// SPDX-License-Identifier: Apache-2.0
// A studio take becomes an .oni recording by OpenNI2's own recorder, which is then played as
// devices.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"
#include "tests/support/openni2/scripted_camera.h"

namespace mixrig::test {
namespace {

constexpr int kFrames = 16;

class OpenNi2Run : public CommandTest {
 protected:
  Image<Rgb8> color_of(const std::string& take, int frame) const {
    Image<Rgb8> picture;
    EXPECT_TRUE(image_io::read_rgb8(path(take + numbered("/color/%06d.png", frame)), picture));
    return picture;
  }
  Image<std::uint16_t> depth_of(const std::string& take, int frame) const {
    Image<std::uint16_t> picture;
    EXPECT_TRUE(image_io::read_gray16(path(take + numbered("/depth/%06d.png", frame)), picture));
    return picture;
  }
  static std::string numbered(const char* pattern, int frame) {
    char text[64];
    std::snprintf(text, sizeof text, pattern, frame);
    return text;
  }
  template <typename T, typename U>
  static std::vector<U> packed(const Image<T>& picture) {
    std::vector<U> out(picture.size().area() * sizeof(T) / sizeof(U));
    auto* to = reinterpret_cast<T*>(out.data());
    for (int y = 0; y < picture.height(); ++y, to += picture.width())
      std::copy(picture.row(y), picture.row(y) + picture.width(), to);
    return out;
  }
  /// Records the frames of the take, with its depth steps unchanged.
  void make_recording() const {
    const auto color = color_of("take", 1);
    const auto depth = depth_of("take", 1);
    ScriptedModule module(MIXRIG_OPENNI2_MODULE, {depth.width(), depth.height(), 1000, 0.8F,
                                                  color.width(), color.height(), 125000});
    const auto show = [&](int frame, ScriptedRecording& recording) {
      module.expose(recording.next(), packed<std::uint16_t, std::uint16_t>(depth_of("take", frame)),
                    packed<Rgb8, std::uint8_t>(color_of("take", frame)));
    };
    ScriptedRecording recording(path("take.oni"), module,
                                packed<std::uint16_t, std::uint16_t>(depth),
                                packed<Rgb8, std::uint8_t>(color));
    for (int frame = 2; frame <= kFrames; ++frame) show(frame, recording);
  }
};

TEST_F(OpenNi2Run, AStudioTakeRecordedByTheLibraryIsRecordedAgainAndComposited) {
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --rig kinect2 --seed 31 --size 160x128 --frames " +
                         std::to_string(kFrames)),
      0);
  make_recording();
  std::ifstream file(path("take/take.toml"));
  const std::string take(std::istreambuf_iterator<char>(file), {});
  const auto begin = take.find("[target]"), end = take.find("[pose]");
  std::ofstream(path("rig.toml")) << "format = 1\nname = \"oni\"\n"
                                  << "[[camera]]\nname = \"color\"\nuri = \"openni2:"
                                  << path("take.oni") << "\"\n"
                                  << "[depth]\nuri = \"openni2:" << path("take.oni")
                                  << "\"\nkind = \"distance\"\n"
                                  << std::regex_replace(take.substr(begin, end - begin),
                                                        std::regex("view = .*"), "");
  std::ofstream(path("scene.toml")) << "[camera]\npose = \"floor\"\n[background]\nlearn = [1, 3]\n";
  ASSERT_EQ(mixrig("record --rig " + path("rig.toml") + " " + path("again") +
                   " --duration 60 --format png --json " + path("record.json")),
            0);
  EXPECT_EQ(report("record.json").at("ended"), "end of the cameras");
  // Every recorded depth picture is one of the take, in order, and only the first few may be
  // missing.
  int from = 1, matched = 0;
  for (int frame = 1; std::filesystem::exists(path(numbered("again/depth/%06d.png", frame)));
       ++frame) {
    const auto steps = packed<std::uint16_t, std::uint16_t>(depth_of("again", frame));
    int found = 0;
    for (int n = from; n <= kFrames && found == 0; ++n)
      if (steps == packed<std::uint16_t, std::uint16_t>(depth_of("take", n))) found = n;
    ASSERT_NE(found, 0) << frame;
    from = found;
    ++matched;
  }
  EXPECT_GE(matched, kFrames - 6);
  ASSERT_EQ(mixrig("run " + path("scene.toml") + " --source rig:" + path("rig.toml") +
                   " --backend cpu --format none --out " + path("out")),
            0);
  EXPECT_EQ(report("out/report.json").at("ended"), "end of the source");
  EXPECT_GT(report("out/report.json").at("frames").get<int>(), 0);
}

}  // namespace
}  // namespace mixrig::test
