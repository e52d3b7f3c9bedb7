// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/baselines.h"

#include "host/judge/measure/srgb.h"

namespace mixrig::measure {
namespace {

constexpr float kContact_m = 0.02F;

float step_m(float z_m, const DepthSpread& s) {
  const double z = z_m;
  const double sigma_m = s.floor_m + z * (s.linear + z * s.quadratic_per_m);
  return static_cast<float>(std::max(kLeastStep_m, kStepSigmas * sigma_m));
}

bool is_person(float z_m, float background_m, const DepthSpread& spread) {
  return z_m > 0.0F && background_m > 0.0F && z_m < background_m - step_m(background_m, spread);
}

/// Whether people or room lie before the object; what is unknown does not.
bool hides(float real_m, float object_m) { return real_m > 0.0F && real_m < object_m - kContact_m; }

Rgb8 lit(Rgb8 plate, float light) {
  return {srgb_of(light * linear_of(plate.r)), srgb_of(light * linear_of(plate.g)),
          srgb_of(light * linear_of(plate.b))};
}

std::uint8_t over(std::uint8_t object, std::uint8_t plate, int coverage) {
  const float behind = 1.0F - static_cast<float>(coverage) / 255.0F;
  return srgb_of(linear_of(object) + behind * linear_of(plate));
}

Rgb8 over(Rgb8 object, Rgb8 plate, int coverage) {
  return {over(object.r, plate.r, coverage), over(object.g, plate.g, coverage),
          over(object.b, plate.b, coverage)};
}

void compose_row(Baseline baseline, const PlainInputs& in, const DepthSpread& spread, int y,
                 PlainComposite& out) {
  for (int x = 0; x < in.plate.size.width; ++x) {
    const float z_m = in.depth_m.row(y)[x], background_m = in.background_m.row(y)[x];
    const bool person = baseline == Baseline::kDepthKey && is_person(z_m, background_m, spread);
    bool shown = baseline != Baseline::kPlate && in.coverage.row(y)[x] > 0;
    if (baseline == Baseline::kDepthKey)
      shown = shown && !hides(person ? z_m : background_m, in.object_depth_m.row(y)[x]);
    const int coverage = shown ? in.coverage.row(y)[x] : 0;
    out.color.row(y)[x] =
        shown ? over(in.object.row(y)[x], in.plate.row(y)[x], coverage) : in.plate.row(y)[x];
    out.matte.row(y)[x] = person ? 255 : 0;
    out.layer.row(y)[x] = coverage >= 128 ? kLayerVirtual : person ? 1 : 0;
    if (baseline == Baseline::kDepthKey) out.warped_depth_m.row(y)[x] = z_m;
  }
}

void size(Size size, PlainComposite& out) {
  out.color.reset(size);
  out.warped_depth_m.reset(size);
  out.light.reset(size, 1.0F);
  out.matte.reset(size);
  out.layer.reset(size);
}

}  // namespace

const char* name(Baseline baseline) {
  constexpr std::array<const char*, kBaselines.size()> kNames{"plate", "pasted", "depth_key",
                                                              "ideal"};
  return kNames[static_cast<std::size_t>(baseline)];
}

void compose_plainly(Baseline baseline, const PlainInputs& inputs, const DepthSpread& spread,
                     PlainComposite& out) {
  size(inputs.plate.size, out);
  for (int y = 0; y < inputs.plate.size.height; ++y) compose_row(baseline, inputs, spread, y, out);
}

void compose_ideally(ImageView<const Rgb8> plate, const TruthImages& truth, PlainComposite& out) {
  size(plate.size, out);
  for (int y = 0; y < plate.size.height; ++y)
    for (int x = 0; x < plate.size.width; ++x) {
      const auto layer = static_cast<std::uint8_t>(truth.labels.row(y)[x] & kLayerMask);
      const float light = truth.light.row(y)[x];
      out.color.row(y)[x] =
          layer == kLayerVirtual ? truth.color.row(y)[x] : lit(plate.row(y)[x], light);
      out.light.row(y)[x] = light;
      out.matte.row(y)[x] = truth.matte.row(y)[x];
      out.layer.row(y)[x] = layer;
    }
}

}  // namespace mixrig::measure
