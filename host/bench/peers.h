// SPDX-License-Identifier: Apache-2.0
// Functions of other libraries on the input of a suite. peers.cpp in a build with
// MIXRIG_BENCH_PEERS, no_peers.cpp else.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/bench/contender.h"
#include "host/render/compositor.h"

namespace mixrig::bench {

/// Of a frame; views into what outlives the call.
struct PeerInput {
  ImageView<const float> tof_depth_m;  ///< as it is measured
  ImageView<const Rgb8> plate;         ///< in the view, through the lens
  ImageView<const float> warped_m;     ///< our warped depth, 0 unknown
};

/// What a peer makes: one of both, of the view's size.
struct PeerOutput {
  Image<float> depth_m;
  Image<std::uint8_t> matte;
};

struct Peer {
  std::string name;
  std::function<void(const PeerInput&, PeerOutput&)> run;
};

/// What peers know of a take.
struct PeerSetup {
  geometry::CameraModel tof;
  geometry::Pinhole view;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;
  std::vector<Image<Rgb8>> empty_plates;  ///< of the room without people, in the view
};

/// Whether this build has any.
bool has_peers();

/// Those of a suite ("warp", "refine", "key"), each at the setting that was best on the studio's
/// walk, seeds 5 to 9 (docs/bench.md); for others none.
std::vector<Peer> peers_of(const std::string& suite, const PeerSetup& setup);

/// Adds the peers of a suite. Errors: those of compositing the input that they are given.
Result<void> add_peers(const std::string& suite, const session::Session& session,
                       const std::vector<BenchFrame>& frames, const std::vector<Measure>& measures,
                       std::vector<ContenderPtr>& contenders);

}  // namespace mixrig::bench
