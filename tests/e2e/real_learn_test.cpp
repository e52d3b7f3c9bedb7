// SPDX-License-Identifier: Apache-2.0
// `mixrig learn` and `track --map` on real pictures. A map is learned from every second frame of a
// Kinect in a kitchen, and the frames between are tracked in it; both are compared with the
// published poses, whose error is one to two centimetres. A fisheye whose pictures are too far
// apart must be refused.
#include <numbers>

#include <Eigen/SVD>

#include "host/pose/trajectory/trajectory.h"
#include "tests/e2e/real_take.h"

namespace mixrig::test {
namespace {

using Samples = std::vector<trajectory::TimedPose>;
using Published = std::vector<Eigen::Isometry3d>;

class RealLearn : public RealTakeTest {
 protected:
  Samples samples(const std::string& file) const {
    const auto read = trajectory::read_samples(path(file));
    EXPECT_TRUE(read) << read.error().context;
    return read ? *read : Samples{};
  }
};

/// Fits the mean rotation first, then the mean position: the path is nearly straight, so positions
/// alone do not determine the rotation.
Eigen::Isometry3d world_from_map(const Samples& found, const Published& published) {
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < found.size(); ++i)
    turns += published[i].linear() * found[i].world_from_body.rotation.conjugate();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turns, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d world(
      Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose())));
  Eigen::Vector3d off = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < found.size(); ++i)
    off += published[i].translation() - world * found[i].world_from_body.translation_m;
  world.pretranslate(off / static_cast<double>(found.size()));
  return world;
}

struct PathOff {
  double rms_mm = 0, rms_deg = 0;
};
PathOff off_of(const Samples& found, const Published& published, const Eigen::Isometry3d& world) {
  PathOff off;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const geometry::Pose& pose = found[i].world_from_body;
    const Eigen::Quaterniond turn = Eigen::Quaterniond(world.linear()) * pose.rotation;
    const double deg =
        180 / std::numbers::pi * turn.angularDistance(Eigen::Quaterniond(published[i].linear()));
    off.rms_mm += 1e6 * (world * pose.translation_m - published[i].translation()).squaredNorm();
    off.rms_deg += deg * deg;
  }
  const auto count = static_cast<double>(found.size());
  return {std::sqrt(off.rms_mm / count), std::sqrt(off.rms_deg / count)};
}

TEST_F(RealLearn, AKitchenIsLearnedAndItsKinectFoundInIt) {
  const auto of_known = write_kitchen("known", 0, 2);
  const auto of_unseen = write_kitchen("unseen", 1, 2);
  ASSERT_EQ(mixrig("learn --camera target --take " + path("known/take.toml") + " " + path("map") +
                   " --json " + path("learn.json")),
            0);
  const auto learned = report("learn.json");
  EXPECT_EQ(learned.at("poses"), 6);
  EXPECT_EQ(learned.at("scale"), "metric");
  EXPECT_LT(learned.at("residual_px").get<double>(), 0.6);
  const Samples known = samples("map/path.tum");
  ASSERT_EQ(known.size(), of_known.size());
  const Eigen::Isometry3d world = world_from_map(known, of_known);
  const PathOff off = off_of(known, of_known, world);
  EXPECT_LT(off.rms_mm, 20);
  EXPECT_LT(off.rms_deg, 1);

  ASSERT_EQ(mixrig("track --map " + path("map") + " --take " + path("unseen/take.toml") + " " +
                   path("path.tum") + " --json " + path("track.json")),
            0);
  EXPECT_EQ(report("track.json").at("lost_pct").get<double>(), 0);
  const Samples unseen = samples("path.tum");
  ASSERT_EQ(unseen.size(), of_unseen.size());
  const PathOff tracked = off_of(unseen, of_unseen, world);
  EXPECT_LT(tracked.rms_mm, 20);
  EXPECT_LT(tracked.rms_deg, 1);
  std::printf("learned %.1f mm, %.2f deg RMS; tracked %.1f mm, %.2f deg RMS\n", off.rms_mm,
              off.rms_deg, tracked.rms_mm, tracked.rms_deg);
}

TEST_F(RealLearn, PicturesTooFarApartAreRefused) {
  write_office("office");
  const std::string said = refusal("learn --take " + path("office/take.toml") + " --calibration " +
                                   path("office.toml") + " " + path("map"));
  EXPECT_NE(said.find("can be followed from picture to picture"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("map")));
}

}  // namespace
}  // namespace mixrig::test
