// SPDX-License-Identifier: Apache-2.0
// Bad input to the real command: one error line, the right exit status, no files left.
#include <chrono>
#include <functional>

#include <gtest/gtest.h>

#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

constexpr const char* kRun = "run scene.toml --source take:take --out out --backend cpu";

using Spoil = std::function<void(const TinyTake&)>;

struct Row {
  const char* name;
  std::string words;
  int status;
  std::vector<std::string> contains;  ///< each must be in the error line
  Spoil spoil = [](const TinyTake&) {};
  std::string environment = {};
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.words; }

Spoil cut(const char* file, std::size_t bytes) {
  return [=](const TinyTake& t) { t.cut(file, bytes); };
}
Spoil edit(const char* file, const char* from, const char* to) {
  return [=](const TinyTake& t) { t.edit(file, from, to); };
}
Spoil write(const char* file, const char* text) {
  return [=](const TinyTake& t) { t.text(file, text); };
}
/// A folder with a file of somebody else.
Spoil theirs(const std::string& folder) {
  return [=](const TinyTake& t) {
    fs::create_directory(t.path(folder));
    t.text(folder + "/thesis.tex", "mine");
  };
}

void one_marker(const TinyTake& t) {
  theirs("theirs")(t);
  t.text("m.csv", "frame,t_s,id,x_m,y_m,z_m,qx,qy,qz,qw\n1,0,1,0,0,0,0,0,0,1\n");
}

/// The folder of an earlier run, to which somebody has added a file.
void notes_in_out(const TinyTake& t) {
  fs::create_directory(t.path("out"));
  t.text("out/report.json", "{}");
  t.text("out/notes.txt", "mine");
  fs::last_write_time(t.path("out/report.json"),
                      fs::last_write_time(t.path("out/notes.txt")) - std::chrono::seconds(1));
}

/// Wrong words, and names of what must be kept. Of a take that is not there and an OUT that may not
/// be replaced, OUT is named: it is looked at before the work.
std::vector<Row> rows_of_words() {
  const std::string run = kRun;
  return {
      {"TakeAsScene", "run take/take.toml --source take", 2, {"of a take", "of a scene"}},
      {"FolderAsScene", "run take", 2, {"'take' is a folder", "scene"}},
      {"NoSuchScene", "run no.toml", 2, {"no scene 'no.toml'", "mixrig new"}},
      {"SceneAsRig", "diag --rig scene.toml", 2, {"of a scene", "of a rig"}},
      {"TakeAsRig", "record out --rig take/take.toml", 2, {"of a take", "of a rig"}},
      {"TakeAsCalibration",
       run + " --calibration take/take.toml",
       2,
       {"of a take", "of a calibration"}},
      {"SceneAsTake", "info scene.toml", 2, {"of a scene", "of a take"}},
      {"FolderWithoutTake", "run scene.toml --source theirs", 2, {"take.toml"}, theirs("theirs")},
      {"MisspeltOption", run + " --bakend cpu", 2, {"--bakend", "did you mean --backend"}},
      {"OptionOfNothing", run + " --zzzzzzzzzz", 2, {"--zzzzzzzzzz is no option", "--help"}},
      {"MisspeltCommand", "rum scene.toml", 2, {"rum", "did you mean run", "explain"}},
      {"MisspeltSubcommand", "calibrate extrenal", 2, {"calibrate", "did you mean external"}},
      {"NoSubcommand", "rig", 2, {"rig", "init"}},
      {"OneArgumentTooMany", run + " take", 2, {"'take' is one argument too many"}},
      {"JsonOverAScene", run + " --json scene.toml", 2, {"scene.toml", "something else"}},
      {"OutWithNotes", run, 2, {"out", "'notes.txt'", "report.json"}, notes_in_out},
      {"StillOverNotes",
       "scan --take no --frames 1-3 theirs",
       2,
       {"theirs", "background.toml"},
       theirs("theirs")},
      {"SweepOverNotes", "scan --take no theirs", 2, {"theirs", "manifest.toml"}, theirs("theirs")},
      {"FramesWithoutTake", "scan --rig r.toml --frames 1-3 bg", 2, {"--frames", "--take"}},
      {"ForceOverOthers", "record theirs --force", 2, {"'theirs'", "new folder"}, theirs("theirs")},
      {"TrajectoryOverATake",
       "track --mocap m.csv --up z take/take.toml",
       2,
       {"OUT", "take.toml", "something else"},
       one_marker},
      {"PlotOverATrajectory", "align m.csv m.csv --plot m.csv", 2, {"--plot", "m.csv"}, one_marker},
      {"SourceOfNothing", "run scene.toml --source no", 2, {"\"no\"", "take:DIR"}},
  };
}

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

/// Rows of the extras that are built; for an extra that is not built, the error names it.
std::vector<Row> rows_of_extras() {
  std::vector<Row> all;
#ifdef MIXRIG_EXTRA_PEOPLE
  const std::string plan = "plan scene.toml --source take:";
  all.push_back({"PlanBox", plan + "take out --box 1,2", 2, {"--box", "0.5,0.5,1"}});
  all.push_back({"PlanBoxOfNothing", plan + "take out --box 0,1,1", 2, {"--box"}});
  all.push_back({"PlanMissingTake", plan + "no out", 2, {"no"}});
  all.push_back({"PlanOverNotes", plan + "no theirs", 2, {"'theirs'"}, theirs("theirs")});
#else
  all.push_back({"PeopleLeftOut",
                 kRun,
                 1,
                 {"scene.toml: people", "MIXRIG_EXTRAS"},
                 edit("scene.toml", "[camera]", "[people]\nfollow = true\n[camera]")});
#endif
#ifdef MIXRIG_EXTRA_STUDIO
  for (const auto& [words, contains] :
       {std::pair<const char*, std::vector<std::string>>{"studio out --bend 3",
                                                         {"--bend", "--scenario board"}},
        {"studio out --scenario board --overlap 0.3", {"--overlap", "--scenario sweep"}},
        {"studio out --zoom inf", {"inf", "finite"}},
        {"studio out --refocus 6", {"'6'", "SECONDS,METRES"}},
        {"studio take", {"'take'", "a take", "--force"}},
        {"new take", {"'take'", "a take", "--force"}},
        {"studio out --refocus 6,0.01", {"0.1 to 100 m"}},
        {"studio out --plain --refocus 6,1", {"\"defocus\""}},
        {"run scene.toml --out out --source studio:wolk", {"wolk"}},
        {"run scene.toml --out out --source studio:walk,x", {"seed"}},
        {"run scene.toml --out out --source studio:walk,1,kinect2,9,64", {"WxH"}},
        {"run scene.toml --out out --source studio:walk,1,kinect2,9,64x48,64x48,1", {"at most"}}})
    all.push_back({"Studio", words, 2, contains});
#else
  all.push_back({"StudioLeftOut",
                 "run scene.toml --out out --source studio",
                 1,
                 {"\"studio\"", "MIXRIG_EXTRAS"}});
#endif
#ifdef MIXRIG_CALIBRATE
  const std::string view = "take/color/000001.png",
                    lens = "calibrate intrinsics " + view + " --board checkerboard:9x6:25mm ";
  all.push_back({"PictureOverAView", lens + "--picture " + view, 2, {"--picture", view, "kept"}});
  all.push_back({"OpencvOverAScene", lens + "--opencv scene.toml", 2, {"--opencv", "scene.toml"}});
#endif
#ifdef MIXRIG_EXTRA_MAP
  all.push_back({"LearnOverNotes", "learn --take no theirs", 2, {"'theirs'"}, theirs("theirs")});
#else
  all.push_back({"MapLeftOut", "track --map map --take take", 1, {"\"map\"", "MIXRIG_EXTRAS"}});
#endif
  return all;
}

constexpr const char* kModelWithoutBuffer =
    R"({"asset":{"version":"2.0"},"buffers":[{"uri":"crate.bin","byteLength":36}],)"
    R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
    R"("componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":)"
    R"([{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})";

void crate_without_buffer(const TinyTake& t) {
  t.text("crate.gltf", kModelWithoutBuffer);
  t.text("scene.toml", t.text_of("scene.toml") +
                           "[[object]]\nname = \"crate\"\nmodel = \"crate.gltf\"\n"
                           "position_m = [0.0, 0.0, 0.0]\n");
}
void broken_calibration(const TinyTake& t) {
  t.text("take/c.toml", "format = 1\n[camera]\n");
  t.edit("take/take.toml", "name = ", "calibration = \"c.toml\"\nname = ");
}
void no_frames(const TinyTake& t) {
  for (int stream = 0; stream < 2; ++stream) t.edit("take/take.toml", "count = 4", "count = 0");
}
void floor_without_background(const TinyTake& t) {
  t.edit("scene.toml", "\"identity\"", "\"floor\"");
  t.edit("scene.toml", "[background]\nlearn = [1, 3]\n", "");
}
std::vector<Row> rows() {
  const std::string run = kRun, no_out = "run scene.toml --source ";
  const std::string calibrated = "scan --take take --frames 1-3 out --backend cpu --calibration ";
  std::vector<Row> all{
      {"MissingScene", "run no.toml --source take:take --out out", 2, {"no.toml"}},
      {"MissingTake", no_out + "take:no --out out", 2, {"no"}},
      {"UnknownSource", no_out + "tape:x --out out", 2, {"tape:x", "take:DIR"}},
      {"MissingCalibration", run + " --calibration no.toml", 2, {"no.toml"}},
      {"CalibrationOfOtherCameras",
       calibrated + "c.toml",
       2,
       {"c.toml", "\"target\"", "left"},
       write("c.toml",
             "format = 1\n[cameras.left]\nmodel = \"pinhole\"\nsize_px = [32, 24]\n"
             "fx = 30\nfy = 30\ncx = 15.5\ncy = 11.5\n")},
      {"BrokenCalibrationOfATake", kRun, 2, {"take/c.toml", "camera"}, broken_calibration},
      {"OldCalibrationYaml",
       run + " --calibration old.yaml",
       2,
       {"old.yaml", "calibration.toml"},
       write("old.yaml", "format: 1\ncameras:\n  target:\n")},
      {"TruncatedColor", kRun, 1, {"000004.png"}, cut("take/color/000004.png", 60)},
      {"TruncatedDepth", kRun, 1, {"000002.png"}, cut("take/depth/000002.png", 60)},
      {"EmptyPicture", kRun, 1, {"000004.png"}, cut("take/color/000004.png", 0)},
      {"MissingPicture",
       kRun,
       1,
       {"000004.png"},
       [](const TinyTake& t) { fs::remove(t.path("take/color/000004.png")); }},
      {"SizeAgainstCalibration",
       kRun,
       1,
       {"32x24", "32x20"},
       edit("take/take.toml", "size_px = [32, 24]", "size_px = [32, 20]")},
      {"ZeroLength", kRun, 2, {"take"}, no_frames},
      {"BracketWithoutExposure",
       "lights --take take --bracket long.png,0",
       2,
       {"long.png,0", "PICTURE,EXPOSURE"}},
      {"BracketWithoutTake",
       "lights --model room --bracket long.png,1 short.png,0.01",
       2,
       {"--bracket needs --take"}},
      {"SingularRotation",
       kRun,
       2,
       {"rotation"},
       edit("take/take.toml", "[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]",
            "[[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]")},
      {"NegativeFocalLength", kRun, 2, {"fx"}, edit("take/take.toml", "fx = 30.0", "fx = -30.0")},
      {"NotToml", kRun, 2, {"scene.toml:1"}, write("scene.toml", "[camera\n")},
      {"UnknownKey",
       kRun,
       2,
       {"scene.toml:8", "treshold_m", "threshold_m"},
       edit("scene.toml", "threshold_m", "treshold_m")},
      {"GltfWithoutItsBuffer", kRun, 2, {"crate.bin"}, crate_without_buffer},
      {"LearnedFramesThatAreNotThere",
       kRun,
       2,
       {"background.learn", "1-9", "1-4"},
       edit("scene.toml", "[1, 3]", "[1, 9]")},
      {"FloorWithoutBackground", kRun, 2, {"floor"}, floor_without_background},
      {"FramesOutOfRange", run + " --frames 3-9", 2, {"3-9", "1-4"}},
      {"FramesThatAreNoRange", run + " --frames 4-x", 2, {"4-x"}},
      {"SizeThatIsNone", run + " --size 640", 2, {"640"}},
      {"OutIsAFile", kRun, 2, {"out"}, write("out", "mine")},
      {"OutIsAFolderOfOthers", kRun, 2, {"out"}, theirs("out")},
      {"JsonIntoNoFolder", run + " --json no/report.json", 2, {"no"}},
      {"JsonOverAFolder", "info take --json theirs", 2, {"theirs", "folder"}, theirs("theirs")},
      {"TrajectoryOverAFolder",
       "track --mocap m.csv --up z theirs",
       2,
       {"theirs", "folder"},
       one_marker},
      {"EmptyOut", run + " --out ''", 2, {"--out", "empty"}},
      {"SizeOfMoreThanTheMemory", run + " --size 16384x16384", 2, {"16384x16384", "7680x4320"}},
      {"WatchAndNot", run + " --watch --no-watch", 2, {"--no-watch"}},
      {"StreamWithoutAPort", run + " --stream srt://host", 2, {"srt://host", "HOST:PORT"}},
      {"ImportOverATake", "import no take", 2, {"'take'", "--force"}},
      {"ImportOfATake", "import take out", 2, {"'take'", "a take already"}},
      {"RecordOverATake", "record take", 2, {"'take'", "--force"}},
      {"NotANumber", run + " --change-after nan", 2, {"nan"}},
      {"ScanOfFramesThatAreNotThere", "scan --take take --frames 1-9 bg", 2, {"1-9", "1-4"}},
      {"ScanOfTooFewFrames", "scan --take take --frames 1-2 bg", 1, {"3"}},
      {"ScanOfNothing", "scan bg", 2, {"--take", "--frames"}},
      {"ScanOfASweepWithoutCalibration", "scan --take take bg", 2, {"--calibration"}},
      {"MergeWithoutOut", "scan --merge a b", 2, {"2 to 4", "OUT"}, two_rooms},
      {"MergeOfThreeRoomsWithoutOut", "scan --merge a b c", 2, {"OUT 'c'"}, two_rooms},
      {"MergeOfARoomWithItself", "scan --merge a ./a out", 2, {"'./a'", "twice"}, two_rooms},
      {"MergeIntoARoom", "scan --merge a b a", 2, {"OUT is 'a'"}, two_rooms},
      {"MergeOfAJoinedRoom", "scan --merge j a out", 2, {"'j'", "joined"}, joined_room},
      {"MergeOfNoRoom", "scan --merge a take out", 2, {"'take'", "not a scanned"}, two_rooms},
      {"MergeOfNothing", "scan --merge no a out", 2, {"'no'", "not a scanned"}, two_rooms},
      {"MergeOfFive", "scan --merge a b d e f out", 2, {"2 to 4"}, two_rooms},
      {"MergeNearWhat", "scan --merge a b out --near 1", 2, {"x y z yaw"}, two_rooms},
      {"NearWithoutMerge", "scan --take take out --near 1", 2, {"--merge"}},
      {"InfoOfNothing", "info no", 2, {"no"}},
      {"InfoOfATruncatedTake", "info take", 1, {"000001.png"}, cut("take/depth/000001.png", 60)},
      {"ExplainWithoutASource", "explain scene.toml", 2, {"--source"}},
  };
  all.push_back({"AbsentEgl", no_out + "take:take --out out --backend gles", 1, {"EGL"}});
  all.back().environment = "__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent";
  for (Row& row : rows_of_words()) all.push_back(std::move(row));
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
