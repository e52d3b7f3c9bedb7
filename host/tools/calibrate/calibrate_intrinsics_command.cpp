// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate intrinsics: lens and focal length of one camera from pictures of a board.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/exchange.h"
#include "host/math/image_io/image_io.h"
#include "host/tools/calibrate/calibrate_picture.h"
#include "host/tools/calibrate/intrinsics_report.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

namespace fs = std::filesystem;
using calibration::BoardSpec;
using calibration::ImageCircle;
using calibration::Intrinsics;
using calibration::UncertaintyMap;

struct IntrinsicsArguments {
  std::vector<std::string> images;
  std::string board, model = "pinhole", camera = "target", out, picture, lens = "auto";
  std::string opencv, kalibr, mrcal, circle = "auto";
  bool hold_center = false;
};

constexpr int kMapColumns = 12, kMapRows = 9;

/// Warns where the file has another camera under this name: two cameras may have been exchanged.
void warn_if_swapped(const IntrinsicsArguments& arguments, const Intrinsics& in) {
  std::error_code code;
  if (arguments.out.empty() || !fs::exists(arguments.out, code)) return;
  const auto before = calibration_file::read_calibration(arguments.out);
  const auto* camera = before ? before->camera(arguments.camera) : nullptr;
  if (camera == nullptr) return;
  const double was = geometry::parameters_of(camera->model)[0], is = in.bundle.intrinsics[0];
  constexpr double kOtherCamera = 0.02;
  if (geometry::size_px(camera->model) == geometry::size_px(in.camera) &&
      std::abs(is / was - 1) < kOtherCamera)
    return;
  log_warning("calibrate",
              fmt::format("{} had fx {:.1f} before and has {:.1f} now: are the cameras swapped?",
                          arguments.camera, was, is));
}

Result<void> write_files(const IntrinsicsArguments& arguments, const Intrinsics& in,
                         const UncertaintyMap& map) {
  calibration_file::InputHash hash;
  for (const auto& path : arguments.images) MIXRIG_TRY(hash.add_file(path));
  calibration_file::CalibratedCamera camera;
  camera.name = arguments.camera;
  camera.model = in.camera;
  camera.covariance = in.covariance;
  camera.residual_px = in.rms_px;
  camera.views = static_cast<int>(in.bundle.views.size());
  camera.points = in.points;
  camera.origin = calibration_file::origin_now(hash);
  const calibration_file::ForeignCamera foreign{arguments.camera, in.camera, {}};
  // All texts first: nothing is written where one of the formats cannot hold the lens.
  std::vector<std::pair<std::string, std::string>> texts;
  const auto add = [&](const std::string& path, Result<std::string> text) -> Result<void> {
    if (path.empty()) return {};
    if (!text) return std::move(text).error();
    texts.emplace_back(path, *text);
    return {};
  };
  MIXRIG_TRY(add(arguments.opencv, calibration_file::opencv_text(foreign)));
  MIXRIG_TRY(add(arguments.kalibr, calibration_file::kalibr_text({foreign})));
  MIXRIG_TRY(add(arguments.mrcal, calibration_file::mrcal_text(foreign)));
  if (!arguments.out.empty()) {
    calibration_file::Calibration calibration;
    calibration.cameras = {camera};
    MIXRIG_TRY(calibration_file::update_calibration(arguments.out, calibration));
  }
  for (const auto& [path, text] : texts) MIXRIG_TRY(write_file(path, text));
  if (!arguments.picture.empty())
    MIXRIG_TRY(image_io::write_png(arguments.picture, calibration_picture(in, map)));
  return {};
}

Result<int> lens_terms_of(const IntrinsicsArguments& arguments) {
  if (arguments.lens == "auto") return -1;
  const auto allowed = arguments.model == "fisheye"
                           ? std::vector<std::string>{"0", "2", "4"}
                           : std::vector<std::string>{"0", "2", "4", "5", "8"};
  if (std::find(allowed.begin(), allowed.end(), arguments.lens) != allowed.end())
    return arguments.lens[0] - '0';
  return Error{ErrorCode::kUsage, "--lens " + arguments.lens +
                                      ": use auto, 0, 2, 4, 5 or 8 (fisheye: auto, 0, 2 or 4)"};
}

/// The circle of --image-circle: as given, none, or found in the pictures. Errors: kUsage.
Result<std::optional<ImageCircle>> circle_of(const IntrinsicsArguments& arguments,
                                             const calibration::BrightestPicture& brightest) {
  if (arguments.model != "fisheye" && arguments.circle != "auto" && arguments.circle != "none")
    return Error{ErrorCode::kUsage, "--image-circle is for a fisheye: give --model fisheye"};
  if (arguments.model != "fisheye" || arguments.circle == "none")
    return std::optional<ImageCircle>();
  if (arguments.circle == "auto") return calibration::find_image_circle(brightest.image());
  const char* at = arguments.circle.data();
  const char* const end = at + arguments.circle.size();
  std::array<double, 3> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto [next, code] = std::from_chars(at, end, v[i]);
    const bool last = i + 1 == v.size();
    const bool ends = last ? next == end : next != end && *next == ',';
    constexpr double kMost_px = 1e5;
    if (code != std::errc() || !ends || !(std::abs(v[i]) < kMost_px) || (last && v[i] < 1))
      return Error{ErrorCode::kUsage, "--image-circle " + arguments.circle +
                                          ": use auto, none, or X,Y,RADIUS in pixels"};
    at = next + 1;
  }
  return std::optional(ImageCircle{{v[0], v[1]}, v[2], 0, 0});
}

/// Warns that files of OpenCV and Kalibr cannot hold the camera's largest angle.
void warn_of_losses(const IntrinsicsArguments& arguments, const Intrinsics& in) {
  if (!geometry::max_angle_rad(in.camera) || (arguments.opencv.empty() && arguments.kalibr.empty()))
    return;
  log_warning("calibrate",
              "OpenCV and Kalibr files hold no largest angle: the camera's is in calibration.toml "
              "alone (--out)");
}

/// Refuses an output that would replace a picture of the board, or another kind of file.
Result<void> check_outputs(const IntrinsicsArguments& arguments) {
  std::error_code code;
  for (const std::string& image : arguments.images)
    if (!arguments.picture.empty() && fs::equivalent(arguments.picture, image, code))
      return Error{ErrorCode::kUsage,
                   "--picture " + arguments.picture +
                       ": is one of IMAGES: name another file, that one is kept"};
  MIXRIG_TRY(check_output_file(arguments.picture, kPngBegin, "--picture"));
  MIXRIG_TRY(check_output_file(arguments.opencv, "%YAML", "--opencv"));
  MIXRIG_TRY(check_output_file(arguments.kalibr, "cam0", "--kalibr"));
  return check_output_file(arguments.mrcal, "{", "--mrcal");
}

Result<nlohmann::json> calibrate(const IntrinsicsArguments& arguments) {
  MIXRIG_TRY(check_outputs(arguments));
  MIXRIG_ASSIGN(const BoardSpec board, calibration::parse_board(arguments.board));
  calibration::IntrinsicsOptions options;
  options.kind =
      arguments.model == "fisheye" ? geometry::LensKind::kFisheye : geometry::LensKind::kPinhole;
  MIXRIG_ASSIGN(options.lens_terms, lens_terms_of(arguments));
  options.hold_center = arguments.hold_center;
  MIXRIG_TRY(circle_of(arguments, {}));
  MIXRIG_ASSIGN(const BoardViews all, collect_views(arguments.images, board));
  MIXRIG_TRY(check_board(arguments.images, board, all));
  MIXRIG_ASSIGN(options.circle, circle_of(arguments, all.brightest));
  auto solved = calibration::solve_intrinsics(board, all.size_px, all.views, options);
  if (!solved) {
    Error error = solved.error();
    error.context = "camera " + arguments.camera + ": " + error.context;
    if (!all.without.empty())
      error.context += fmt::format(" ({} pictures show no whole board)", all.without.size());
    return error;
  }
  if (const auto valid = geometry::validate(solved->camera); !valid)
    return Error{ErrorCode::kData, "camera " + arguments.camera + ": " + valid.error().context +
                                       ", or use fewer terms: --lens"};
  const UncertaintyMap map = calibration::projection_uncertainty(*solved, kMapColumns, kMapRows);
  const auto advice = calibration::advise(*solved, board);
  const auto why = objections(*solved, map);
  warn_if_swapped(arguments, *solved);
  warn_of_losses(arguments, *solved);
  MIXRIG_TRY(write_files(arguments, *solved, map));
  print(arguments.camera, all, *solved, map, advice, why);
  return with_end(
      report_of(arguments.camera, all, *solved, map, advice, why), arguments.out,
      arguments.out.empty() ? "give --out FILE to keep the camera" : in_rig_toml(arguments.out));
}

}  // namespace

void add_calibrate_intrinsics_command(Command app, Context& context) {
  auto arguments = std::make_shared<IntrinsicsArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command = group.add_subcommand("intrinsics", "one camera from pictures of a board");
  command
      .add_option("IMAGES", arguments->images, "pictures of the board, PNG or JPEG, of one camera")
      .required();
  command
      .add_option(
          "--board", arguments->board,
          "checkerboard:9x6:25mm (inner corners), charuco:14x9:40mm:30mm:5X5_250 (squares), "
          "aprilgrid:6x6:88mm:26.4mm[:FIRST] (tags)")
      .required();
  command.add_option("--model", arguments->model, "pinhole or fisheye")
      .one_of({"pinhole", "fisheye"});
  command.add_option("--lens", arguments->lens,
                     "lens coefficients: 0, 2, 4, 5, 8; auto: by the error on held-out views");
  command.add_option("--image-circle", arguments->circle,
                     "fisheye: X,Y,RADIUS in pixels, none, or auto: found in the pictures");
  command.add_flag("--hold-center", arguments->hold_center,
                   "keep the principal point in the middle of the picture");
  command.add_option("--camera", arguments->camera,
                     "name in the calibration: target, fisheye, tof");
  command.add_option("--out", arguments->out, "calibration.toml to write the camera into");
  command.add_option("--picture", arguments->picture, "PNG of residuals, uncertainty and views");
  command.add_option("--opencv", arguments->opencv, "write the camera as OpenCV YAML too");
  command.add_option("--kalibr", arguments->kalibr, "write the camera as Kalibr camchain YAML too");
  command.add_option("--mrcal", arguments->mrcal, "write the camera as mrcal .cameramodel too");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return calibrate(*arguments); }; });
}

}  // namespace mixrig::tools
