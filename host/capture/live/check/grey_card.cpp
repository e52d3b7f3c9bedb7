// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/check/grey_card.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host/capture/live/rig/held_controls.h"
#include "host/capture/live/session/live_capture.h"

namespace mixrig::live {
namespace {

using capture::CardArea;
using capture::CardSamples;
using capture::CardState;
using capture::LinearVerdict;
using device::CameraControl;
using device::PixelFormat;

constexpr int kCardFrames = 8;
constexpr int kLateFrames = 4;  ///< frames that may have been exposed before a control took effect
constexpr Duration kCardSettles = std::chrono::milliseconds(500);
constexpr Duration kCardTimeout = std::chrono::seconds(10);  ///< from one used frame to the next
constexpr double kMostGain = 16;                             ///< largest white_gains in rig.toml

bool is_grey_camera(PixelFormat format) {
  return format == PixelFormat::kGray8 || format == PixelFormat::kGray16;
}

bool has_words(PixelFormat format) {
  return format == PixelFormat::kGray16 ||
         (format >= PixelFormat::kBayerRggb16 && format <= PixelFormat::kBayerBggr16);
}

Result<CardArea> area_in(Size picture, const std::optional<CardArea>& wanted) {
  if (!wanted) {
    const Size size{std::max(1, picture.width / 5), std::max(1, picture.height / 5)};
    return CardArea{(picture.width - size.width) / 2, (picture.height - size.height) / 2, size};
  }
  const CardArea& a = *wanted;
  if (a.size.width <= picture.width - a.x && a.size.height <= picture.height - a.y) return a;
  return Error{ErrorCode::kUsage,
               fmt::format("--grey-card {},{},{},{} reaches beyond the picture of {}x{}", a.x, a.y,
                           a.size.width, a.size.height, picture.width, picture.height)};
}

/// Reads samples of the card with the camera's present settings.
class CardReader {
 public:
  CardReader(device::Camera& camera, const capture::ColorSettings& settings,
             const std::optional<CardArea>& area, const NextFrame& next, Clock& clock)
      : camera_(camera),
        cut_(has_words(camera.info().format) && !settings.limited_samples),
        area_(area),
        next_(next),
        clock_(clock),
        decoder_(capture::raw_settings(settings)) {}

  /// Collects samples. Errors: kTimeout; those of the camera, of decoding and of the area.
  Result<CardSamples> collect() {
    CardSamples samples{0, cut_, {}};
    const HostTime begin = clock_.now();
    HostTime last = begin;
    for (int seen = 0, used = 0; used < kCardFrames;) {
      if (clock_.now() - last > kCardTimeout)
        return Error{ErrorCode::kTimeout,
                     camera_.info().uri + ": sends no whole picture: check cable and trigger"};
      MIXRIG_ASSIGN(const device::FramePtr frame, next_());
      if (!frame || frame->sequence == sequence_ || (frame->flags & device::kFrameIncomplete) != 0)
        continue;
      sequence_ = frame->sequence;
      if (++seen <= kLateFrames || clock_.now() - begin < kCardSettles) continue;
      MIXRIG_TRY(decoder_.decode(*frame, plate_));
      MIXRIG_ASSIGN(const CardArea area, area_in(plate_.size(), area_));
      samples.add(plate_.view(), area);
      last = clock_.now();
      ++used;
    }
    return samples;
  }
  Result<CardSamples> collect_at(double exposure_s) {
    MIXRIG_TRY(camera_.set(CameraControl::kExposure, exposure_s));
    MIXRIG_ASSIGN(CardSamples samples, collect());
    MIXRIG_ASSIGN(samples.exposure_s, camera_.get(CameraControl::kExposure));
    return samples;
  }

 private:
  device::Camera& camera_;
  const bool cut_;
  const std::optional<CardArea> area_;
  const NextFrame& next_;
  Clock& clock_;
  capture::ColorDecoder decoder_;
  Image<Rgb8> plate_;
  std::optional<std::uint64_t> sequence_;
};

const char* advice_of(CardState state) {
  switch (state) {
    case CardState::kGood:
      return "";
    case CardState::kSaturated:
      return "the card is saturated: lower exposure_ms, or light it less";
    case CardState::kDark:
      return "the card is too dark to judge: raise exposure_ms, or light it more";
    case CardState::kUneven:
      return "it does not look like one card: give its pixels as --grey-card X,Y,W,H, and light it "
             "evenly";
    case CardState::kTooNoisy:
      return "too few pixels for their noise: bring the card nearer, or light it more";
  }
  return "";
}

Check card_row(const std::string& name, const CardSamples& samples, CardState state) {
  return {
      name, "card", state == CardState::kGood ? Verdict::kPass : Verdict::kFail,
      fmt::format("R {:.0f}, G {:.0f}, B {:.0f} of 255, {:.1f} % saturated", samples.mean_byte(0),
                  samples.mean_byte(1), samples.mean_byte(2), 100 * samples.saturated_share()),
      advice_of(state)};
}

std::string write_advice(const CameraConfig& config, const std::string& lines) {
  return fmt::format("write into [[camera]] \"{}\" of rig.toml: {}", config.name, lines);
}

std::string words_of(const capture::ColorSettings& settings) {
  std::string words(transfer_word(settings.encoding.transfer));
  if (settings.encoding.transfer == device::Transfer::kGamma)
    words += fmt::format(" {:.2f}", settings.encoding.gamma);
  return words;
}

/// Returns the lines of rig.toml that differ from the declared settings.
std::string lines_of(const capture::ColorSettings& fit, const capture::ColorSettings& declared,
                     int sample_bits) {
  std::string lines = fmt::format("transfer = \"{}\"", transfer_word(fit.encoding.transfer));
  if (fit.encoding.transfer == device::Transfer::kGamma)
    lines += fmt::format(", gamma = {:.2f}", fit.encoding.gamma);
  if (fit.black != declared.black)
    lines += fmt::format(", black_level = {:.0f}", fit.black * ((1 << sample_bits) - 1));
  return lines;
}

Check transfer_row(const CameraConfig& config, const device::CameraInfo& info,
                   const LinearVerdict& verdict, const capture::ColorSettings& declared) {
  using Kind = LinearVerdict::Kind;
  Check check{config.name, "transfer", Verdict::kFail,
              fmt::format("{}: {:.2f} and {:.2f} times the light at twice the exposure",
                          words_of(declared), verdict.doublings[0], verdict.doublings[1]),
              ""};
  switch (verdict.kind) {
    case Kind::kRight:
      check.verdict = Verdict::kPass;
      break;
    case Kind::kOther:
      check.advice = write_advice(config, lines_of(verdict.fit, declared, info.sample_bits)) +
                     fmt::format(" (then within {:.1f} %)", 100 * std::expm1(verdict.error));
      break;
    case Kind::kNoneFits:
      check.advice =
          "no transfer and black level explains it: turn off automatic controls, HDR and tone "
          "curves of the camera, and set black_level to its sample with the lens covered";
      break;
    case Kind::kUnsteady:
      check.verdict = Verdict::kWarn;
      check.advice =
          "the same exposure gave another light later: keep the light steady and fix gain in "
          "rig.toml, then run it again";
      break;
    case Kind::kNoEffect:
      check.advice = "the brightness does not change with the exposure";
      break;
  }
  return check;
}

Check not_judged(const CameraConfig& config, std::string advice) {
  return {config.name, "transfer", Verdict::kWarn, "not judged", std::move(advice)};
}

/// Exposes four times and judges the transfer. `settings` becomes the fitted one.
Check check_transfer(const CameraConfig& config, device::Camera& camera, CardReader& reader,
                     CardSamples first, const device::ControlRange& range,
                     capture::ColorSettings& settings) {
  const auto rest_s = camera.get(CameraControl::kExposure);
  if (!rest_s) return not_judged(config, to_line(rest_s.error()));
  if (!(*rest_s / 4 >= range.minimum && *rest_s <= range.maximum))
    return not_judged(config, fmt::format("the exposure is {:.6g} ms, a quarter of it has to be at "
                                          "least {:.6g} ms: raise exposure_ms",
                                          *rest_s * 1e3, range.minimum * 1e3));
  first.exposure_s = *rest_s;
  std::array<CardSamples, 4> exposures{first};
  std::optional<Error> error;
  for (std::size_t i = 1; i < exposures.size() && !error; ++i) {
    auto samples = reader.collect_at(*rest_s * std::array{1.0, 0.5, 0.25, 1.0}.at(i));
    if (samples)
      exposures.at(i) = *samples;
    else
      error = samples.error();
  }
  if (error) {
    std::string line = to_line(*error);
    if (const auto back = camera.set(CameraControl::kExposure, *rest_s); !back)
      line += "; the exposure was not put back: " + to_line(back.error());
    return not_judged(config, std::move(line));
  }
  for (const CardSamples& samples : exposures)
    if (const CardState state = card_state(samples, settings); state != CardState::kGood)
      return not_judged(config,
                        fmt::format("at {:.6g} ms {}", samples.exposure_s * 1e3, advice_of(state)));
  const LinearVerdict verdict = judge_linear(exposures, settings);
  Check check = transfer_row(config, camera.info(), verdict, settings);
  settings = verdict.fit;
  return check;
}

Check grey_row(const CameraConfig& config, device::Camera& camera, const CardSamples& samples,
               const capture::ColorSettings& settings) {
  const capture::GreyVerdict grey = judge_grey(samples, settings);
  Check check{config.name, "grey", grey.grey ? Verdict::kPass : Verdict::kFail,
              fmt::format("R/G {:.3f}, B/G {:.3f} by {}", grey.red_green, grey.blue_green,
                          words_of(settings)),
              ""};
  if (grey.grey) return check;
  if (*std::max_element(grey.gains.begin(), grey.gains.end()) > kMostGain) {
    check.advice = "a channel has less than a 16th of another's light: check lamp, filter and lens";
    return check;
  }
  std::string lines = fmt::format("white_gains = [{:.3f}, {:.3f}, {:.3f}]", grey.gains[0],
                                  grey.gains[1], grey.gains[2]);
  // Gains hold for one white balance.
  if (const auto kelvin = camera.get(CameraControl::kWhiteBalance); kelvin)
    lines += fmt::format(", white_balance_k = {:.0f}", *kelvin);
  check.advice = write_advice(config, lines);
  return check;
}

}  // namespace

std::vector<Check> check_card(const CameraConfig& config, device::Camera& camera,
                              const std::optional<CardArea>& area, const NextFrame& next,
                              Clock& clock) {
  const device::CameraInfo& info = camera.info();
  capture::ColorSettings settings = color_settings(config, info);
  (void)hold_controls(config, camera, {});
  CardReader reader(camera, settings, area, next, clock);
  const auto first = reader.collect();
  if (!first)
    return {{config.name, "card", Verdict::kFail, "not measured", to_line(first.error())}};
  const CardState state = card_state(*first, settings);
  std::vector<Check> checks{card_row(config.name, *first, state)};
  if (state != CardState::kGood) return checks;
  const auto range = std::find_if(info.controls.begin(), info.controls.end(), [](const auto& r) {
    return r.control == CameraControl::kExposure;
  });
  if (range != info.controls.end())
    checks.push_back(check_transfer(config, camera, reader, *first, *range, settings));
  else
    checks.push_back(not_judged(config, "the exposure of this camera cannot be set"));
  if (!is_grey_camera(info.format)) checks.push_back(grey_row(config, camera, *first, settings));
  return checks;
}

}  // namespace mixrig::live
