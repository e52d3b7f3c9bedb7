// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/calibrate/drawn_board.h"

#include <cmath>

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

namespace mixrig::test {

using calibration::BoardKind;
using calibration::BoardSpec;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// The face of a board: 1 white, 0 black; coordinates in squares from the outer top left corner of
/// a ChArUco or of tag 0's row and column, from point 0 for a checkerboard.
class Face {
 public:
  Face(const BoardSpec& board, bool first_is_white)
      : board_(board), black_(first_is_white ? 1 : 0) {
    if (board.kind == BoardKind::kCharuco) read_markers(cv::aruco::DICT_5X5_250, 1);
    if (board.kind == BoardKind::kAprilgrid) read_markers(cv::aruco::DICT_APRILTAG_36h11, 2);
  }

  double at(double x_m, double y_m) const {
    switch (board_.kind) {
      case BoardKind::kCheckerboard:
        return checkerboard(x_m, y_m);
      case BoardKind::kCharuco:
        return charuco(x_m, y_m);
      default:
        return aprilgrid(x_m, y_m);
    }
  }

 private:
  void read_markers(int dictionary, int border) {
    const auto known = cv::aruco::getPredefinedDictionary(dictionary);
    cells_ = known->markerSize + 2 * border;
    const int count = board_.columns * board_.rows;
    for (int id = 0; id < count; ++id) {
      cv::Mat marker;
      cv::aruco::drawMarker(known, board_.first_tag + id, cells_, marker, border);
      markers_.push_back(marker);
    }
  }
  double checkerboard(double x_m, double y_m) const {
    const int c = static_cast<int>(std::floor(x_m / board_.square_m)),
              r = static_cast<int>(std::floor(y_m / board_.square_m));
    const bool inside = c >= -1 && r >= -1 && c < board_.columns && r < board_.rows;
    return inside && std::abs(c + r) % 2 == black_ ? 0 : 1;
  }
  /// Cell of a marker whose top left corner is the origin; sides run from 0 to 1.
  double marker(int id, double x, double y) const {
    const int c = std::min(static_cast<int>(x * cells_), cells_ - 1),
              r = std::min(static_cast<int>(y * cells_), cells_ - 1);
    return markers_[static_cast<std::size_t>(id)].at<unsigned char>(r, c) > 0 ? 1 : 0;
  }
  double charuco(double x_m, double y_m) const {
    // Point 0 is the inner corner of the first square; markers stand in white squares and count row
    // by row.
    const double x = x_m / board_.square_m + 1, y = y_m / board_.square_m + 1;
    const int c = static_cast<int>(std::floor(x)), r = static_cast<int>(std::floor(y));
    if (c < 0 || r < 0 || c >= board_.columns || r >= board_.rows) return 1;
    if ((c + r) % 2 == black_) return 0;
    const int before = (r * board_.columns + c) / 2;
    const double side = board_.marker_m / board_.square_m, margin = (1 - side) / 2;
    const double u = (x - c - margin) / side, v = (y - r - margin) / side;
    return u < 0 || v < 0 || u >= 1 || v >= 1 ? 1 : marker(before, u, v);
  }
  double aprilgrid(double x_m, double y_m) const {
    const double step = board_.square_m + board_.gap_m;
    const int c = static_cast<int>(std::floor(x_m / step)),
              r = static_cast<int>(std::floor(y_m / step));
    const double x = x_m - c * step, y = y_m - r * step;
    if (c >= 0 && r >= 0 && c < board_.columns && r < board_.rows && x < board_.square_m &&
        y < board_.square_m)
      return marker((board_.rows - 1 - r) * board_.columns + c, x / board_.square_m,
                    y / board_.square_m);
    // Little black squares where four gaps meet touch the tags' corners.
    const bool square = x >= board_.square_m && y >= board_.square_m;
    return square && c >= -1 && r >= -1 && c < board_.columns && r < board_.rows ? 0 : 1;
  }

  BoardSpec board_;
  int black_;  ///< column + row of a black square, modulo 2
  std::vector<cv::Mat> markers_;
  int cells_ = 0;
};

}  // namespace

Vector2d DrawnCamera::ray(const Vector2d& px) const {
  const Vector2d d((px.x() - cx_px) / focal_px, (px.y() - cy_px) / focal_px);
  return d / (1 + k * d.squaredNorm());
}

Vector2d DrawnCamera::project(const Vector3d& p) const {
  const Vector2d ideal(p.x() / p.z(), p.y() / p.z());
  const double r = ideal.norm();
  const double root = std::sqrt(1 - 4 * k * r * r);
  const double scale = r < 1e-12 || k == 0 ? 1 : 2 / (1 + root);
  return focal_px * scale * ideal + Vector2d(cx_px, cy_px);
}

Image<std::uint8_t> draw_board(const BoardSpec& board, const DrawnCamera& camera,
                               const geometry::Pose& camera_from_board, const DrawnLook& look,
                               unsigned seed) {
  const Face face(board, look.first_is_white);
  const Eigen::Matrix3d rotation = camera_from_board.rotation.toRotationMatrix();
  Eigen::Matrix3d plane;
  plane << rotation.leftCols<2>(), camera_from_board.translation_m;
  const Eigen::Matrix3d board_from_ray = plane.inverse();
  const auto face_at = [&](double x, double y) {
    const Vector3d at = board_from_ray * camera.ray({x, y}).homogeneous();
    return face.at(at.x() / at.z(), at.y() / at.z());
  };
  // Averages over the pixel's area; one sample suffices where its corners and middle are alike.
  const auto mean_face = [&](int x, int y) {
    const double here = face_at(x, y);
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += face_at(x + (i % 2) - 0.5, y + (i / 2) - 0.5);
    if (sum == 4 * here) return here;
    constexpr int kSamples = 6;
    sum = 0;
    for (int s = 0; s < kSamples * kSamples; ++s)
      sum += face_at(x + (s % kSamples + 0.5) / kSamples - 0.5,
                     y + (s / kSamples + 0.5) / kSamples - 0.5);
    return sum / (kSamples * kSamples);
  };
  cv::Mat light(camera.size_px.height, camera.size_px.width, CV_32F);
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      const double mean = mean_face(x, y);
      const double shade = 1 - look.shading * x / light.cols;
      light.at<float>(y, x) =
          static_cast<float>(shade * (look.black + (look.white - look.black) * mean));
    }
  if (look.blur_px > 0) cv::GaussianBlur(light, light, {0, 0}, look.blur_px);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, look.noise);
  Image<std::uint8_t> image(camera.size_px);
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x)
      image.at(x, y) = cv::saturate_cast<std::uint8_t>(light.at<float>(y, x) + noise(random));
  return image;
}

std::vector<Vector2d> true_px(const BoardSpec& board, const DrawnCamera& camera,
                              const geometry::Pose& camera_from_board) {
  std::vector<Vector2d> px;
  for (const auto& p : board_points_m(board)) px.push_back(camera.project(camera_from_board * p));
  return px;
}

geometry::Pose board_pose(const BoardSpec& board, const Vector3d& turn_rad,
                          const Vector3d& middle_m) {
  const auto points = board_points_m(board);
  Vector3d low = points.front(), high = low;
  for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double angle = turn_rad.norm();
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(angle, angle > 0 ? Vector3d(turn_rad / angle) : Vector3d::UnitZ()));
  return {rotation, middle_m - rotation * (0.5 * (low + high))};
}

std::vector<geometry::Pose> varied_poses(const BoardSpec& board, int count, unsigned seed,
                                         double distance_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double z = distance_m * (1 + 0.25 * unit(random));
    const double around = 2.4 * i;  // the golden angle spreads tilts and places evenly
    const Vector3d turn(0.55 * std::cos(around), 0.55 * std::sin(around), 0.3 * unit(random));
    poses.push_back(board_pose(
        board, turn, {0.22 * z * std::cos(1.7 * around), 0.13 * z * std::sin(1.3 * around), z}));
  }
  return poses;
}

}  // namespace mixrig::test
