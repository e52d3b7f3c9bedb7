// SPDX-License-Identifier: Apache-2.0
// A camera's view of the board.
#include "studio/board/board_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::studio {
namespace {

constexpr int kBoardCameraBand = 16;

/// Share of a pixel's response left of x: a unit square convolved with a Gaussian.
double response(double x, double blur_px) {
  if (blur_px < 1e-3) return std::clamp(x + 0.5, 0.0, 1.0);
  const auto integral = [&](double t) {  // of the normal distribution function
    const double z = t / blur_px;
    return t * 0.5 * std::erfc(-z * std::numbers::sqrt2 / 2) +
           blur_px * std::exp(-0.5 * z * z) * 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2;
  };
  return integral(x + 0.5) - integral(x - 0.5);
}

double quantile(double share, double blur_px) {
  double low = -1 - 6 * blur_px, high = -low;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (response(middle, blur_px) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

struct BoardCamera::View {
  const TraceScene& board;
  const BoardPattern& pattern;
  Vec3 eye;
  Eigen::Matrix3d board_from_camera;
  SampleSteps steps;
};

BoardCamera::BoardCamera(Size size_px, RayFunction ray, double blur_px)
    : size_(size_px), ray_(std::move(ray)), rays_(size_px.area(), Eigen::Vector3f::Zero()) {
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x) {
      Eigen::Vector3d direction;
      if (ray_(x, y, direction))
        rays_[static_cast<std::size_t>(y) * size_.width + x] = direction.cast<float>();
    }
  // Multi-jittered lattice (Chiu, Shirley and Wang 1994): no two samples share a column or a row,
  // so that slanted edges are smooth.
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double a = (i + (j + 0.5) / kSide) / kSide, b = (j + (i + 0.5) / kSide) / kSide;
      const Eigen::Vector2d at(quantile(a, blur_px), quantile(b, blur_px));
      samples_[static_cast<std::size_t>(i) * kSide + j] = at.cast<float>();
      reach_px_ = std::max(reach_px_, static_cast<float>(at.cwiseAbs().maxCoeff()));
    }
}

BoardPixel BoardCamera::centre(const View& view, int x, int y) const {
  BoardPixel pixel;
  const Eigen::Vector3f& ray = this->ray(x, y);
  if (ray.isZero()) return pixel;
  const Vec3 direction = (view.board_from_camera * ray.cast<double>()).cast<float>();
  Hit hit;
  // Seen from the front only.
  if (direction.z() <= 0 || !view.board.intersect(view.eye, direction, 1e9F, hit)) return pixel;
  pixel.board = 1;
  pixel.u_m = hit.uv.x(), pixel.v_m = hit.uv.y();
  pixel.distance_m = hit.t;
  pixel.cosine = std::abs(hit.normal.dot(direction));
  return pixel;
}

void BoardCamera::trace_shares(const View& view, int x, int y, BoardPixel& pixel) const {
  int board = 0, paper = 0, count = 0;
  BoardPixel seen = pixel;
  for (int i = view.steps.border / 2; i < kSamples; i += view.steps.border, ++count) {
    const Vec2& offset = samples_[static_cast<std::size_t>(i)];
    Eigen::Vector3d ray;
    if (!ray_(x + static_cast<double>(offset.x()), y + static_cast<double>(offset.y()), ray))
      continue;
    const Vec3 direction = (view.board_from_camera * ray).cast<float>();
    Hit hit;
    if (direction.z() <= 0 || !view.board.intersect(view.eye, direction, 1e9F, hit)) continue;
    ++board;
    paper += view.pattern.white(hit.uv.x(), hit.uv.y()) ? 1 : 0;
    if (seen.board == 0)
      seen = {1, 0, hit.uv.x(), hit.uv.y(), hit.t, std::abs(hit.normal.dot(direction))};
  }
  pixel = seen;
  pixel.board = static_cast<float>(board) / static_cast<float>(count);
  pixel.paper = static_cast<float>(paper) / static_cast<float>(count);
}

void BoardCamera::find_shares(const View& view, int x, int y, const std::vector<BoardPixel>& pixels,
                              BoardPixel& pixel) const {
  const auto at = [&](int i, int j) -> const BoardPixel& {
    return pixels[static_cast<std::size_t>(j) * size_.width + i];
  };
  const int reach = 1 + static_cast<int>(std::ceil(reach_px_));
  const int x0 = std::max(x - reach, 0), x1 = std::min(x + reach, size_.width - 1);
  const int y0 = std::max(y - reach, 0), y1 = std::min(y + reach, size_.height - 1);
  float around = 0;
  for (const int j : {y0, y, y1})
    for (const int i : {x0, x, x1}) around += at(i, j).board;
  if (around == 0) return;
  if (around < 9) return trace_shares(view, x, y, pixel);
  const int left = std::max(x - 1, 0), right = std::min(x + 1, size_.width - 1);
  const int top = std::max(y - 1, 0), below = std::min(y + 1, size_.height - 1);
  const auto slope = [](const BoardPixel& a, const BoardPixel& b, int n) {
    return Vec2((b.u_m - a.u_m) / static_cast<float>(n), (b.v_m - a.v_m) / static_cast<float>(n));
  };
  const Vec2 dx = slope(at(left, y), at(right, y), right - left);
  const Vec2 dy = slope(at(x, top), at(x, below), below - top);
  const Vec2 half = reach_px_ * (dx.cwiseAbs() + dy.cwiseAbs());
  if (view.pattern.is_one_color(pixel.u_m, pixel.v_m, half.x(), half.y())) {
    pixel.paper = view.pattern.white(pixel.u_m, pixel.v_m) ? 1 : 0;
    return;
  }
  // Each sample is a small box, so that the share changes continuously as an edge moves.
  const Vec2 box = (0.7F / kSide) * (dx.cwiseAbs() + dy.cwiseAbs());
  float paper = 0;
  int count = 0;
  for (int i = view.steps.edge / 2; i < kSamples; i += view.steps.edge, ++count) {
    const Vec2& offset = samples_[static_cast<std::size_t>(i)];
    const Vec2 uv = Vec2(pixel.u_m, pixel.v_m) + offset.x() * dx + offset.y() * dy;
    paper += view.pattern.white_share(uv.x(), uv.y(), box.x(), box.y());
  }
  pixel.paper = paper / static_cast<float>(count);
}

void BoardCamera::trace(const TraceScene& board, const BoardPattern& pattern,
                        const geometry::Pose& camera_from_board, const SampleSteps& steps,
                        Crew& crew, std::vector<BoardPixel>& pixels) {
  const geometry::Pose board_from_camera = geometry::inverse(camera_from_board);
  const View view{board, pattern, board_from_camera.translation_m.cast<float>(),
                  board_from_camera.rotation.toRotationMatrix(), steps};
  std::vector<BoardPixel> centres(size_.area());
  pixels.resize(size_.area());
  const auto index = [&](int x, int y) { return static_cast<std::size_t>(y) * size_.width + x; };
  crew.rows(size_.height, kBoardCameraBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size_.width; ++x) centres[index(x, y)] = centre(view, x, y);
  });
  crew.rows(size_.height, kBoardCameraBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size_.width; ++x) {
        BoardPixel& pixel = pixels[index(x, y)];
        pixel = centres[index(x, y)];
        find_shares(view, x, y, centres, pixel);
      }
  });
}

}  // namespace mixrig::studio
