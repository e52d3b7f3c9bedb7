// SPDX-License-Identifier: Apache-2.0
// The compositor: what it needs once, what it takes and gives per frame. Two back ends draw the
// same passes (host/render/README.md): cpu and gles.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/geometry/camera_model.h"
#include "host/geometry/pose.h"

namespace mixrig::render {

/// Triangles of one material, borrowed from the scene for the compositor's life. Object axes.
struct MeshView {
  std::span<const glm::vec3> positions_m;
  std::span<const glm::vec3> normals;  ///< unit
  std::span<const glm::vec2> uv;       ///< empty without texture; v grows downwards
  std::span<const std::uint32_t> indices;
  glm::vec3 base_color{1};        ///< linear
  ImageView<const Rgb8> texture;  ///< sRGB, may be empty; repeats
  bool double_sided = false;
};

struct VirtualObject {
  std::vector<MeshView> meshes;
  geometry::Pose world_from_object;
  double scale = 1.0;
  bool casts_shadow = true;
};

/// As scene::Lamp.
struct Lamp {
  glm::dvec3 position_m{0};
  std::optional<glm::dvec3> direction;
  glm::dvec2 size_m{0};
  glm::vec3 intensity{1};
};

struct Light {
  glm::vec3 ambient{0.3F};
  float exposure = 1.0F;
  std::vector<Lamp> lamps;
};

/// Empty room in the view; borrowed. Empty images where nothing was learned yet.
struct BackgroundView {
  ImageView<const float> depth_m;  ///< 0 unknown
  ImageView<const float> depth_sigma_m;
  ImageView<const Rgbf> color;  ///< linear
  ImageView<const float> color_sigma;
};

struct KeyParams {
  float threshold_m = 0.05F;
  float noise_factor = 4.0F;
  bool color = true;
};

/// Standard deviation of one ToF value at z: floor + linear z + quadratic z^2.
struct NoiseParams {
  float floor_m = 0.005F, linear = 0.002F, quadratic_per_m = 0.001F;
};

struct CaptureBox {
  glm::dvec3 min_m{0}, max_m{0};  ///< world
};

/// All that holds for a take. The compositor copies or uploads what it needs, except meshes,
/// textures and background, which are borrowed.
struct CompositorSetup {
  geometry::CameraModel target;  ///< the plate, with its lens
  geometry::Pinhole view;        ///< what is composited: ideal, any size
  geometry::CameraModel tof;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;  ///< along the ray, not along z
  NoiseParams noise;
  BackgroundView background;
  std::vector<VirtualObject> objects;
  Light light;
  KeyParams key;
  std::optional<CaptureBox> capture_box;
};

struct FrameInput {
  ImageView<const Rgb8> plate;         ///< sRGB, distorted, size of `target`
  ImageView<const float> tof_depth_m;  ///< size of `tof`; 0, NaN, infinite or negative = unknown
  geometry::Pose world_from_target;
};

/// What the key says of a pixel of the real scene.
enum class PixelState : std::uint8_t { kUnknown = 0, kBackground = 1, kForeground = 2, kEdge = 3 };

/// What fills at least half of a pixel of the composite: the layer that mixed depth is of.
enum class Layer : std::uint8_t { kBackground = 0, kPerson = 1, kVirtual = 2 };

/// All images have the view's size; kept between frames, so nothing allocates after the first.
struct FrameOutput {
  Image<Rgb8> color;               ///< the composite, sRGB
  Image<float> mixed_depth_m;      ///< z of what is visible, 0 unknown
  Image<float> segmented_depth_m;  ///< z of people, 0 elsewhere
  Image<std::uint8_t> matte;       ///< people, 255 = all
  bool inspect = false;            ///< fill the images below too
  Image<float> warped_depth_m;     ///< ToF depth in the view before keying, 0 unknown
  Image<std::uint8_t> state;       ///< PixelState
  Image<float> light;              ///< light map, 0..1
  Image<std::uint8_t> layer;       ///< Layer
};

enum class Stage {
  kUpload,
  kPlate,
  kCorrect,
  kWarp,
  kVirtual,
  kShadow,
  kKey,
  kLight,
  kMix,
  kReadback,
  kCount
};
std::string_view name(Stage stage);

/// Wall time of each stage of the last frame, milliseconds; 0 for a stage that did not run.
using StageTimes = std::array<float, static_cast<std::size_t>(Stage::kCount)>;

/// Composites frames of one take. Not thread-safe; gles instances stay on the thread that made
/// them.
class Compositor {
 public:
  virtual ~Compositor() = default;
  /// Errors: kData for images of a wrong size.
  virtual Result<void> compose(const FrameInput& input, FrameOutput& output) = 0;
  virtual const StageTimes& stage_times() const = 0;
  /// "cpu, 2 threads, x86-64-v3 (AVX2, 8 lanes)" or GL_RENDERER.
  virtual std::string renderer() const = 0;
};

enum class Backend { kAuto, kGles, kCpu };

/// Checks a setup: sizes that agree, valid cameras, finite lamps. Both back ends call it first.
Result<void> validate(const CompositorSetup& setup);

}  // namespace mixrig::render
