// SPDX-License-Identifier: Apache-2.0
// Sends the motion capture of a studio take as NatNet in real time, while another program plays the
// take. usage: natnet_sender TAKE PORT BEGIN_S [DELAY_MS [JITTER_MS [BODY]]]. BEGIN_S: time of the
// take's first frame on CLOCK_MONOTONIC, play_at_s of rig.toml.
#include "tests/support/natnet_sender.h"

#include <cstdio>
#include <random>

#include "hal/base/clock.h"
#include "tests/support/taken_mocap.h"

int main(int argc, char** argv) {
  using namespace mixrig;
  if (argc < 4) {
    std::fprintf(stderr, "usage: natnet_sender TAKE PORT BEGIN_S [DELAY_MS [JITTER_MS [BODY]]]\n");
    return 2;
  }
  const auto number = [&](int i, double otherwise) {
    return argc > i ? std::atof(argv[i]) : otherwise;
  };
  const double begin_s = number(3, 0), delay_s = 1e-3 * number(4, 30),
               jitter_s = 1e-3 * number(5, 2);
  const int body = static_cast<int>(number(6, 1));
  const auto samples = test::read_taken_mocap(argv[1]);
  if (samples.empty()) {
    std::fprintf(stderr, "natnet_sender: %s has no mocap.txt or truth/rig.json\n", argv[1]);
    return 2;
  }
  test::NatNetSender sender(std::atoi(argv[2]));
  SystemClock clock;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  long sent = 0;
  for (const test::TakenSample& sample : samples) {
    const double at_s = begin_s + sample.time_s + delay_s + jitter_s * share(random);
    clock.sleep_until(HostTime(Duration(std::llround(at_s * 1e9))));
    if (!sender.has_client(0)) continue;
    sender.send(test::packet_of(sample, body));
    ++sent;
  }
  std::printf("%ld of %zu frames sent\n", sent, samples.size());
  return 0;
}
