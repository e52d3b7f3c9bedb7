// SPDX-License-Identifier: Apache-2.0
// The compositor: what it needs once, what it takes and gives per frame. Two back ends draw the
// same passes (docs/method/compositor.md): cpu and gles.
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
  float specular = 0;  ///< share of what a dielectric mirrors, 4 % at right angles; 0: matte
  bool is_matte() const { return metallic == 0 && specular == 0; }
};

/// Triangles of one material, borrowed from the scene for the compositor's life. Object axes.
struct MeshView {
  std::span<const glm::vec3> positions_m;
  std::span<const glm::vec3> normals;  ///< unit
  std::span<const glm::vec2> uv;       ///< empty without texture; v grows downwards
  std::span<const std::uint32_t> indices;
  glm::vec3 base_color{1};        ///< linear
  ImageView<const Rgb8> texture;  ///< sRGB, may be empty; repeats
  bool double_sided = false;
  Gloss gloss{};
  glm::vec3 emission{0};  ///< linear, at most 1: light of its own
  /// As `texture`, may be empty. Bytes over 255 of `gloss_map` multiply roughness (green) and
  /// metallic (blue); `normal_map` is glTF's, tangents are those of the triangles; `emission_map`
  /// is sRGB and multiplies `emission`.
  ImageView<const Rgb8> gloss_map{}, normal_map{}, emission_map{};
  float normal_scale = 1;  ///< of x and y of `normal_map`
};

struct VirtualObject {
  std::vector<MeshView> meshes;
  geometry::Pose world_from_object;
  double scale = 1.0;
  bool casts_shadow = true;
  bool in_set = false;  ///< part of the set: it stays where objects are hidden
};

/// The room without people in the view; borrowed. Empty images where nothing was learned yet. A
/// colour with a negative red is unknown.
struct BackgroundView {
  ImageView<const float> depth_m;  ///< 0 unknown
  ImageView<const float> depth_sigma_m;
  ImageView<const Rgbf> color;  ///< linear
  ImageView<const float> color_sigma;
};

/// The room without people as seen from one place, in pictures that face several directions;
/// borrowed. It is drawn again for each pose of the camera, as a mesh that is cut at depth steps.
struct BackgroundModel {
  geometry::Pinhole camera;  ///< of every face, any size and field of view
  /// Of each face, at most kMostFaces, all at one place. Neighbours overlap by more than a sample
  /// of depth; what several see is read in that whose axis is nearest.
  std::vector<geometry::Pose> world_from_face;
  /// The faces below one another. Depth and its spread are z in the axes of their face.
  ImageView<const float> depth_m;        ///< 0 unknown
  ImageView<const float> depth_sigma_m;  ///< may be empty
  ImageView<const Rgbx8> color;          ///< learned_color(); `color_factor` times as many pixels a
                                         ///< side; may be empty
  int color_factor = 1;
};
inline constexpr int kMostColorFactor = 8;
inline constexpr int kMostModels = 4;

struct KeyParams {
  float threshold_m = 0.05F;
  float noise_factor = 4.0F;
  bool color = true;
  bool refine = true;  ///< the matte follows the edges of the plate; only with color
  bool motion = true;  ///< people's depth is moved to the time of the plate; a still camera's
  bool steady = true;  ///< the matte of the frame before joins where the plate stayed alike
};

/// World axes, z up. Real points outside are not keyed (Cortes Reina 2015, section 3.1 "Cropping").
/// Without a background the box alone keys: its bottom is the floor.
struct CaptureBox {
  glm::dvec3 min_m{0}, max_m{0};
  float floor_tolerance_m = 0.01F;  ///< what is lower over the bottom is the floor
};

/// What is seen instead of the real background, behind all virtual objects.
struct Backdrop {
  ImageView<const Rgb8> picture;  ///< sRGB, size of the view; empty: nothing, transparent
};

/// A second depth camera, which sees past the near things that hide the room from the first.
struct SecondTof {
  geometry::CameraModel model;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;
  geometry::DepthNoise noise;  ///< of one value
};
/// Depth of field of a thin lens: a point at z is a disc of diameter fx aperture |1/z - 1/distance|
/// in the view.
struct Focus {
  float distance_m = 0;             ///< of what is sharp; 0: of what is seen at `pixel`
  std::optional<glm::ivec2> pixel;  ///< of the view
  float aperture_m = 0;             ///< diameter of the entrance pupil
  float most_blur_px = 25;          ///< discs are at most as wide, at most kMostBlur_px
  bool fast = false;                ///< fewer taps
};
inline constexpr float kMostBlur_px = 200;

struct PictureLook;
/// What the camera does to real things and virtual ones then show, too. How much is measured in the
/// first plate, where no frame says it (picture_look.h).
struct LookSettings {
  bool grain = false;       ///< noise of the sensor
  bool blur = false;        ///< of the lens, and of its resampling
  bool chroma = false;      ///< colour is blurred farther than brightness: mosaic, subsampling
  bool sharpening = false;  ///< edges overshoot
  bool motion = false;      ///< of the camera while a plate is exposed (FrameInput::motion)
  /// What is measured in plates.
  bool measures() const { return grain || blur || chroma || sharpening; }
};

/// How still points move in the camera's axes while a plate is exposed: that at p by
/// cross(turn_rad, p) + shift_m, mid-exposure in the middle of it.
struct CameraMotion {
  glm::vec3 turn_rad{0}, shift_m{0};
};

/// All that holds for a take. The compositor copies or uploads what it needs, except meshes,
/// textures and background, which are borrowed.
struct CompositorSetup {
  geometry::CameraModel target;     ///< the plate, with its lens
  bool lens_moves = false;          ///< frames bring their own lens (FrameInput::lens)
  geometry::Vignetting vignetting;  ///< of the plate: it is taken out, so that corners of plate and
                                    ///< composite are as bright as the middle
  geometry::Pinhole view;           ///< what is composited: ideal, any size; view_through() is
                                    ///< that of a frame with its own lens
  geometry::CameraModel tof;
  geometry::Pose target_from_tof;
  bool depth_is_distance = false;  ///< along the ray, not along z
  geometry::DepthNoise noise;      ///< of one ToF value
  std::optional<SecondTof> tof2;
  BackgroundView background;  ///< of a camera that stands still
  /// Instead, of a camera that moves: at most kMostModels, learned from different places. A
  /// surface is where any of them has it; its colour is that of the model that saw it best.
  std::vector<BackgroundModel> background_models;
  std::vector<VirtualObject> objects;
  bool may_hide_objects = false;  ///< frames may hide them (FrameInput::objects_shown)
  geometry::Light light;
  KeyParams key;
  std::optional<CaptureBox> capture_box;
  bool open_walls = false;           ///< the background does not hide virtual objects
  std::optional<Backdrop> backdrop;  ///< the real background is not shown
  bool people_cast_shadows = false;  ///< on virtual objects
  LookSettings look;                 ///< of virtual objects and the set
  std::optional<Focus> focus;        ///< of the colour; depth and matte stay sharp
  /// Of the first frame, where it is known: what is found out once a pose is then found when the
  /// compositor is made, in its thread, and not in the first frame.
  std::optional<geometry::Pose> first_pose;
};

/// The view of a frame: that of the setup, whose focal lengths and centre change as those of the
/// lens do. Pure.
geometry::Pinhole view_through(const CompositorSetup& setup, const geometry::Pinhole& target);

/// Light of one frame, in place of that of the setup. A lamp that is dark in the setup stays dark.
struct FrameLight {
  glm::vec3 ambient{0.3F};
  float exposure = 1.0F;
  std::span<const glm::vec3> intensity{};  ///< of the first lamps; the others keep theirs
};

/// A plate that lies in its camera's own memory, which a GPU may read in place. Any thread.
class SharedPlate {
 public:
  virtual ~SharedPlate() = default;
  /// Valid while what hold() gives lives.
  virtual const RawPicture& raw() const = 0;
  /// The same as sRGB; decoded by the first call.
  virtual ImageView<const Rgb8> decoded() const = 0;
  /// Keeps the memory from being filled again.
  virtual std::shared_ptr<const void> hold() const = 0;
};

struct FrameInput {
  /// sRGB, distorted, size of `target`; may be empty with `shared`, where
  /// CompositorState::plate_need is kShared.
  ImageView<const Rgb8> plate;
  ImageView<const float> tof_depth_m;  ///< size of `tof`; 0, NaN, infinite or negative = unknown
  geometry::Pose world_from_target;
  /// In place of CompositorSetup::target, of the same size; only where CompositorSetup::lens_moves.
  std::optional<geometry::LensState> lens{};
  /// Of the first objects of the setup, from this frame on; empty: they stay where they are.
  std::span<const geometry::Pose> world_from_object{};
  /// Size of `tof2`; empty: this frame has none. Only where the setup has that camera.
  ImageView<const float> tof2_depth_m{};
  /// From this frame on; absent: the light stays as it is.
  std::optional<FrameLight> light{};
  /// In place of the setup's distance: what is seen at this pixel of the view is sharp. Only where
  /// the setup has a focus.
  std::optional<glm::ivec2> focus_pixel{};
  double time_s = 0;  ///< mid-exposure of the plate, any zero; frames of one time do not move
  double depth_delay_s = 0;  ///< mid-exposure of tof_depth_m after that; 0 where it is not known
  /// Absent: not known, nothing is blurred by it. Only where the setup's look has motion.
  std::optional<CameraMotion> motion{};
  /// What was measured in plates, all of it; counts from this frame on. Null: the look stays as it
  /// is. Only where the setup's look measures.
  const PictureLook* look = nullptr;
  const SharedPlate* shared = nullptr;  ///< the same picture as `plate`; null: it has no other form
  /// False: the frame is drawn as by a setup without the objects that are in no set. Only where the
  /// setup may hide objects.
  bool objects_shown = true;
};

/// What a compositor reads of a plate that its camera shares.
enum class PlateNeed : std::uint8_t {
  kDecoded,           ///< FrameInput::plate alone
  kDecodedAndShared,  ///< the picture in place, and pixels on the host
  kShared,            ///< the picture in place alone
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

/// What fills most of a pixel of the composite: the layer that mixed depth is of.
enum class Layer : std::uint8_t { kBackground = 0, kPerson = 1, kVirtual = 2 };

/// A set of images of FrameOutput: a sum of the bits below.
using OutputMask = std::uint32_t;
inline constexpr OutputMask kColor = 1, kMixedDepth = 2, kSegmentedDepth = 4, kMatte = 8;
inline constexpr OutputMask kWarpedDepth = 16;
inline constexpr OutputMask kState = 32;  ///< makes the matte too, which decides the states
inline constexpr OutputMask kLight = 64, kLayer = 128;
inline constexpr OutputMask kAlpha = 256;
inline constexpr OutputMask kGpuColor = 512;  ///< kColor where the compositor shares no objects
inline constexpr OutputMask kComposite = kColor | kMixedDepth | kSegmentedDepth | kMatte;
inline constexpr OutputMask kAll = kComposite | kWarpedDepth | kState | kLight | kLayer | kAlpha;

/// A composite that stays in the GPU's memory. Any thread; it may outlive its compositor.
class GpuPicture {
 public:
  virtual ~GpuPicture() = default;
  virtual Size size_px() const = 0;
  /// Copies it, without waiting for the GPU, into the texture that is bound to GL_TEXTURE_2D: RGBA
  /// of 8 bits, of the same size, in the context that is current on this thread, which is of the
  /// share group. Framebuffer bindings stay. Errors: kDevice where the driver refuses, or the
  /// compositor is no more.
  virtual Result<void> copy_to_bound_texture() const = 0;
};

/// The EGL context of a screen, whose objects a gles compositor shares; it outlives that.
struct GlShare {
  void* display = nullptr;  ///< EGLDisplay; null: nothing is shared
  void* context = nullptr;  ///< EGLContext
};

/// Images of one frame. The wanted ones have the view's size, the others stay as they were: what is
/// not wanted is not stored, and not computed where nothing else needs it.
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
  Image<std::uint8_t> alpha;       ///< share that shows anything, 255 = all; `color` is over black
  std::shared_ptr<const GpuPicture> gpu_color;  ///< the composite, of kGpuColor; null without
};

/// Time of each stage of one frame, milliseconds; 0 for a stage that did not run.
using StageTimes = std::array<float, static_cast<std::size_t>(Stage::kCount)>;

/// What a compositor tells beside its images.
struct CompositorState {
  std::string renderer;      ///< "cpu, 2 threads, x86-64-v3 (AVX2, 8 lanes)" or GL_RENDERER
  StageTimes stage_times{};  ///< of the frame collected last
  PlateNeed plate_need = PlateNeed::kDecoded;  ///< of the next frame
  /// The plate of the frame submitted last was read in its camera's memory.
  bool imported_plate = false;
  /// Why FrameInput::shared is not read, or no more; empty where it is.
  std::string why_copied = "the back end reads copies";
};

/// Composites frames of one take. Not thread-safe; gles instances stay on the thread of their first
/// frame, and end there.
class Compositor {
 public:
  /// Frames that may be submitted and not yet collected.
  static constexpr int kMostInFlight = 2;

  virtual ~Compositor() = default;
  /// Starts a frame that makes the `wanted` images; `input` is read before it returns, but for the
  /// memory of `shared`, which is held until the frame was collected. gles only
  /// queues the work of the GPU, cpu does all of it here. Errors: kData for images of a wrong size
  /// and a pose that is not finite, kUsage for more than kMostInFlight frames; then no frame was
  /// started.
  virtual Result<void> submit(const FrameInput& input, OutputMask wanted) = 0;
  /// Waits for the oldest frame in flight and delivers its images: frames come out in the order of
  /// submit(). The images that `output` held may be exchanged for them, so that memory is used
  /// again. Errors: kUsage where no frame is in flight.
  virtual Result<void> collect(FrameOutput& output) = 0;
  /// Number of frames submitted and not yet collected.
  virtual int in_flight() const = 0;
  /// For the compositor's life; submit(), collect() and compose() change it.
  virtual const CompositorState& state() const = 0;
  /// Submits a frame and collects it. Errors: of both; kUsage while other frames are in flight. cpu
  /// draws into the images of `output`, and so needs none of its own.
  virtual Result<void> compose(const FrameInput& input, FrameOutput& output);
};

enum class Backend { kAuto, kGles, kCpu };

/// Checks a setup: sizes that agree, valid cameras, finite lamps. Both back ends call it first.
Result<void> validate(const CompositorSetup& setup);

}  // namespace mixrig::render
