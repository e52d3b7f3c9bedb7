// SPDX-License-Identifier: Apache-2.0
// Compares our depth of a Kinect v2's packets with that of libfreenect2: the same bytes go through
// both stream parsers and decoders, and each result is measured against the studio's truth.
#include <gtest/gtest.h>

#ifdef MIXRIG_HAS_LIBFREENECT2
#include <cmath>
#include <vector>

#include "hal/wire/camera/kinect2_raw.h"
#include "host/capture/depth/phase_decoder.h"
#include "studio/studio.h"
#include "tests/support/libfreenect2/libfreenect2_decoder.h"
#endif

namespace mixrig::test {
namespace {

#ifndef MIXRIG_HAS_LIBFREENECT2
TEST(Kinect2Peer, DecodesAsLibfreenect2Does) {
  GTEST_SKIP() << "no checkout of libfreenect2: configure with -DMIXRIG_LIBFREENECT2=FOLDER";
}
#else

constexpr double kWrong_m = 0.1;
constexpr int kFirst = 40, kFrames = 2;

/// Errors of one decoder against the truth.
struct Judged {
  long pixels = 0, missing = 0, wrong = 0;
  double absolute_m = 0;
  void add(double distance_m, double true_m) {
    ++pixels;
    const double e = std::abs(distance_m - true_m);
    if (distance_m == 0)
      ++missing;
    else if (e > kWrong_m)
      ++wrong;
    else
      absolute_m += e;
  }
  double mean_mm() const {
    return 1e3 * absolute_m / static_cast<double>(pixels - missing - wrong);
  }
  double missing_pct() const {
    return 100.0 * static_cast<double>(missing) / static_cast<double>(pixels);
  }
  double wrong_pct() const {
    return 100.0 * static_cast<double>(wrong) / static_cast<double>(pixels);
  }
};

/// Differences in the pixels that both decoders know.
struct Between {
  long both = 0, apart = 0;  ///< apart: by more than kWrong_m, not in the sums
  double sum_m = 0, square_m2 = 0;
  double mean_mm() const { return 1e3 * sum_m / static_cast<double>(both); }
  double sigma_mm() const {
    const double mean = sum_m / static_cast<double>(both);
    return 1e3 * std::sqrt(square_m2 / static_cast<double>(both) - mean * mean);
  }
};

/// Distances of good pixels through our own parser and decoder.
Image<float> ours(const std::vector<std::uint8_t>& raw, depth::PhaseDecoder& decoder) {
  depth::PhaseDepth out;
  device::Kinect2DepthStream stream;
  for (std::size_t at = 0; at < raw.size(); at += device::kKinect2PacketBytes) {
    stream.feed({raw.data() + at, device::kKinect2PacketBytes}, true,
                [&](const device::Kinect2RawFrame& frame) { decoder.decode(frame.pictures, out); });
    stream.feed({}, true,
                [&](const device::Kinect2RawFrame& frame) { decoder.decode(frame.pictures, out); });
  }
  for (int y = 0; y < out.state.height(); ++y)
    for (int x = 0; x < out.state.width(); ++x)
      if (out.state.at(x, y) != depth::PixelState::kGood) out.distance_m.at(x, y) = 0;
  return std::move(out.distance_m);
}

struct Outcome {
  Judged own, peer;
  Between between;
};

Outcome compare(bool judged_look) {
  studio::StudioOptions options;
  options.scenario = *studio::parse_scenario("walk");
  options.seed = 7;
  options.frames = kFirst + kFrames;
  options.size_px = {64, 64};
  options.raw = true;
  if (judged_look) options.realism = studio::Realism::all();
  auto studio = studio::Studio::create(options);
  const studio::RawTables& tables = *studio->info().raw;
  depth::PhaseDecoder decoder(
      depth::kinect2_phase_camera(*device::parse_kinect2_infrared(tables.infrared),
                                  *device::parse_kinect2_offsets(tables.phase_offsets)));
  Libfreenect2Decoder peer(tables.phase_offsets, tables.infrared);
  Outcome outcome;
  studio::Frame frame;
  for (int number = kFirst; number < kFirst + kFrames; ++number) {
    studio->render(number, frame);
    const Image<float> own = ours(frame.raw, decoder);
    const Image<float>& other = peer.decode(frame.raw);
    if (own.empty() || other.empty()) return {};
    for (int y = 1; y + 1 < own.height(); ++y)
      for (int x = 1; x + 1 < own.width(); ++x) {
        const double truth = frame.tof_true_m.at(x, y), a = own.at(x, y), b = other.at(x, y);
        if (!(truth > 0)) continue;
        outcome.own.add(a, truth), outcome.peer.add(b, truth);
        if (a == 0 || b == 0) continue;
        if (std::abs(a - b) > kWrong_m) {
          ++outcome.between.apart;
          continue;
        }
        ++outcome.between.both;
        outcome.between.sum_m += a - b, outcome.between.square_m2 += (a - b) * (a - b);
      }
  }
  return outcome;
}

void tell(const char* name, const Judged& j) {
  std::printf("%s: mean abs error %.2f mm, wrong %.3f %%, missing %.2f %%\n", name, j.mean_mm(),
              j.wrong_pct(), j.missing_pct());
}

class Kinect2Peer : public ::testing::TestWithParam<bool> {};

TEST_P(Kinect2Peer, DecodesAsLibfreenect2Does) {
  const Outcome outcome = compare(GetParam());
  ASSERT_GT(outcome.between.both, 300'000) << "a parser gave no frame";
  tell("mixrig", outcome.own), tell("libfreenect2", outcome.peer);
  std::printf("difference: mean %.3f mm, sigma %.2f mm, apart %.3f %%\n", outcome.between.mean_mm(),
              outcome.between.sigma_mm(),
              100.0 * static_cast<double>(outcome.between.apart) /
                  static_cast<double>(outcome.between.both));
  EXPECT_LE(outcome.own.mean_mm(), outcome.peer.mean_mm());
  EXPECT_LE(outcome.own.wrong_pct(), outcome.peer.wrong_pct() + 0.05);
  EXPECT_LE(outcome.own.missing_pct(), outcome.peer.missing_pct() + 0.5);
  if (GetParam()) return;  // ours corrects the error by multipath
  EXPECT_LT(outcome.between.apart, outcome.between.both / 2000);
  EXPECT_NEAR(outcome.between.mean_mm(), 0, 1);
  EXPECT_LT(outcome.between.sigma_mm(), 6);
}

INSTANTIATE_TEST_SUITE_P(Looks, Kinect2Peer, ::testing::Bool(),
                         [](const auto& look) { return look.param ? "judged" : "plain"; });
#endif

}  // namespace
}  // namespace mixrig::test
