// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/features/feature_tracks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "extras/map/reconstruction/features/track_align.h"
#include "extras/map/reconstruction/views/rays.h"
#include "hal/base/order_statistics.h"

namespace mixrig::reconstruction {
namespace {

constexpr int kWindow_px = 15, kPyramid = 4;
constexpr float kSame_px = 1;   ///< a feature and a track
constexpr float kApart_px = 7;  ///< tracks, of each other
constexpr double kLeastSigma_px = 0.3, kMostSigma_px = 0.6;
constexpr double kRim_rad = 0.05;         ///< of a fisheye that is not used
constexpr float kBack_px = 0.5;           ///< forward and back
constexpr float kOffKey_px = 1.5;         ///< by the key picture and by the picture before
constexpr std::size_t kLongestKey = 5;    ///< pictures
constexpr std::size_t kRevivedKeys = 12;  ///< that lost tracks are looked for in
constexpr double kLeastLeft = 0.7;

cv::Mat as_mat(ImageView<const std::uint8_t> image) {
  return {image.size.height, image.size.width, CV_8U, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

/// 255 where the camera has rays, and a border's width away from where it has none.
cv::Mat field_of(const geometry::AnyCamera& camera) {
  const Size size = geometry::size_px(camera);
  cv::Mat field(size.height, size.width, CV_8U, cv::Scalar(0));
  constexpr int kBorder_px = 4;
  for (int y = kBorder_px; y < size.height - kBorder_px; ++y)
    for (int x = kBorder_px; x < size.width - kBorder_px; ++x)
      if (ray_of(camera, {x, y}, 1, kRim_rad)) field.at<std::uint8_t>(y, x) = 255;
  return field;
}

bool in_field(const cv::Mat& field, const cv::Point2f& p) {
  const int x = cvRound(p.x), y = cvRound(p.y);
  return x >= 0 && y >= 0 && x < field.cols && y < field.rows && field.at<std::uint8_t>(y, x) != 0;
}

std::vector<Feature> features_of(const cv::Mat& grey, const cv::Mat& field, int most) {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  cv::SIFT::create(most, 3, 0.02)->detectAndCompute(grey, field, points, descriptors);
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].response > points[b].response;
  });
  std::vector<Feature> features;
  for (const std::size_t i : order) {
    Feature f;
    f.px = {points[i].pt.x, points[i].pt.y};
    f.size_px = points[i].size;
    const auto* row = descriptors.ptr<float>(static_cast<int>(i));
    for (std::size_t k = 0; k < f.descriptor.size(); ++k)
      f.descriptor[k] = cv::saturate_cast<std::uint8_t>(row[k]);
    features.push_back(f);
  }
  return features;
}

using Points = std::vector<cv::Point2f>;

/// Sigma (px) of a position found by KLT: from sampling, and from the noise of both pictures' grey
/// values by the window's gradients. `strength`: of cv::cornerMinEigenVal, 4 times the smaller
/// eigenvalue of the mean of the gradients' products, for grey values from 0 to 1.
double sigma_of(const cv::Mat& strength, const cv::Point2f& px, double grey_sigma) {
  const double mean = strength.at<float>(cvRound(px.y), cvRound(px.x)) * 255.0 * 255.0 / 4;
  const double sum = std::max(mean, 1e-9) * kWindow_px * kWindow_px;
  return std::hypot(kLeastSigma_px, grey_sigma * std::sqrt(2 / sum));
}

/// KLT that keeps only what comes back to where it began. Starts at `found`.
std::vector<std::uint8_t> follow(const cv::Mat& from, const cv::Mat& to, const Points& points,
                                 Points& found) {
  std::vector<std::uint8_t> there, back_there;
  std::vector<float> errors;
  const cv::Size window(kWindow_px, kWindow_px);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  cv::calcOpticalFlowPyrLK(from, to, points, found, there, errors, window, kPyramid, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  Points back = points;
  cv::calcOpticalFlowPyrLK(to, from, found, back, back_there, errors, window, kPyramid, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < points.size(); ++i)
    there[i] = there[i] && back_there[i] && cv::norm(back[i] - points[i]) < kBack_px;
  return there;
}

}  // namespace

Image<std::uint8_t> grey_of(ImageView<const Rgb8> picture) {
  Image<std::uint8_t> grey(picture.size);
  for (int y = 0; y < picture.size.height; ++y)
    for (int x = 0; x < picture.size.width; ++x) {
      const Rgb8& c = picture.row(y)[x];
      grey.row(y)[x] = static_cast<std::uint8_t>((299 * c.r + 587 * c.g + 114 * c.b + 500) / 1000);
    }
  return grey;
}

std::vector<Feature> find_features(ImageView<const std::uint8_t> grey,
                                   const geometry::AnyCamera& camera, int most) {
  return features_of(as_mat(grey), field_of(camera), most);
}

struct FeatureTracker::State {
  struct Active {
    int track;
    cv::Point2f px;
    cv::Point2f key_px;  ///< in the last key picture
    double sigma_px;
  };

  geometry::AnyCamera camera;
  TrackingOptions options;
  cv::Mat field;
  Image<std::uint8_t> before;
  std::vector<Active> active;
  std::size_t active_at_key = 0;
  std::vector<std::vector<Active>> at_key;  ///< of each key
  FeatureTracks result;

  void advance(const cv::Mat& grey);
  void align_to_key(const cv::Mat& grey);
  bool is_key() const;
  void revive(const cv::Mat& grey);
  void revive_from(std::size_t key, const cv::Mat& grey, std::vector<char>& live);
  void make_key(const Image<std::uint8_t>& grey);
  void seed(const cv::Point2f& px, const cv::Mat& strength, cv::Mat& free, int feature);
  void see(const Active& a);
};

void FeatureTracker::State::see(const Active& a) {
  result.tracks[static_cast<std::size_t>(a.track)].seen.push_back(
      {static_cast<int>(result.times_s.size()) - 1, {a.px.x, a.px.y}, a.sigma_px});
}

void FeatureTracker::State::advance(const cv::Mat& grey) {
  if (active.empty()) return;
  Points points, found;
  for (const Active& a : active) points.push_back(a.px);
  found = points;
  const auto there = follow(as_mat(before.view()), grey, points, found);
  std::vector<Active> kept;
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (!there[i] || !in_field(field, found[i])) continue;
    kept.push_back(active[i]);
    kept.back().px = found[i];
  }
  active = std::move(kept);
}

void FeatureTracker::State::align_to_key(const cv::Mat& grey) {
  if (active.empty() || result.keys.empty()) return;
  Points points, found;
  for (const Active& a : active) points.push_back(a.key_px), found.push_back(a.px);
  std::vector<std::uint8_t> there;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(as_mat(result.keys.back().grey.view()), grey, points, found, there,
                           errors, {kWindow_px, kWindow_px}, 0,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01},
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (there[i] && cv::norm(found[i] - active[i].px) < kOffKey_px) active[i].px = found[i];
}

bool FeatureTracker::State::is_key() const {
  if (result.keys.empty() ||
      static_cast<double>(active.size()) < kLeastLeft * static_cast<double>(active_at_key))
    return true;
  const int since = static_cast<int>(result.times_s.size()) - 1 - result.keys.back().picture;
  if (since >= static_cast<int>(kLongestKey)) return true;
  std::vector<float> steps;
  for (const Active& a : active) steps.push_back(static_cast<float>(cv::norm(a.px - a.key_px)));
  const double per_rad = geometry::parameters_of(camera)[0];
  return median_in_place(std::span<float>(steps)) > options.key_step_rad * per_rad;
}

/// Tracks that were lost since key `key` are looked for again from its picture.
void FeatureTracker::State::revive_from(std::size_t key, const cv::Mat& grey,
                                        std::vector<char>& live) {
  std::vector<float> steps_x, steps_y;
  std::vector<cv::Point2f> now(result.tracks.size());
  for (const Active& a : active) now[static_cast<std::size_t>(a.track)] = a.px;
  std::vector<int> lost;
  std::vector<double> sigmas_px;
  Points points;
  for (const Active& a : at_key[key]) {
    const auto track = static_cast<std::size_t>(a.track);
    if (live[track] != 0) {
      steps_x.push_back(now[track].x - a.px.x), steps_y.push_back(now[track].y - a.px.y);
    } else {
      lost.push_back(a.track), points.push_back(a.px), sigmas_px.push_back(a.sigma_px);
    }
  }
  if (lost.empty()) return;
  const cv::Point2f step(median_in_place(std::span<float>(steps_x)),
                         median_in_place(std::span<float>(steps_y)));
  Points found;
  for (const cv::Point2f& p : points) found.push_back(p + step);
  const auto there = follow(as_mat(result.keys[key].grey.view()), grey, points, found);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (!there[i] || !in_field(field, found[i])) continue;
    live[static_cast<std::size_t>(lost[i])] = 1;
    active.push_back({lost[i], found[i], found[i], sigmas_px[i]});
    see(active.back());
  }
}

void FeatureTracker::State::revive(const cv::Mat& grey) {
  std::vector<char> live(result.tracks.size(), 0);
  for (const Active& a : active) live[static_cast<std::size_t>(a.track)] = 1;
  const std::size_t keys = at_key.size();
  for (std::size_t back = 1; back <= std::min(keys, kRevivedKeys); ++back)
    if (static_cast<int>(active.size()) < 2 * options.tracks) revive_from(keys - back, grey, live);
}

void FeatureTracker::State::seed(const cv::Point2f& px, const cv::Mat& strength, cv::Mat& free,
                                 int feature) {
  if (!in_field(free, px)) return;
  const double sigma_px = sigma_of(strength, px, options.grey_sigma);
  if (sigma_px > kMostSigma_px) return;
  cv::circle(free, px, static_cast<int>(kApart_px), cv::Scalar(0), cv::FILLED);
  const int track = static_cast<int>(result.tracks.size());
  result.tracks.emplace_back();
  active.push_back({track, px, px, sigma_px});
  see(active.back());
  if (feature >= 0) result.keys.back().track_of_feature[static_cast<std::size_t>(feature)] = track;
}

void FeatureTracker::State::make_key(const Image<std::uint8_t>& grey) {
  KeyPicture key;
  key.picture = static_cast<int>(result.times_s.size()) - 1;
  key.grey = grey;
  const cv::Mat mat = as_mat(grey.view());
  revive(mat);
  key.features = features_of(mat, field, options.features);
  key.track_of_feature.assign(key.features.size(), -1);
  result.keys.push_back(std::move(key));
  KeyPicture& now = result.keys.back();
  cv::Mat free = field.clone(), strength;
  cv::cornerMinEigenVal(mat, strength, kWindow_px);
  for (Active& a : active) {
    a.key_px = a.px;
    cv::circle(free, a.px, static_cast<int>(kApart_px), cv::Scalar(0), cv::FILLED);
  }
  for (std::size_t i = 0; i < now.features.size(); ++i) {
    const cv::Point2f px(static_cast<float>(now.features[i].px.x()),
                         static_cast<float>(now.features[i].px.y()));
    const auto near = std::find_if(active.begin(), active.end(),
                                   [&](const Active& a) { return cv::norm(a.px - px) < kSame_px; });
    if (near != active.end()) {
      now.track_of_feature[i] = near->track;
    } else if (static_cast<int>(active.size()) < options.tracks) {
      seed(px, strength, free, static_cast<int>(i));
    }
  }
  const int room = options.tracks - static_cast<int>(active.size());
  if (room > 0) {
    Points corners;
    cv::goodFeaturesToTrack(mat, corners, room, 0.005, kApart_px, free);
    for (const cv::Point2f& px : corners) seed(px, strength, free, -1);
  }
  active_at_key = active.size();
  at_key.push_back(active);
}

FeatureTracker::FeatureTracker(const geometry::AnyCamera& camera, const TrackingOptions& options)
    : state_(std::make_unique<State>()) {
  state_->camera = camera;
  state_->options = options;
  state_->field = field_of(camera);
}

FeatureTracker::~FeatureTracker() = default;

void FeatureTracker::add(ImageView<const Rgb8> picture, double time_s) {
  State& s = *state_;
  Image<std::uint8_t> grey = grey_of(picture);
  s.result.times_s.push_back(time_s);
  const cv::Mat mat = as_mat(grey.view());
  s.advance(mat);
  s.align_to_key(mat);
  for (const State::Active& a : s.active) s.see(a);
  if (s.is_key()) s.make_key(grey);
  const bool kept = s.result.greys.size() * grey.size().area() < kMostKept_bytes;
  s.result.greys.push_back(kept ? smoothed(grey.view()) : Image<std::uint8_t>());
  s.before = std::move(grey);
}

FeatureTracks FeatureTracker::finish() {
  state_->active.clear(), state_->at_key.clear();
  return std::exchange(state_->result, {});
}

}  // namespace mixrig::reconstruction
