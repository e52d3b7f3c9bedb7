// SPDX-License-Identifier: Apache-2.0
#include "host/tools/calibrate/collect_views.h"

#include <cstdio>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "hal/base/log.h"
#include "host/calibrate/board/suggest_board.h"
#include "host/capture/live/session/lost_camera.h"
#include "host/math/image_io/image_io.h"
#include "host/tools/calibrate/coverage_picture.h"

namespace mixrig::tools {
namespace {

using calibration::CollectState;
using calibration::ViewCollector;

constexpr int kFisheyeFrames = 50;  ///< in which its first picture must come
constexpr int kSearchFrames = 250;  ///< without the board, before a line says so
constexpr Duration kReturnTime = std::chrono::seconds(5);  ///< in which a camera may come back

/// The board that the last picture seems to show, as --board takes it, or empty.
std::string shown_instead(const ViewCollector& collector, const calibration::BoardSpec& stated) {
  const auto meant = calibration::suggest_board(collector.last_gray(), stated);
  return meant ? calibration::board_text(*meant) : "";
}

std::string words_of(CollectState state, const ViewCollector& collector) {
  switch (state) {
    case CollectState::kNoBoard:
      return "no board";
    case CollectState::kSettling:
      return "hold it still";
    case CollectState::kMoving:
      return fmt::format("moves {:.2f} px", collector.motion().most_px);
    case CollectState::kBlurred:
      return "blurred";
    case CollectState::kKnown:
      return "nothing new here";
    case CollectState::kKept:
      return "kept, move on";
  }
  return "";
}

bool waits_for_fisheye(const capture::SourceInfo& info, const capture::Capture& capture,
                       int number) {
  return info.fisheye_rate_hz > 0 && info.fisheye_px.empty() && capture.fisheye.empty() &&
         number <= kFisheyeFrames;
}

void warn_early(const ViewCollector& collector, const calibration::BoardSpec& board) {
  const auto& counts = collector.counts();
  if (counts.frames == kSearchFrames && counts.in_target + counts.in_fisheye == 0)
    log_warning("views", collector.why_none(shown_instead(collector, board)).context);
}

void warn_without_amplitude(const ViewCollector& collector) {
  for (const calibration::CoveredCamera& camera : collector.coverage().cameras())
    if (camera.role == calibration::ViewRole::kTof) return;
  log_warning("views",
              "the depth camera gives no amplitude, in which the board could be found: the views "
              "have no camera \"tof\" and calibrate rig will not place it; let it deliver its "
              "intensity beside the depth (docs/reference/devices.md)");
}

/// Notices a camera that is gone while the others deliver (the fisheye).
class LostCamera {
 public:
  /// The error of a camera that has been lost for kReturnTime.
  std::optional<Error> after(const capture::CaptureSource& source, HostTime now) {
    auto lost = lost_now(source);
    if (!lost) since_.reset();
    if (lost && !since_) since_ = now;
    if (lost && now - *since_ < kReturnTime) lost.reset();
    return lost;
  }
  static std::optional<Error> lost_now(const capture::CaptureSource& source) {
    const auto report = source.report();
    return report ? live::lost_camera(*report) : std::nullopt;
  }

 private:
  std::optional<HostTime> since_;
};

}  // namespace

CollectStatus::CollectStatus() : terminal_(isatty(STDERR_FILENO) == 1) {}

CollectStatus::~CollectStatus() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

void CollectStatus::show(CollectState state, const ViewCollector& collector) {
  const calibration::Coverage& coverage = collector.coverage();
  const bool kept = state == CollectState::kKept;
  if (terminal_)
    std::fprintf(stderr, "\r%d views, %d of %d shared | %s | next: %s\033[K%s",
                 collector.folder().views(), coverage.shared(), coverage.needs().front().wanted,
                 words_of(state, collector).c_str(), coverage.advice().c_str(),
                 kept || (state == CollectState::kKnown && moved_) ? "\a" : "");
  else if (kept)
    std::fprintf(stderr, "view %d kept, %d of %d shared; next: %s\n", collector.folder().views(),
                 coverage.shared(), coverage.needs().front().wanted, coverage.advice().c_str());
  moved_ = state != CollectState::kKept && state != CollectState::kKnown;
}

Result<nlohmann::json> finish_views(ViewCollector& collector, const CollectArguments& arguments,
                                    const char* ended, const Error* error) {
  const auto& counts = collector.counts();
  const calibration::Coverage& coverage = collector.coverage();
  const int views = collector.folder().views();
  if (views == 0 && error != nullptr) return *error;
  if (views == 0) {
    const bool unseen = counts.still == 0;  // parts of another board are found here and there
    return collector.why_none(unseen ? shown_instead(collector, arguments.settings.board) : "");
  }
  MIXRIG_TRY(image_io::write_png(collector.folder().staging() / "coverage.png",
                                 coverage_picture(coverage)));
  MIXRIG_TRY(collector.finish());
  if (error != nullptr) {
    Error told = *error;
    told.context +=
        fmt::format(" (the {} views so far are in '{}')", views, arguments.out.string());
    return told;
  }
  std::printf("%s: %d views, %d of them shared by target and depth camera, of %d frames\n",
              arguments.out.string().c_str(), views, coverage.shared(), counts.frames);
  if (counts.without_tof > 0 && coverage.shared() == 0)
    log_warning("views",
                "the depth camera's amplitude never showed the board: hold it nearer, or "
                "give the depth camera more light");
  nlohmann::json needs = nlohmann::json::array();
  for (const calibration::Need& need : coverage.needs())
    needs.push_back({{"what", need.what}, {"wanted", need.wanted}, {"have", need.have}});
  return nlohmann::json{{"out", arguments.out.string()},
                        {"next", "mixrig calibrate rig " + arguments.out.string()},
                        {"views", views},
                        {"shared", coverage.shared()},
                        {"enough", coverage.enough()},
                        {"ended", ended},
                        {"frames", counts.frames},
                        {"in_target", counts.in_target},
                        {"in_fisheye", counts.in_fisheye},
                        {"still", counts.still},
                        {"blurred", counts.blurred},
                        {"without_tof", counts.without_tof},
                        {"moving_tof", counts.moving_tof},
                        {"needs", std::move(needs)}};
}

Result<nlohmann::json> collect_views(capture::CaptureSource& source,
                                     const CollectArguments& arguments,
                                     const std::atomic<bool>& stop) {
  capture::Capture capture;
  std::optional<ViewCollector> collector;
  std::optional<CollectStatus> status(std::in_place);
  const char* ended = "coverage";
  std::optional<Error> error;
  LostCamera lost;
  for (int number = 1; !collector || !collector->coverage().enough(); ++number) {
    auto there =
        number <= source.info().frames ? source.read(number, capture) : Result<bool>(false);
    if (stop || !there || !*there) {
      ended = stop ? "stopped" : "end of the source";
      if (!stop) error = there ? LostCamera::lost_now(source) : there.error();
      break;
    }
    if ((error = lost.after(source, capture.mid_exposure))) break;
    if (!collector) {
      if (waits_for_fisheye(source.info(), capture, number)) continue;
      MIXRIG_ASSIGN(collector, ViewCollector::create(arguments.out, source.info(), capture,
                                                     arguments.settings));
      warn_without_amplitude(*collector);
    }
    MIXRIG_ASSIGN(const CollectState state, collector->add(capture));
    status->show(state, *collector);
    warn_early(*collector, arguments.settings.board);
  }
  status.reset();
  if (!collector)
    return error ? *error
                 : Error{ErrorCode::kData,
                         stop ? "stopped before the first frame" : "the source has no frames"};
  auto report = finish_views(*collector, arguments, ended, error ? &*error : nullptr);
  if (report && !collector->coverage().enough())
    log_warning("views", "they do not cover all that is wanted (coverage.png): " +
                             collector->coverage().advice());
  return report;
}

}  // namespace mixrig::tools
