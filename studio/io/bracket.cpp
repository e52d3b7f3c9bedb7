// SPDX-License-Identifier: Apache-2.0
#include "studio/io/bracket.h"

#include <optional>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/math/image_io/image_io.h"
#include "studio/io/moving_rig.h"

namespace mixrig::studio_io {

capture::ExposureLimits exposure_limits() {
  constexpr studio::ExposureControl kControl;
  return {kControl.least_s, kControl.most_s, kControl.step_s};
}

Result<void> add_bracket(studio::Studio& studio, int frame, const Image<Rgb8>& plate,
                         const std::filesystem::path& folder, std::vector<take::BracketRow>& rows) {
  constexpr studio::ExposureControl kControl;
  for (const auto next : {capture::shorter_exposure, capture::longer_exposure}) {
    studio::Frame again;
    again.color = plate;
    double exposure_s = kControl.rest_s;
    while (const auto s = next(again.color.view(), exposure_s, exposure_limits())) {
      exposure_s = *s;
      studio.set_exposure(kControl.factor(exposure_s));
      studio.render(frame, again);
      rows.push_back({frame, exposure_s, kControl.rest_s});
      MIXRIG_TRY(
          take::write_bracket_plate(folder, static_cast<int>(rows.size()), again.color.view()));
    }
  }
  studio.set_exposure(1);
  return {};
}

Result<void> write_bracket(studio::Studio& studio, const std::vector<take::BracketRow>& rows,
                           const std::filesystem::path& folder) {
  if (!rows.empty()) MIXRIG_TRY(write_file(folder / take::kBracketTable, take::bracket_text(rows)));
  Image<Rgbf> light(Size{1440, 720});
  studio.room_light(world_from_base(studio.info()), light);
  std::vector<image_io::Channel> channels;
  for (const auto& [name, value] : {std::pair{"R", &Rgbf::r}, {"G", &Rgbf::g}, {"B", &Rgbf::b}}) {
    image_io::Channel& channel = channels.emplace_back(name, Image<float>(light.size()));
    for (int y = 0; y < light.height(); ++y)
      for (int x = 0; x < light.width(); ++x) channel.pixels.at(x, y) = light.at(x, y).*value;
  }
  return image_io::write_exr(folder / "truth/light.exr", channels);
}

}  // namespace mixrig::studio_io
