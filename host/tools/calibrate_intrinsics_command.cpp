// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate intrinsics: lens and focal length of one camera from pictures of a board.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "hal/base/log.h"
#include "host/app/output_folder.h"
#include "host/camera_io/calibration.h"
#include "host/camera_io/exchange.h"
#include "host/image_io/image_io.h"
#include "host/tools/calibrate_picture.h"
#include "host/tools/command.h"
#include "host/tools/intrinsics_report.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

namespace fs = std::filesystem;
using calibration::BoardSpec;
using calibration::Intrinsics;
using calibration::UncertaintyMap;

struct Words {
  std::vector<std::string> images;
  std::string board, model = "pinhole", camera = "target", out, picture, lens = "auto";
  std::string opencv, kalibr, mrcal;
  bool hold_center = false;
};

constexpr int kMapColumns = 12, kMapRows = 9;

/// A camera of the same name that was something else before: two cameras were exchanged.
void warn_if_swapped(const Words& words, const Intrinsics& in) {
  std::error_code code;
  if (words.out.empty() || !fs::exists(words.out, code)) return;
  const auto before = camera_io::read_calibration(words.out);
  const auto* camera = before ? before->camera(words.camera) : nullptr;
  if (camera == nullptr) return;
  const double was = geometry::parameters_of(camera->model)[0], is = in.bundle.intrinsics[0];
  constexpr double kOtherCamera = 0.02;
  if (geometry::size_px(camera->model) == geometry::size_px(in.camera) &&
      std::abs(is / was - 1) < kOtherCamera)
    return;
  char line[200];
  std::snprintf(line, sizeof(line),
                "%s had fx %.1f before and has %.1f now: are the cameras swapped?",
                words.camera.c_str(), was, is);
  log_warning("calibrate", line);
}

Result<void> write_files(const Words& words, const Intrinsics& in, const UncertaintyMap& map) {
  camera_io::InputHash hash;
  for (const auto& path : words.images) MIXRIG_TRY(hash.add_file(path));
  camera_io::CalibratedCamera camera;
  camera.name = words.camera;
  camera.model = in.camera;
  camera.covariance = in.covariance;
  camera.residual_px = in.rms_px;
  camera.views = static_cast<int>(in.bundle.views.size());
  camera.points = in.points;
  camera.origin = camera_io::origin_now(hash);
  const camera_io::ForeignCamera foreign{words.camera, in.camera, {}};
  // All texts first: a lens that a format lacks must leave no file behind.
  std::vector<std::pair<std::string, std::string>> texts;
  const auto add = [&](const std::string& path, Result<std::string> text) -> Result<void> {
    if (path.empty()) return {};
    if (!text) return std::move(text).error();
    texts.emplace_back(path, *text);
    return {};
  };
  MIXRIG_TRY(add(words.opencv, camera_io::opencv_text(foreign)));
  MIXRIG_TRY(add(words.kalibr, camera_io::kalibr_text({foreign})));
  MIXRIG_TRY(add(words.mrcal, camera_io::mrcal_text(foreign)));
  if (!words.out.empty()) {
    camera_io::Calibration calibration;
    calibration.cameras = {camera};
    MIXRIG_TRY(camera_io::update_calibration(words.out, calibration));
  }
  for (const auto& [path, text] : texts) MIXRIG_TRY(app::write_text(path, text));
  if (!words.picture.empty())
    MIXRIG_TRY(image_io::write_png(words.picture, calibration_picture(in, map)));
  return {};
}

Result<int> lens_terms_of(const Words& words) {
  if (words.lens == "auto") return -1;
  const auto allowed = words.model == "fisheye" ? std::vector<std::string>{"0", "2", "4"}
                                                : std::vector<std::string>{"0", "2", "4", "5", "8"};
  if (std::find(allowed.begin(), allowed.end(), words.lens) != allowed.end())
    return words.lens[0] - '0';
  return Error{ErrorCode::kUsage,
               "--lens " + words.lens + ": use auto, 0, 2, 4, 5 or 8 (fisheye: auto, 0, 2 or 4)"};
}

Result<nlohmann::json> act(const Words& words) {
  MIXRIG_ASSIGN(const BoardSpec board, calibration::parse_board(words.board));
  calibration::IntrinsicsOptions options;
  options.kind =
      words.model == "fisheye" ? geometry::LensKind::kFisheye : geometry::LensKind::kPinhole;
  MIXRIG_ASSIGN(options.lens_terms, lens_terms_of(words));
  options.hold_center = words.hold_center;
  MIXRIG_ASSIGN(const BoardViews all, collect_views(words.images, board));
  MIXRIG_TRY(check_board(words.images, board, all));
  auto solved = calibration::solve_intrinsics(board, all.size_px, all.views, options);
  if (!solved) {
    Error error = solved.error();
    error.context = "camera " + words.camera + ": " + error.context;
    if (!all.without.empty())
      error.context += " (" + std::to_string(all.without.size()) + " pictures show no whole board)";
    return error;
  }
  if (const auto valid = geometry::validate(solved->camera); !valid)
    return Error{ErrorCode::kData, "camera " + words.camera + ": " + valid.error().context +
                                       ", or ask for fewer terms by --lens"};
  const UncertaintyMap map = calibration::projection_uncertainty(*solved, kMapColumns, kMapRows);
  const auto advice = calibration::advise(*solved, board);
  const auto why = objections(*solved, map);
  warn_if_swapped(words, *solved);
  MIXRIG_TRY(write_files(words, *solved, map));
  print(words.camera, all, *solved, map, advice, why);
  return report_of(words.camera, all, *solved, map, advice, why);
}

}  // namespace

void add_calibrate_intrinsics_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App& group = command_group(app, "calibrate", "calibrate cameras and rig");
  CLI::App* command = group.add_subcommand("intrinsics", "one camera from pictures of a board");
  command->add_option("IMAGES", words->images, "pictures of the board, PNG or JPEG, of one camera")
      ->required();
  command
      ->add_option(
          "--board", words->board,
          "checkerboard:9x6:25mm (inner corners), charuco:14x9:40mm:30mm:5X5_250 (squares), "
          "aprilgrid:6x6:88mm:26.4mm (tags)")
      ->required();
  command->add_option("--model", words->model, "pinhole or fisheye")
      ->check(CLI::IsMember({"pinhole", "fisheye"}));
  command->add_option("--lens", words->lens,
                      "lens coefficients: 0, 2, 4, 5, 8; auto: by the error on held-out views");
  command->add_flag("--hold-center", words->hold_center,
                    "keep the principal point in the middle of the picture");
  command->add_option("--camera", words->camera, "name in the calibration: target, fisheye, tof");
  command->add_option("--out", words->out, "calibration.yaml that the camera is written into");
  command->add_option("--picture", words->picture, "PNG of residuals, uncertainty and views");
  command->add_option("--opencv", words->opencv, "write the camera as OpenCV YAML too");
  command->add_option("--kalibr", words->kalibr, "write the camera as Kalibr camchain YAML too");
  command->add_option("--mrcal", words->mrcal, "write the camera as mrcal .cameramodel too");
  command->callback([&context, words] { context.action = [words] { return act(*words); }; });
}

}  // namespace mixrig::tools
