// SPDX-License-Identifier: Apache-2.0
// scene.toml: its values, and the lines for what is wrong.
#include <random>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "host/scene/scene_manifest.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::scene {
namespace {

const char* const kGood = R"([camera]
pose = "floor"
capture_volume = { min_m = [0.0, 0.0, 0.0], max_m = [5.0, 4.0, 3.0] }
[background]
learn = [1, 25]
[[object]]
name = "crate"
model = "models/crate.glb"
position_m = [2.0, 2.5, 0.0]
yaw_deg = 90.0
scale = 2.0
casts_shadow = false
[light]
ambient = 0.25
exposure = 1.5
[[light.lamp]]
position_m = [1.5, 1.2, 2.95]
direction = [0.0, 0.0, -2.0]
size_m = [0.6, 0.3]
intensity = [2.0, 3.0, 4.0]
[[light.lamp]]
position_m = [0.0, 0.0, 2.0]
[key]
threshold_m = 0.1
noise_factor = 5
)";

TEST(Scene, HoldsWhatTheFileSays) {
  const auto scene = parse_scene(kGood, "s/scene.toml", false);
  ASSERT_TRUE(scene) << scene.error().context;
  EXPECT_EQ(scene->pose_source, PoseSource::kFloor);
  EXPECT_EQ(scene->capture_volume->max_m, Eigen::Vector3d(5, 4, 3));
  EXPECT_EQ(scene->background.learn, (std::pair{1, 25}));
  ASSERT_EQ(scene->objects.size(), 1U);
  const Object& crate = scene->objects[0];
  EXPECT_EQ(crate.model_path, "s/models/crate.glb");
  EXPECT_EQ(crate.scale, 2.0);
  EXPECT_FALSE(crate.casts_shadow);
  // A quarter turn about z, up, takes x to y.
  EXPECT_TRUE((crate.world_from_object * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(2, 3.5, 0), 1e-12));
  EXPECT_EQ(scene->light.ambient, Eigen::Vector3f(0.25F, 0.25F, 0.25F));
  EXPECT_EQ(scene->light.exposure, 1.5);
  ASSERT_EQ(scene->light.lamps.size(), 2U);
  EXPECT_EQ(*scene->light.lamps[0].direction, Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(scene->light.lamps[0].intensity, Eigen::Vector3f(2, 3, 4));
  EXPECT_EQ(scene->light.lamps[0].size_m, Eigen::Vector2d(0.6, 0.3));
  EXPECT_EQ(scene->light.lamps[1].name, "lamp 2");
  EXPECT_FALSE(scene->light.lamps[1].direction.has_value());
  EXPECT_EQ(scene->key.noise_factor, 5.0);
}

TEST(Scene, LookAndTheKeysOfTheFrameBefore) {
  const auto scene = parse_scene(
      "[look]\nchroma = true\nsharpening = true\nmotion = true\nfollow = false\nexposure_ms = 8.5\n"
      "[key]\nsteady = false\n",
      "scene.toml", true);
  ASSERT_TRUE(scene) << scene.error().context;
  EXPECT_TRUE(scene->look.chroma && scene->look.sharpening && scene->look.motion);
  EXPECT_FALSE(scene->look.grain || scene->look.blur || scene->look.follow);
  EXPECT_EQ(scene->look.exposure_ms, 8.5);
  EXPECT_FALSE(scene->key.steady);
  const auto none = parse_scene("", "scene.toml", true);
  ASSERT_TRUE(none) << none.error().context;
  EXPECT_FALSE(none->look.chroma || none->look.sharpening || none->look.motion);
  EXPECT_TRUE(none->key.steady);
}

TEST(Scene, AnEmptyFileIsAValidSceneOfDefaults) {
  const auto scene = parse_scene("", "scene.toml", true);
  ASSERT_TRUE(scene) << scene.error().context;
  EXPECT_EQ(scene->pose_source, PoseSource::kTake);
  EXPECT_TRUE(scene->objects.empty());
  EXPECT_FALSE(scene->capture_volume.has_value());
}

TEST(Scene, AFileOfAStreamStartsAtTheScenesFolder) {
  for (const auto& [uri, meant] :
       {std::pair("show.mkv", "s/show.mkv"), std::pair("../show.mp4", "show.mp4"),
        std::pair("/shows/a.mov", "/shows/a.mov"), std::pair("srt://host:7", "srt://host:7")}) {
    const auto scene =
        parse_scene("[[stream_out]]\nuri = \"" + std::string(uri) + "\"\n", "s/scene.toml", false);
    ASSERT_TRUE(scene) << scene.error().context;
    EXPECT_EQ(scene->stream_outs.at(0).uri, meant);
  }
}

Result<Scene> scene_of(const std::string& camera) {
  return parse_scene("[camera]\n" + camera, "s/scene.toml", false);
}

TEST(Scene, NamesWhereThePoseComesFrom) {
  const auto fixed = scene_of(
      "pose = \"fixed\"\nworld_from_target = { rotation_xyzw = [0, 0, 1, 0], translation_m = [1, "
      "2, 3] }\n");
  ASSERT_TRUE(fixed) << fixed.error().context;
  EXPECT_EQ(fixed->pose_source, PoseSource::kFixed);
  EXPECT_EQ(fixed->camera.world_from_target * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 2, 3));

  const auto recorded = scene_of(
      "pose = \"recorded\"\ntrajectory = \"mocap.txt\"\ntime_offset_s = -3.5\nmax_age_ms = "
      "50\nwhen_lost = \"hide\"\n");
  ASSERT_TRUE(recorded) << recorded.error().context;
  EXPECT_EQ(recorded->pose_source, PoseSource::kRecorded);
  EXPECT_EQ(recorded->camera.trajectory, "s/mocap.txt");
  EXPECT_EQ(recorded->camera.time_offset_s, -3.5);
  EXPECT_DOUBLE_EQ(recorded->camera.max_age_s, 0.05);
  EXPECT_EQ(recorded->camera.when_lost, WhenLost::kHide);

  const auto head = scene_of(
      "pose = \"pan_tilt\"\nworld_from_base = { rotation_xyzw = [0, 0, 0, 1], translation_m = [0, "
      "0, 1.2] }\n");
  ASSERT_TRUE(head) << head.error().context;
  EXPECT_EQ(head->pose_source, PoseSource::kPanTilt);
  EXPECT_EQ(head->camera.world_from_base.translation_m.z(), 1.2);
  EXPECT_EQ(head->camera.when_lost, WhenLost::kFreeze);

  const auto mocap = scene_of(
      "pose = \"mocap:motive-pc:1510,239.255.42.99\"\nconstellation = \"camera.toml\"\nup = "
      "\"z\"\ndelay_ms = 30\n");
  ASSERT_TRUE(mocap) << mocap.error().context;
  EXPECT_EQ(mocap->pose_source, PoseSource::kMocap);
  EXPECT_EQ(mocap->camera.mocap.server, "motive-pc:1510,239.255.42.99");
  EXPECT_EQ(mocap->camera.mocap.constellation, "s/camera.toml");
  EXPECT_FALSE(mocap->camera.mocap.y_up);
  EXPECT_DOUBLE_EQ(mocap->camera.mocap.delay_s, 0.03);

  const auto freed = scene_of(
      "pose = \"freed:0.0.0.0:7000,3\"\nrate_hz = 59.94\ndelay_ms = 20\nsigma_mm = 2\nsigma_deg = "
      "0.01\nworld_from_tracker = { rotation_xyzw = [0, 0, 0, 1], translation_m = [1, 2, 0] }\n");
  ASSERT_TRUE(freed) << freed.error().context;
  EXPECT_EQ(freed->pose_source, PoseSource::kFreeD);
  EXPECT_STREQ(name(freed->pose_source), "freed");
  EXPECT_EQ(freed->camera.stream.address, "0.0.0.0:7000,3");
  EXPECT_DOUBLE_EQ(freed->camera.stream.rate_hz, 59.94);
  EXPECT_DOUBLE_EQ(freed->camera.stream.delay_s, 0.02);
  EXPECT_DOUBLE_EQ(*freed->camera.stream.sigma_m, 0.002);
  EXPECT_NEAR(*freed->camera.stream.sigma_rad, 1.745e-4, 1e-6);
  EXPECT_EQ(freed->camera.stream.world_from_tracker.translation_m.y(), 2);
  const auto open = scene_of("pose = \"opentrackio:239.135.1.7:55555\"\nstamps = \"system\"\n");
  ASSERT_TRUE(open) << open.error().context;
  EXPECT_EQ(open->pose_source, PoseSource::kOpenTrack);
  EXPECT_EQ(open->camera.stream.stamps, TrackerStream::Stamps::kSystem);

  const auto tracker = scene_of("pose = \"tracker\"\npredict = \"both\"\nsmooth_ms = 200\n");
  ASSERT_TRUE(tracker) << tracker.error().context;
  EXPECT_EQ(tracker->camera.predict, Predict::kBoth);
  EXPECT_EQ(tracker->camera.smooth_s, 0.2);
}

TEST(Scene, RefusesTwoPoseSourcesAndWhatIsMissing) {
  struct Row {
    const char *camera, *says;
  };
  const Row rows[] = {
      {"pose = \"pan_tilt\"\ntrajectory = \"a.txt\"\n",
       "s/scene.toml:3: key \"camera.trajectory\": belongs to pose = \"recorded\", but pose is "
       "\"pan_tilt\": two pose sources, remove one"},
      {"trajectory = \"a.txt\"\n", "belongs to pose = \"recorded\", but pose is \"take\""},
      {"pose = \"recorded\"\nworld_from_target = { rotation_xyzw = [0, 0, 0, 1], translation_m = "
       "[0, 0, 0] }\n",
       "belongs to pose = \"fixed\""},
      {"pose = \"recorded\"\ndelay_ms = 3\n", "belongs to pose = \"mocap\""},
      {"pose = \"pan_tilt\"\npredict = \"head\"\n", "belongs to pose = \"tracker\""},
      {"pose = \"floor\"\nsmooth_ms = 200\n", "belongs to pose = \"tracker\""},
      {"pose = \"tracker\"\nsmooth_ms = 600\n", "smooth_ms"},
      {"pose = \"tracker\"\npredict = \"fast\"\n", "use one of \"velocity\", \"head\", \"both\""},
      {"pose = \"fixed\"\n", "key \"camera.world_from_target\": missing"},
      {"pose = \"recorded\"\ntime_offset_s = 1.0\n", "needs a trajectory"},
      {"pose = \"recorded\"\ntrajectory = \"a\"\ntime_offset_s = nan\n", "camera.time_offset_s"},
      {"pose = \"mocap:\"\n", "names no server"},
      {"pose = \"mocap:a\"\nbody = 2\nconstellation = \"a.toml\"\n", "given beside constellation"},
      {"pose = \"mocap:a\"\ndelay_ms = -1\n", "camera.delay_ms"},
      {"pose = \"freed:\"\nrate_hz = 50\n", "names no port"},
      {"pose = \"freed:7000\"\n", "camera.rate_hz\": missing: FreeD has no time stamps"},
      {"pose = \"freed:7000\"\nrate_hz = 50\nsigma_mm = 1\n", "given alone"},
      {"pose = \"freed:7000\"\nrate_hz = 50\nstamps = \"system\"\n",
       "belongs to pose = \"opentrackio\""},
      {"pose = \"opentrackio:7000\"\nstamps = \"system\"\ndelay_ms = 3\n", "remove it"},
      {"pose = \"opentrackio:7000\"\nbody = 3\n", "belongs to pose = \"mocap\""},
      {"pose = \"pantilt\"\n", "\"pantilt\" is not known: use one of"},
      {"max_age_mss = 3\n", "not known: did you mean \"max_age_ms\"?"},
      {"max_age_ms = -3\n", "camera.max_age_ms"},
      {"when_lost = \"stop\"\n", "use one of \"freeze\", \"hide\""},
  };
  for (const Row& row : rows) {
    EXPECT_TRUE(test::refused(scene_of(row.camera), {row.says})) << row.camera;
  }
}

/// `set` replaces the background of a scene with a capture volume.
Result<Scene> scene_with_set(const std::string& set, const std::filesystem::path& path, bool load) {
  return parse_scene(
      "[camera]\ncapture_volume = { min_m = [0, 0, 0], max_m = [5, 4, 3], floor_tolerance_m = 0.03 "
      "}\n" +
          set,
      path, load);
}

TEST(Scene, ASetReplacesTheBackground) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(image_io::write_png(folder.path() / "sky.png", Image<Rgb8>({4, 3}, {1, 2, 3})));
  const auto scene = scene_with_set(
      "[set]\nmodel = \"court.glb\"\nposition_m = [1, 2, 0]\nscale = 2\npicture = \"sky.png\"\n",
      folder.path() / "scene.toml", false);
  ASSERT_TRUE(scene) << scene.error().context;
  ASSERT_TRUE(scene->set && scene->set->model);
  EXPECT_EQ(scene->set->model->world_from_object.translation_m, Eigen::Vector3d(1, 2, 0));
  EXPECT_EQ(scene->set->model->scale, 2);
  EXPECT_FALSE(scene->set->model->casts_shadow);
  EXPECT_EQ(scene->set->picture_path, folder.path() / "sky.png");
  EXPECT_EQ(scene->capture_volume->floor_tolerance_m, 0.03);
  const auto empty = scene_with_set("[set]\n", "s/scene.toml", true);
  ASSERT_TRUE(empty) << empty.error().context;
  ASSERT_TRUE(empty->set);
  EXPECT_TRUE(!empty->set->model && empty->set->picture.empty());
  const auto with_picture =
      scene_with_set("[set]\npicture = \"sky.png\"\n", folder.path() / "scene.toml", true);
  ASSERT_TRUE(with_picture) << with_picture.error().context;
  EXPECT_EQ(with_picture->set->picture.size(), (Size{4, 3}));
}

TEST(Scene, EventsAndPhysics) {
  const std::string ball = "[[object]]\nposition_m = [0.0, 0.0, 0.0]\nmodel = \"b.glb\"\n";
  const auto scene = parse_scene(ball +
                                     "physics = { mass_kg = 0.4, bounce = 0.5, shape = \"ball\", "
                                     "velocity_m_s = [1, 0, -2.5] }\n"
                                     "[people]\nfollow = true\n[events]\nudp = \"127.0.0.1:7420\"\n"
                                     "osc = \"127.0.0.1:53000\"\npeople = true\n",
                                 "s/scene.toml", false);
  ASSERT_TRUE(scene) << scene.error().context;
  EXPECT_TRUE(scene->follow_people);
  EXPECT_EQ(scene->events->udp, "127.0.0.1:7420");
  EXPECT_EQ(scene->events->osc, "127.0.0.1:53000");
  EXPECT_TRUE(scene->events->people);
  EXPECT_EQ(scene->objects[0].physics->mass_kg, 0.4);
  EXPECT_TRUE(scene->objects[0].physics->is_ball);
  EXPECT_EQ(scene->objects[0].physics->velocity_m_s, Eigen::Vector3d(1, 0, -2.5));
  const auto plain = parse_scene(ball + "[events]\n", "s/scene.toml", false);
  ASSERT_TRUE(plain) << plain.error().context;
  EXPECT_FALSE(plain->follow_people);
  EXPECT_FALSE(plain->objects[0].physics);
  EXPECT_TRUE(plain->events->udp.empty() && plain->events->osc.empty());
  EXPECT_FALSE(plain->events->people);
  for (const auto& [text, says] : std::initializer_list<std::pair<std::string, std::string>>{
           {"physics = {}\n", "scene.toml:4: key \"object.physics"},
           {"physics = { mass_kg = -1.0 }\n", "scene.toml:4: key \"object.physics.mass_kg"},
           {"physics = { mass_kg = 1.0, bounce = 2.0 }\n", "object.physics.bounce"},
           {"physics = { mass_kg = 1.0, velocity_m_s = [20, 0, 0] }\n",
            "object.physics.velocity_m_s"},
           {"physics = { mass_kg = 1.0, form = \"ball\" }\n", "form"},
           {"[events]\nudp = \"127.0.0.1\"\n", "scene.toml:5: key \"events.udp\""},
           {"[events]\nosc = \"53000\"\n", "scene.toml:5: key \"events.osc\""},
           {"[events]\npeople = true\n", "scene.toml:5: key \"events.people\": has no receiver"},
           {"[events]\nudp = \"a:0\"\n", "give HOST:PORT"},
           {"[events]\nudp = \"a:77777\"\n", "give HOST:PORT"},
           {"[events]\nudp = \"a:7b\"\n", "give HOST:PORT"}}) {
    EXPECT_TRUE(test::refused(parse_scene(ball + text, "s/scene.toml", false), {says})) << text;
  }
}

TEST(Scene, WallsMayBeOpen) {
  const auto open = parse_scene("[background]\nlearn = [1, 5]\nwalls = \"open\"\n", "s", false);
  ASSERT_TRUE(open) << open.error().context;
  EXPECT_TRUE(open->background.open_walls);
  const auto room = parse_scene(
      "[background]\nmodel = \"room\"\n"
      "world_from_base = { rotation_xyzw = [0, 0, 0, 1], translation_m = [1, 2, 3] }\n",
      "s", false);
  ASSERT_TRUE(room) << room.error().context;
  ASSERT_TRUE(room->background.world_from_base);
  EXPECT_EQ(room->background.world_from_base->translation_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(test::refused(
      parse_scene("[background]\nlearn = [1, 5]\n"
                  "world_from_base = { rotation_xyzw = [0, 0, 0, 1], translation_m = [1, 2, 3] }\n",
                  "s", false),
      {"world_from_base"}));
  const auto alone = parse_scene("[background]\nwalls = \"open\"\n", "s", false);
  ASSERT_TRUE(alone) << alone.error().context;
  EXPECT_FALSE(parse_scene("[background]\nlearn = [1, 5]\nwalls = \"none\"\n", "s", false));
}

TEST(Scene, ReportsWhatIsWrongWithASet) {
  EXPECT_TRUE(
      test::refused(parse_scene("[set]\n", "s/scene.toml", true), {"camera.capture_volume"}));
  for (const char* set : {"[set]\nmodel = \"no.glb\"\n", "[set]\npicture = \"no.png\"\n"}) {
    EXPECT_TRUE(
        test::refused(scene_with_set(set, "s/scene.toml", true), {"s/scene.toml:4: key \"set."}));
  }
  EXPECT_TRUE(test::refused(scene_with_set("[set]\nmodle = \"a.glb\"\n", "s/scene.toml", false),
                            {"did you mean \"model\""}));
}

TEST(Scene, ReportsEachWrongValueWithLineAndKey) {
  struct Row {
    const char *from, *to, *says;
  };
  const Row rows[] = {
      {"threshold_m", "treshold_m",
       "s/scene.toml:24: key \"key.treshold_m\": not known: did you mean \"threshold_m\"?"},
      {"[key]", "[kye]", "key \"kye\": not known"},
      {"[key]", "[look]\nexposure_ms = -1\n[key]",
       "s/scene.toml:24: key \"look.exposure_ms\": -1 is out of range"},
      {"\"floor\"", "\"flor\"",
       "s/scene.toml:2: key \"camera.pose\": \"flor\" is not known: use one of"},
      {"max_m = [5.0", "max_m = [0.0", "key \"camera.capture_volume.min_m\": must lie below max_m"},
      {"[1, 25]", "[25, 1]",
       "s/scene.toml:5: key \"background.learn\": must be the first and the last frame"},
      {"[1, 25]", "[1, 2.5]", "key \"background.learn\""},
      {"learn = [1, 25]", "", "give learn, model"},
      {"position_m = [2.0, 2.5, 0.0]", "", "key \"object.position_m\": missing"},
      {"position_m = [2.0, 2.5, 0.0]", "position_m = [2.0, nan, 0.0]",
       "s/scene.toml:9: key \"object.position_m\": nan is out of range"},
      {"yaw_deg = 90.0", "yaw_deg = 90.0\nrotation_xyzw = [0, 0, 0, 1]",
       "given beside rotation_xyzw"},
      {"yaw_deg = 90.0", "rotation_xyzw = [0, 0, 0, 0]", "its length is not 1"},
      {"scale = 2.0", "scale = 0", "s/scene.toml:11: key \"object.scale\": 0 is out of range"},
      {"direction = [0.0, 0.0, -2.0]", "direction = [0, 0, 0]",
       "key \"light.lamp.direction\": has no length"},
      {"ambient = 0.25", "ambient = -1", "key \"light.ambient\": -1 is out of range"},
      {"ambient = 0.25", "ambient_by = \"sky\"", "use one of \"constant\", \"room\""},
      {"ambient = 0.25", "lamps = \"find\"", "\"find\" beside [[light.lamp]]"},
      {"ambient = 0.25", "ambient = [1, 2]",
       "key \"light.ambient\": must be an array of 3 numbers"},
      {"models/crate.glb", "${MIXRIG_NO_SUCH_FOLDER}/c.glb",
       "environment variable MIXRIG_NO_SUCH_FOLDER is not set"},
  };
  for (const Row& row : rows) {
    std::string text = kGood;
    text.replace(text.find(row.from), std::string(row.from).size(), row.to);
    EXPECT_TRUE(test::refused(parse_scene(text, "s/scene.toml", false), {row.says})) << row.to;
  }
}

TEST(Scene, ModelsAreReadFromBesideTheFileAndAMissingOneIsReportedWithItsKey) {
  const test::TemporaryFolder folder;
  const auto path =
      folder.write("scene.toml", "[[object]]\nmodel = \"m/t.glb\"\nposition_m = [0, 0, 0]\n");
  EXPECT_TRUE(test::refused(load_scene(path), {"scene.toml:2: key \"object.model\": cannot read"}));
  folder.write("m/t.glb", test::glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})",
                                    test::floats({0, 0, 0, 1, 0, 0, 0, 2, 0})));
  const auto scene = load_scene(path);
  ASSERT_TRUE(scene) << scene.error().context;
  EXPECT_EQ(scene->objects[0].model.meshes.size(), 1U);
  EXPECT_EQ(load_scene(folder / "none.toml").error().code, ErrorCode::kNotFound);
}

TEST(Scene, AnyBytesEndInASceneOrOneLine) {
  std::mt19937 random(8);
  const std::string whole = kGood;
  for (int i = 0; i < 1500; ++i) {
    std::string text = whole.substr(0, i % 3 == 0 ? random() % whole.size() : whole.size());
    for (unsigned flips = random() % 4; flips > 0 && !text.empty(); --flips)
      text[random() % text.size()] = static_cast<char>(32 + random() % 95);
    if (const auto scene = parse_scene(text, "scene.toml", false); !scene) {
      EXPECT_EQ(scene.error().context.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace mixrig::scene
