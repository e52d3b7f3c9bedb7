// SPDX-License-Identifier: Apache-2.0
// Functions of other libraries on the input of a suite. opencv_peers.cpp in a build with
// MIXRIG_BENCH_PEERS, no_peers.cpp else.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/judge/bench/contender.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {

/// Of a frame; views into what outlives the call.
struct PeerInput {
  ImageView<const float> tof_z_m;   ///< along the axis, without the ToF camera's lens; 0 unknown
  ImageView<const Rgb8> plate;      ///< in the view, through the lens
  ImageView<const float> warped_m;  ///< our warped depth, 0 unknown
};

/// What a peer makes, one of both, of the view's size.
struct PeerOutput {
  Image<float> depth_m;
  Image<std::uint8_t> matte;
};

struct Peer {
  std::string name;   ///< "rgbd::registerDepth, dilated"
  bool best = false;  ///< of its function's grid; the others are only for --grid
  std::function<void(const PeerInput&, PeerOutput&)> run;
};

/// What peers know of a take.
struct PeerSetup {
  geometry::Pinhole tof;  ///< without its lens
  geometry::Pinhole view;
  geometry::Pose target_from_tof;
  std::vector<Image<Rgb8>> empty_plates;  ///< of the room without people, in the view
};

/// Whether this build has any.
bool has_peers();

/// Those of a suite ("warp", "refine", "key", and "pairs", which is refine's; of others none), at
/// every setting of the grid. One thread each.
std::vector<Peer> peers_of(const std::string& suite, const PeerSetup& setup);

/// Adds the peers of a suite, each at its best setting, or with `grid` at all. Errors: those of
/// compositing the input that they are given.
Result<void> add_peers(const std::string& suite, bool grid, const session::Session& session,
                       const std::vector<BenchFrame>& frames, const std::vector<Measure>& measures,
                       std::vector<ContenderPtr>& contenders);

}  // namespace mixrig::bench
