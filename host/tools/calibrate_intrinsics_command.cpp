// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate intrinsics: lens and focal length of one camera from pictures of a board.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "hal/base/log.h"
#include "hal/base/parallel.h"
#include "host/app/output_folder.h"
#include "host/calibration/intrinsics.h"
#include "host/calibration/suggest_board.h"
#include "host/calibration/uncertainty.h"
#include "host/camera_io/calibration.h"
#include "host/camera_io/exchange.h"
#include "host/image_io/image_io.h"
#include "host/tools/calibrate_picture.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

namespace fs = std::filesystem;
using calibration::BoardSpec;
using calibration::Intrinsics;
using calibration::ObservedView;
using calibration::UncertaintyMap;

struct Words {
  std::vector<std::string> images;
  std::string board, model = "pinhole", camera = "target", out, picture, lens = "auto";
  std::string opencv, kalibr, mrcal;
  bool hold_center = false;
};

constexpr int kMapColumns = 12, kMapRows = 9;

/// What was seen in one file.
struct Seen {
  Size size_px;
  std::optional<calibration::BoardView> board;
  std::optional<Error> error;
};

/// Grey of a picture; 16-bit grey pictures (of ToF cameras) are stretched to 8.
Result<Image<std::uint8_t>> read_gray(const fs::path& path) {
  Image<std::uint16_t> deep;
  if (path.extension() == ".png" && image_io::read_gray16(path, deep))
    return calibration::gray_of(deep);
  Image<Rgb8> color;
  MIXRIG_TRY(image_io::read_rgb8(path, color));
  return calibration::gray_of(color);
}

Seen look_at(const std::string& path, const BoardSpec& board) {
  Seen seen;
  auto gray = read_gray(path);
  if (!gray) return seen.error = gray.error(), seen;
  seen.size_px = gray->size();
  auto view = calibration::detect_board(*gray, board);
  if (!view) return seen.error = view.error(), seen;
  seen.board = std::move(*view);
  return seen;
}

std::vector<Seen> look_at_all(const Words& words, const BoardSpec& board) {
  std::vector<Seen> seen(words.images.size());
  Progress bar("finding the board", static_cast<int>(seen.size()));
  // One picture a thread at a time; the bar belongs to the caller's thread.
  Crew crew;
  const int batch = crew.threads();
  for (int from = 0; from < static_cast<int>(seen.size()); from += batch) {
    const int count = std::min(batch, static_cast<int>(seen.size()) - from);
    crew.rows(count, 1, [&](int begin, int end) {
      for (int i = from + begin; i < from + end; ++i)
        seen[static_cast<std::size_t>(i)] =
            look_at(words.images[static_cast<std::size_t>(i)], board);
    });
    bar.step(from + count);
  }
  return seen;
}

Error no_board(const Words& words, const BoardSpec& board) {
  const auto first = read_gray(words.images.front());
  const auto meant = first ? calibration::suggest_board(*first, board) : std::nullopt;
  return {ErrorCode::kData,
          "no picture shows the board " + words.board +
              (meant ? ", but " + words.images.front() + " shows " + board_text(*meant) +
                           ": give --board " + board_text(*meant)
                     : std::string(": check its kind, inner corners and light; a checkerboard must "
                                   "be seen whole"))};
}

/// Views and the one size of all pictures.
struct Collected {
  Size size_px;
  std::vector<ObservedView> views;
  std::vector<std::string> without;
};

Result<Collected> collect(const Words& words, const BoardSpec& board) {
  const auto seen = look_at_all(words, board);
  Collected all;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::string name = fs::path(words.images[i]).filename().string();
    if (seen[i].error) return *seen[i].error;
    if (i == 0) all.size_px = seen[i].size_px;
    if (seen[i].size_px != all.size_px) {
      const auto text = [](Size s) {
        return std::to_string(s.width) + "x" + std::to_string(s.height);
      };
      return Error{ErrorCode::kData, words.images[i] + ": is " + text(seen[i].size_px) +
                                         ", the first picture " + text(all.size_px) +
                                         ": give the pictures of one camera"};
    }
    if (seen[i].board)
      all.views.push_back({name, *seen[i].board});
    else
      all.without.push_back(name);
  }
  if (all.views.empty()) return no_board(words, board);
  return all;
}

/// Ids in wrong places bend every view: told before any camera is fitted.
Result<void> check_board(const Words& words, const BoardSpec& board, const Collected& all) {
  if (board.kind == calibration::BoardKind::kCheckerboard) return {};
  std::vector<double> shares;
  for (const auto& view : all.views) {
    Eigen::Vector2d low = view.board.px.front(), high = low;
    for (const auto& p : view.board.px) low = low.cwiseMin(p), high = high.cwiseMax(p);
    shares.push_back(calibration::homography_misfit_px(view.board, board) / (high - low).norm());
  }
  std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2),
                   shares.end());
  constexpr double kWrongShare = 0.05;
  if (shares[shares.size() / 2] < kWrongShare) return {};
  const auto at = std::find_if(
      words.images.begin(), words.images.end(),
      [&](const std::string& path) { return fs::path(path).filename() == all.views.front().name; });
  const auto image = read_gray(*at);
  const auto meant = image ? calibration::suggest_board(*image, board) : std::nullopt;
  return Error{
      ErrorCode::kData,
      "the board is not " + words.board + ": its points lie in other places in every view" +
          (meant ? ": give --board " + board_text(*meant) : std::string(": count its squares"))};
}

/// Why not to use this calibration; empty for go.
std::vector<std::string> objections(const Intrinsics& in, const UncertaintyMap& map) {
  constexpr double kWorst_px = 2.0, kMedian_px = 0.5, kRms_px = 1.0, kPointsOut = 0.1;
  constexpr int kFewViews = 6;
  const auto text = [](const char* format, double a) {
    char line[160];
    std::snprintf(line, sizeof(line), format, a);
    return std::string(line);
  };
  std::vector<std::string> why;
  if (!(map.worst_px <= kWorst_px))
    why.push_back(text("a pixel is uncertain by %.2f px where it is worst", map.worst_px));
  if (!(map.median_px <= kMedian_px))
    why.push_back(text("the median pixel is uncertain by %.2f px", map.median_px));
  if (in.rms_px > kRms_px)
    why.push_back(
        text("points miss by %.2f px RMS (views of two cameras, a wrong --model or a soft board?)",
             in.rms_px));
  if (in.points_out > kPointsOut * (in.points + in.points_out))
    why.push_back(text("%.0f %% of the points do not fit",
                       100.0 * in.points_out / (in.points + in.points_out)));
  if (in.bundle.views.size() < kFewViews)
    why.push_back(text("only %.0f views", static_cast<double>(in.bundle.views.size())));
  return why;
}

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

nlohmann::json numbers(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double v : values)
    list.push_back(std::isfinite(v) ? nlohmann::json(v) : nlohmann::json());
  return list;
}

nlohmann::json report_of(const Words& words, const Collected& all, const Intrinsics& in,
                         const UncertaintyMap& map, const calibration::Advice& advice,
                         const std::vector<std::string>& why) {
  const auto kind = geometry::kind_of(in.camera);
  const Eigen::VectorXd values = geometry::parameters_of(in.camera);
  nlohmann::json parameters, views = nlohmann::json::array();
  const auto names = geometry::parameter_names(kind);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    parameters[std::string(names[i])] = {{"value", values[k]},
                                         {"sigma", std::sqrt(in.covariance(k, k))}};
  }
  for (const auto& view : in.views)
    views.push_back({{"name", view.name},
                     {"used", view.used},
                     {"why_not", view.why_not},
                     {"rms_px", view.rms_px},
                     {"points", view.points},
                     {"points_out", view.points_out}});
  for (const auto& name : all.without)
    views.push_back({{"name", name}, {"used", false}, {"why_not", "the board was not found"}});
  return {{"camera", words.camera},
          {"model", name_of(kind)},
          {"lens_terms", in.lens_terms},
          {"size_px", {all.size_px.width, all.size_px.height}},
          {"parameters", parameters},
          {"rms_px", in.rms_px},
          {"sigma_px", in.sigma_px},
          {"held_out_px", in.held_out_px},
          {"points", in.points},
          {"points_out", in.points_out},
          {"views", views},
          {"uncertainty",
           {{"columns", map.columns},
            {"rows", map.rows},
            {"sigma_px", numbers(map.sigma_px)},
            {"median_px", map.median_px},
            {"worst_px", map.worst_px}}},
          {"coverage", calibration::coverage(in, map.columns, map.rows)},
          {"advice",
           {{"where", advice.where},
            {"mean_now_px", advice.mean_now_px},
            {"mean_then_px", advice.mean_then_px}}},
          {"verdict", why.empty() ? "go" : "no-go"},
          {"why", why}};
}

void print(const Words& words, const Collected& all, const Intrinsics& in,
           const UncertaintyMap& map, const calibration::Advice& advice,
           const std::vector<std::string>& why) {
  const auto names = geometry::parameter_names(geometry::kind_of(in.camera));
  const Eigen::VectorXd values = geometry::parameters_of(in.camera);
  std::printf("camera        %s, %s, %dx%d, %d lens terms\n", words.camera.c_str(),
              words.model.c_str(), all.size_px.width, all.size_px.height, in.lens_terms);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (in.covariance(k, k) > 0)
      std::printf("  %-4s %14.6g  +- %.3g\n", std::string(names[i]).c_str(), values[k],
                  std::sqrt(in.covariance(k, k)));
  }
  std::printf(
      "residual      %.4f px RMS over %d points of %zu views (%d points left out); held out %.4f "
      "px\n",
      in.rms_px, in.points, in.bundle.views.size(), in.points_out, in.held_out_px);
  for (const auto& view : in.views) {
    if (view.used)
      std::printf("  %-24s %.4f px, %d points\n", view.name.c_str(), view.rms_px, view.points);
    else
      std::printf("  %-24s left out: %s\n", view.name.c_str(), view.why_not.c_str());
  }
  for (const auto& name : all.without)
    std::printf("  %-24s left out: the board was not found\n", name.c_str());
  std::printf("uncertainty   of projection: median %.4f px, worst %.4f px\n", map.median_px,
              map.worst_px);
  if (advice.mean_then_px < 0.9 * advice.mean_now_px)
    std::printf("next view     hold the board %s: %.4f px would become %.4f px\n",
                advice.where.c_str(), advice.mean_now_px, advice.mean_then_px);
  else
    std::printf("next view     no single view would help much\n");
  std::string reasons;
  for (const auto& reason : why) reasons += (reasons.empty() ? ": " : "; ") + reason;
  std::printf("verdict       %s%s\n", why.empty() ? "go" : "no-go", reasons.c_str());
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
  MIXRIG_ASSIGN(const Collected all, collect(words, board));
  MIXRIG_TRY(check_board(words, board, all));
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
  print(words, all, *solved, map, advice, why);
  return report_of(words, all, *solved, map, advice, why);
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
