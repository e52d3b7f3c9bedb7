// SPDX-License-Identifier: Apache-2.0
// The compositor's interface: its setup, and the input and output of a frame. Two back ends, cpu
// and gles, draw the same passes (docs/method/compositor.md).
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
#include "hal/base/learned_color.h"
#include "hal/base/raw_picture.h"
#include "hal/base/result.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/lamp.h"
#include "host/math/geometry/lens_table.h"
#include "host/math/geometry/pose.h"
#include "host/math/geometry/vignetting.h"

namespace mixrig::render {

/// How a surface mirrors light: metallic-roughness of glTF 2.0.
struct Gloss {
  float metallic = 0, roughness = 1;
  float specular = 0;  ///< scales a dielectric's 4 % at normal incidence; 0: matte
  bool is_matte() const { return metallic == 0 && specular == 0; }
};

/// A triangle mesh of one material, in object axes. The arrays are borrowed from the scene and must
/// outlive the compositor.
struct MeshView {
  std::span<const glm::vec3> positions_m;
  std::span<const glm::vec3> normals;  ///< unit
  std::span<const glm::vec2> uv;       ///< empty without texture; v grows downwards
  std::span<const std::uint32_t> indices;
  glm::vec3 base_color{1};        ///< linear
  ImageView<const Rgb8> texture;  ///< sRGB, may be empty; repeats
  bool double_sided = false;
  Gloss gloss{};
  glm::vec3 emission{0};  ///< linear, at most 1: light that the surface emits
  /// Textures addressed like `texture`, each may be empty. `gloss_map`: its bytes over 255 multiply
  /// roughness (green) and metallic (blue). `normal_map` is glTF's, with tangents derived from the
  /// triangles. `emission_map` is sRGB and multiplies `emission`.
  ImageView<const Rgb8> gloss_map{}, normal_map{}, emission_map{};
  float normal_scale = 1;  ///< multiplies x and y of `normal_map`
};

struct VirtualObject {
  std::vector<MeshView> meshes;
  geometry::Pose world_from_object;
  double scale = 1.0;
  bool casts_shadow = true;
  bool in_set = false;  ///< part of the virtual set: still drawn in frames that hide the objects
};

/// The empty room in the view, without people; borrowed. The images are empty where nothing was
/// learned yet. A colour with a negative red is unknown.
struct BackgroundView {
  ImageView<const float> depth_m;  ///< 0 unknown
  ImageView<const float> depth_sigma_m;
  ImageView<const Rgbf> color;  ///< linear
  ImageView<const float> color_sigma;
};

/// The empty room as seen from one place, in pictures (faces) that look in several directions;
/// borrowed. It is drawn anew for each pose of the camera, as a mesh that is cut at depth steps.
struct BackgroundModel {
  geometry::Pinhole camera;  ///< pinhole of every face, any size and field of view
  /// One pose a face, at most kMostFaces, all with the same origin. Neighbouring faces overlap by
  /// more than one depth sample; where several see a point, the one with the nearest axis is read.
  std::vector<geometry::Pose> world_from_face;
  /// These images hold the faces one below the other. Depth and its sigma are z in the axes of
  /// their face.
  ImageView<const float> depth_m;        ///< 0 unknown
  ImageView<const float> depth_sigma_m;  ///< may be empty
  ImageView<const Rgbx8> color;  ///< learned_color(), may be empty; `color_factor` times the
                                 ///< depth's resolution along each axis
  int color_factor = 1;
};
inline constexpr int kMostColorFactor = 8;
inline constexpr int kMostModels = 4;

struct KeyParams {
  float threshold_m = 0.05F;
  float noise_factor = 4.0F;
  bool color = true;
  bool refine = true;  ///< the matte follows the edges of the plate; needs `color`
  bool steady = true;  ///< blends in the previous matte where the plate has not changed
};

/// World axes, z up. Real points outside are not keyed (Cortes Reina 2015, section 3.1 "Cropping").
/// Without a background the box alone keys, and its bottom is the floor.
struct CaptureBox {
  glm::dvec3 min_m{0}, max_m{0};
  float floor_tolerance_m = 0.01F;  ///< points up to this height over the bottom are floor
};

/// Replaces the real background, behind all virtual objects.
struct Backdrop {
  ImageView<const Rgb8> picture;  ///< sRGB, size of the view; empty: transparent
};

/// A second depth camera: it measures what the first one does not see behind near things.
struct SecondTof {
  geometry::CameraModel model;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;
  geometry::DepthNoise noise;  ///< of one depth value
};
/// Depth of field of a thin lens: a point at depth z is drawn as a disc of diameter fx aperture
/// |1/z - 1/distance| in the view.
struct Focus {
  float distance_m = 0;             ///< distance in focus; 0: the depth at `pixel`
  std::optional<glm::ivec2> pixel;  ///< view pixel
  float aperture_m = 0;             ///< diameter of the entrance pupil
  float most_blur_px = 25;          ///< largest disc diameter; itself at most kMostBlur_px
  bool fast = false;                ///< fewer taps
};
inline constexpr float kMostBlur_px = 200;

struct PictureLook;
/// Which properties of the camera's picture are given to virtual things too. Their amounts come
/// from FrameInput::look, else they are measured in the first plate (picture_look.h).
struct LookSettings {
  bool grain = false;   ///< noise of the sensor
  bool blur = false;    ///< by the lens and the plate's resampling
  bool chroma = false;  ///< colour is blurred more than brightness, by demosaicing and subsampling
  bool sharpening = false;  ///< the camera's sharpening, which makes edges overshoot
  bool motion = false;      ///< motion blur by FrameInput::motion
  /// Whether any property is measured in plates.
  bool measures() const { return grain || blur || chroma || sharpening; }
};

/// Apparent motion of still points in camera axes over the whole exposure: a point p moves by
/// cross(turn_rad, p) + shift_m. The exposure is centred at mid-exposure.
struct CameraMotion {
  glm::vec3 turn_rad{0}, shift_m{0};
};

/// Everything that holds for a take. The compositor copies or uploads what it needs; meshes,
/// textures and background are borrowed.
struct CompositorSetup {
  geometry::CameraModel target;     ///< the plate, with its lens
  bool lens_moves = false;          ///< frames bring their own lens (FrameInput::lens)
  geometry::Vignetting vignetting;  ///< of the plate; corrected, so that the composite's corners
                                    ///< are as bright as its centre
  geometry::Pinhole view;  ///< ideal pinhole that is composited, any size; view_through() gives it
                           ///< for another lens
  geometry::CameraModel tof;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;  ///< depth values are distances along the ray, not z
  geometry::DepthNoise noise;      ///< of one ToF value
  std::optional<SecondTof> tof2;
  BackgroundView background;  ///< of a camera that stands still
  /// Used instead of `background` for a camera that moves: at most kMostModels, learned from
  /// different places. Surfaces of all models are drawn; a surface's colour is that of the model
  /// that saw it best.
  std::vector<BackgroundModel> background_models;
  std::vector<VirtualObject> objects;
  bool may_hide_objects = false;  ///< frames may hide them (FrameInput::objects_shown)
  geometry::Light light;
  KeyParams key;
  std::optional<CaptureBox> capture_box;
  bool open_walls = false;           ///< true: the background does not hide virtual objects
  std::optional<Backdrop> backdrop;  ///< if set, replaces the real background
  bool people_cast_shadows = false;  ///< people cast shadows on virtual objects
  LookSettings look;                 ///< applies to virtual objects and the set
  std::optional<Focus> focus;        ///< applies to colour only; depth and matte stay sharp
  /// Pose of the first frame, if known: tables that need a pose are then built when the compositor
  /// is made, not in the first frame.
  std::optional<geometry::Pose> first_pose;
};

/// The view for the pinhole `target` of the camera in use: the setup's view with focal lengths and
/// centre changed as the lens changes them. Pure.
geometry::Pinhole view_through(const CompositorSetup& setup, const geometry::Pinhole& target);

/// Replaces the setup's light from a frame on. A lamp that is dark in the setup stays dark.
struct FrameLight {
  glm::vec3 ambient{0.3F};
  float exposure = 1.0F;
  std::span<const glm::vec3>
      intensity{};  ///< of the first lamps; lamps beyond its size keep theirs
};

/// A plate that lies in its camera's own memory, which a GPU may read in place. Any thread.
class SharedPlate {
 public:
  virtual ~SharedPlate() = default;
  /// The undecoded picture. Valid while the result of hold() lives.
  virtual const RawPicture& raw() const = 0;
  /// The picture as sRGB; decoded by the first call.
  virtual ImageView<const Rgb8> decoded() const = 0;
  /// While the result lives, the camera does not refill the memory.
  virtual std::shared_ptr<const void> hold() const = 0;
};

struct FrameInput {
  /// sRGB, distorted, size of `target`; may be empty with `shared`, where
  /// CompositorState::plate_need is kShared.
  ImageView<const Rgb8> plate;
  ImageView<const float> tof_depth_m;  ///< size of `tof`; 0, NaN, infinite or negative = unknown
  geometry::Pose world_from_target;
  /// Lens of this frame, in place of CompositorSetup::target and of the same size; only with
  /// CompositorSetup::lens_moves.
  std::optional<geometry::LensState> lens{};
  /// Poses of the setup's first objects from this frame on; empty: they stay where they are.
  std::span<const geometry::Pose> world_from_object{};
  /// Depth of the second depth camera, size of `tof2`; empty: none in this frame. Only if the setup
  /// has that camera.
  ImageView<const float> tof2_depth_m{};
  /// Light from this frame on; absent: it stays as it is.
  std::optional<FrameLight> light{};
  /// View pixel whose depth is in focus, in place of the setup's distance. Only if the setup has a
  /// focus.
  std::optional<glm::ivec2> focus_pixel{};
  double time_s = 0;  ///< mid-exposure of the plate, any zero; frames with equal times have no
                      ///< motion between them
  /// Camera motion during the exposure; absent: unknown, no motion blur. Only if the setup's look
  /// has motion.
  std::optional<CameraMotion> motion{};
  /// Measured look, complete, from this frame on; null: it stays as it is. Only if the setup's look
  /// measures.
  const PictureLook* look = nullptr;
  const SharedPlate* shared = nullptr;  ///< `plate` in its camera's memory; null: not there
  /// False: objects outside the set are not drawn, as if the setup had none. Only if the setup may
  /// hide objects.
  bool objects_shown = true;
};

/// Which form of a shared plate a compositor reads.
enum class PlateNeed : std::uint8_t {
  kDecoded,  ///< FrameInput::plate
  kShared,   ///< the picture in place
};

enum class Stage {
  kUpload,
  kPlate,
  kCorrect,
  kWarp,
  kBackground,
  kVirtual,
  kShadow,
  kKey,
  kLight,
  kMix,
  kFocus,
  kReadback,
  kCount
};
std::string_view name(Stage stage);

/// Decision of the key for a pixel of the real scene.
enum class PixelState : std::uint8_t { kUnknown = 0, kBackground = 1, kForeground = 2, kEdge = 3 };

/// The layer that fills most of a pixel of the composite; the mixed depth is that layer's.
enum class Layer : std::uint8_t { kBackground = 0, kPerson = 1, kVirtual = 2 };

/// A set of images of FrameOutput: a sum of the bits below.
using OutputMask = std::uint32_t;
inline constexpr OutputMask kColor = 1, kMixedDepth = 2, kSegmentedDepth = 4, kMatte = 8;
inline constexpr OutputMask kWarpedDepth = 16;
inline constexpr OutputMask kState = 32;  ///< also makes the matte, which decides the states
inline constexpr OutputMask kLight = 64, kLayer = 128;
inline constexpr OutputMask kAlpha = 256;
inline constexpr OutputMask kGpuColor = 512;  ///< in GPU memory; kColor where nothing is shared
inline constexpr OutputMask kComposite = kColor | kMixedDepth | kSegmentedDepth | kMatte;
inline constexpr OutputMask kAll = kComposite | kWarpedDepth | kState | kLight | kLayer | kAlpha;

/// A composite that stays in the GPU's memory. Any thread; it may outlive its compositor.
class GpuPicture {
 public:
  virtual ~GpuPicture() = default;
  virtual Size size_px() const = 0;
  /// Copies the composite into the texture bound to GL_TEXTURE_2D (RGBA8, same size) without
  /// waiting for the GPU. The context current on this thread must be of the share group.
  /// Framebuffer bindings are kept. Errors: kDevice where the driver refuses, or the compositor no
  /// longer exists.
  virtual Result<void> copy_to_bound_texture() const = 0;
};

/// The EGL context of a screen; a gles compositor shares its objects. It must outlive the
/// compositor.
struct GlShare {
  void* display = nullptr;  ///< EGLDisplay; null: nothing is shared
  void* context = nullptr;  ///< EGLContext
};

/// Images of one frame. Wanted images have the view's size; the others are left as they were, and
/// are computed only where another image needs them.
struct FrameOutput {
  OutputMask wanted = kComposite;  ///< what compose() makes; collect() sets what it delivered
  Image<Rgb8> color;               ///< the composite, sRGB
  Image<float> mixed_depth_m;      ///< z of what is visible, 0 unknown
  Image<float> segmented_depth_m;  ///< z of people, 0 elsewhere
  Image<std::uint8_t> matte;       ///< people, 255 = all
  Image<float> warped_depth_m;     ///< ToF depth in the view before keying, 0 unknown
  Image<std::uint8_t> state;       ///< PixelState
  Image<float> light;              ///< light map, 0..1
  Image<std::uint8_t> layer;       ///< Layer
  Image<std::uint8_t>
      alpha;  ///< share of the pixel that shows anything, 255 = all; `color` is over black
  std::shared_ptr<const GpuPicture> gpu_color;  ///< the composite for kGpuColor; null without it
};

/// Time of each stage of one frame, milliseconds; 0 for a stage that did not run.
using StageTimes = std::array<float, static_cast<std::size_t>(Stage::kCount)>;

/// What a compositor reports besides its images.
struct CompositorState {
  std::string renderer;      ///< "cpu, 2 threads, x86-64-v3 (AVX2, 8 lanes)" or GL_RENDERER
  StageTimes stage_times{};  ///< of the frame collected last
  PlateNeed plate_need = PlateNeed::kDecoded;  ///< for the next frame
  /// Whether the plate of the last submitted frame was read in its camera's memory.
  bool imported_plate = false;
  /// Why FrameInput::shared is not read; empty where it is.
  std::string why_copied = "the back end reads copies";
};

/// Composites frames of one take. Not thread-safe; a gles instance must be used and destroyed in
/// the thread of its first frame.
class Compositor {
 public:
  /// Most frames that may be submitted and not yet collected.
  static constexpr int kMostInFlight = 2;

  virtual ~Compositor() = default;
  /// Starts a frame that makes the `wanted` images. `input` is read before it returns; only the
  /// memory of `shared` is held until the frame is collected. gles queues GPU work, cpu does all
  /// work here. Errors: kData for wrong image sizes or a pose that is not finite, kUsage for more
  /// than kMostInFlight frames; then no frame was started.
  virtual Result<void> submit(const FrameInput& input, OutputMask wanted) = 0;
  /// Waits for the oldest frame in flight and delivers its images, in the order of submit(). May
  /// swap its buffers with those in `output` to reuse memory. Errors: kUsage where no frame is in
  /// flight.
  virtual Result<void> collect(FrameOutput& output) = 0;
  /// Number of frames submitted and not yet collected.
  virtual int in_flight() const = 0;
  /// The reference is valid for the compositor's life; submit(), collect() and compose() change it.
  virtual const CompositorState& state() const = 0;
  /// Submits a frame and collects it. Errors: those of both, and kUsage while other frames are in
  /// flight. cpu draws straight into the images of `output`.
  virtual Result<void> compose(const FrameInput& input, FrameOutput& output);
};

enum class Backend { kAuto, kGles, kCpu };

/// Checks a setup: sizes that agree, valid cameras, finite lamps. Both back ends call it first.
Result<void> validate(const CompositorSetup& setup);

}  // namespace mixrig::render
