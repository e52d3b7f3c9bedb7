// SPDX-License-Identifier: Apache-2.0
// Functions of other libraries that run on the input of a suite. Defined in opencv_peers.cpp in a
// build with MIXRIG_BENCH_PEERS, else in no_peers.cpp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/judge/bench/contender.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {

/// Images of one frame; they must stay valid during the call.
struct PeerInput {
  ImageView<const float> tof_z_m;   ///< along the axis, without the ToF camera's lens; 0 unknown
  ImageView<const Rgb8> plate;      ///< in the view, through the lens
  ImageView<const float> warped_m;  ///< our warped depth, 0 unknown
};

/// Result of a peer: one of the two images, in the view's size.
struct PeerOutput {
  Image<float> depth_m;
  Image<std::uint8_t> matte;
};

struct Peer {
  std::string name;   ///< "rgbd::registerDepth, dilated"
  bool best = false;  ///< best setting of its function's grid; other settings run only with --grid
  std::function<void(const PeerInput&, PeerOutput&)> run;
};

/// Properties of a take that peers need.
struct PeerSetup {
  geometry::Pinhole tof;  ///< without its lens
  geometry::Pinhole view;
  geometry::Pose target_from_tof;
  std::vector<Image<Rgb8>> empty_plates;  ///< pictures of the room without people, in the view
};

/// Whether this build has peers.
bool has_peers();

/// Peers of a suite at every setting of their grids: "warp", "refine", "key" and "pairs", which
/// uses those of "refine"; empty for other suites. Each runs in one thread.
std::vector<Peer> peers_of(const std::string& suite, const PeerSetup& setup);

/// Adds the peers of a suite at their best settings, or with `grid` at all settings. Errors: those
/// of compositing their input.
Result<void> add_peers(const std::string& suite, bool grid, const session::Session& session,
                       const std::vector<BenchFrame>& frames, const std::vector<Measure>& measures,
                       std::vector<ContenderPtr>& contenders);

}  // namespace mixrig::bench
