// SPDX-License-Identifier: Apache-2.0
#include "studio/io/fisheye_pictures.h"

#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "host/capture/capture/fisheye.h"

namespace mixrig::studio_io {

void FisheyePictures::add_to(studio::Studio& studio, capture::Capture& capture) {
  using capture::Stream;
  using capture::StreamStatus;
  const int pictures = studio.info().fisheye_pictures;
  if (pictures == 0) return;
  if (!rendered_ && next_.number < pictures) {
    studio.render_fisheye(next_.number + 1, next_);
    rendered_ = true;
  }
  capture::lose_fisheye(capture);
  if (!rendered_ || next_.frame != capture.number) return;
  rendered_ = false;
  std::swap(capture.fisheye, next_.picture);
  capture.fisheye_mid_exposure = HostTime(Duration(std::llround(next_.time_s * 1e9)));
  capture.fisheye_counter = static_cast<std::uint64_t>(next_.number);
  capture.set_status(Stream::kFisheye, StreamStatus::kFresh);
  const Eigen::Vector3d& t = next_.world_from_fisheye.translation_m;
  const Eigen::Vector4d q = next_.world_from_fisheye.rotation.coeffs();
  fmt::format_to(std::back_inserter(truth_), "{:.9f} {:.9f} {:.9f} {:.9f}", next_.time_s, t.x(),
                 t.y(), t.z());
  fmt::format_to(std::back_inserter(truth_), " {:.12f} {:.12f} {:.12f} {:.12f}\n", q[0], q[1], q[2],
                 q[3]);
  fmt::format_to(std::back_inserter(people_), "{},{:.4f}\n", next_.number, next_.people_share);
}

}  // namespace mixrig::studio_io
