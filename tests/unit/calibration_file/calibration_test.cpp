// SPDX-License-Identifier: Apache-2.0
#include "host/capture/calibration_file/calibration.h"

#include <gtest/gtest.h>

#include "host/capture/calibration_file/tables.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::calibration_file {
namespace {

using geometry::LensKind;

CalibratedCamera some_camera(const std::string& name, LensKind kind) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(geometry::parameter_count(kind));
  v.head<8>() << 1100.1, 1099.9, 640.3, 511.7, -0.1 / 3, 0.02, 1e-4, -1e-17;
  CalibratedCamera camera;
  camera.name = name;
  camera.model = geometry::make_camera(kind, {1280, 1024}, v);
  camera.covariance = Eigen::MatrixXd::Random(v.size(), v.size());
  camera.residual_px = 0.1234;
  camera.views = 20;
  camera.points = 1080;
  camera.origin = {"2026-01-02T03:04:05Z", "mixrig 0.1.0", "0123456789abcdef"};
  return camera;
}

Calibration whole() {
  Calibration all;
  all.cameras = {some_camera("target", LensKind::kPinhole),
                 some_camera("a: b#", LensKind::kFisheye)};
  CalibratedPose pose;
  pose.name = "tof";
  pose.target_from = {Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {-0.05, 1.0 / 3, 0}};
  pose.covariance = Eigen::MatrixXd::Identity(6, 6) * 1e-9;
  pose.views = 7;
  all.poses = {pose};
  DepthError error;
  error.knots_m = {0.5, 1, 2};
  error.error_m = {0.01, -0.01, 0.003};
  error.place_m = {1e-3, 0, 0, 0, 2e-3};
  all.depth_error = error;
  all.depth_error2 = error;
  all.depth_error2->camera = "tof2";
  PanTilt unit;
  unit.tilt.direction = Eigen::Vector3d::UnitX();
  unit.tilt.scale = 1.0001;
  unit.tilt.step_rad = 0.0009;
  unit.covariance = Eigen::MatrixXd::Identity(9, 9);
  all.pan_tilt = unit;
  return all;
}

TEST(CalibrationFile, ReadsBackTheBitsThatItWrote) {
  const Calibration before = whole();
  const auto read = parse_calibration(calibration_text(before), "c.toml");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_EQ(read->cameras.size(), 2U);
  for (const CalibratedCamera& a : before.cameras) {
    ASSERT_NE(read->camera(a.name), nullptr);
    const CalibratedCamera& b = *read->camera(a.name);
    EXPECT_EQ(geometry::kind_of(a.model), geometry::kind_of(b.model));
    EXPECT_EQ(geometry::parameters_of(a.model), geometry::parameters_of(b.model));
    EXPECT_EQ(geometry::size_px(a.model), geometry::size_px(b.model));
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.residual_px, b.residual_px);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.origin, b.origin);
  }
  ASSERT_NE(read->pose("tof"), nullptr);
  EXPECT_LT((read->pose("tof")->target_from.matrix() - before.poses[0].target_from.matrix()).norm(),
            1e-15);
  EXPECT_EQ(read->pose("tof")->covariance, before.poses[0].covariance);
  EXPECT_EQ(read->pose("fisheye"), nullptr);
  EXPECT_EQ(read->depth_error->error_m, before.depth_error->error_m);
  EXPECT_EQ(read->depth_error->place_m, before.depth_error->place_m);
  ASSERT_TRUE(read->depth_error2);
  EXPECT_EQ(read->depth_error2->camera, "tof2");
  EXPECT_EQ(read->depth_error2->error_m, before.depth_error2->error_m);
  EXPECT_EQ(read->pan_tilt->tilt.scale, 1.0001);
  EXPECT_EQ(read->pan_tilt->tilt.step_rad, 0.0009);
  EXPECT_EQ(read->pan_tilt->covariance.rows(), 9);
}

TEST(CalibrationFile, HoldsTheLargestAngleOfAFisheye) {
  const auto angle_of = [](const std::string& text) {
    const auto read = parse_calibration(text, "c.toml");
    EXPECT_TRUE(read) << read.error().context;
    return read ? geometry::max_angle_rad(read->camera("fisheye")->model) : std::nullopt;
  };
  Calibration all;
  all.cameras = {some_camera("fisheye", LensKind::kFisheye)};
  const std::string without = calibration_text(all);
  EXPECT_EQ(without.find("max_angle"), std::string::npos);
  EXPECT_EQ(angle_of(without), std::nullopt);
  for (const double angle : {1.0 / 3, 1.6, M_PI}) {
    all.cameras[0].model = geometry::make_camera(
        LensKind::kFisheye, {1280, 1024}, geometry::parameters_of(all.cameras[0].model), angle);
    EXPECT_EQ(angle_of(calibration_text(all)), angle);
  }
  const std::string good = calibration_text(all);
  for (const char* wrong : {"nan", "inf", "-1.6", "0.0", "3.1416", "1e300", "\"1.6\"", "[1.6]"}) {
    std::string text = good;
    text.replace(text.find("max_angle_rad"),
                 text.find('\n', text.find("max_angle_rad")) - text.find("max_angle_rad"),
                 "max_angle_rad = " + std::string(wrong));
    const auto read = parse_calibration(text, "c.toml");
    ASSERT_FALSE(read) << wrong;
    EXPECT_EQ(read.error().context.rfind("c.toml:", 0), 0U) << read.error().context;
    EXPECT_NE(read.error().context.find("max_angle_rad"), std::string::npos)
        << read.error().context;
  }
  Calibration pinhole;
  pinhole.cameras = {some_camera("target", LensKind::kPinhole)};
  const auto read =
      parse_calibration(calibration_text(pinhole) + "max_angle_rad = 1.6\n", "c.toml");
  EXPECT_TRUE(test::refused(read, {"for model = \"fisheye\" alone"}));
}

TEST(CalibrationFile, UpdatesOneEntryAndKeepsTheOthers) {
  const test::TemporaryFolder folder;
  const auto path = folder / "calibration.toml";
  ASSERT_TRUE(update_calibration(path, whole()));
  Calibration newer;
  newer.cameras = {some_camera("target", LensKind::kFisheye)};
  ::testing::internal::CaptureStderr();
  const auto updated = update_calibration(path, newer);
  const std::string told = ::testing::internal::GetCapturedStderr();
  ASSERT_TRUE(updated);
  EXPECT_NE(told.find("calibration.toml: replaces camera target of "), std::string::npos) << told;
  EXPECT_EQ(told.find("pose"), std::string::npos) << told;
  const auto read = read_calibration(path);
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_EQ(read->cameras.size(), 2U);
  EXPECT_EQ(geometry::kind_of(read->camera("target")->model), LensKind::kFisheye);
  EXPECT_TRUE(read->depth_error);
  EXPECT_FALSE(std::filesystem::exists(folder / "calibration.toml.partial"));
}

geometry::LensTable some_lens() {
  std::vector<geometry::LensNode> nodes;
  for (const double zoom : {100.0, 200.5, 1e7 / 3})
    for (const double focus : {-1.0, 1.0 / 3})
      nodes.push_back({{zoom, focus},
                       {{{{1280, 1024}, 1100 + zoom / 1e5, 1101, 640 + focus, 512},
                         geometry::Lens({-0.1 / 3, 0.02, 1e-4, 0, 0, 0, 0, 0})},
                        focus / 100},
                       0.1});
  return *geometry::LensTable::make(nodes);
}

TEST(CalibrationFile, HoldsTheTableOfALensThatZooms) {
  Calibration all = whole();
  all.cameras[0].lens = some_lens();
  const std::string text = calibration_text(all);
  auto read = parse_calibration(text, "c.toml");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_TRUE(read->camera("target")->lens);
  const auto &a = all.cameras[0].lens->nodes(), &b = read->camera("target")->lens->nodes();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].at, b[i].at);
    EXPECT_EQ(a[i].lens.camera.pinhole, b[i].lens.camera.pinhole);
    EXPECT_EQ(a[i].lens.camera.lens.coefficients(), b[i].lens.camera.lens.coefficients());
    EXPECT_EQ(a[i].lens.pupil_shift_m, b[i].lens.pupil_shift_m);
    EXPECT_EQ(a[i].residual_px, b[i].residual_px);
  }
  merge(*read, whole());  // calibrated again at one setting
  EXPECT_TRUE(read->camera("target")->lens);
  for (const auto& [from, to, why] :
       {std::tuple("focus = -1.0", "focus = -2.0", "cameras.target.lens"),
        std::tuple("pupil_shift_m = -0.01", "pupil_shift_m = -1.01", "pupil_shift_m"),
        std::tuple("zoom = 100.0", "zoom = nan", "zoom"),
        std::tuple("zoom = 100.0", "zom = 100.0", "zom")}) {
    std::string wrong = text;
    const std::size_t at = wrong.find(from, wrong.find("lens]]"));
    ASSERT_NE(at, std::string::npos) << from;
    wrong.replace(at, std::string(from).size(), to);
    const auto refused = parse_calibration(wrong, "c.toml");
    ASSERT_FALSE(refused) << to;
    EXPECT_EQ(refused.error().context.rfind("c.toml:", 0), 0U) << refused.error().context;
    EXPECT_NE(refused.error().context.find(why), std::string::npos) << refused.error().context;
  }
}

TEST(CalibrationFile, ALensKeepsItsVignettingWhenItIsCalibratedAgain) {
  Calibration all = whole();
  all.cameras[0].vignetting = {0.31, 1.0 / 3};
  auto read = parse_calibration(calibration_text(all), "c.toml");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(read->camera("target")->vignetting, all.cameras[0].vignetting);
  EXPECT_TRUE(read->camera("a: b#")->vignetting.is_none());
  merge(*read, whole());
  EXPECT_EQ(read->camera("target")->vignetting, all.cameras[0].vignetting);
  all.cameras[0].vignetting = {0.5, 0};
  merge(*read, all);
  EXPECT_EQ(read->camera("target")->vignetting, (geometry::Vignetting{0.5, 0}));
}

TEST(CalibrationFile, DoesNotTouchWhatItCannotRead) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("calibration.toml", "format = 2\n");
  EXPECT_TRUE(test::refused(update_calibration(path, whole()), {}, ErrorCode::kFormat));
  EXPECT_EQ(test::read_bytes(path), "format = 2\n");
}

TEST(CalibrationFile, SaysWhatIsWrongAndWhere) {
  const std::string good = calibration_text(whole());
  struct Case {
    const char *from, *to, *says;
  };
  for (const Case& c :
       {Case{"format = 1", "format = 3", "c.toml:2: key \"format\""},
        Case{"\"pinhole\"", "\"pinhol\"", "use one of \"pinhole\", \"fisheye\""},
        Case{"size_px = [1280", "size_px = [0", "size_px"},
        Case{"fx = 1100.1", "fx = -1100.1", "-1100.1 is out of range"},
        Case{"fx = 1100.1", "fx = nan", "nan is out of range"},
        Case{"rotation_xyzw = [0", "rotation_xyzw = [1", "must have length 1"},
        Case{"rotation_xyzw", "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nrotation_xyzw",
             "remove one of them"},
        Case{"knots_m = [0.5, 1.0", "knots_m = [0.5, 0.5", "must grow"},
        Case{"error_m = [", "error_m = [1, ", "array of 3 numbers"},
        Case{"views = 20", "view = 20", "\"cameras.target.view\": not known"},
        Case{"covariance = [", "covariance = [[1],", "covariance"},
        Case{"fx = 1100.1", "vignetting = [1, 9]\nfx = 1100.1", "9 is out of range"},
        Case{"fx = 1100.1", "vignetting = 1\nfx = 1100.1", "vignetting"},
        Case{"[depth_error]", "[depth_eror]", "did you mean \"depth_error\"?"},
        Case{"[depth_error]", "[depth_error", "not valid TOML"}}) {
    std::string bad = good;
    const auto at = bad.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    bad.replace(at, std::string(c.from).size(), c.to);
    EXPECT_TRUE(test::refused(parse_calibration(bad, "c.toml"), {c.says}, ErrorCode::kFormat))
        << c.to;
  }
}

TEST(CalibrationFile, SaysWhatToDoAboutAnOldYamlFile) {
  for (const char* text : {"format: 1\ncameras:\n  target:\n", "# note\nformat: 1\n"}) {
    const auto read = parse_calibration(text, "calibration.yaml");
    EXPECT_TRUE(test::refused(read, {}, ErrorCode::kFormat));
    EXPECT_TRUE(read.error().context.starts_with("calibration.yaml: "));
    EXPECT_NE(read.error().context.find("mixrig calibrate writes calibration.toml"),
              std::string::npos);
  }
}

TEST(CalibrationFile, NamesMayHoldAnything) {
  Calibration all;
  all.cameras = {some_camera("left \"eye\".[1]\n\\", LensKind::kPinhole)};
  const auto read = parse_calibration(calibration_text(all), "c.toml");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_NE(read->camera(all.cameras[0].name), nullptr);
}

/// The error that parsing of `text` as one table gives, or empty.
template <typename Parse>
std::string error_of(const std::string& text, Parse parse) {
  auto document = config::Document::parse(text, "t.toml");
  EXPECT_TRUE(document) << document.error().context;
  parse(document->root());
  const auto done = document->finish();
  return done ? "" : done.error().context;
}

TEST(Tables, ACameraNeedsNoModelAndNoDistortion) {
  geometry::CameraModel model;
  EXPECT_EQ(error_of("size_px = [64, 48]\nfx = 60\nfy = 61\ncx = 31.5\ncy = 23.5\n",
                     [&](const config::Table& t) { model = parse_pinhole(t); }),
            "");
  EXPECT_EQ(model.pinhole.fy_px, 61);
  EXPECT_TRUE(model.lens.is_ideal());
}

TEST(Tables, AnInlineCameraMayHoldAllThatCalibrationTomlHolds) {
  const CalibratedCamera camera = some_camera("", LensKind::kPinhole);
  geometry::CameraModel model;
  EXPECT_EQ(error_of(camera_table(camera).text(),
                     [&](const config::Table& t) { model = parse_pinhole(t); }),
            "");
  EXPECT_EQ(geometry::parameters_of(model), geometry::parameters_of(camera.model));
}

TEST(Tables, AnInlineCameraHasNoVignetting) {
  CalibratedCamera camera = some_camera("", LensKind::kPinhole);
  camera.vignetting = {0.3, 0};
  EXPECT_NE(error_of(camera_table(camera).text(), [](const config::Table& t) { parse_pinhole(t); })
                .find("calibration file"),
            std::string::npos);
}

TEST(Tables, ColourAndDepthAreNotReadThroughAFisheye) {
  const std::string text = camera_table(some_camera("", LensKind::kFisheye).model).text();
  EXPECT_NE(error_of(text, [](const config::Table& t) { parse_pinhole(t); }).find("\"pinhole\""),
            std::string::npos);
  EXPECT_EQ(error_of(text, [](const config::Table& t) { parse_camera(t, "fisheye"); }), "");
}

TEST(Tables, APoseIsAMatrixOrAQuaternion) {
  const geometry::Pose pose{Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {-1, 2, 3}};
  geometry::Pose read;
  const auto parse = [&](const config::Table& t) { read = parse_pose(t); };
  EXPECT_EQ(error_of(pose_table(pose).text(), parse), "");
  EXPECT_LT((read.matrix() - pose.matrix()).norm(), 1e-15);
  EXPECT_EQ(
      error_of("translation_m = [1, 2, 3]\nrotation = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\n", parse),
      "");
  EXPECT_LT((read * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  EXPECT_NE(error_of("translation_m = [1, 2, 3]\n", parse).find("\"rotation\": missing"),
            std::string::npos);
  EXPECT_NE(error_of("translation_m = [1, 2, 3]\nrotation_xyzw = [0, 0, 0, 0]\n", parse)
                .find("must have length 1"),
            std::string::npos);
}

TEST(Tables, CamerasOfOneRigAreNotTensOfMetresApart) {
  const auto error = [&](const char* place) {
    return error_of(std::string("translation_m = ") + place + "\nrotation_xyzw = [0, 0, 0, 1]\n",
                    [](const config::Table& t) { parse_calibrated_pose(t, "tof"); });
  };
  EXPECT_EQ(error("[-1.2, 0.3, 0.1]"), "");
  EXPECT_NE(
      error("[-52.0, 0.2, -0.3]")
          .find("\"translation_m\": puts the cameras 52 m apart, which one rig cannot be: give "
                "it in metres"),
      std::string::npos)
      << error("[-52.0, 0.2, -0.3]");
}

TEST(CalibrationFile, RefusesHostileText) {
  EXPECT_FALSE(parse_calibration("", "c"));
  EXPECT_FALSE(parse_calibration("- 1", "c"));
  EXPECT_FALSE(parse_calibration("format = 1\ncameras = 3\n", "c"));
  EXPECT_FALSE(parse_calibration("format = 1\n[cameras]\nleft = 3\n", "c"));
  EXPECT_FALSE(parse_calibration("format = 1\n[depth_error]\nknots_m = 3\n", "c"));
  EXPECT_FALSE(parse_calibration(std::string(100000, '['), "c"));
  EXPECT_FALSE(parse_calibration(std::string(100000, '{'), "c"));
  EXPECT_FALSE(parse_calibration(std::string("\0\x01\xff", 3), "c"));
}

TEST(InputHash, IsFnv1a) {
  InputHash hash;
  EXPECT_EQ(hash.text(), "cbf29ce484222325");
  hash.add_bytes("foobar");
  EXPECT_EQ(hash.text(), "85944171f73967e8");  // published test vector
}

}  // namespace
}  // namespace mixrig::calibration_file
