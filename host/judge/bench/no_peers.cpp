// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/peers.h"

namespace mixrig::bench {

bool has_peers() { return false; }

Result<void> add_peers(const std::string&, bool, const session::Session&,
                       const std::vector<BenchFrame>&, const std::vector<Measure>&,
                       std::vector<ContenderPtr>&) {
  return {};
}

std::vector<Peer> peers_of(const std::string&, const PeerSetup&) { return {}; }

}  // namespace mixrig::bench
