// SPDX-License-Identifier: Apache-2.0
// Files as the other tools write them, typed by hand from their documentation.
#include "host/capture/calibration_file/exchange.h"

#include <array>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::calibration_file {
namespace {

using geometry::LensKind;

constexpr const char* kOpencv = R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3e+02, 0., 342.25, 0.,
       5.4e+02, 235.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.5e-01, -3.5e-02, 1.75e-03, -2.5e-04, 0.25 ]
avg_reprojection_error: 3.9e-01
)";

constexpr const char* kRos = R"(image_width: 640
image_height: 480
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [300, 0, 320, 0, 301, 240, 0, 0, 1]
distortion_model: equidistant
distortion_coefficients:
  rows: 1
  cols: 4
  data: [0.01, -0.02, 0.003, +0.0004]
)";

constexpr const char* kKalibr = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  distortion_model: radtan
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [0.0, -1.0, 0.0, -0.11]
  - [1.0, 0.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.02]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.02, 0.003, 0.0004]
  distortion_model: equidistant
  intrinsics: [380, 381, 370, 250]
  resolution: [752, 480]
)";

constexpr const char* kMrcal = R"(# generated on 2023 with a tool
{
    'lensmodel':  'LENSMODEL_OPENCV8',
    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....
    'intrinsics': [ 1761.18,1761.25,1965.7,1087.5,-0.012,0.05,-0.0002,0.0001,0.03,0.3,0.04,0.01,],
    'valid_intrinsics_region': [
    [ 10, 20 ],
    [ 30, 40 ],
    ],
    # extrinsics are rt_fromref
    'extrinsics': [ 0,0,1.5707963267948966,1,2,3,],
    'imagersize': [ 4000,2200,],
    'icam_intrinsics': 0,
    'optimization_inputs': b'P)h>@6aWAK2mk;8Apigu}{{<-,#`'
}
)";

TEST(OpencvFile, ReadsItsYaml) {
  const auto camera = parse_opencv(kOpencv, "o.yml");
  ASSERT_TRUE(camera) << camera.error().context;
  Eigen::VectorXd wanted(12);
  wanted << 530, 540, 342.25, 235.5, -0.25, -0.035, 1.75e-3, -2.5e-4, 0.25, 0, 0, 0;
  EXPECT_EQ(geometry::parameters_of(camera->model), wanted);
  EXPECT_EQ(geometry::size_px(camera->model), (Size{640, 480}));
}

TEST(OpencvFile, ReadsRosCameraInfoOfAFisheye) {
  const auto camera = parse_opencv(kRos, "r.yaml");
  ASSERT_TRUE(camera) << camera.error().context;
  ASSERT_EQ(geometry::kind_of(camera->model), LensKind::kFisheye);
  EXPECT_EQ(geometry::parameters_of(camera->model)[7], 0.0004);
}

TEST(OpencvFile, RoundTripsBothKinds) {
  for (const char* text : {kOpencv, kRos}) {
    const auto camera = parse_opencv(text, "a");
    const auto again = parse_opencv(*opencv_text(*camera), "b");
    ASSERT_TRUE(again) << again.error().context;
    EXPECT_EQ(geometry::parameters_of(again->model), geometry::parameters_of(camera->model));
  }
}

TEST(KalibrFile, ReadsAChain) {
  const auto cameras = parse_kalibr(kKalibr, "k.yaml");
  ASSERT_TRUE(cameras) << cameras.error().context;
  ASSERT_EQ(cameras->size(), 2U);
  EXPECT_EQ(geometry::parameters_of((*cameras)[0].model)[5], 0.07);
  EXPECT_EQ(geometry::kind_of((*cameras)[1].model), LensKind::kFisheye);
  // A point of the first camera in the second: turned by a quarter, then moved.
  const Eigen::Vector3d moved = (*cameras)[1].camera_from_reference * Eigen::Vector3d(1, 2, 3);
  EXPECT_LT((moved - Eigen::Vector3d(-2.11, 1, 3.02)).norm(), 1e-12);
}

TEST(KalibrFile, RoundTripsAndRefusesWhatKalibrLacks) {
  const auto cameras = parse_kalibr(kKalibr, "k.yaml");
  const auto text = kalibr_text(*cameras);
  ASSERT_TRUE(text);
  const auto again = parse_kalibr(*text, "again");
  ASSERT_TRUE(again) << again.error().context;
  EXPECT_LT(
      ((*again)[1].camera_from_reference.matrix() - (*cameras)[1].camera_from_reference.matrix())
          .norm(),
      1e-14);
  EXPECT_TRUE(
      test::refused(kalibr_text({*parse_opencv(kOpencv, "o")}), {}, ErrorCode::kUnsupported));
}

TEST(MrcalFile, ReadsItsDictionary) {
  const auto camera = parse_mrcal(kMrcal, "m.cameramodel");
  ASSERT_TRUE(camera) << camera.error().context;
  EXPECT_EQ(geometry::parameters_of(camera->model)[11], 0.01);
  EXPECT_EQ(geometry::size_px(camera->model), (Size{4000, 2200}));
  const Eigen::Vector3d moved = camera->camera_from_reference * Eigen::Vector3d::UnitX();
  EXPECT_LT((moved - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST(MrcalFile, RoundTripsAndRefusesAFisheye) {
  const auto camera = parse_mrcal(kMrcal, "m");
  const auto again = parse_mrcal(*mrcal_text(*camera), "again");
  ASSERT_TRUE(again) << again.error().context;
  EXPECT_EQ(geometry::parameters_of(again->model), geometry::parameters_of(camera->model));
  EXPECT_LT((again->camera_from_reference.matrix() - camera->camera_from_reference.matrix()).norm(),
            1e-14);
  EXPECT_FALSE(mrcal_text(*parse_opencv(kRos, "r")));
  std::string splined = kMrcal;
  splined.replace(splined.find("LENSMODEL_OPENCV8"), 17, "LENSMODEL_CAHVORE");
  EXPECT_TRUE(test::refused(parse_mrcal(splined, "m"), {}, ErrorCode::kUnsupported));
}

/// Output of a command; nullopt if it fails.
std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string out;
  std::array<char, 4096> part{};
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe))
    out.append(part.data(), count);
  return pclose(pipe) == 0 ? std::optional(out) : std::nullopt;
}

TEST(MrcalFile, IsReadByMrcalItself) {
  if (!output_of("/usr/bin/python3 -c \"import mrcal\""))
    GTEST_SKIP() << "mrcal is not installed: scripts/setup mrcal";
  const test::TemporaryFolder folder;
  const auto camera = parse_mrcal(kMrcal, "m");
  const auto path = folder.write("ours.cameramodel", *mrcal_text(*camera));
  // mrcal's own library projects a point; our model must give the same pixel.
  const std::string script =
      "import sys, mrcal, numpy as np; m = mrcal.cameramodel(sys.argv[1]); "
      "q = mrcal.project(np.array((0.3, -0.2, 1.)), *m.intrinsics()); "
      "t = m.extrinsics_Rt_fromref(); print(repr(float(q[0])), repr(float(q[1])), "
      "*map(float, t.ravel()))";
  const auto output = output_of("/usr/bin/python3 -c '" + script + "' " + path.string());
  ASSERT_TRUE(output) << "mrcal cannot read what we wrote";
  std::array<double, 14> v{};
  const char* at = output->c_str();
  char* end = nullptr;
  for (double& value : v) {
    value = std::strtod(at, &end);
    ASSERT_NE(at, end) << *output;
    at = end;
  }
  const auto px = geometry::project(camera->model, {0.3, -0.2, 1});
  EXPECT_NEAR(v[0], px->x(), 1e-9);
  EXPECT_NEAR(v[1], px->y(), 1e-9);
  const Eigen::Matrix3d rotation = camera->camera_from_reference.rotation.toRotationMatrix();
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(v[2 + i], rotation(i / 3, i % 3), 1e-9);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(v[11 + i], camera->camera_from_reference.translation_m[i], 1e-12);
}

TEST(KalibrFile, WritesTheLayoutThatKalibrReads) {
  std::string text = kKalibr;
  text.replace(text.find("0.0002"), 6, "-1e-05");
  const auto cameras = parse_kalibr(text, "k.yaml");
  // A point before each exponent: PyYAML reads -1e-05 as text.
  EXPECT_EQ(*kalibr_text({(*cameras)[0]}), R"(cam0:
  camera_model: pinhole
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  distortion_model: radtan
  distortion_coeffs: [-0.28, 0.07, -1.0e-05, 1.8e-05]
  resolution: [752, 480]
)");
}

TEST(OpencvFile, WritesTheLayoutThatOpencvReads) {
  EXPECT_EQ(*opencv_text(*parse_opencv(kRos, "r")), R"(%YAML:1.0
---
image_width: 640
image_height: 480
fisheye_model: 1
camera_matrix: !!opencv-matrix
  rows: 3
  cols: 3
  dt: d
  data: [300, 0, 320, 0, 301, 240, 0, 0, 1]
distortion_coefficients: !!opencv-matrix
  rows: 4
  cols: 1
  dt: d
  data: [0.01, -0.02, 0.003, 0.0004]
)");
}

TEST(ReadCameras, FindsTheKindOfAFile) {
  EXPECT_EQ(sniff(kOpencv), FileKind::kOpencv);
  EXPECT_EQ(sniff(kRos), FileKind::kOpencv);
  EXPECT_EQ(sniff(kKalibr), FileKind::kKalibr);
  EXPECT_EQ(sniff(kMrcal), FileKind::kMrcal);
  Calibration ours;
  ours.cameras = {{"left", parse_opencv(kRos, "r")->model, {}, 0, 0, 0, {}}};
  EXPECT_EQ(sniff(calibration_text(ours)), FileKind::kMixrig);
  const test::TemporaryFolder folder;
  for (const char* text : {kOpencv, kRos, kKalibr, kMrcal}) {
    const auto cameras = read_cameras(folder.write("left.txt", text));
    ASSERT_TRUE(cameras) << cameras.error().context;
    EXPECT_GE(cameras->size(), 1U);
  }
  EXPECT_EQ(read_cameras(folder / "absent").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read_cameras(folder.path()).error().code, ErrorCode::kNotFound);
}

TEST(ReadCameras, SaysWhatIsWrong) {
  EXPECT_TRUE(test::refused(parse_opencv("image_width: 640\nimage_height: 480\n", "o.yml"),
                            {"camera_matrix"}));
  std::string skewed = kRos;
  skewed.replace(skewed.find("[300, 0"), 7, "[300, 5");
  EXPECT_FALSE(parse_opencv(skewed, "o"));
  std::string folded = kOpencv;
  folded.replace(folded.find("-2.5e-01"), 8, "-9.5e+01");
  EXPECT_FALSE(parse_opencv(folded, "o"));
  EXPECT_FALSE(parse_kalibr("cam0: 3", "k"));
  EXPECT_FALSE(parse_mrcal("{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1,2", "m"));
}

}  // namespace
}  // namespace mixrig::calibration_file
