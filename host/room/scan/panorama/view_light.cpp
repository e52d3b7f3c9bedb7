// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/view_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "hal/base/order_statistics.h"
#include "hal/base/srgb.h"
#include "host/capture/capture/bracket.h"

namespace mixrig::model {
namespace {

constexpr std::size_t kLeastSamples = 300;   ///< of a median that counts
constexpr std::size_t kMostSamples = 20000;  ///< of a view and a pair of exposures, about
constexpr double kUnbelievable = 1.5;
constexpr float kFullWell = 10000, kReadNoise = 8;  ///< electrons
constexpr float kAgreeSigmas = 4, kAgreeShare = 0.02F;
constexpr int kLightGrain = 8;

using Exposures = std::pair<double, double>;  ///< nominal, the longer first

/// A plate at an exposure over that of the frames.
struct ExposedPlate {
  double exposure = 1;
  const Image<Rgb8>* plate = nullptr;
};

/// The view's own plate among the others, the longest exposure first.
std::vector<ExposedPlate> plates_of(const ScanView& view) {
  std::vector<ExposedPlate> plates{{1, &view.plate}};
  for (const ScanView::Bracket& b : view.brackets)
    if (b.plate.size() == view.plate.size()) plates.push_back({b.exposure, &b.plate});
  std::stable_sort(plates.begin(), plates.end(), [](const ExposedPlate& a, const ExposedPlate& b) {
    return a.exposure > b.exposure;
  });
  return plates;
}

std::map<Exposures, std::vector<float>> log_ratios(std::span<const ScanView> views) {
  std::map<Exposures, std::vector<float>> of;
  for (const ScanView& view : views) {
    const std::vector<ExposedPlate> plates = plates_of(view);
    const int stride = 1 + static_cast<int>(3 * view.plate.size().area() / kMostSamples);
    for (std::size_t i = 1; i < plates.size(); ++i)
      capture::add_log_ratios(plates[i - 1].plate->view(), plates[i].plate->view(), stride,
                              of[{plates[i - 1].exposure, plates[i].exposure}]);
  }
  return of;
}

/// Middle of the ratios of what has stayed. The median of all is off by what moved, on one side;
/// what differs from it by more than its scatter explains is left out, again and again.
double middle_of(std::vector<float>& logs) {
  constexpr int kRounds = 5;
  constexpr float kStays = 4 * 1.4826F;  // four sigmas, over the median of the deviations
  constexpr float kLeastSpread = 1e-3F;
  std::vector<float> off;
  float middle = upper_median_in_place(std::span(logs));
  for (int i = 0; i < kRounds; ++i) {
    off.clear();
    for (const float l : logs) off.push_back(std::abs(l - middle));
    const float gate = kStays * std::max(kLeastSpread, upper_median_in_place(std::span(off)));
    std::erase_if(logs, [&](float l) { return std::abs(l - middle) > gate; });
    middle = upper_median_in_place(std::span(logs));
  }
  return middle;
}

/// Measures `to`, which is one step away from `from` in the chain.
void measure_step(const FoundExposure& from, std::vector<float>& logs, FoundExposure& to) {
  const double nominal = to.nominal / from.nominal;
  if (logs.size() >= kLeastSamples) {
    const double ratio = std::exp(middle_of(logs));
    to.measured = from.measured * (to.nominal < from.nominal ? ratio : 1 / ratio);
    to.samples = logs.size();
  } else {  // n is exposed as (n + offset) / (1 + offset)
    const double offset =
        from.nominal == 1 ? 0 : (from.measured - from.nominal) / (1 - from.measured);
    to.measured = (to.nominal + offset) / (1 + offset);
  }
  const double ratio = to.measured / from.measured;
  to.used = from.used && std::abs(std::log(ratio / nominal)) < std::log(kUnbelievable);
}

struct Merge {
  const Image<Rgb8>* plate = nullptr;
  float per_light = 1;                ///< 1 / exposure
  std::array<float, 256> variance{};  ///< of the light at the frames' exposure, by byte
};

Merge merge_of(const ExposedPlate& plate, double measured) {
  const auto& linear = linear_of_srgb_bytes();
  Merge merge{plate.plate, static_cast<float>(1 / measured), {}};
  for (std::size_t i = 0; i < 256; ++i) {
    const float step = linear[std::min<std::size_t>(i + 1, 255)] - linear[i > 0 ? i - 1 : 0];
    const float noise = linear[i] / kFullWell + kReadNoise * kReadNoise / (kFullWell * kFullWell) +
                        step * step / 48;
    merge.variance[i] = noise * merge.per_light * merge.per_light;
  }
  return merge;
}

class LightJoin {
 public:
  explicit LightJoin(std::vector<Merge> merges) : merges_(std::move(merges)) {}

  RgbHalf at(int x, int y) const {
    const Merge* longest = nullptr;
    for (const Merge& m : merges_)
      if (!is_saturated(m.plate->row(y)[x])) {
        longest = &m;
        break;
      }
    if (longest == nullptr) longest = &merges_.back();
    std::array<std::uint16_t, 3> light{};
    for (std::size_t c = 0; c < 3; ++c) light[c] = half_of_float(channel(*longest, x, y, c));
    return {light[0], light[1], light[2]};
  }

 private:
  static bool is_saturated(const Rgb8& c) {
    return std::max({c.r, c.g, c.b}) >= capture::kSaturatedByte;
  }
  static std::size_t byte_of(const Rgb8& c, std::size_t channel) {
    return channel == 0 ? c.r : channel == 1 ? c.g : c.b;
  }

  float channel(const Merge& longest, int x, int y, std::size_t c) const {
    const auto& linear = linear_of_srgb_bytes();
    const std::size_t first = byte_of(longest.plate->row(y)[x], c);
    const float reference = linear[first] * longest.per_light;
    const float own = longest.variance[first];
    float sum = reference / own, weight = 1 / own;
    for (const Merge* m = &longest + 1; m < merges_.data() + merges_.size(); ++m) {
      const std::size_t byte = byte_of(m->plate->row(y)[x], c);
      const float light = linear[byte] * m->per_light, variance = m->variance[byte];
      const float limit = kAgreeSigmas * std::sqrt(own + variance) + kAgreeShare * reference;
      if (std::abs(light - reference) > limit) continue;
      sum += light / variance, weight += 1 / variance;
    }
    return sum / weight;
  }

  std::vector<Merge> merges_;  ///< the longest exposure first
};

void join_view(std::span<const FoundExposure> exposures, ScanView& view, Crew& crew) {
  std::vector<Merge> merges;
  double shortest = 1;
  for (const ExposedPlate& plate : plates_of(view))
    for (const FoundExposure& found : exposures)
      if (found.nominal == plate.exposure && found.used) {
        merges.push_back(merge_of(plate, found.measured));
        shortest = std::min(shortest, found.measured);
      }
  if (merges.size() < 2) return;
  view.light.reset(view.plate.size());
  view.light_limit = linear_of_srgb_bytes()[capture::kSaturatedByte] / static_cast<float>(shortest);
  const LightJoin join(std::move(merges));
  crew.rows(view.plate.height(), kLightGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < view.plate.width(); ++x) view.light.row(y)[x] = join.at(x, y);
  });
}

}  // namespace

std::vector<FoundExposure> find_exposures(std::span<const ScanView> views) {
  auto logs = log_ratios(views);
  std::map<double, FoundExposure, std::greater<>> found;
  for (const ScanView& view : views) {
    if (view.brackets.empty()) continue;
    for (const ExposedPlate& plate : plates_of(view)) {
      found[plate.exposure].nominal = plate.exposure;
      ++found[plate.exposure].views;
    }
  }
  // The pair with the most samples that leads to an exposure, from the frames' outwards.
  const auto follow = [&](auto begin, auto end, bool shorter) {
    for (auto to = begin; to != end; ++to) {
      std::vector<float>* best = nullptr;
      const FoundExposure* from = nullptr;
      for (auto& [pair, samples] : logs) {
        if ((shorter ? pair.second : pair.first) != to->first) continue;
        if (best != nullptr && best->size() >= samples.size()) continue;
        best = &samples, from = &found[shorter ? pair.first : pair.second];
      }
      if (from != nullptr) measure_step(*from, *best, to->second);
    }
  };
  const auto frames = found.find(1.0);
  if (frames == found.end()) return {};
  follow(std::next(frames), found.end(), true);
  follow(std::make_reverse_iterator(frames), found.rend(), false);
  std::vector<FoundExposure> all;
  for (const auto& [nominal, exposure] : found) all.push_back(exposure);
  return all;
}

void join_brackets(std::span<const FoundExposure> exposures, std::span<ScanView> views,
                   Crew& crew) {
  for (ScanView& view : views) {
    if (!view.brackets.empty()) join_view(exposures, view, crew);
    view.brackets.clear();
  }
}

}  // namespace mixrig::model
