// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/srt_keys.h"

#include <algorithm>
#include <array>
#include <string>

namespace mixrig::output {
namespace {

/// Keys of an SRT address that srtsink of GStreamer 1.22 knows.
constexpr std::array<std::string_view, 37> kSrtKeys{"mode",
                                                    "passphrase",
                                                    "pbkeylen",
                                                    "latency",
                                                    "streamid",
                                                    "localaddress",
                                                    "localport",
                                                    "poll-timeout",
                                                    "transtype",
                                                    "maxbw",
                                                    "inputbw",
                                                    "oheadbw",
                                                    "mss",
                                                    "fc",
                                                    "sndbuf",
                                                    "rcvbuf",
                                                    "conntimeo",
                                                    "lossmaxttl",
                                                    "rcvlatency",
                                                    "peerlatency",
                                                    "tlpktdrop",
                                                    "snddropdelay",
                                                    "nakreport",
                                                    "minversion",
                                                    "packetfilter",
                                                    "congestion",
                                                    "messageapi",
                                                    "payloadsize",
                                                    "kmrefreshrate",
                                                    "kmpreannounce",
                                                    "peeridletimeo",
                                                    "ipttl",
                                                    "iptos",
                                                    "tsbpdmode",
                                                    "drifttracer",
                                                    "retransmitalgo",
                                                    "enforcedencryption"};

Error srt_error(std::string what) { return {ErrorCode::kUsage, std::move(what)}; }

Result<void> check_value(std::string_view key, std::string_view value) {
  if (key == "mode" && value != "caller" && value != "listener" && value != "rendezvous")
    return srt_error("mode is caller, listener or rendezvous");
  if (key == "passphrase" && (value.size() < 10 || value.size() > 79))
    return srt_error("the passphrase has 10 to 79 characters");
  if (key == "pbkeylen" && value != "16" && value != "24" && value != "32")
    return srt_error("pbkeylen is 16, 24 or 32 bytes");
  return {};
}

}  // namespace

Result<bool> srt_calls(std::string_view query) {
  bool calls = true;
  while (!query.empty()) {
    query.remove_prefix(1);  // ? or &
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(pair.size());
    const std::string_view key = pair.substr(0, pair.find('='));
    const std::string_view value = pair.substr(std::min(key.size() + 1, pair.size()));
    if (std::find(kSrtKeys.begin(), kSrtKeys.end(), key) == kSrtKeys.end())
      return srt_error("SRT has no key \"" + std::string(key) +
                       "\": most use mode, passphrase, pbkeylen, latency, streamid, localaddress or "
                       "localport");
    MIXRIG_TRY(check_value(key, value));
    if (key == "mode") calls = value == "caller";
  }
  return calls;
}

}  // namespace mixrig::output
