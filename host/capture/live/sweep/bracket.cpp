// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/sweep/bracket.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/order_statistics.h"

namespace mixrig::live {
namespace {

constexpr Duration kBracketWait = std::chrono::milliseconds(100);
/// Time, and number of pictures, within which the picture must follow a control, else the control
/// has no effect; and the longest time if fewer pictures come.
constexpr Duration kFollows = std::chrono::seconds(3), kFollowsAtMost = std::chrono::seconds(60);
constexpr int kLeastLooks = 20;
/// Wait if the pictures do not show the change.
constexpr Duration kBlind = std::chrono::milliseconds(500);
constexpr double kReached = 1.3, kStill = 1.03, kReadBack = 1.1;
constexpr std::size_t kLeastSeen = 100;
constexpr int kSeenStride = 7;
constexpr double kMostOfPeriod = 0.9;

/// Returns the factor by which `b` is brighter; empty if too few pixels show it.
std::optional<double> brighter(const Image<Rgb8>& a, const Image<Rgb8>& b,
                               std::vector<float>& scratch) {
  scratch.clear();
  capture::add_log_ratios(a.view(), b.view(), kSeenStride, scratch);
  if (scratch.size() < kLeastSeen) return {};
  return std::exp(static_cast<double>(upper_median_in_place(std::span(scratch))));
}

bool is_near(double factor, double wanted, double within) {
  return std::abs(std::log(factor / wanted)) < std::log(within);
}

}  // namespace

Result<ExposureBracket> ExposureBracket::create(device::Camera& camera, Duration frame_period) {
  const auto& controls = camera.info().controls;
  const auto range = std::find_if(controls.begin(), controls.end(), [](const auto& r) {
    return r.control == device::CameraControl::kExposure;
  });
  if (range == controls.end())
    return Error{ErrorCode::kUnsupported, camera.info().uri + ": has no exposure control"};
  MIXRIG_ASSIGN(const double frames_s, camera.get(device::CameraControl::kExposure));
  if (!(frames_s > 0))
    return Error{ErrorCode::kDevice, camera.info().uri + ": does not report its exposure"};
  const double most_s = std::min(range->maximum, kMostOfPeriod * seconds(frame_period));
  return ExposureBracket(camera, frames_s,
                         {range->minimum, std::max(most_s, frames_s), range->step});
}

ExposureBracket::ExposureBracket(ExposureBracket&& other) noexcept
    : camera_(std::exchange(other.camera_, nullptr)),
      limits_(other.limits_),
      frames_s_(other.frames_s_),
      set_s_(other.set_s_),
      given_up_(other.given_up_) {}

ExposureBracket::~ExposureBracket() {
  if (camera_ != nullptr && set_s_ != frames_s_)
    if (const auto put_back = set(frames_s_); !put_back)
      log_warning("scan", to_line(put_back.error()) + ": the exposure was not put back");
}

Result<void> ExposureBracket::set(double exposure_s) {
  set_s_ = exposure_s;
  MIXRIG_TRY(camera_->set(device::CameraControl::kExposure, exposure_s));
  MIXRIG_ASSIGN(const double says_s, camera_->get(device::CameraControl::kExposure));
  if (is_near(says_s, exposure_s, kReadBack) ||
      std::abs(says_s - exposure_s) <= std::max(limits_.step_s, limits_.least_s))
    return {};
  return Error{ErrorCode::kDevice,
               fmt::format("{}: was set to expose for {:.6g} s and reports {:.6g} s: check that "
                           "nothing else controls the camera",
                           camera_->info().uri, exposure_s, says_s)};
}

void ExposureBracket::give_up(const std::string& why) {
  given_up_ = true;
  log_warning("scan", why + ": further views are scanned at one exposure only");
}

Result<ExposureBracket::Step> ExposureBracket::collect(SweepRig& rig, double ratio,
                                                       std::size_t count, Image<Rgb8>& last,
                                                       std::vector<Image<Rgb8>>& plates,
                                                       const std::atomic<bool>& stop,
                                                       Clock& clock) {
  const HostTime begin = clock.now();
  const Image<Rgb8> before = last;
  std::vector<float> scratch;
  capture::Capture frame;
  plates.clear();
  for (int looks = 0; plates.size() < count;) {
    if (stop) return Step::kStopped;
    const Duration passed = clock.now() - begin;
    if (passed > (looks < kLeastLooks ? kFollowsAtMost : kFollows)) return Step::kNoEffect;
    HostTime exposed_from{};
    MIXRIG_ASSIGN(const bool there, rig.next(kBracketWait, frame, exposed_from));
    if (!there || exposed_from < begin || frame.plate.size() != before.size()) continue;
    ++looks;
    const auto now = brighter(before, frame.plate, scratch);
    const bool reached = now ? is_near(*now, ratio, kReached) : clock.now() - begin > kBlind;
    const auto since = plates.empty() ? std::nullopt : brighter(plates[0], frame.plate, scratch);
    if (!reached || (since && !is_near(*since, 1, kStill))) plates.clear();
    if (reached) std::swap(plates.emplace_back(), frame.plate);
  }
  last = plates.back();
  return Step::kDone;
}

Result<std::vector<capture::BracketPlate>> ExposureBracket::take(SweepRig& rig,
                                                                 const Image<Rgb8>& plate,
                                                                 const std::atomic<bool>& stop,
                                                                 Clock& clock) {
  std::vector<capture::BracketPlate> taken;
  std::vector<Image<Rgb8>> plates;
  Image<Rgb8> last = plate;
  double last_s = frames_s_;
  for (const auto next : {capture::shorter_exposure, capture::longer_exposure}) {
    const Image<Rgb8>* from = &plate;
    double from_s = frames_s_;
    Image<Rgb8> step_plate;
    while (!given_up_) {
      const auto exposure_s = next(from->view(), from_s, limits_);
      if (!exposure_s) break;
      if (const auto told = set(*exposure_s); !told) {
        give_up(to_line(told.error()));
        break;
      }
      MIXRIG_ASSIGN(const Step step,
                    collect(rig, *exposure_s / last_s, kPlates, last, plates, stop, clock));
      if (step == Step::kStopped) return taken;
      if (step == Step::kNoEffect) {
        give_up(
            fmt::format("{}: says that it exposes for {:.6g} s, but its picture does not follow",
                        camera_->info().uri, *exposure_s));
        break;
      }
      last_s = from_s = *exposure_s;
      step_plate = last, from = &step_plate;
      for (Image<Rgb8>& one : plates) taken.push_back({last_s, frames_s_, std::move(one)});
    }
  }
  if (set_s_ == frames_s_) return taken;
  MIXRIG_TRY(set(frames_s_));
  last = plate;
  MIXRIG_ASSIGN(const Step step, collect(rig, 1, 1, last, plates, stop, clock));
  if (step == Step::kNoEffect)
    return Error{ErrorCode::kTimeout,
                 fmt::format("{}: was put back to {:.6g} s, but its picture is not as bright as it "
                             "was: check that nothing else controls the camera, then run the same "
                             "command again",
                             camera_->info().uri, frames_s_)};
  if (given_up_) taken.clear();
  return taken;
}

}  // namespace mixrig::live
