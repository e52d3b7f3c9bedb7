// SPDX-License-Identifier: Apache-2.0
// Bad input to the real command: one error line, the right exit status, no files left.
#include <functional>

#include <gtest/gtest.h>

#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

constexpr const char* kRun = "run scene.toml --source take:take --out out --backend cpu";

struct Row {
  const char* name;
  std::function<void(const TinyTake&)> spoil;
  std::string words;
  int status;
  std::vector<std::string> contains;  ///< each must be in the error line
  std::string environment;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.words; }

void nothing(const TinyTake&) {}

/// Folders a, b and c with the least that a scanned room has.
void two_rooms(const TinyTake& t) {
  for (const std::string name : {"a", "b", "c"}) {
    fs::create_directory(t.path(name));
    const image_io::Channel distance{"distance_m", Image<float>({8, 4}, 2.0F)};
    const image_io::Channel sigma{"sigma_m", Image<float>({8, 4}, 0.01F)};
    const image_io::Channel views{"views", Image<float>({8, 4}, 1.0F)};
    EXPECT_TRUE(image_io::write_exr(t.path(name + "/room.exr"), {distance, sigma, views}));
    const Image<Rgb8> color({8, 4}, {100, 110, 120});
    EXPECT_TRUE(image_io::write_png(t.path(name + "/color.png"), color.view()));
    t.text(name + "/manifest.toml",
           "format = 1\nprojection = \"equirectangular\"\norigin = \"base\"\nsize_px = [8, 4]\n"
           "views = 1\nframes = 1\nmeasured_pct = 100.0\nfill_pct = 100.0\ntriangles = 0\n"
           "mesh_tolerance_mm = 1.0\n");
  }
}

void joined_room(const TinyTake& t) {
  two_rooms(t);
  fs::create_directory(t.path("j"));
  fs::rename(t.path("b"), t.path("j/room_1"));
  fs::rename(t.path("c"), t.path("j/room_2"));
  const std::string rest =
      "sigma_mm = 1\nsigma_deg = 0.1\nfirst_from_base = { rotation_xyzw = [0.0, 0.0, 0.0, 1.0], "
      "translation_m = [1.0, 0.0, 0.0] }\n";
  t.text("j/manifest.toml",
         "format = 1\nprojection = \"joined\"\ntriangles = 0\n[[room]]\nfolder = \"room_1\"\n" +
             rest + "[[room]]\nfolder = \"room_2\"\n" + rest);
}

/// Of the extras that are built; one that is not is named.
std::vector<Row> rows_of_extras() {
  std::vector<Row> all;
#ifdef MIXRIG_EXTRA_PEOPLE
  for (const Row& row : std::initializer_list<Row>{
           {"PlanBox",
            nothing,
            "plan scene.toml --source take:take out --box 1,2",
            2,
            {"--box", "0.5,0.5,1"},
            ""},
           {"PlanBoxOfNothing",
            nothing,
            "plan scene.toml --source take:take out --box 0,1,1",
            2,
            {"--box"},
            ""},
           {"PlanMissingTake", nothing, "plan scene.toml --source take:no out", 2, {"no"}, ""},
       })
    all.push_back(row);
#endif
#ifdef MIXRIG_EXTRA_STUDIO
  for (const Row& row : std::initializer_list<Row>{
           {"OptionOfABoard",
            nothing,
            "studio out --bend 3",
            2,
            {"--bend", "--scenario board"},
            ""},
           {"OptionOfASweep",
            nothing,
            "studio out --scenario board --overlap 0.3",
            2,
            {"--overlap", "--scenario sweep"},
            ""},
           {"EndlessNumber", nothing, "studio out --zoom inf", 2, {"inf", "finite"}, ""},
           {"RefocusOfOneNumber",
            nothing,
            "studio out --refocus 6",
            2,
            {"'6'", "SECONDS,METRES"},
            ""},
           {"RefocusTooNear", nothing, "studio out --refocus 6,0.01", 2, {"0.1 to 100 m"}, ""},
           {"RefocusOfASharpLens",
            nothing,
            "studio out --plain --refocus 6,1",
            2,
            {"\"defocus\""},
            ""},
       })
    all.push_back(row);
  const std::pair<const char*, const char*> sources[] = {
      {"studio:wolk", "wolk"},
      {"studio:walk,x", "seed"},
      {"studio:walk,1,kinect2,9,64", "WxH"},
      {"studio:walk,1,kinect2,9,64x48,64x48,1", "at most"}};
  for (const auto& [source, contains] : sources)
    all.push_back({"StudioSource",
                   nothing,
                   std::string("run scene.toml --out out --source ") + source,
                   2,
                   {contains},
                   ""});
#else
  all.push_back({"StudioLeftOut",
                 nothing,
                 "run scene.toml --out out --source studio",
                 1,
                 {"\"studio\"", "MIXRIG_EXTRAS"},
                 ""});
#endif
#ifndef MIXRIG_EXTRA_PEOPLE
  all.push_back({"PeopleLeftOut",
                 [](const TinyTake& t) {
                   t.edit("scene.toml", "[camera]", "[people]\nfollow = true\n[camera]");
                 },
                 kRun,
                 1,
                 {"scene.toml: people", "MIXRIG_EXTRAS"},
                 ""});
#endif
#ifndef MIXRIG_EXTRA_MAP
  all.push_back(
      {"MapLeftOut", nothing, "track --map map --take take", 1, {"\"map\"", "MIXRIG_EXTRAS"}, ""});
#endif
  return all;
}

std::vector<Row> rows() {
  std::vector<Row> all{
      {"MissingScene", nothing, "run no.toml --source take:take --out out", 2, {"no.toml"}, ""},
      {"MissingTake", nothing, "run scene.toml --source take:no --out out", 2, {"no"}, ""},
      {"UnknownSource",
       nothing,
       "run scene.toml --source tape:x --out out",
       2,
       {"tape:x", "take:DIR"},
       ""},
      {"MissingCalibration",
       nothing,
       std::string(kRun) + " --calibration no.toml",
       2,
       {"no.toml"},
       ""},
      {"CalibrationOfOtherCameras",
       [](const TinyTake& t) {
         t.text("c.toml",
                "format = 1\n[cameras.left]\nmodel = \"pinhole\"\nsize_px = [32, 24]\n"
                "fx = 30\nfy = 30\ncx = 15.5\ncy = 11.5\n");
       },
       "scan --static take --frames 1-3 out --backend cpu --calibration c.toml",
       2,
       {"c.toml", "\"target\"", "left"},
       ""},
      {"BrokenCalibrationOfATake",
       [](const TinyTake& t) {
         t.text("take/c.toml", "format = 1\n[camera]\n");
         t.edit("take/take.toml", "name = ", "calibration = \"c.toml\"\nname = ");
       },
       kRun,
       2,
       {"take/c.toml", "camera"},
       ""},
      {"OldCalibrationYaml",
       [](const TinyTake& t) { t.text("old.yaml", "format: 1\ncameras:\n  target:\n"); },
       std::string(kRun) + " --calibration old.yaml",
       2,
       {"old.yaml", "calibration.toml"},
       ""},
      {"TruncatedColor",
       [](const TinyTake& t) { t.cut("take/color/000004.png", 60); },
       kRun,
       1,
       {"000004.png"},
       ""},
      {"TruncatedDepth",
       [](const TinyTake& t) { t.cut("take/depth/000002.png", 60); },
       kRun,
       1,
       {"000002.png"},
       ""},
      {"EmptyPicture",
       [](const TinyTake& t) { t.cut("take/color/000004.png", 0); },
       kRun,
       1,
       {"000004.png"},
       ""},
      {"MissingPicture",
       [](const TinyTake& t) { fs::remove(t.path("take/color/000004.png")); },
       kRun,
       1,
       {"000004.png"},
       ""},
      {"SizeAgainstCalibration",
       [](const TinyTake& t) {
         t.edit("take/take.toml", "size_px = [32, 24]", "size_px = [32, 20]");
       },
       kRun,
       1,
       {"32x24", "32x20"},
       ""},
      {"ZeroLength",
       [](const TinyTake& t) {
         t.edit("take/take.toml", "count = 4", "count = 0");
         t.edit("take/take.toml", "count = 4", "count = 0");
       },
       kRun,
       2,
       {"take"},
       ""},
      {"BracketWithoutExposure",
       nothing,
       "lights --take take --bracket long.png,0",
       2,
       {"long.png,0", "PICTURE,EXPOSURE"},
       ""},
      {"BracketWithoutTake",
       nothing,
       "lights --model room --bracket long.png,1 short.png,0.01",
       2,
       {"--bracket needs --take"},
       ""},
      {"SingularRotation",
       [](const TinyTake& t) {
         t.edit("take/take.toml", "[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]",
                "[[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]");
       },
       kRun,
       2,
       {"rotation"},
       ""},
      {"NegativeFocalLength",
       [](const TinyTake& t) { t.edit("take/take.toml", "fx = 30.0", "fx = -30.0"); },
       kRun,
       2,
       {"fx"},
       ""},
      {"NotToml",
       [](const TinyTake& t) { t.text("scene.toml", "[camera\n"); },
       kRun,
       2,
       {"scene.toml:1"},
       ""},
      {"UnknownKey",
       [](const TinyTake& t) { t.edit("scene.toml", "threshold_m", "treshold_m"); },
       kRun,
       2,
       {"scene.toml:8", "treshold_m", "threshold_m"},
       ""},
      {"GltfWithoutItsBuffer",
       [](const TinyTake& t) {
         t.text(
             "crate.gltf",
             R"({"asset":{"version":"2.0"},"buffers":[{"uri":"crate.bin","byteLength":36}],)"
             R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
             R"("componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":)"
             R"([{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})");
         t.text("scene.toml", t.text_of("scene.toml") +
                                  "[[object]]\nname = \"crate\"\nmodel = \"crate.gltf\"\n"
                                  "position_m = [0.0, 0.0, 0.0]\n");
       },
       kRun,
       2,
       {"crate.bin"},
       ""},
      {"LearnedFramesThatAreNotThere",
       [](const TinyTake& t) { t.edit("scene.toml", "[1, 3]", "[1, 9]"); },
       kRun,
       2,
       {"background.learn", "1-9", "1-4"},
       ""},
      {"FloorWithoutBackground",
       [](const TinyTake& t) {
         t.edit("scene.toml", "\"identity\"", "\"floor\"");
         t.edit("scene.toml", "[background]\nlearn = [1, 3]\n", "");
       },
       kRun,
       2,
       {"floor"},
       ""},
      {"FramesOutOfRange", nothing, std::string(kRun) + " --frames 3-9", 2, {"3-9", "1-4"}, ""},
      {"FramesThatAreNoRange", nothing, std::string(kRun) + " --frames 4-x", 2, {"4-x"}, ""},
      {"SizeThatIsNone", nothing, std::string(kRun) + " --size 640", 2, {"640"}, ""},
      {"OutIsAFile", [](const TinyTake& t) { t.text("out", "mine"); }, kRun, 2, {"out"}, ""},
      {"OutIsAFolderOfOthers",
       [](const TinyTake& t) {
         fs::create_directory(t.path("out"));
         t.text("out/thesis.tex", "mine");
       },
       kRun,
       2,
       {"out"},
       ""},
      {"JsonIntoNoFolder", nothing, std::string(kRun) + " --json no/report.json", 2, {"no"}, ""},
      {"JsonOverAFolder",
       [](const TinyTake& t) {
         fs::create_directory(t.path("theirs"));
         t.text("theirs/thesis.tex", "mine");
       },
       "info take --json theirs",
       2,
       {"theirs", "folder"},
       ""},
      {"TrajectoryOverAFolder",
       [](const TinyTake& t) {
         fs::create_directory(t.path("theirs"));
         t.text("theirs/thesis.tex", "mine");
         t.text("m.csv", "frame,t_s,id,x_m,y_m,z_m,qx,qy,qz,qw\n1,0,1,0,0,0,0,0,0,1\n");
       },
       "track --mocap m.csv --up z --out theirs",
       2,
       {"theirs", "folder"},
       ""},
      {"EmptyOut", nothing, std::string(kRun) + " --out ''", 2, {"--out", "empty"}, ""},
      {"SizeOfMoreThanTheMemory",
       nothing,
       std::string(kRun) + " --size 16384x16384",
       2,
       {"16384x16384", "7680x4320"},
       ""},
      {"WatchAndNot", nothing, std::string(kRun) + " --watch --no-watch", 2, {"--no-watch"}, ""},
      {"StreamWithoutAPort",
       nothing,
       std::string(kRun) + " --stream srt://host",
       2,
       {"srt://host", "HOST:PORT"},
       ""},
      {"RecordOverATake", nothing, "record take", 2, {"'take'", "--force"}, ""},
      {"NotANumber", nothing, std::string(kRun) + " --change-after nan", 2, {"nan"}, ""},
      {"ScanOfFramesThatAreNotThere",
       nothing,
       "scan --static take --frames 1-9 bg",
       2,
       {"1-9", "1-4"},
       ""},
      {"ScanOfTooFewFrames", nothing, "scan --static take --frames 1-2 bg", 1, {"3"}, ""},
      {"ScanOfNothing", nothing, "scan bg", 2, {"--take", "--static"}, ""},
      {"ScanOfASweepWithoutCalibration", nothing, "scan --take take bg", 2, {"--calibration"}, ""},
      {"MergeWithoutOut", two_rooms, "scan --merge a b", 2, {"2 to 4", "OUT"}, ""},
      {"MergeOfThreeRoomsWithoutOut", two_rooms, "scan --merge a b c", 2, {"OUT 'c'"}, ""},
      {"MergeOfARoomWithItself", two_rooms, "scan --merge a ./a out", 2, {"'./a'", "twice"}, ""},
      {"MergeIntoARoom", two_rooms, "scan --merge a b a", 2, {"OUT is 'a'"}, ""},
      {"MergeOfAJoinedRoom", joined_room, "scan --merge j a out", 2, {"'j'", "joined"}, ""},
      {"MergeOfNoRoom", two_rooms, "scan --merge a take out", 2, {"'take'", "not a scanned"}, ""},
      {"MergeOfNothing", two_rooms, "scan --merge no a out", 2, {"'no'", "not a scanned"}, ""},
      {"MergeOfFive", two_rooms, "scan --merge a b d e f out", 2, {"2 to 4"}, ""},
      {"MergeNearWhat", two_rooms, "scan --merge a b out --near 1", 2, {"x y z yaw"}, ""},
      {"NearWithoutMerge", nothing, "scan --static take out --near 1", 2, {"--merge"}, ""},
      {"InfoOfNothing", nothing, "info no", 2, {"no"}, ""},
      {"InfoOfATruncatedTake",
       [](const TinyTake& t) { t.cut("take/depth/000001.png", 60); },
       "info take",
       1,
       {"000001.png"},
       ""},
      {"ExplainWithoutASource", nothing, "explain scene.toml", 2, {"--source"}, ""},
  };
  all.push_back({"AbsentEgl",
                 nothing,
                 "run scene.toml --source take:take --out out --backend gles",
                 1,
                 {"EGL"},
                 "__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent"});
  for (Row& row : rows_of_extras()) all.push_back(std::move(row));
  return all;
}

class BadInput : public ::testing::TestWithParam<Row> {};

TEST_P(BadInput, IsOneLineAndLeavesNothing) {
  const Row& row = GetParam();
  const TinyTake take;
  row.spoil(take);
  const auto before = take.contents();
  const Outcome outcome = take.mixrig(row.words, row.environment);
  EXPECT_EQ(outcome.status, row.status) << outcome.err;
  EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  for (const std::string& word : row.contains)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " is not in: " << outcome.err;
  EXPECT_EQ(take.contents(), before);
}

INSTANTIATE_TEST_SUITE_P(Cli, BadInput, ::testing::ValuesIn(rows()), [](const auto& row) {
  return row.param.name + std::to_string(row.index);
});

TEST(Cli, ComposesATakeOfFramesWithoutPartnerUpToThem) {
  const TinyTake take;
  fs::remove(take.path("take/depth/000004.png"));
  take.edit("take/take.toml", "count = 4\nrate_hz = 25.0\n[target]",
            "count = 3\nrate_hz = 25.0\n[target]");
  const Outcome outcome =
      take.mixrig("run scene.toml --source take:take --out out --backend cpu --frames 3-3");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.error_lines(), 1) << "one warning: " << outcome.err;
  EXPECT_NE(outcome.err.find("partner"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace mixrig::test
