// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/picture_look.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/srgb.h"

namespace mixrig::render {
namespace {

constexpr int kLookBlock_px = 24;
constexpr int kMostLookBlocks = 600;
/// Bins of brightness, by the square root of light.
constexpr std::size_t kLightBins = 12;
constexpr std::size_t kLeastBlocks = 4;
/// Part of the blocks of a brightness that counts: the smoothest.
constexpr double kSmoothShare = 1.0 / 3;
constexpr float kMostBlur_px = 1.2F;
/// Median variance of the place of a straight step over the area of pixels. Virtual edges have
/// kFewSamples_px2 less: n samples across an edge (kSampleTurnPx) have 1/6 (1 - 1/n^2) in the mean.
constexpr float kSharpMedian_px2 = 3.0F / 16;
constexpr int kSamplesAcross = kVirtualSamples * kVirtualSamples;
constexpr float kFewSamples_px2 = 1.0F / (6 * kSamplesAcross * kSamplesAcross);
constexpr std::size_t kLeastEdges = 20;
/// Least height of steps, in linear light and in colour differences.
constexpr float kLeastStep = 0.15F, kLeastChromaStep = 0.1F;
/// Least deficit of a step's variance to a virtual object's that counts as sharpening.
constexpr float kLeastNarrow_px2 = 0.05F, kMostSharpening = 0.6F;

/// Mean squared responses of a block to [1 -2 1] x [1 -2 1], at one and at two pixels.
struct BlockNoise {
  glm::vec3 light{0}, fine{0}, coarse{0};
  float shared = 0;  ///< correlation of the fine responses of the channels
};

glm::vec3 response(const Image<glm::vec3>& a, int x, int y, int step) {
  const auto line = [&](int j) {
    const glm::vec3* row = a.row(j);
    return row[x - step] - 2.0F * row[x] + row[x + step];
  };
  return line(y - step) - 2.0F * line(y) + line(y + step);
}

BlockNoise noise_of_block(const Image<glm::vec3>& a, int y0, Size block) {
  BlockNoise sum;
  glm::vec3 products(0);
  float count = 0;
  for (int y = y0 + 2; y < y0 + block.height - 2; ++y)
    for (int x = 2; x < block.width - 2; ++x) {
      const glm::vec3 fine = response(a, x, y, 1), coarse = response(a, x, y, 2);
      sum.light += a.row(y)[x], sum.fine += fine * fine, sum.coarse += coarse * coarse;
      products += glm::vec3(fine.x * fine.y, fine.y * fine.z, fine.z * fine.x);
      count += 1;
    }
  const glm::vec3 f = sum.fine;
  const glm::vec3 norms =
      glm::sqrt(glm::max(glm::vec3(f.x * f.y, f.y * f.z, f.z * f.x), glm::vec3(1e-20F)));
  sum.shared = glm::dot(products / norms, glm::vec3(1.0F / 3));
  sum.light /= count, sum.fine /= count, sum.coarse /= count;
  return sum;
}

/// Autocorrelation along an axis, times the sum of squares of its taps, at 0, 1 and 2 pixels.
glm::dvec3 autocorrelation(double spread) {
  const double middle = 1 - 2 * spread;
  return {middle * middle + 2 * spread * spread, 2 * spread * middle, spread * spread};
}
/// Squared responses to [1 -2 1] at one and at two pixels for that autocorrelation.
glm::dvec2 responses(double spread) {
  const glm::dvec3 r = autocorrelation(spread);
  return {6 * r[0] - 8 * r[1] + 2 * r[2], 6 * r[0] - 8 * r[2]};
}

/// Finds the spread at which the fine response is `ratio` of the coarse one; the ratio falls with
/// the spread.
double spread_of(double ratio) {
  double low = 0, high = 1.0 / 3;
  for (int i = 0; i < 30; ++i) {
    const double at = 0.5 * (low + high);
    const glm::dvec2 r = responses(at);
    const double found = r[0] * r[0] / (r[1] * r[1]);
    (found > ratio ? low : high) = at;
  }
  return 0.5 * (low + high);
}

/// The smoothest blocks of one brightness.
std::vector<BlockNoise> smooth_blocks(std::vector<BlockNoise> blocks) {
  const auto strength = [](const BlockNoise& b) { return b.fine.x + b.fine.y + b.fine.z; };
  std::sort(blocks.begin(), blocks.end(),
            [&](const BlockNoise& a, const BlockNoise& b) { return strength(a) < strength(b); });
  const double some = kSmoothShare * static_cast<double>(blocks.size());
  blocks.resize(std::min(blocks.size(), std::max(kLeastBlocks, static_cast<std::size_t>(some))));
  return blocks;
}

/// Fits floor + slope * light by relative least squares; both at least 0.
void fit_line(const std::vector<BlockNoise>& blocks, float scale, int channel, Grain& grain) {
  double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
  for (const BlockNoise& b : blocks) {
    const double x = b.light[channel], y = scale * b.fine[channel];
    const double weight = 1 / std::max(y * y, 1e-16);
    w += weight, wx += weight * x, wxx += weight * x * x, wy += weight * y, wxy += weight * x * y;
  }
  const double det = w * wxx - wx * wx;
  double slope = det > 1e-9 * w * wxx ? (w * wxy - wx * wy) / det : 0;
  double floor = (wy - slope * wx) / w;
  if (slope < 0) slope = 0, floor = wy / w;
  if (floor < 0) floor = 0, slope = wxx > 0 ? wxy / wxx : 0;
  grain.floor[channel] = static_cast<float>(floor);
  grain.slope[channel] = static_cast<float>(slope);
}

/// Nullopt with too few smooth blocks.
std::optional<Grain> grain_of(const Image<glm::vec3>& a, Size block) {
  std::array<std::vector<BlockNoise>, kLightBins> bins;
  for (int y = 0; y + block.height <= a.height(); y += block.height) {
    const BlockNoise noise = noise_of_block(a, y, block);
    const float light = std::clamp(luminance(noise.light), 0.0F, 0.999F);
    // Nearly white blocks are clipped.
    if (std::max({noise.light.x, noise.light.y, noise.light.z}) > 0.9F) continue;
    bins[static_cast<std::size_t>(kLightBins * std::sqrt(light))].push_back(noise);
  }
  std::vector<BlockNoise> smooth;
  double fine = 0, coarse = 0, shared = 0;
  for (const auto& bin : bins) {
    if (bin.size() < kLeastBlocks) continue;
    for (const BlockNoise& b : smooth_blocks(bin)) {
      smooth.push_back(b);
      const float scale = 1 / std::max(b.coarse.y, 1e-12F);
      fine += scale * b.fine.y, coarse += scale * b.coarse.y, shared += b.shared;
    }
  }
  if (smooth.empty()) return std::nullopt;
  Grain grain;
  grain.spread = static_cast<float>(spread_of(fine / coarse));
  grain.shared =
      static_cast<float>(std::clamp(shared / static_cast<double>(smooth.size()), 0.0, 1.0));
  const double r = responses(grain.spread)[0] / autocorrelation(grain.spread)[0];
  for (int c = 0; c < 3; ++c) fit_line(smooth, static_cast<float>(1 / (r * r)), c, grain);
  return grain;
}

/// Variance, px^2, of the place of an isolated step within 4 pixels of `at`. light[k] runs along
/// the axis, `beside` along a neighbouring line. Nullopt if there is no such step.
std::optional<float> step_variance(const float* light, const float* beside, int at,
                                   float least_height) {
  const auto mean3 = [](const float* v) { return (v[0] + v[1] + v[2]) / 3; };
  const float low = mean3(light + at - 5), high = mean3(light + at + 3);
  const float height = high - low;
  if (std::abs(height) < least_height) return std::nullopt;
  const float flat = 0.05F * std::abs(height);
  if (std::abs(light[at - 5] - light[at - 3]) > flat ||
      std::abs(light[at + 5] - light[at + 3]) > flat)
    return std::nullopt;
  const auto moments = [&](const float* v) {
    float first = 0, second = 0, sum = 0;
    for (int i = -3; i < 3; ++i) {
      const float d = v[at + i + 1] - v[at + i], x = static_cast<float>(i) + 0.5F;
      sum += d, first += d * x, second += d * x * x;
    }
    const float mean = first / sum;
    return glm::vec2(mean, second / sum - mean * mean);
  };
  const glm::vec2 own = moments(light), next = moments(beside);
  if (std::abs(own.x) > 0.75F || std::abs(own.x - next.x) > 0.12F) return std::nullopt;
  return own.y;
}

/// Whether the largest central difference around lies at `at`, and is a step.
bool is_steepest(const float* light, int at) {
  const float own = std::abs(light[at + 1] - light[at - 1]);
  for (int i = -3; i <= 3; ++i)
    if (std::abs(light[at + i + 1] - light[at + i - 1]) > own) return false;
  return own > 0.03F;
}

/// Collects the variances of isolated steps of value(pixel) along rows, or along columns, of all
/// blocks.
template <typename Value>
void find_steps(const Image<glm::vec3>& a, Size block, bool rows, float least_height,
                const Value& value, std::vector<float>& found) {
  constexpr int kMargin = 6;
  const int length = rows ? block.width : block.height, lines = rows ? block.height : block.width;
  std::vector<float> line(static_cast<std::size_t>(length)), next = line;
  for (int y0 = 0; y0 + block.height <= a.height(); y0 += block.height)
    for (int j = 0; j + 1 < lines; ++j) {
      for (int i = 0; i < length; ++i) {
        const auto k = static_cast<std::size_t>(i);
        line[k] = value(rows ? a.row(y0 + j)[i] : a.row(y0 + i)[j]);
        next[k] = value(rows ? a.row(y0 + j + 1)[i] : a.row(y0 + i)[j + 1]);
      }
      for (int i = kMargin; i < length - kMargin; ++i)
        if (is_steepest(line.data(), i))
          if (const auto variance = step_variance(line.data(), next.data(), i, least_height))
            found.push_back(*variance);
    }
}

/// Median; nullopt with too few values. Reorders them.
std::optional<float> median_of(std::vector<float>& variances) {
  if (variances.size() < kLeastEdges) return std::nullopt;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return *middle;
}

void find_sharpness(const Image<glm::vec3>& a, Size block, PictureLook& look) {
  const auto light = [](const glm::vec3& c) { return luminance(c); };
  std::vector<float> steps;
  for (const bool rows : {true, false}) find_steps(a, block, rows, kLeastStep, light, steps);
  const auto variance = median_of(steps);
  if (!variance) return;
  const float wider = *variance - kSharpMedian_px2 + kFewSamples_px2;
  look.blur_px = std::min(kMostBlur_px, std::sqrt(std::max(0.0F, wider)));
  // The mask takes 2 s from the variance.
  const bool narrow = wider < -kLeastNarrow_px2;
  look.sharpening = narrow ? std::min(kMostSharpening, -0.5F * wider) : 0;
  for (const bool rows : {true, false}) {
    steps.clear();
    const auto red = [](const glm::vec3& c) { return c.r - c.g; };
    const auto blue = [](const glm::vec3& c) { return c.b - c.g; };
    find_steps(a, block, rows, kLeastChromaStep, red, steps);
    find_steps(a, block, rows, kLeastChromaStep, blue, steps);
    const auto chroma = median_of(steps);
    if (!chroma) continue;
    const float more = std::max(0.0F, *chroma - *variance);
    look.chroma_px[rows ? 0 : 1] = std::min(kMostBlur_px, std::sqrt(more));
  }
}

glm::vec3 bilinear_light(ImageView<const Rgb8> plate, glm::vec2 at) {
  const auto& linear = linear_of_srgb_bytes();
  const Size size = plate.size;
  const float u = std::clamp(at.x, 0.0F, static_cast<float>(size.width - 1));
  const float v = std::clamp(at.y, 0.0F, static_cast<float>(size.height - 1));
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int x1 = std::min(x0 + 1, size.width - 1), y1 = std::min(y0 + 1, size.height - 1);
  const auto light = [&](int x, int y) {
    const Rgb8 c = plate.row(y)[x];
    return glm::vec3(linear[c.r], linear[c.g], linear[c.b]);
  };
  const float tx = u - static_cast<float>(x0), ty = v - static_cast<float>(y0);
  return glm::mix(glm::mix(light(x0, y0), light(x1, y0), tx),
                  glm::mix(light(x0, y1), light(x1, y1), tx), ty);
}

}  // namespace

PictureLook wanted_of(const PictureLook& look, const LookSettings& wanted) {
  PictureLook some = look;
  if (!wanted.grain) some.grain = {};
  if (!wanted.blur) some.blur_px = 0;
  if (!wanted.chroma) some.chroma_px = {};
  if (!wanted.sharpening) some.sharpening = 0;
  return some;
}

std::string to_text(const PictureLook& look) {
  const Grain& g = look.grain;
  return fmt::format(
      "look of the plate: noise {:.4f} at light 0.2 (green), spread {:.2f}, shared {:.2f}; blur "
      "{:.2f} px, of colour {:.2f} and {:.2f} px more; sharpening {:.2f}",
      std::sqrt(g.floor.y + 0.2F * g.slope.y), g.spread, g.shared, look.blur_px, look.chroma_px.x,
      look.chroma_px.y, look.sharpening);
}

PictureLook measure_look(const Image<glm::vec3>& blocks, Size block, const PictureLook& before) {
  PictureLook look = before;
  if (const auto grain = grain_of(blocks, block)) look.grain = *grain;
  find_sharpness(blocks, block, look);
  return look;
}

LookMeter::LookMeter(const CompositorSetup& setup) {
  const Size view = setup.view.size_px;
  const int columns = view.width / kLookBlock_px, rows = view.height / kLookBlock_px;
  if (columns * rows == 0) return;
  const int every = (columns * rows + kMostLookBlocks - 1) / kMostLookBlocks;
  const int count = columns * rows / every;
  plate_px_.reset({kLookBlock_px, kLookBlock_px * count});
  light_.reset(plate_px_.size());
  std::vector<glm::vec2> line(static_cast<std::size_t>(view.width));
  for (int y = 0; y < rows * kLookBlock_px; ++y) {
    plate_row(setup.target, setup.view, y, line.data());
    const int first = y / kLookBlock_px * columns;
    for (int i = (first + every - 1) / every; i < count && i * every < first + columns; ++i)
      std::copy_n(line.data() + (i * every - first) * kLookBlock_px, kLookBlock_px,
                  plate_px_.row(i * kLookBlock_px + y % kLookBlock_px));
  }
}

PictureLook LookMeter::measure(ImageView<const Rgb8> plate, const PictureLook& before) {
  if (plate_px_.empty()) return before;
  for (int y = 0; y < light_.height(); ++y)
    for (int x = 0; x < light_.width(); ++x)
      light_.row(y)[x] = bilinear_light(plate, plate_px_.row(y)[x]);
  return measure_look(light_, {kLookBlock_px, kLookBlock_px}, before);
}

PictureLook measured_first(LookMeter& meter, ImageView<const Rgb8> plate) {
  const PictureLook look = meter.measure(plate);
  log_info("render", to_text(look));
  return look;
}

}  // namespace mixrig::render
