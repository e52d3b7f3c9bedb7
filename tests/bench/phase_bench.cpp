// SPDX-License-Identifier: Apache-2.0
// Decodes the raw pictures of studio frames and compares the depth with the truth: error, noise,
// wrong and missing pixels, CPU time of one thread. usage: phase_bench SCENARIO SEED FIRST LAST
// [plain|judged] [FOLDER]. With FOLDER it writes pictures of the frames there. If the build knows a
// checkout of libfreenect2 (MIXRIG_LIBFREENECT2), its decoder is measured too, on the same packets.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "hal/wire/camera/kinect2_raw.h"
#include "host/capture/depth/phase_decoder.h"
#include "host/math/image_io/image_io.h"
#include "studio/studio.h"
#ifdef MIXRIG_HAS_LIBFREENECT2
#include "tests/support/libfreenect2/libfreenect2_decoder.h"
#endif

namespace mixrig {
namespace {

constexpr float kWrong_m = 0.1F;  // Cortes Reina 2015, section 4.2
constexpr int kRepeats = 20;

/// True depth of a frame. In the band, a depth step of over 100 mm is within one pixel.
struct True {
  Image<float> distance_m;
  Image<std::uint8_t> band;
};

True truth_of(const Image<float>& distance_m) {
  True truth{distance_m, Image<std::uint8_t>(distance_m.size())};
  for (int y = 1; y + 1 < distance_m.height(); ++y)
    for (int x = 1; x + 1 < distance_m.width(); ++x) {
      float low = 1e9F, high = 0;
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u)
          low = std::min(low, distance_m.at(u, v)), high = std::max(high, distance_m.at(u, v));
      truth.band.at(x, y) = high - low > kWrong_m;
    }
  return truth;
}

struct Score {
  long pixels = 0, wrong = 0, missing = 0, known = 0;
  double sum = 0, absolute = 0, square = 0, normalised = 0;
  void add(float distance, float sigma, float truth) {
    ++pixels;
    if (!(distance > 0)) return void(++missing);
    const double e = static_cast<double>(distance) - static_cast<double>(truth);
    if (std::abs(e) > static_cast<double>(kWrong_m)) return void(++wrong);
    ++known, sum += e, absolute += std::abs(e), square += e * e;
    if (sigma > 0) normalised += e * e / static_cast<double>(sigma * sigma);
  }
  void print(const char* name, const char* where, double ms) const {
    const auto n = static_cast<double>(std::max(1L, known)), all = static_cast<double>(pixels);
    std::printf("| %s | %s | %ld | %.2f | %.2f | %.2f | %.3f | %.3f | %.2f | %.2f |\n", name, where,
                pixels, 1e3 * absolute / n, 1e3 * sum / n, 1e3 * std::sqrt(square / n),
                100 * static_cast<double>(wrong) / all, 100 * static_cast<double>(missing) / all,
                normalised / n, ms);
  }
};

struct Both {
  Score all, surface, band;
  void add(const Image<float>& distance, const Image<float>* sigma, const True& truth) {
    for (int y = 1; y + 1 < distance.height(); ++y)
      for (int x = 1; x + 1 < distance.width(); ++x) {
        const float s = sigma != nullptr ? sigma->at(x, y) : 0, t = truth.distance_m.at(x, y);
        if (!(t > 0)) continue;
        all.add(distance.at(x, y), s, t);
        (truth.band.at(x, y) != 0 ? band : surface).add(distance.at(x, y), s, t);
      }
  }
  void print(const char* name, double ms) const {
    all.print(name, "all", ms), surface.print(name, "surfaces", ms), band.print(name, "edges", ms);
  }
};

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<std::uint8_t> pictures_of(const std::vector<std::uint8_t>& raw) {
  std::vector<std::uint8_t> pictures;
  device::Kinect2DepthStream stream;
  constexpr std::size_t kPacket = 33792;
  for (std::size_t at = 0; at < raw.size();) {
    const std::size_t end = (at / device::kKinect2PacketBytes + 1) * device::kKinect2PacketBytes;
    const std::size_t count = std::min(kPacket, end - at);
    stream.feed({raw.data() + at, count}, true, [&](const device::Kinect2RawFrame& frame) {
      pictures.assign(frame.pictures.begin(), frame.pictures.end());
    });
    at += count;
    if (at == end) stream.feed({}, true, {});
  }
  return pictures;
}

/// Distance, error and state side by side.
Image<Rgb8> picture_of(const depth::PhaseDepth& out, const True& truth) {
  const Size size = out.distance_m.size();
  Image<Rgb8> picture({3 * size.width, size.height});
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::clamp(255 * v, 0.0F, 255.0F));
  };
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto state = out.state.at(x, y);
      const float d = out.distance_m.at(x, y), e = (d - truth.distance_m.at(x, y)) / 0.05F;
      const bool good = state == depth::PixelState::kGood;
      const std::uint8_t grey = byte(good ? d / 6 : 0), left = byte(1 - std::abs(e));
      picture.at(x, y) = {grey, grey, grey};
      picture.at(size.width + x, y) = !good   ? Rgb8{0, 0, 0}
                                      : e > 0 ? Rgb8{255, left, left}
                                              : Rgb8{left, left, 255};
      picture.at(2 * size.width + x, y) = good                                 ? Rgb8{160, 160, 160}
                                          : state == depth::PixelState::kMixed ? Rgb8{255, 210, 0}
                                          : state == depth::PixelState::kSaturated ? Rgb8{255, 0, 0}
                                                                                   : Rgb8{0, 0, 0};
    }
  return picture;
}

int bench(int count, char** arguments) {
  studio::StudioOptions options;
  const auto scenario = studio::parse_scenario(arguments[1]);
  if (!scenario) return std::fprintf(stderr, "%s\n", to_line(scenario.error()).c_str()), 2;
  options.scenario = *scenario;
  options.seed = static_cast<unsigned>(std::atoi(arguments[2]));
  const int first = std::atoi(arguments[3]), last = std::atoi(arguments[4]);
  options.frames = std::max(2, last);
  options.size_px = {64, 64};
  options.raw = true;
  if (count > 5 && std::string(arguments[5]) == "judged") options.realism = studio::Realism::all();
  const std::filesystem::path folder = count > 6 ? arguments[6] : "";
  auto studio = studio::Studio::create(options);
  if (!studio) return std::fprintf(stderr, "%s\n", to_line(studio.error()).c_str()), 2;
  const studio::RawTables& tables = *studio->info().raw;
  const auto offsets = device::parse_kinect2_offsets(tables.phase_offsets);
  const auto infrared = device::parse_kinect2_infrared(tables.infrared);
  if (!offsets || !infrared) return std::fprintf(stderr, "tables cannot be read\n"), 1;
  const depth::PhaseCamera camera = depth::kinect2_phase_camera(*infrared, *offsets);
  depth::PhaseDecoder decoder(camera);
  if (!folder.empty()) std::filesystem::create_directories(folder);
  Both good, single, with_mixed, others;
  std::array<long, 4> states{};
  double seconds = 0, others_s = 0;
#ifdef MIXRIG_HAS_LIBFREENECT2
  test::Libfreenect2Decoder peer(tables.phase_offsets, tables.infrared);
#endif
  depth::PhaseDepth out;
  studio::Frame frame;
  Image<Rgb8> picture;
  for (int number = first; number <= last; ++number) {
    studio->render(number, frame);
    const True truth = truth_of(frame.tof_true_m);
    const auto pictures = pictures_of(frame.raw);
    if (pictures.empty()) return std::fprintf(stderr, "no frame in the packets\n"), 1;
    for (const bool smoothing : {false, true}) {
      decoder.set_smoothing(smoothing);
      const double begin = cpu_s();
      for (int i = 0; i < kRepeats; ++i) decoder.decode(pictures, out);
      if (smoothing) seconds += (cpu_s() - begin) / kRepeats;
      if (smoothing && !folder.empty() &&
          !image_io::write_png(folder / (std::to_string(number) + ".png"),
                               std::as_const(picture = picture_of(out, truth)).view()))
        return std::fprintf(stderr, "%s: cannot write\n", folder.c_str()), 1;
      if (smoothing) with_mixed.add(out.distance_m, &out.sigma_m, truth);
      for (int y = 0; y < out.state.height(); ++y)
        for (int x = 0; x < out.state.width(); ++x) {
          if (smoothing) ++states[static_cast<std::size_t>(out.state.at(x, y))];
          if (out.state.at(x, y) != depth::PixelState::kGood) out.distance_m.at(x, y) = 0;
        }
      (smoothing ? good : single).add(out.distance_m, &out.sigma_m, truth);
    }
#ifdef MIXRIG_HAS_LIBFREENECT2
    others.add(peer.decode(frame.raw), nullptr, truth);
    others_s += peer.cpu_s();
#endif
  }
  const double frames = last - first + 1, ms = 1e3 * seconds / frames;
  std::printf(
      "| decoder | pixels | count | mean abs error, mm | bias, mm | rms, mm | wrong %% | missing "
      "%% "
      "| (error / sigma)^2 | CPU ms |\n|---|---|---|---|---|---|---|---|---|---|\n");
  good.print("mixrig", ms);
  single.print("mixrig, single pixels", 0);
  with_mixed.print("mixrig, mixed ones too", 0);
  if (others.all.pixels > 0) others.print("libfreenect2", 1e3 * others_s / frames);
  std::printf("good %ld, dark %ld, saturated %ld, mixed %ld\n", states[0], states[1], states[2],
              states[3]);
  return 0;
}

}  // namespace
}  // namespace mixrig

int main(int count, char** arguments) {
  if (count < 5)
    return std::fprintf(stderr,
                        "usage: phase_bench SCENARIO SEED FIRST LAST [plain|judged] [FOLDER]\n"),
           2;
  return mixrig::bench(count, arguments);
}
