// SPDX-License-Identifier: Apache-2.0
// Bias of marker centres over the phase within a pixel, by radius and threshold.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/math/estimation/markers/marker_blobs.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Greys = std::array<std::array<double, 32>, 32>;

/// A disc blurred by half a pixel, each pixel integrated over 8x8 points.
Greys disc(double x0, double y0, double radius, double peak) {
  Greys greys;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      double sum = 0;
      for (int sub = 0; sub < 64; ++sub) {
        const double px = x + (sub % 8 - 3.5) / 8, py = y + (sub / 8 - 3.5) / 8;
        sum += 0.5 * std::erfc((std::hypot(px - x0, py - y0) - radius) / (0.5 * std::sqrt(2.0)));
      }
      greys[y][x] = 10 + peak * sum / 64;
    }
  return greys;
}

Image<std::uint8_t> shot_of(const Greys& greys, double noise, RandomGeometry& random) {
  Image<std::uint8_t> picture({32, 32}, 0);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      picture.at(x, y) = static_cast<std::uint8_t>(
          std::clamp(std::lround(greys[y][x] + noise * random.normal()), 0L, 255L));
  return picture;
}

BlobBias measure(double radius_px, int threshold, int shots) {
  RandomGeometry random(7);
  BlobBias result{radius_px, threshold, 0, 0};
  double squared = 0;
  int count = 0;
  for (int phase = 0; phase < 10; ++phase) {
    const Eigen::Vector2d truth(15 + 0.1 * phase, 15.35);
    const Greys greys = disc(truth.x(), truth.y(), radius_px, 200);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int shot = 0; shot < shots; ++shot) {
      const auto blobs =
          estimation::find_marker_blobs(shot_of(greys, 2, random), {threshold, 1, 1000, 2, 3});
      if (blobs.size() != 1) return {radius_px, threshold, NAN, NAN};
      const Eigen::Vector2d error = blobs[0].value.centre_px - truth;
      mean += error / shots;
      squared += error.x() * error.x() / blobs[0].covariance(0, 0);
      ++count;
    }
    result.bias_px = std::max(result.bias_px, mean.norm());
  }
  result.over_sigma = std::sqrt(squared / count);
  return result;
}

}  // namespace

std::vector<BlobBias> measure_blob_bias(int shots) {
  std::vector<BlobBias> table;
  for (const double radius_px : {1.0, 1.5, 2.0, 3.0, 5.0})
    for (const int threshold : {30, 60, 120}) table.push_back(measure(radius_px, threshold, shots));
  return table;
}

}  // namespace mixrig::estimation_bench
