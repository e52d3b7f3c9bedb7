// SPDX-License-Identifier: Apache-2.0
// Residuals of all pixels of a view: analysis by synthesis (Schiller, Bartczak, Kellner and Koch
// 2010, section 4.1).
#include <algorithm>
#include <cmath>

#include "host/calibrate/rig/depth_terms.h"
#include "host/calibrate/rig/pixel_light.h"
#include "host/calibrate/rig/pixel_motion.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

constexpr double kPixelHuber = 3;     // sigmas
constexpr double kLeastShare = 0.85;  // of the variance that a picture of the board explains
constexpr long kLeastPixels = 200;

/// Sums of the grey residuals of a picture, light eliminated.
Eigen::MatrixXd grey_sums(const Scene& scene, const std::vector<Sample>& samples,
                          const Image<float>& picture, double sigma, const CameraColumns& at) {
  const Light light = solve_light(samples, picture).light;
  RowSum sum(at.count);
  LightSum plain;  // of pixels without an edge: they depend on the light alone
  ProjectedBoardPoint projected;
  for (const Sample& s : samples) {
    const double paper = s.light.dot(light.head<kLight>());
    const double ink = s.light.dot(light.tail<kLight>());
    const double miss = (paper + s.ink * (ink - paper) - picture.at(s.x, s.y)) / sigma;
    const double weight = std::abs(miss) > kPixelHuber ? kPixelHuber / std::abs(miss) : 1;
    if (!s.edge || !project_board_point(scene, s.uv, projected)) {
      plain.add(s.light, s.ink, weight / (sigma * sigma), sigma * miss);
      continue;
    }
    auto row = sum.next();
    // At a fixed pixel the picture moves in the opposite direction.
    add_motion(scene, projected, s.uv, -(ink - paper) * s.ink_by_px, at, row);
    row[at.blur] = (ink - paper) * s.ink_by_blur;
    row.segment<kLight>(at.rest) = (1 - s.ink) * s.light;
    row.segment<kLight>(at.rest + kLight) = s.ink * s.light;
    row.head(at.count) *= std::sqrt(weight) / sigma;
    row[at.count] = std::sqrt(weight) * miss;
  }
  Eigen::MatrixXd all = sum.sum();
  all.block<2 * kLight, 2 * kLight>(at.rest, at.rest) += plain.products();
  all.block<2 * kLight, 1>(at.rest, at.count) += plain.values();
  all.block<1, 2 * kLight>(at.count, at.rest) += plain.values().transpose();
  all(at.count, at.count) += plain.squares();
  // Light is linear: its best values for any step of the rest.
  const int keep = at.rest, total = at.count + 1;
  Eigen::MatrixXd cross(total - 2 * kLight, 2 * kLight), h(total - 2 * kLight, total - 2 * kLight);
  cross.topRows(keep) = all.block(0, keep, keep, 2 * kLight);
  cross.bottomRows(1) = all.block(at.count, keep, 1, 2 * kLight);
  h.topLeftCorner(keep, keep) = all.topLeftCorner(keep, keep);
  h.topRightCorner(keep, 1) = all.block(0, at.count, keep, 1);
  h.bottomLeftCorner(1, keep) = all.block(at.count, 0, 1, keep);
  h(keep, keep) = all(at.count, at.count);
  Eigen::MatrixXd own = all.block(keep, keep, 2 * kLight, 2 * kLight);
  own.diagonal().array() += 1e-9 * own.trace() / (2 * kLight);
  return h - cross * estimation::SymmetricSolver(own).solve(cross.transpose());
}

/// Adds a camera's own sums to those of the view.
void scatter(const Eigen::MatrixXd& own, const CameraColumns& at, const RigLayout& layout,
             std::size_t camera, bool depth, Eigen::MatrixXd& sum) {
  const RigLayout::Camera& place = layout.cameras[camera];
  std::vector<int> to(static_cast<std::size_t>(own.rows()), -1);
  const auto map = [&](int from, int where, int count) {
    for (int i = 0; i < count && where >= 0; ++i) to[from + i] = where + i;
  };
  map(0, place.intrinsics, at.free);
  map(at.extrinsics, place.extrinsics, 6);
  map(at.blur, place.blur, 1);
  map(at.pose, layout.count, 6);
  map(at.bend, layout.bend, 3);
  if (depth) map(at.rest, layout.depth, at.count - at.rest);
  to.back() = layout.count + 6;
  for (Eigen::Index i = 0; i < own.rows(); ++i)
    for (Eigen::Index j = 0; j < own.cols(); ++j)
      if (to[i] >= 0 && to[j] >= 0) sum(to[i], to[j]) += own(i, j);
}

}  // namespace

void PixelTerms::weigh(const RigModel& model, const std::vector<int>& views, Crew& crew) {
  const std::size_t cameras = model.cameras.size();
  weights_.assign(pictures_.size(), std::vector<Weights>(cameras));
  crew.rows(static_cast<int>(views.size() * cameras), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int view = views[i / cameras];
      const std::size_t c = i % cameras;
      const ViewPictures& seen = pictures_[view][c];
      Weights& w = weights_[view][c];
      if (seen.picture.empty()) continue;
      const Scene scene = make_scene(model, print_, c, view);
      w.pixels = pixels_on_board(scene);
      const auto samples = render(scene, w.pixels, !seen.depth_m.empty());
      if (static_cast<long>(samples.size()) < kLeastPixels) continue;
      const LightFit fit = solve_light(samples, seen.picture);
      w.grey = fit.sigma;
      w.contrast = std::abs(samples[samples.size() / 2].light.dot(fit.light.head<kLight>() -
                                                                  fit.light.tail<kLight>()));
      w.used = fit.share > kLeastShare;
      if (seen.depth_m.empty() || model.depth.knots_m.size() < 2) continue;
      const DepthScatter depth = depth_scatter(scene, samples, seen);
      w.paper_m = depth.paper_m, w.ink_m = depth.ink_m;
    }
  });
}

ViewTerm PixelTerms::sums(const RigModel& model, const RigLayout& layout, int view) const {
  ViewTerm term;
  term.sum = Eigen::MatrixXd::Zero(layout.count + 7, layout.count + 7);
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    const Weights& w = weights_[view][c];
    if (!w.used) continue;
    const ViewPictures& seen = pictures_[view][c];
    const Scene scene = make_scene(model, print_, c, view);
    const auto samples = render(scene, w.pixels, !seen.depth_m.empty());
    if (static_cast<long>(samples.size()) < kLeastPixels) continue;
    const CameraColumns at = columns_of(scene.camera, 2 * kLight);
    // The sum without light has its residual where light began.
    scatter(grey_sums(scene, samples, seen.picture, w.grey, at), at, layout, c, false, term.sum);
    term.rows += static_cast<long>(samples.size());
    if (seen.depth_m.empty() || layout.depth < 0) continue;
    const CameraColumns deep =
        columns_of(scene.camera, static_cast<int>(model.depth.knots_m.size()));
    scatter(depth_sums(scene, samples, seen, {w.paper_m, w.ink_m}, deep, term.rows), deep, layout,
            c, true, term.sum);
  }
  return term;
}

ViewFunction PixelTerms::function() const {
  return [this](const RigModel& model, const RigLayout& layout, int view) {
    return sums(model, layout, view);
  };
}

double PixelTerms::grey_rms(int camera) const {
  double squares = 0, pixels = 0;
  for (const auto& view : weights_) {
    const Weights& w = view[static_cast<std::size_t>(camera)];
    if (!w.used) continue;
    const auto n = static_cast<double>(w.pixels.size());
    squares += n * std::pow(w.grey / w.contrast, 2), pixels += n;
  }
  return pixels > 0 ? std::sqrt(squares / pixels) : 0;
}

}  // namespace mixrig::calibration
