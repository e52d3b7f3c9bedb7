// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>
#include <opencv2/video/background_segm.hpp>
#include <opencv2/ximgproc/edge_filter.hpp>

#include "host/judge/bench/peers.h"

namespace mixrig::bench {
namespace {

cv::Matx33d matrix_of(const geometry::Pinhole& p) {
  return {p.fx_px, 0, p.cx_px, 0, p.fy_px, p.cy_px, 0, 0, 1};
}

cv::Size cv_size(Size size) { return {size.width, size.height}; }

/// The picture, blue first; a copy.
cv::Mat bgr_of(ImageView<const Rgb8> plate) {
  cv::Mat bgr(cv_size(plate.size), CV_8UC3);
  for (int y = 0; y < plate.size.height; ++y)
    for (int x = 0; x < plate.size.width; ++x) {
      const Rgb8 c = plate.row(y)[x];
      bgr.at<cv::Vec3b>(y, x) = {c.b, c.g, c.r};
    }
  return bgr;
}

/// Copies depth; values that are not finite or not positive become 0.
void copy_known(const cv::Mat& from, Image<float>& to) {
  to.reset({from.cols, from.rows});
  for (int y = 0; y < from.rows; ++y)
    for (int x = 0; x < from.cols; ++x) {
      const float z = from.at<float>(y, x);
      to.row(y)[x] = std::isfinite(z) && z > 0 ? z : 0;
    }
}

/// Depth registered to the view. The function reads the depth picture in the size of the picture
/// that it makes, past its end where that is larger: both are made as large here.
void register_depth(const PeerSetup& setup, int divisor, bool dilated, const PeerInput& in,
                    PeerOutput& out) {
  const Size tof = in.tof_z_m.size;
  const Size size{setup.view.size_px.width / divisor, setup.view.size_px.height / divisor};
  const cv::Size plane(std::max(size.width, tof.width), std::max(size.height, tof.height));
  cv::Mat z(plane, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int y = 0; y < tof.height; ++y)
    for (int x = 0; x < tof.width; ++x)
      if (const float z_m = in.tof_z_m.row(y)[x]; z_m > 0) z.at<float>(y, x) = z_m;
  cv::Matx44d rt = cv::Matx44d::eye();
  const Eigen::Matrix3d rotation = setup.target_from_tof.rotation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rt(i, j) = rotation(i, j);
    rt(i, 3) = setup.target_from_tof.translation_m[i];
  }
  cv::Mat registered;
  cv::rgbd::registerDepth(matrix_of(setup.tof), matrix_of(session::resized(setup.view, size)),
                          cv::Mat(), rt, z, plane, registered, dilated);
  registered = registered(cv::Rect(0, 0, size.width, size.height)).clone();
  if (divisor > 1)
    cv::resize(registered, registered, cv_size(setup.view.size_px), 0, 0, cv::INTER_NEAREST);
  copy_known(registered, out.depth_m);
}

std::vector<Peer> warp_peers(const PeerSetup& setup) {
  std::vector<Peer> peers;
  for (const int divisor : {1, 2, 3})
    for (const bool dilated : {false, true})
      peers.push_back({fmt::format("rgbd::registerDepth{}{}", dilated ? ", dilated" : "",
                                   divisor > 1 ? fmt::format(", 1/{} size", divisor) : ""),
                       false, [=](const PeerInput& in, PeerOutput& out) {
                         register_depth(setup, divisor, dilated, in, out);
                       }});
  return peers;
}

/// An edge-aware filter of two channels by a guide of 8 bits.
using Filter = std::function<void(const cv::Mat& guide, const cv::Mat& source, cv::Mat& filtered)>;

/// Depth weighed by whether it is known: F(conf z) / F(conf).
void filter_depth(const Filter& filter, const PeerInput& in, PeerOutput& out) {
  constexpr float kLeastWeight = 1e-3F;
  const cv::Mat guide = bgr_of(in.plate);
  cv::Mat source(guide.size(), CV_32FC3), filtered;
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x) {
      const float z_m = in.warped_m.row(y)[x];
      source.at<cv::Vec3f>(y, x) = {z_m, z_m > 0 ? 1.0F : 0.0F, 0};
    }
  filter(guide, source, filtered);
  out.depth_m.reset({source.cols, source.rows});
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x) {
      const auto& f = filtered.at<cv::Vec3f>(y, x);
      out.depth_m.row(y)[x] = f[1] > kLeastWeight ? f[0] / f[1] : 0;
    }
}

/// Silences std::cout, to which the solver prints its iterations.
class SilentOutput {
 public:
  SilentOutput() : before_(std::cout.rdbuf(nullptr)) {}
  SilentOutput(const SilentOutput&) = delete;
  SilentOutput& operator=(const SilentOutput&) = delete;
  ~SilentOutput() { std::cout.rdbuf(before_); }  // clears the state too

 private:
  std::streambuf* before_;
};

/// Solves for the depth with the known as confidence. The solver wants 0..1.
void solve_depth(double space_px, double luma, double lambda, const PeerInput& in,
                 PeerOutput& out) {
  double farthest_m = 0;
  for (int y = 0; y < in.warped_m.size.height; ++y)
    for (int x = 0; x < in.warped_m.size.width; ++x)
      farthest_m = std::max<double>(farthest_m, in.warped_m.row(y)[x]);
  const auto scale = static_cast<float>(1 / std::max(farthest_m, 1e-6));
  const cv::Mat guide = bgr_of(in.plate);
  cv::Mat source(guide.size(), CV_32F), confidence(guide.size(), CV_32F), solved;
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x) {
      const float z_m = in.warped_m.row(y)[x];
      source.at<float>(y, x) = z_m * scale;
      confidence.at<float>(y, x) = z_m > 0 ? 1.0F : 0.0F;
    }
  const SilentOutput silent;
  cv::ximgproc::fastBilateralSolverFilter(guide, source, confidence, solved, space_px, luma, luma,
                                          lambda);
  solved *= farthest_m;
  copy_known(solved, out.depth_m);
}

void add_filter(std::vector<Peer>& peers, std::string name, Filter filter) {
  peers.push_back(
      {std::move(name), false, [filter = std::move(filter)](const PeerInput& in, PeerOutput& out) {
         filter_depth(filter, in, out);
       }});
}

void add_bilateral(std::vector<Peer>& peers) {
  for (const int d : {3, 5, 11, 21})
    for (const double color : {4.0, 8.0, 20.0, 50.0})
      add_filter(peers, fmt::format("ximgproc::jointBilateralFilter d {} color {}", d, color),
                 [=](const cv::Mat& guide, const cv::Mat& source, cv::Mat& filtered) {
                   cv::Mat joint;
                   guide.convertTo(joint, CV_32F);
                   cv::ximgproc::jointBilateralFilter(joint, source, filtered, d, color, d / 2.0);
                 });
}

void add_guided(std::vector<Peer>& peers) {
  for (const int radius : {1, 2, 4, 8})
    for (const double eps : {0.65, 6.5, 65.0})
      add_filter(peers, fmt::format("ximgproc::guidedFilter r {} eps {}", radius, eps),
                 [=](const cv::Mat& guide, const cv::Mat& source, cv::Mat& filtered) {
                   cv::ximgproc::guidedFilter(guide, source, filtered, radius, eps);
                 });
}

void add_global(std::vector<Peer>& peers) {
  for (const double lambda : {1.0, 5.0, 50.0})
    for (const double color : {2.0, 4.0, 8.0})
      add_filter(
          peers,
          fmt::format("ximgproc::fastGlobalSmootherFilter lambda {} color {}", lambda, color),
          [=](const cv::Mat& guide, const cv::Mat& source, cv::Mat& filtered) {
            cv::ximgproc::fastGlobalSmootherFilter(guide, source, filtered, lambda, color);
          });
}

void add_domain(std::vector<Peer>& peers) {
  for (const double space : {2.0, 4.0, 10.0})
    for (const double color : {4.0, 8.0, 20.0})
      add_filter(peers, fmt::format("ximgproc::dtFilter RF space {} color {}", space, color),
                 [=](const cv::Mat& guide, const cv::Mat& source, cv::Mat& filtered) {
                   cv::ximgproc::dtFilter(guide, source, filtered, space, color,
                                          cv::ximgproc::DTF_RF);
                 });
}

void add_solver(std::vector<Peer>& peers) {
  for (const double space : {4.0, 8.0})
    for (const double luma : {2.0, 4.0, 8.0})
      for (const double lambda : {1.0, 8.0})
        peers.push_back(
            {fmt::format("ximgproc::fastBilateralSolverFilter space {} luma {} lambda {}", space,
                         luma, lambda),
             false, [=](const PeerInput& in, PeerOutput& out) {
               solve_depth(space, luma, lambda, in, out);
             }});
}

std::vector<Peer> refine_peers() {
  std::vector<Peer> peers;
  add_bilateral(peers);
  add_guided(peers);
  add_global(peers);
  add_domain(peers);
  add_solver(peers);
  return peers;
}

/// People by colour alone: what differs from the learned plates; shadows are none.
std::vector<Peer> key_peers(const PeerSetup& setup) {
  std::vector<Peer> peers;
  for (const double threshold : {16.0, 32.0, 64.0, 128.0})
    for (const int median_px : {1, 5, 9}) {
      auto model = cv::createBackgroundSubtractorMOG2(
          static_cast<int>(std::max<std::size_t>(setup.empty_plates.size(), 1)), threshold, true);
      cv::Mat mask;
      for (const Image<Rgb8>& plate : setup.empty_plates) model->apply(bgr_of(plate), mask);
      peers.push_back({fmt::format("MOG2 threshold {} median {}", threshold, median_px), false,
                       [=](const PeerInput& in, PeerOutput& out) {
                         cv::Mat people;
                         model->apply(bgr_of(in.plate), people, 0);
                         if (median_px > 1) cv::medianBlur(people, people, median_px);
                         out.matte.reset(in.plate.size);
                         for (int y = 0; y < people.rows; ++y)
                           for (int x = 0; x < people.cols; ++x)
                             out.matte.row(y)[x] = people.at<std::uint8_t>(y, x) == 255 ? 255 : 0;
                       }});
    }
  return peers;
}

/// Whether a setting is the best of its grid (docs/results/bench.md): for a suite of the studio on
/// walk 7, for pairs of colour and disparity on all three.
bool is_best(const std::string& suite, const std::string& name) {
  constexpr std::array kStudio{"rgbd::registerDepth, dilated, 1/2 size",
                               "MOG2 threshold 16 median 5",
                               "ximgproc::jointBilateralFilter d 5 color 8",
                               "ximgproc::guidedFilter r 2 eps 6.5",
                               "ximgproc::fastGlobalSmootherFilter lambda 5 color 4",
                               "ximgproc::dtFilter RF space 4 color 8",
                               "ximgproc::fastBilateralSolverFilter space 4 luma 4 lambda 8"};
  constexpr std::array kPairs{"ximgproc::jointBilateralFilter d 5 color 8",
                              "ximgproc::guidedFilter r 2 eps 6.5",
                              "ximgproc::fastGlobalSmootherFilter lambda 5 color 4",
                              "ximgproc::dtFilter RF space 4 color 8"};
  const auto has = [&](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return suite == "pairs" ? has(kPairs) : has(kStudio);
}

}  // namespace

bool has_peers() { return true; }

std::vector<Peer> peers_of(const std::string& suite, const PeerSetup& setup) {
  cv::setNumThreads(1);
  std::vector<Peer> peers;
  if (suite == "warp") peers = warp_peers(setup);
  if (suite == "refine" || suite == "pairs") peers = refine_peers();
  if (suite == "key") peers = key_peers(setup);
  for (Peer& peer : peers) peer.best = is_best(suite, peer.name);
  return peers;
}

}  // namespace mixrig::bench
