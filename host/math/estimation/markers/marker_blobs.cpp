// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/markers/marker_blobs.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"

namespace mixrig::estimation {
namespace {

struct Pixel {
  int x, y;
};

/// All bright pixels connected to `seed`; marks them as seen.
void flood(ImageView<const std::uint8_t> picture, int threshold, Pixel seed,
           Image<std::uint8_t>& seen, std::vector<Pixel>& region) {
  region.assign(1, seed);
  seen.at(seed.x, seed.y) = 1;
  for (std::size_t next = 0; next < region.size(); ++next) {
    const Pixel at = region[next];
    const int left = std::max(0, at.x - 1), right = std::min(picture.size.width - 1, at.x + 1);
    const int top = std::max(0, at.y - 1), bottom = std::min(picture.size.height - 1, at.y + 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        if (seen.at(x, y) || picture.at(x, y) <= threshold) continue;
        seen.at(x, y) = 1;
        region.push_back({x, y});
      }
  }
}

/// BlobMoments of a region, relative to its first pixel.
struct BlobMoments {
  double mass = 0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // of the shape, unweighted
  Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();   // covariance of the centre, unit grey noise
  double peak = 0;
  bool at_border = false;
};

BlobMoments moments_of(ImageView<const std::uint8_t> picture, int threshold,
                       const std::vector<Pixel>& region) {
  BlobMoments m;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Pixel& p : region) {
    const double weight = picture.at(p.x, p.y) - threshold;
    m.mass += weight;
    m.centre += weight * Eigen::Vector2d(p.x, p.y);
    middle += Eigen::Vector2d(p.x, p.y);
    m.peak = std::max<double>(m.peak, picture.at(p.x, p.y));
    m.at_border = m.at_border || p.x == 0 || p.y == 0 || p.x == picture.size.width - 1 ||
                  p.y == picture.size.height - 1;
  }
  m.centre /= m.mass;
  middle /= static_cast<double>(region.size());
  for (const Pixel& p : region) {
    const Eigen::Vector2d off = Eigen::Vector2d(p.x, p.y) - middle;
    const Eigen::Vector2d arm = Eigen::Vector2d(p.x, p.y) - m.centre;
    m.spread += off * off.transpose();
    m.noise += arm * arm.transpose();
  }
  // A pixel is a square of variance 1/12, so a row of pixels has a width too.
  m.spread = m.spread / static_cast<double>(region.size()) + Eigen::Matrix2d::Identity() / 12.0;
  m.noise /= m.mass * m.mass;
  return m;
}

std::string fault_of(const BlobMoments& m, int area_px, const BlobOptions& options) {
  if (area_px < options.min_area_px) return "the blob is too small";
  if (area_px > options.max_area_px) return "the blob is too large";
  if (m.at_border) return "the blob is cut by the border of the picture";
  const Eigen::Vector2d axes = planar_spectrum_of(m.spread).values.cwiseMax(0).cwiseSqrt();
  if (axes[1] > options.max_elongation * axes[0])
    return "the blob is too long: two markers may have grown together";
  return {};
}

}  // namespace

std::vector<Estimate<MarkerBlob>> find_marker_blobs(ImageView<const std::uint8_t> picture,
                                                    const BlobOptions& options) {
  std::vector<Estimate<MarkerBlob>> blobs;
  if (picture.empty() || options.threshold < 0 || options.threshold > 254) return blobs;
  Image<std::uint8_t> seen(picture.size, 0);
  std::vector<Pixel> region;
  for (int y = 0; y < picture.size.height; ++y)
    for (int x = 0; x < picture.size.width; ++x) {
      if (seen.at(x, y) || picture.at(x, y) <= options.threshold) continue;
      flood(picture, options.threshold, {x, y}, seen, region);
      const int area_px = static_cast<int>(region.size());
      const BlobMoments m = moments_of(picture, options.threshold, region);
      Estimate<MarkerBlob> blob;
      if (auto fault = fault_of(m, area_px, options); !fault.empty()) {
        blob = Estimate<MarkerBlob>::degenerate(fault);
      } else {
        blob.verdict = Verdict::ok();
        blob.covariance = options.sigma_grey * options.sigma_grey * m.noise;
      }
      blob.value = {m.centre, area_px, m.peak};
      blobs.push_back(std::move(blob));
    }
  return blobs;
}

}  // namespace mixrig::estimation
