// SPDX-License-Identifier: Apache-2.0
// Whole takes: reading returns what was written, and no incomplete take is left.
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/each_pixel.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/throw_in.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

void write_take(const std::filesystem::path& folder, StreamFormat format, int frames, bool truth) {
  auto writer = TakeWriter::create(folder, made_info(), format);
  ASSERT_TRUE(writer) << writer.error().context;
  for (int number = 1; number <= frames; ++number) {
    ASSERT_TRUE(writer->write(made_frame(number)));
    if (truth) {
      ASSERT_TRUE(writer->write_truth(made_truth()));
    }
  }
  const auto finished = writer->finish();
  ASSERT_TRUE(finished) << finished.error().context;
}

void expect_same(const capture::Capture& read, const capture::Capture& written) {
  ASSERT_EQ(read.plate.size(), kColorSize);
  ASSERT_EQ(read.depth_m.size(), kDepthSize);
  ASSERT_EQ(read.amplitude.size(), kDepthSize);
  EXPECT_EQ(read.number, written.number);
  EXPECT_EQ(read.time_s, written.time_s);
  EXPECT_TRUE(read.world_from_target.matrix().isApprox(written.world_from_target.matrix(), 1e-12));
  for (const auto [x, y] : test::each_pixel(kColorSize))
    ASSERT_EQ(read.plate.at(x, y), written.plate.at(x, y));
  for (const auto [x, y] : test::each_pixel(kDepthSize)) {
    ASSERT_NEAR(read.depth_m.at(x, y), written.depth_m.at(x, y), 1e-6);
    ASSERT_EQ(read.amplitude.at(x, y), written.amplitude.at(x, y));
  }
}

class TakeRoundTrip : public ::testing::TestWithParam<StreamFormat> {};

TEST_P(TakeRoundTrip, FramesAndCalibrationComeBackInAnyOrder) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", GetParam(), 12, false);
  EXPECT_FALSE(std::filesystem::exists(folder / "take.partial"));
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  const TakeInfo& info = reader->info();
  const TakeInfo made = made_info();
  EXPECT_EQ(info.name, made.name);
  EXPECT_EQ(info.frames, 12);
  EXPECT_EQ(info.target.pinhole, made.target.pinhole);
  EXPECT_EQ(info.target.lens.coefficients(), made.target.lens.coefficients());
  EXPECT_EQ(info.tof.pinhole, made.tof.pinhole);
  EXPECT_EQ(info.view, made.view);
  EXPECT_EQ(info.noise.quadratic_per_m, made.noise.quadratic_per_m);
  EXPECT_TRUE(info.target_from_tof.matrix().isApprox(made.target_from_tof.matrix(), 1e-12));
  EXPECT_TRUE(info.has_poses);
  EXPECT_FALSE(info.has_truth);
  EXPECT_TRUE(info.amplitude_is_light);
  capture::Capture frame;
  for (const int number : {1, 2, 3, 12, 5, 4, 6, 1}) {
    const auto read = reader->read(number, frame);
    ASSERT_TRUE(read) << read.error().context;
    expect_same(frame, made_frame(number));
  }
  EXPECT_EQ(reader->read(0, frame).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(reader->read(13, frame).error().code, ErrorCode::kNotFound);
}

TEST_P(TakeRoundTrip, ASecondDepthCameraComesBack) {
  const test::TemporaryFolder folder;
  const Size size{9, 7};
  TakeInfo info = made_info();
  info.depth.delay_s = 0.006;
  info.tof2 = capture::SecondDepthCamera{
      .model = {{size, 8, 8.5, 4, 3}, geometry::Lens({0.1, 0, 0, 0, 0, 0, 0, 0})},
      .target_from_tof = {Eigen::Quaterniond::Identity(), {0.08, 0, 0.01}},
      .kind = capture::DepthKind::kDistance,
      .noise = {0.004, 0.002, 0.001},
      .unit_m = 0.0005,
      .offset_m = 0.01,
      .unknown = 65535,
      .amplitude_is_light = true};
  info.depth2 = SecondDepthStream{StreamInfo{}, StreamInfo{}};
  info.depth2->depth.delay_s = -0.014;
  auto writer = TakeWriter::create(folder / "take", info, GetParam());
  ASSERT_TRUE(writer) << writer.error().context;
  for (int number = 1; number <= 3; ++number) {
    capture::Capture frame = made_frame(number);
    if (number != 2) {  // a frame without it
      frame.depth2.depth_m.reset(size, 2 + 0.25F * static_cast<float>(number));
      frame.depth2.amplitude.reset(size, 100.0F * static_cast<float>(number));
      frame.depth2.depth_m.at(3, 2) = 0;
    }
    ASSERT_TRUE(writer->write(frame));
  }
  ASSERT_TRUE(writer->finish());
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  ASSERT_TRUE(reader->info().tof2);
  const capture::SecondDepthCamera& read = *reader->info().tof2;
  EXPECT_EQ(read.model.pinhole, info.tof2->model.pinhole);
  EXPECT_EQ(read.model.lens.coefficients(), info.tof2->model.lens.coefficients());
  EXPECT_EQ(read.kind, info.tof2->kind);
  EXPECT_EQ(read.noise.linear, 0.002);
  EXPECT_EQ(read.offset_m, 0.01);
  EXPECT_TRUE(read.amplitude_is_light);
  EXPECT_TRUE(read.target_from_tof.matrix().isApprox(info.tof2->target_from_tof.matrix(), 1e-12));
  capture::Capture frame;
  for (const int number : {1, 3, 2}) {
    ASSERT_TRUE(reader->read(number, frame));
    EXPECT_EQ(frame.status_of(capture::Stream::kDepth2), capture::StreamStatus::kFresh);
    EXPECT_EQ(frame.depth_mid_exposure - frame.mid_exposure, std::chrono::milliseconds(6));
    EXPECT_EQ(frame.depth2.mid_exposure - frame.mid_exposure, -std::chrono::milliseconds(14));
    ASSERT_EQ(frame.depth2.depth_m.size(), size);
    const float z = number == 2 ? 0 : 2 + 0.25F * static_cast<float>(number);
    EXPECT_NEAR(frame.depth2.depth_m.at(8, 6), z, 1e-6);
    EXPECT_EQ(frame.depth2.depth_m.at(3, 2), 0);
    EXPECT_EQ(frame.depth2.amplitude.at(0, 0), number == 2 ? 0 : 100 * number);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, TakeRoundTrip,
                         ::testing::Values(StreamFormat::kPng, StreamFormat::kMatroska),
                         [](const auto& row) {
                           return row.param == StreamFormat::kPng ? "Png" : "Matroska";
                         });

TEST(Take, AFrameThatHasNoMemoryIsItsErrorAndTheNextOneIsRead) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", StreamFormat::kPng, 2, false);
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader);
  const std::string name = "frame 1 of take '" + (folder / "take").string() + "'";
  const test::ThrowIn without(name);
  capture::Capture frame;
  EXPECT_TRUE(test::refused(reader->read(1, frame), {name, "no memory is left"}));
  ASSERT_TRUE(reader->read(1, frame));
  expect_same(frame, made_frame(1));
}

TEST(Take, TruthComesBackInItsUnits) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", StreamFormat::kPng, 2, true);
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  capture::Truth truth;
  ASSERT_TRUE(reader->read_truth(2, truth));
  EXPECT_FLOAT_EQ(truth.depth_m.at(32, 19), 2.5F);
  EXPECT_NEAR(truth.light.at(0, 0), 0.5F, 1e-5);
  EXPECT_EQ(truth.matte.at(1, 1), 200);
  EXPECT_EQ(truth.composite.at(2, 2), (Rgb8{1, 2, 3}));
  EXPECT_EQ(truth.labels.at(3, 3), 13);
  EXPECT_EQ(reader->read_truth(3, truth).error().code, ErrorCode::kNotFound);
}

TEST(Take, DepthThatNoStepCanHoldIsWrittenAsUnknown) {
  const test::TemporaryFolder folder;
  capture::Capture odd = made_frame(1);
  odd.depth_m.at(0, 0) = std::numeric_limits<float>::quiet_NaN();
  odd.depth_m.at(1, 0) = -1.0F;
  odd.depth_m.at(2, 0) = 1e9F;
  odd.depth_m.at(3, 0) = std::numeric_limits<float>::infinity();
  odd.depth_m.at(4, 0) = 65.535F;
  auto writer = TakeWriter::create(folder / "take", made_info(), StreamFormat::kPng);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(odd));
  ASSERT_TRUE(writer->finish());
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader);
  capture::Capture frame;
  ASSERT_TRUE(reader->read(1, frame));
  for (int x = 0; x < 4; ++x) EXPECT_EQ(frame.depth_m.at(x, 0), 0.0F);
  EXPECT_FLOAT_EQ(frame.depth_m.at(4, 0), 65.535F);
}

TEST(Take, CopiesItsCalibration) {
  const test::TemporaryFolder folder;
  TakeInfo info = made_info();
  info.calibration = folder / "rig.toml";
  EXPECT_TRUE(
      test::refused(TakeWriter::create(folder / "take", info, StreamFormat::kPng), {"rig.toml"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "take.partial"));
  std::ofstream(info.calibration) << "format = 1\n";
  {
    auto writer = TakeWriter::create(folder / "take", info, StreamFormat::kPng);
    ASSERT_TRUE(writer) << writer.error().context;
    ASSERT_TRUE(writer->write(made_frame(1)));
    ASSERT_TRUE(writer->finish());
  }
  const auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().calibration, folder / "take" / "calibration.toml");
  std::string text;
  std::getline(std::ifstream(reader->info().calibration), text);
  EXPECT_EQ(text, "format = 1");
}

TEST(Take, FramesOfARecordingHaveTheTimesOfTheirTicksNotOfTheirNumbers) {
  for (const bool has_poses : {false, true}) {
    const test::TemporaryFolder folder;
    TakeInfo info = made_info();
    info.has_poses = has_poses;
    auto writer = TakeWriter::create(folder / "take", info, StreamFormat::kPng);
    ASSERT_TRUE(writer) << writer.error().context;
    for (int number = 1; number <= 3; ++number) ASSERT_TRUE(writer->write(made_frame(number)));
    // A frame was lost between the second and the third.
    std::ofstream(writer->staging() / "ticks.csv")
        << "frame,stream,tick,counter,mid_exposure_ns,residual_us\n"
           "1,target,3,1,7000000000,0.0\n1,tof,3,1,7000300000,0.0\n"
           "2,target,6,2,7033000000,0.0\n3,target,12,4,7099000000,0.0\n";
    std::ofstream(writer->staging() / "pan_tilt.csv")
        << "frame,pan_rad,tilt_rad\n1,0.1,0.2\n3,0.3,0.4\n";
    ASSERT_TRUE(writer->finish());
    auto reader = TakeReader::open(folder / "take");
    ASSERT_TRUE(reader) << reader.error().context;
    const double times_s[] = {0, 0.033, 0.099};
    capture::Capture frame;
    for (int number = 1; number <= 3; ++number) {
      ASSERT_TRUE(reader->read(number, frame));
      const double stamped_s = (number - 1) / 30.0;  // of its line in poses.txt
      EXPECT_NEAR(frame.time_s, has_poses ? stamped_s : times_s[number - 1], 1e-9);
      EXPECT_EQ(frame.pan_tilt.has_value(), number != 2);
    }
    EXPECT_EQ(frame.pan_tilt->pan_rad, 0.3);
    EXPECT_EQ(frame.tick, 12U);
  }
}

TEST(Take, ADroppedWriterWithoutAFrameLeavesNothingAndAForeignFolderIsRefused) {
  const test::TemporaryFolder folder;
  for (const bool discarded : {false, true}) {
    auto writer = TakeWriter::create(folder / "take", made_info(), StreamFormat::kPng);
    ASSERT_TRUE(writer);
    if (!discarded) continue;
    ASSERT_TRUE(writer->write(made_frame(1)));
    writer->discard();
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  folder.write("mine/letter.txt", "dear");
  EXPECT_TRUE(test::refused(TakeWriter::create(folder / "mine", made_info(), StreamFormat::kPng),
                            {}, ErrorCode::kUsage));
  EXPECT_EQ(test::read_bytes(folder / "mine/letter.txt"), "dear");
}

TEST(Take, AnOlderTakeIsReplacedOnlyAtTheEnd) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", StreamFormat::kPng, 3, false);
  auto writer = TakeWriter::create(folder / "take", made_info(), StreamFormat::kPng);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(made_frame(1)));
  EXPECT_EQ(TakeReader::open(folder / "take")->info().frames, 3);
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(TakeReader::open(folder / "take")->info().frames, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "take/color/000002.png"));
}

TEST(Take, PicturesOfAnotherSizeThanTheCalibrationAreRefusedByName) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", StreamFormat::kPng, 1, false);
  ASSERT_TRUE(
      image_io::write_png(folder / "take/color/000001.png", Image<Rgb8>(Size{32, 20}).view()));
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader);
  capture::Capture frame;
  const auto read = reader->read(1, frame);
  EXPECT_TRUE(test::refused(read, {"000001.png' is 32x20 but [target] size_px is 33x20"},
                            ErrorCode::kData));
  std::filesystem::remove(folder / "take/color/000001.png");
  EXPECT_EQ(reader->read(1, frame).error().code, ErrorCode::kNotFound);
}

TEST(Take, FloatDepthPicturesAreMetresAsTheyAre) {
  const test::TemporaryFolder folder;
  write_take(folder / "take", StreamFormat::kPng, 1, false);
  std::vector<image_io::Channel> channels{{"Z", Image<float>(kDepthSize, 3.25F)},
                                          {"other", Image<float>(kDepthSize)}};
  channels[0].pixels.at(0, 0) = -1.0F;
  ASSERT_TRUE(image_io::write_exr(folder / "take/depth/000001.exr", channels));
  std::string manifest = test::read_bytes(folder / "take/take.toml");
  const std::size_t at = manifest.find("depth/%06d.png");
  manifest.replace(at, 14, "depth/%06d.exr");
  folder.write("take/take.toml", manifest);
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  capture::Capture frame;
  ASSERT_TRUE(reader->read(1, frame));
  EXPECT_EQ(frame.depth_m.at(5, 5), 3.25F);
  EXPECT_EQ(frame.depth_m.at(0, 0), -1.0F) << "unknown values are decided by the compositor";
}

}  // namespace
}  // namespace mixrig::take
