// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/pairs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "hal/base/clock.h"
#include "host/judge/bench/peers.h"
#include "host/judge/measure/srgb.h"
#include "host/math/image_io/image_io.h"
#include "host/render/tables/room_edges.h"

namespace mixrig::bench {
namespace {

constexpr int kFactor = 8;

struct PairFiles {
  const char *name, *color, *disparity;
  float unit_px;  ///< of one step of the file
};
constexpr std::array<PairFiles, 3> kPairs{
    {{"art", "art/color.png", "art/disparity.png", 1},
     {"aloe", "aloe/aloeL.jpg", "aloe/aloeGT.png", 1},
     {"motorcycle", "motorcycle/motorcycle_left.png", "motorcycle/disp_x256.png", 1.0F / 256}}};

Result<Image<float>> read_disparity(const std::filesystem::path& path, float unit_px) {
  Image<float> out;
  const auto convert = [&](const auto& image) {
    out.reset(image.size());
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x)
        out.row(y)[x] = unit_px * static_cast<float>(image.row(y)[x]);
  };
  if (unit_px < 1) {
    Image<std::uint16_t> image;
    MIXRIG_TRY(image_io::read_gray16(path, image));
    convert(image);
  } else {
    Image<std::uint8_t> image;
    MIXRIG_TRY(image_io::read_gray8(path, image));
    convert(image);
  }
  return out;
}

/// Known values weighed by their bilinear share.
Image<float> bilinear(const Image<float>& low, Size size) {
  Image<float> out(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float u = std::max(0.0F, static_cast<float>(x - kFactor / 2) / kFactor);
      const float v = std::max(0.0F, static_cast<float>(y - kFactor / 2) / kFactor);
      float sum = 0, weights = 0;
      for (int k = 0; k < 4; ++k) {
        const int i = static_cast<int>(u) + k % 2, j = static_cast<int>(v) + k / 2;
        const float d = low.row(std::min(j, low.height() - 1))[std::min(i, low.width() - 1)];
        const float weight =
            (1 - std::abs(u - static_cast<float>(i))) * (1 - std::abs(v - static_cast<float>(j)));
        if (d > 0) sum += weight * d, weights += weight;
      }
      out.row(y)[x] = weights > 0 ? sum / weights : 0;
    }
  return out;
}

Image<Rgbf> linear_light(const Image<Rgb8>& color) {
  std::array<float, 256> linear;
  for (int i = 0; i < 256; ++i)
    linear[static_cast<std::size_t>(i)] = measure::linear_of(static_cast<std::uint8_t>(i));
  Image<Rgbf> out(color.size());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const Rgb8 c = color.row(y)[x];
      out.row(y)[x] = {linear[c.r], linear[c.g], linear[c.b]};
    }
  return out;
}

void add_pair_errors(const Image<float>& found, const Image<float>& truth, Row& row) {
  constexpr float kWrong_px = 3;
  measure::Sum square, absolute, wrong;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x) {
      const float d = found.row(y)[x], t = truth.row(y)[x];
      if (!(t > 0)) continue;
      const bool known = d > 0;
      wrong.add(!known || std::abs(d - t) > kWrong_px ? 100 : 0);
      if (known) square.add((d - t) * (d - t)), absolute.add(std::abs(d - t));
    }
  row.more = {{"rms_px", std::sqrt(square.mean().value_or(0))},
              {"mae_px", absolute.mean().value_or(0)},
              {"wrong_pct", wrong.mean().value_or(0)}};
}

/// The compositor's depth passes: no offset between the cameras, the middle of the picture at 2.5
/// m.
class WarpedPair {
 public:
  Result<void> open(const Pair& pair, const Image<float>& low) {
    const Size size = pair.color.size(), small = low.size();
    const double focal_px = 1.2 * size.width;
    setup_.view = {size, focal_px, focal_px, 0.5 * size.width, 0.5 * size.height};
    setup_.target = {setup_.view, {}};
    setup_.tof.pinhole = {small, focal_px / kFactor, focal_px / kFactor,
                          (0.5 * size.width - kFactor / 2) / kFactor,
                          (0.5 * size.height - kFactor / 2) / kFactor};
    float largest = 0;
    for (int y = 0; y < low.height(); ++y)
      largest = std::max(largest, *std::max_element(low.row(y), low.row(y) + low.width()));
    scale_ = 1.5F * largest;  // the nearest at 1.5 m
    depth_m_.reset(small);
    for (int y = 0; y < low.height(); ++y)
      for (int x = 0; x < low.width(); ++x)
        depth_m_.row(y)[x] = low.row(y)[x] > 0 ? scale_ / low.row(y)[x] : 0;
    MIXRIG_ASSIGN(compositor_, session::make_compositor(setup_, {render::Backend::kCpu, 1}));
    return {};
  }
  /// The time of the two passes.
  Result<float> run(const Pair& pair, Image<float>& disparity) {
    output_.wanted = render::kWarpedDepth;
    MIXRIG_TRY(compositor_->compose({pair.color, depth_m_, {}}, output_));
    disparity.reset(pair.color.size());
    for (int y = 0; y < disparity.height(); ++y)
      for (int x = 0; x < disparity.width(); ++x) {
        const float z_m = output_.warped_depth_m.row(y)[x];
        disparity.row(y)[x] = z_m > 0 ? scale_ / z_m : 0;
      }
    const auto& ms = compositor_->state().stage_times;
    return ms[static_cast<std::size_t>(render::Stage::kCorrect)] +
           ms[static_cast<std::size_t>(render::Stage::kWarp)];
  }

 private:
  render::CompositorSetup setup_;
  std::unique_ptr<render::Compositor> compositor_;
  Image<float> depth_m_;
  render::FrameOutput output_;
  float scale_ = 1;
};

using Method = std::pair<std::string, std::function<Result<float>(Image<float>&)>>;

/// Runs a method until it has `times`.
Result<Row> run_method(const Pair& pair, const Method& method, bool peer, int times) {
  Row row;
  row.name = pair.name + ": " + method.first, row.group = peer ? "OpenCV" : "ours", row.peer = peer;
  Image<float> found;
  for (int i = 0; i < times; ++i) {
    MIXRIG_ASSIGN(const float ms, method.second(found));
    row.times_ms.push_back(ms);
  }
  add_pair_errors(found, pair.disparity, row);
  return row;
}

std::vector<Method> peer_methods(const Pair& pair, const Image<float>& blurred, bool grid) {
  std::vector<Method> methods;
  const SystemClock clock;
  for (const Peer& peer : peers_of("pairs", {}))
    if (grid || peer.best)
      methods.emplace_back(peer.name, [&pair, &blurred, peer, clock](Image<float>& found) {
        PeerOutput out;
        const HostTime begin = clock.now();
        peer.run({{}, pair.color, blurred}, out);
        const double ms = milliseconds(clock.now() - begin);
        found = std::move(out.depth_m);
        return Result<float>(static_cast<float>(ms));
      });
  return methods;
}

}  // namespace

Result<std::vector<Pair>> read_pairs(const std::filesystem::path& folder) {
  std::vector<Pair> pairs;
  for (const PairFiles& files : kPairs) {
    Pair& pair = pairs.emplace_back();
    pair.name = files.name;
    MIXRIG_TRY(image_io::read_rgb8(folder / files.color, pair.color));
    MIXRIG_ASSIGN(pair.disparity, read_disparity(folder / files.disparity, files.unit_px));
    if (pair.color.size() != pair.disparity.size())
      return Error{ErrorCode::kData, (folder / files.disparity).string() +
                                         ": is not as large as the picture " + files.color};
  }
  return pairs;
}

Image<float> decimated(const Image<float>& values, int factor) {
  Image<float> low({values.width() / factor, values.height() / factor});
  for (int y = 0; y < low.height(); ++y)
    for (int x = 0; x < low.width(); ++x)
      low.row(y)[x] = values.row(factor * y + factor / 2)[factor * x + factor / 2];
  return low;
}

Image<float> sides_by_color(const Image<float>& low, const Image<Rgb8>& color) {
  // Depth in units of 1 / disparity: the surfaces and their order are the same.
  Image<float> depth(color.size());
  const auto sample = [&](int x, int y) {
    return low.row(std::min(y / kFactor, low.height() - 1))[std::min(x / kFactor, low.width() - 1)];
  };
  const auto inverse = [](float v) { return v > 0 ? 1 / v : 0; };
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) depth.row(y)[x] = inverse(sample(x, y));
  Image<float> found = render::depth_at_color_edges({depth, {}, linear_light(color), {}}, kFactor);
  for (int y = 0; y < found.height(); ++y)
    std::transform(found.row(y), found.row(y) + found.width(), found.row(y), inverse);
  return found;
}

Result<Suite> run_pairs(const std::filesystem::path& folder, bool grid, bool quick,
                        const ProgressFn& progress) {
  MIXRIG_ASSIGN(const std::vector<Pair> pairs, read_pairs(folder));
  Suite suite{"refine", "mae_px", "mean error of the disparity, px", {}};
  const int times = quick || grid ? 1 : 5;
  const SystemClock clock;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Pair& pair = pairs[p];
    const Image<float> low = decimated(pair.disparity, kFactor);
    const Image<float> blurred = bilinear(low, pair.color.size());
    WarpedPair warped;
    MIXRIG_TRY(warped.open(pair, low));
    const std::vector<Method> ours{
        {"bilinear",
         [&](Image<float>& found) {
           const HostTime begin = clock.now();
           found = bilinear(low, pair.color.size());
           return Result<float>(static_cast<float>(milliseconds(clock.now() - begin)));
         }},
        {"correct and warp", [&](Image<float>& found) { return warped.run(pair, found); }},
        {"side by colour", [&](Image<float>& found) {
           const HostTime begin = clock.now();
           found = sides_by_color(low, pair.color);
           return Result<float>(static_cast<float>(milliseconds(clock.now() - begin)));
         }}};
    for (const Method& method : ours) {
      MIXRIG_ASSIGN(Row row, run_method(pair, method, false, times));
      suite.rows.push_back(std::move(row));
    }
    for (const Method& method : peer_methods(pair, blurred, grid)) {
      MIXRIG_ASSIGN(Row row, run_method(pair, method, true, times));
      suite.rows.push_back(std::move(row));
    }
    if (progress) progress("refine", static_cast<int>(p) + 1, static_cast<int>(pairs.size()));
  }
  return suite;
}

}  // namespace mixrig::bench
