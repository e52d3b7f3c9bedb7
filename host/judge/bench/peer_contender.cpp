// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string_view>
#include <utility>

#include "host/judge/baselines/judge.h"
#include "host/judge/bench/peers.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {
namespace {

/// The input of all peers of a suite, made once and not timed.
struct PeerFrame {
  Image<float> tof_z_m, warped_m;
  Image<Rgb8> plate;
  PeerInput input() const { return {tof_z_m, plate, warped_m}; }
};
using PeerFrames = std::vector<PeerFrame>;

class PeerContender final : public Contender {
 public:
  PeerContender(Peer peer, std::shared_ptr<const PeerFrames> inputs,
                const std::vector<BenchFrame>& frames, std::vector<Measure> measures)
      : peer_(std::move(peer)),
        inputs_(std::move(inputs)),
        frames_(frames),
        measures_(std::move(measures)) {}

  Result<float> time(std::size_t index) override {
    const HostTime begin = clock_.now();
    peer_.run((*inputs_)[index].input(), output_);
    return static_cast<float>(milliseconds(clock_.now() - begin));
  }

  /// Judges a peer's output. An image that it does not make counts as nobody, unknown depth and
  /// full light.
  Result<void> judge(std::size_t index) override {
    const PeerFrame& frame = (*inputs_)[index];
    peer_.run(frame.input(), output_);
    const Size size = frame.plate.size();
    has_depth_ = !output_.depth_m.empty();
    if (!has_depth_) no_depth_m_.reset(size);
    if (output_.matte.empty()) no_matte_.reset(size);
    light_.reset(size, 1.0F), layer_.reset(size);
    return judge_.add(
        frames_[index].truth,
        measure::ResultImages{frame.plate, has_depth_ ? output_.depth_m : no_depth_m_,
                              output_.matte.empty() ? no_matte_ : output_.matte, light_, layer_});
  }

  Row row() const override {
    Row row;
    row.name = peer_.name, row.group = "OpenCV", row.peer = true;
    add_errors(judge_.errors(), has_depth_, has_depth_ ? std::vector<Measure>{} : measures_, row);
    return row;
  }

 private:
  Peer peer_;
  std::shared_ptr<const PeerFrames> inputs_;
  const std::vector<BenchFrame>& frames_;
  std::vector<Measure> measures_;
  PeerOutput output_;
  Image<float> no_depth_m_, light_;
  Image<std::uint8_t> no_matte_, layer_;
  bool has_depth_ = false;
  session::Judge judge_;
  SystemClock clock_;
};

/// The ToF picture of a pinhole without lens, by the nearest pixel.
Image<float> without_lens(const render::CompositorSetup& setup, const Image<float>& depth_m) {
  const geometry::Pinhole& pinhole = setup.tof.pinhole;
  Image<float> z_m(pinhole.size_px);
  for (int y = 0; y < z_m.height(); ++y)
    for (int x = 0; x < z_m.width(); ++x) {
      const Eigen::Vector2d ray = pinhole.unproject(Eigen::Vector2d(x, y));
      const auto px = setup.tof.project({ray.x(), ray.y(), 1.0});
      if (!px) continue;
      const long u = std::lround(px->x()), v = std::lround(px->y());
      if (u < 0 || v < 0 || u >= depth_m.width() || v >= depth_m.height()) continue;
      const double along = setup.depth_is_distance ? std::hypot(ray.x(), ray.y(), 1.0) : 1.0;
      const float d = depth_m.row(static_cast<int>(v))[u];
      z_m.row(y)[x] = std::isfinite(d) && d > 0 ? static_cast<float>(d / along) : 0;
    }
  return z_m;
}

/// Plate and warped depth of a frame in the view, by a compositor of nothing else.
Result<PeerFrame> peer_frame(render::Compositor& compositor, const render::CompositorSetup& setup,
                             const Image<Rgb8>& plate, const Image<float>& depth_m,
                             const geometry::Pose& pose) {
  render::FrameOutput output;
  output.wanted = render::kColor | render::kWarpedDepth;
  MIXRIG_TRY(compositor.compose({plate, depth_m, pose}, output));
  return PeerFrame{without_lens(setup, depth_m), std::move(output.warped_depth_m),
                   std::move(output.color)};
}

}  // namespace

Result<void> add_peers(const std::string& suite, bool grid, const session::Session& session,
                       const std::vector<BenchFrame>& frames, const std::vector<Measure>& measures,
                       std::vector<ContenderPtr>& contenders) {
  render::CompositorSetup plain = session.setup;
  plain.objects.clear();
  MIXRIG_ASSIGN(const auto compositor, session::make_compositor(plain, {render::Backend::kCpu, 0}));
  auto inputs = std::make_shared<PeerFrames>();
  for (const BenchFrame& frame : frames) {
    MIXRIG_ASSIGN(PeerFrame input, peer_frame(*compositor, plain, frame.capture.plate,
                                              frame.capture.depth_m, frame.world_from_target));
    inputs->push_back(std::move(input));
  }
  PeerSetup setup{plain.tof.pinhole, plain.view, plain.target_from_tof, {}};
  MIXRIG_ASSIGN(const auto plates, read_empty_plates(session, 25));
  for (const Image<Rgb8>& plate : plates) {
    MIXRIG_ASSIGN(PeerFrame empty,
                  peer_frame(*compositor, plain, plate, Image<float>(plain.tof.size_px()),
                             frames.front().world_from_target));
    setup.empty_plates.push_back(std::move(empty.plate));
  }
  std::vector<Measure> judged;  // a peer does not composite
  for (const Measure& m : measures)
    if (std::string_view(m.key) != "order_wrong_pct") judged.push_back(m);
  for (Peer& peer : peers_of(suite, setup))
    if (grid || peer.best)
      contenders.push_back(
          std::make_unique<PeerContender>(std::move(peer), inputs, frames, judged));
  return {};
}

}  // namespace mixrig::bench
