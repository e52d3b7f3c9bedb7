// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/map_finder.h"

#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>

#include "extras/map/reconstruction/views/rays.h"
#include "extras/map/reconstruction/views/resection.h"

namespace mixrig::reconstruction {
namespace {

constexpr int kFeatures = 1000, kMostLooks = 3;
constexpr double kMatchSigma_px = 1.5;
constexpr float kMatchRatio = 0.8F;
constexpr std::size_t kFewestMatches = 15;

/// The first, middle and last descriptor of each point: what one key picture after another adds
/// differs little.
std::vector<MapDescriptor> some_of(const std::vector<MapDescriptor>& all, std::size_t points) {
  std::vector<std::vector<std::size_t>> of_point(points);
  for (std::size_t i = 0; i < all.size(); ++i)
    of_point[static_cast<std::size_t>(all[i].point)].push_back(i);
  std::vector<MapDescriptor> some;
  for (const auto& looks : of_point) {
    const std::size_t count = std::min<std::size_t>(looks.size(), kMostLooks);
    for (std::size_t i = 0; i < count; ++i)
      some.push_back(all[looks[count == 1 ? 0 : i * (looks.size() - 1) / (count - 1)]]);
  }
  return some;
}

template <typename Items>
cv::Mat matrix_of(const Items& items,
                  const Descriptor& (*descriptor)(const typename Items::value_type&)) {
  cv::Mat matrix(static_cast<int>(items.size()), static_cast<int>(Descriptor{}.size()), CV_32F);
  for (std::size_t i = 0; i < items.size(); ++i)
    std::copy(descriptor(items[i]).begin(), descriptor(items[i]).end(),
              matrix.ptr<float>(static_cast<int>(i)));
  return matrix;
}

Image<std::uint8_t> bytes_of(const Image<float>& grey) {
  Image<std::uint8_t> bytes(grey.size());
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x)
      bytes.row(y)[x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(grey.row(y)[x]), 0L, 255L));
  return bytes;
}

}  // namespace

MapFinder::MapFinder(const LearnedMap& map, const tracking::PatchMap& patches,
                     const geometry::AnyCamera& camera, const tracking::AlignOptions& options)
    : descriptors_(some_of(map.descriptors, map.points.size())),
      patches_(patches),
      camera_(camera),
      options_(options) {
  for (const MapPoint& p : map.points) places_.push_back(p.place);
}

std::optional<tracking::PatchFit> MapFinder::find(const tracking::GreyPyramid& picture,
                                                  const tracking::SearchField&) const {
  const Image<std::uint8_t> grey = bytes_of(picture.level(0));
  const std::vector<Feature> features = find_features(grey.view(), camera_, kFeatures);
  if (features.size() < kFewestMatches || descriptors_.size() < kFewestMatches) return std::nullopt;
  const cv::Mat seen = matrix_of(
      features, +[](const Feature& f) -> const Descriptor& { return f.descriptor; });
  const cv::Mat known = matrix_of(
      descriptors_, +[](const MapDescriptor& d) -> const Descriptor& { return d.values; });
  std::vector<std::vector<cv::DMatch>> pairs;
  cv::BFMatcher(cv::NORM_L2).knnMatch(seen, known, pairs, kMostLooks + 1);
  std::vector<Eigen::Vector3d> places;
  std::vector<estimation::Bearing> rays;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto point = [&](const cv::DMatch& m) {
      return descriptors_[static_cast<std::size_t>(m.trainIdx)].point;
    };
    const auto& best = pairs[i];
    const auto next = std::find_if(best.begin(), best.end(), [&](const cv::DMatch& m) {
      return point(m) != point(best.front());
    });
    if (best.empty() || (next != best.end() && best[0].distance > kMatchRatio * next->distance))
      continue;
    const auto ray = ray_of(camera_, features[i].px, kMatchSigma_px);
    if (!ray) continue;
    places.push_back(places_[static_cast<std::size_t>(point(best[0]))]);
    rays.push_back(*ray);
  }
  const auto pose = find_pose(places, rays, 3, 1000);
  if (!pose || pose->inliers.size() < kFewestMatches) return std::nullopt;
  tracking::PatchAlign align(patches_, camera_, options_);
  const int coarse = std::min(align.coarsest(), options_.finest + 2);
  const tracking::PatchFit fit =
      align.align(picture, pose->camera_from_map, coarse, options_.finest);
  if (!tracking::explains(fit)) return std::nullopt;
  return fit;
}

}  // namespace mixrig::reconstruction
