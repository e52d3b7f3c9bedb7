// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/virtual_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/render/cpu/virtual/texel_lanes.h"
#include "host/render/cpu/virtual/virtual_surface.h"

namespace mixrig::render::cpu {
namespace {

constexpr FloatLanes kZeroLanes{};
constexpr float kWholeByte = 255, kUnitByte = 127;

/// Samples of kLanes pixels, in the order of kSampleColumn.
struct Samples {
  SampleLanes w;
  std::array<IntLanes, kPixelSamples> item, covered;
};
template <typename T>
std::array<T, kPixelSamples> every_sample(const void* upper, const void* lower) {
  const auto at = [](const void* from, int i) {
    return load<T>(static_cast<const float*>(from) + i * kLanes);
  };
  const T a = at(upper, 0), b = at(upper, 1), c = at(lower, 0), d = at(lower, 1);
  return {every<2, 0>(a, b), every<2, 1>(a, b), every<2, 0>(c, d), every<2, 1>(c, d)};
}
Samples samples_at(const VirtualScratch& scratch, int x, int row) {
  const auto from = [&](const auto& image, int down) {
    return image.row(row + down) + kVirtualSamples * x;
  };
  Samples out;
  out.w = every_sample<FloatLanes>(from(scratch.sample_w, 0), from(scratch.sample_w, 1));
  out.item = every_sample<IntLanes>(from(scratch.sample_item, 0), from(scratch.sample_item, 1));
  for (std::size_t s = 0; s < kPixelSamples; ++s) out.covered[s] = out.w[s] > 0;
  return out;
}

/// Attributes at the samples; normals are times inverse depth.
struct Shown {
  std::array<VectorLanes, kPixelSamples> normal{};
  SampleLanes u{}, v{};
  std::array<IntLanes, kPixelSamples> draw{}, double_sided{};
  bool any_double_sided = false;
};

void show_item(const FrameParams& params, const VirtualScratch& scratch, std::int32_t number, int x,
               int y, const std::array<IntLanes, kPixelSamples>& of_item, Shown& shown) {
  const VirtualScratch::Item& item = scratch.items[static_cast<std::size_t>(number)];
  const VirtualScratch::Surface& surface = scratch.surfaces[static_cast<std::size_t>(number)];
  const Rect& box = item.triangle.box;
  const bool double_sided = params.draws[item.draw].mesh->double_sided;
  shown.any_double_sided |= double_sided;
  const FloatLanes first = lane_numbers() * static_cast<float>(kVirtualSamples) +
                           static_cast<float>(kVirtualSamples * x - box.x0);
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const IntLanes mask = of_item[s];
    if (!any(mask)) continue;
    const FloatLanes dx = first + kSampleColumn[s];
    const float dy = static_cast<float>(kVirtualSamples * y - box.y0) + kSampleRow[s];
    const auto set = [&](const Affine& f, FloatLanes& to) {
      to = mask ? dx * f.a + (f.b * dy + f.c) : to;
    };
    set(surface.normal[0], shown.normal[s].x), set(surface.normal[1], shown.normal[s].y),
        set(surface.normal[2], shown.normal[s].z);
    set(surface.u, shown.u[s]), set(surface.v, shown.v[s]);
    shown.draw[s] = mask ? IntLanes{} + static_cast<std::int32_t>(item.draw) : shown.draw[s];
    if (double_sided) shown.double_sided[s] |= mask;
  }
}

/// Reads the attributes of all samples; false if a mesh does not fit.
bool show(const FrameParams& params, const VirtualScratch& scratch, const Samples& samples, int x,
          int y, Shown& shown) {
  std::array<IntLanes, kPixelSamples> left = samples.covered, of_item;
  for (std::size_t s = 0; s < kPixelSamples; ++s)
    while (const unsigned bits = bits_of(left[s])) {
      const std::int32_t number = samples.item[s][std::countr_zero(bits)];
      if (!scratch.fits[scratch.items[static_cast<std::size_t>(number)].draw]) return false;
      for (std::size_t t = 0; t < kPixelSamples; ++t) {
        of_item[t] = left[t] & (samples.item[t] == number);
        left[t] &= ~of_item[t];
      }
      show_item(params, scratch, number, x, y, of_item, shown);
    }
  return true;
}

/// Unit normals, one vector a sample; zero where nothing is covered.
using NormalLanes = std::array<VectorLanes, kPixelSamples>;
NormalLanes unit_normals(const PinholeParams& view, const Samples& samples, const Shown& shown,
                         int x, int y) {
  NormalLanes out;
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const VectorLanes& n = shown.normal[s];
    const FloatLanes square = n.x * n.x + n.y * n.y + n.z * n.z;
    const IntLanes counted = samples.covered[s] & (square > 0);
    FloatLanes scale = 1 / sqrt(counted ? square : kZeroLanes + 1.0F);
    if (shown.any_double_sided) {
      const float half = 1.0F / kVirtualSamples;
      const FloatLanes u =
          lane_numbers() + (static_cast<float>(x) + half * (kSampleColumn[s] - 0.5F));
      const float v = static_cast<float>(y) + half * (kSampleRow[s] - 0.5F);
      const FloatLanes along = n.x * ((u - view.center_px.x) / view.focal_px.x) +
                               n.y * ((v - view.center_px.y) / view.focal_px.y) + n.z;
      scale = (shown.double_sided[s] & (along > 0)) ? -scale : scale;
    }
    scale = counted ? scale : kZeroLanes;
    out[s] = {n.x * scale, n.y * scale, n.z * scale};
  }
  return out;
}

/// For each sample, whether it counts.
using SampleMask = std::array<IntLanes, kPixelSamples>;

/// Selects the samples of the nearest surface.
SampleMask nearest_surface(const Samples& samples, const NormalLanes& normals, FloatLanes nearest) {
  VectorLanes n{};
  SampleMask is_nearest;
  IntLanes found{};
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const IntLanes is = samples.covered[s] & (samples.w[s] == nearest) & ~found;
    n.x = is ? normals[s].x : n.x, n.y = is ? normals[s].y : n.y, n.z = is ? normals[s].z : n.z;
    is_nearest[s] = is, found |= is;
  }
  SampleMask mask;
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const VectorLanes& m = normals[s];
    const IntLanes like = (n.x * m.x + n.y * m.y + n.z * m.z >= kOneSurfaceCosine) &
                          (samples.w[s] >= kOneSurfacePart * nearest);
    mask[s] = samples.covered[s] & (like | is_nearest[s]);
  }
  return mask;
}

IntLanes packed_normal(const VectorLanes& sum) {
  const FloatLanes z = sum.z - 1e-6F;
  const FloatLanes scale = kUnitByte / sqrt(sum.x * sum.x + sum.y * sum.y + z * z);
  const auto byte = [&](FloatLanes f) {
    const FloatLanes scaled = f * scale;
    return truncate(scaled + (scaled < 0 ? kZeroLanes - 0.5F : kZeroLanes + 0.5F)) & 255;
  };
  return byte(sum.x) | byte(sum.y) << 8 | byte(z) << 16;
}

/// Sums over the selected samples.
struct Sums {
  VectorLanes normal{};
  ColorLanes albedo{};
  std::array<FloatLanes, 3> gloss{};  ///< metallic, roughness, specular
  IntLanes count{};
};

/// Sums the materials of all draws that the pixels show, one draw after the other.
Sums sums_of(const FrameParams& params, const Samples& samples, const Shown& shown,
             const NormalLanes& normals, const SampleMask& mask) {
  Sums sums;
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const auto counted = [&](FloatLanes f) { return mask[s] ? f : kZeroLanes; };
    sums.normal.x += counted(normals[s].x), sums.normal.y += counted(normals[s].y),
        sums.normal.z += counted(normals[s].z);
    sums.count -= mask[s];  // true is -1
  }
  SampleMask left = mask;
  for (std::size_t s = 0; s < kPixelSamples; ++s)
    while (const unsigned bits = bits_of(left[s])) {
      const std::int32_t number = shown.draw[s][std::countr_zero(bits)];
      const Draw& draw = params.draws[static_cast<std::size_t>(number)];
      const MeshView& mesh = *draw.mesh;
      SampleLanes counted;
      for (std::size_t t = 0; t < kPixelSamples; ++t) {
        const IntLanes of_draw = left[t] & (shown.draw[t] == number);
        counted[t] = of_draw ? kZeroLanes + 1.0F : kZeroLanes;
        left[t] &= ~of_draw;
      }
      const FloatLanes count = counted[0] + counted[1] + counted[2] + counted[3];
      ColorLanes color{count, count, count};
      if (!mesh.uv.empty() && !mesh.texture.empty())
        color = sum_of_texels(mesh.texture, shown.u, shown.v, samples.w, counted);
      const glm::vec3& base = draw.params.base_color;
      sums.albedo.r += base.r * color.r, sums.albedo.g += base.g * color.g,
          sums.albedo.b += base.b * color.b;
      sums.gloss[0] += mesh.gloss.metallic * count, sums.gloss[1] += mesh.gloss.roughness * count,
          sums.gloss[2] += mesh.gloss.specular * count;
    }
  return sums;
}

/// Sums converted to the layer's formats.
class Packed {
 public:
  explicit Packed(const Sums& sums)
      : normal_(packed_normal(sums.normal) | sums.count * kSampleShare << 24),
        albedo_{fixed(sums.albedo.r), fixed(sums.albedo.g), fixed(sums.albedo.b)} {
    const FloatLanes count = max(to_float(sums.count), kZeroLanes + 1.0F);
    for (std::size_t i = 0; i < gloss_.size(); ++i)
      gloss_[i] = truncate(
          kWholeByte * min(max(sums.gloss[i] / count, kZeroLanes), kZeroLanes + 1.0F) + 0.5F);
  }
  IntLanes normal() const { return normal_; }
  Rgbx16 albedo(int i) const {
    const auto of = [i](IntLanes lanes) { return static_cast<std::uint16_t>(lanes[i]); };
    return {of(albedo_[0]), of(albedo_[1]), of(albedo_[2]), 0};
  }
  GlossBytes gloss(int i) const {
    const auto of = [i](IntLanes lanes) { return static_cast<std::uint8_t>(lanes[i]); };
    return {of(gloss_[0]), of(gloss_[1]), of(gloss_[2])};
  }

 private:
  static IntLanes fixed(FloatLanes sum) {
    return truncate(min(sum / static_cast<float>(kPixelSamples), kZeroLanes + 1.0F) * kLinearOne +
                    0.5F);
  }
  IntLanes normal_;
  std::array<IntLanes, 3> albedo_, gloss_;
};

void store_nearest(const Packed& packed, IntLanes some, int x, int y, VirtualLayer& layer) {
  PackedNormal* const normal = layer.normal.row(y) + x;
  store(normal, some ? packed.normal() : load<IntLanes>(normal));
  for (unsigned left = bits_of(some); left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    layer.color.row(y)[x + i] = packed.albedo(i);
    if (!layer.gloss.empty()) layer.gloss.row(y)[x + i] = packed.gloss(i);
    if (!layer.emission.empty()) layer.emission.row(y)[x + i] = {};
  }
}

/// Adds other surfaces; the first `done` lanes have theirs already.
void add_others(const Packed& packed, IntLanes some, FloatLanes w, int x, int y, int done,
                VirtualLayer& layer) {
  for (unsigned left = bits_of(some); left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    if (i < done) continue;
    const auto normal = std::bit_cast<PackedNormal>(packed.normal()[i]);
    layer.others.add(y, {x + i, w[i], normal, packed.gloss(i), packed.albedo(i), {}, {}});
  }
}

}  // namespace

VirtualScratch::Surface surface_of(const Draw& draw, const Triangle& triangle,
                                   std::uint32_t first_index) {
  const MeshView& mesh = *draw.mesh;
  const std::uint32_t* index = &mesh.indices[first_index];
  VirtualScratch::Surface out{};
  const auto add = [&](const Affine& share, float value, Affine& to) {
    to.a += share.a * value, to.b += share.b * value, to.c += share.c * value;
  };
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Affine& share = triangle.share[corner];
    const glm::vec3 normal = draw.params.camera_from_object_normal * mesh.normals[index[corner]];
    for (int axis = 0; axis < 3; ++axis)
      add(share, normal[axis], out.normal[static_cast<std::size_t>(axis)]);
    if (mesh.uv.empty()) continue;
    add(share, mesh.uv[index[corner]].x, out.u), add(share, mesh.uv[index[corner]].y, out.v);
  }
  return out;
}

bool fits_lanes(const MeshView& mesh) {
  return mesh.normal_map.empty() && mesh.gloss_map.empty() && mesh.emission == glm::vec3(0) &&
         fits_lanes(mesh.texture);
}

bool resolve_lanes(const FrameParams& params, const VirtualScratch& scratch, int x, int y,
                   int sample_row, int done, VirtualLayer& layer) {
  const Samples samples = samples_at(scratch, x, sample_row);
  Shown shown;
  if (!show(params, scratch, samples, x, y, shown)) return false;
  const auto& covered = samples.covered;
  const IntLanes count = -(covered[0] + covered[1] + covered[2] + covered[3]);  // true is -1
  const auto white = static_cast<std::int32_t>(kWholeByte);
  store(layer.coverage.row(y) + x,
        to_bytes((white * count + kPixelSamples / 2) / static_cast<std::int32_t>(kPixelSamples)));
  const FloatLanes nearest = max(max(samples.w[0], samples.w[1]), max(samples.w[2], samples.w[3]));
  store(layer.w.row(y) + x, nearest);
  const IntLanes some = count > 0;
  if (!any(some)) return true;
  const NormalLanes normals = unit_normals(params.draws[0].params.view, samples, shown, x, y);
  const SampleMask mask = nearest_surface(samples, normals, nearest);
  store_nearest(Packed(sums_of(params, samples, shown, normals, mask)), some, x, y, layer);
  SampleMask rest;
  FloatLanes rest_w{};
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    rest[s] = covered[s] & ~mask[s];
    rest_w = max(rest_w, rest[s] ? samples.w[s] : kZeroLanes);
  }
  const IntLanes two = rest_w > 0;
  if (any(two))
    add_others(Packed(sums_of(params, samples, shown, normals, rest)), two, rest_w, x, y, done,
               layer);
  return true;
}

}  // namespace mixrig::render::cpu
