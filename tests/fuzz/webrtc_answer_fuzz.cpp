// SPDX-License-Identifier: Apache-2.0
// Messages of the WebRTC socket: an accepted message is written again and means the same.
#include <cstdlib>
#include <string_view>

#include "host/operator/page/webrtc/webrtc_answer.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(webrtc_answer) {
  using namespace mixrig::page;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)parse_peer_message(text);
  const auto answer = parse_webrtc_answer(text);
  if (!answer) return 0;
  const std::string anew = webrtc_answer_text(*answer);
  if (anew.size() > 2048) std::abort();
  const auto again = parse_webrtc_answer(anew);
  if (!again || !(*again == *answer)) std::abort();
  return 0;
}
