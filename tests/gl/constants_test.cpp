// SPDX-License-Identifier: Apache-2.0
// The numbers that both back ends share (host/render/constants.h) are the same in the shaders.
#include "host/render/constants.h"

#include <map>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "shaders/shaders.h"

namespace mixrig::test {
namespace {

using namespace render;

/// Numbers by their name in GLSL.
const std::map<std::string, double> kOurs = {
    {"nearest_m", kNearestM},
    {"person_matte", kPersonMatte},
    {"virtual_share", kVirtualShare},
    {"farthest_m", kFarthestM},
    {"steepest", kSteepest},
    {"steepest_slope", kSteepestSlope},
    {"steepest_cosine", kSteepestCosine},
    {"largest_bend", kLargestBend},
    {"plane_part", kPlanePart},
    {"smooth_part", kSmoothPart},
    {"least_supporters", kLeastSupporters},
    {"least_known", kLeastKnown},
    {"least_corner_part", kLeastCornerPart},
    {"open_reach", kOpenReach},
    {"shut_reach", kShutReach},
    {"reach_ramp_px", kReachRampPx},
    {"hole_share", kHoleShare},
    {"mixed_share", kMixedShare},
    {"share_slack", kShareSlack},
    {"share_part_of_depth", kSharePartOfDepth},
    {"most_reach", kMostReach},
    {"border_samples", kBorderSamples},
    {"border_spread2", kBorderSpread2},
    {"border_apart", kBorderApart},
    {"border_bent2", kBorderBent2},
    {"border_back", kBorderBack},
    {"cell_indices", kCellIndices},
    {"hidden_part", kHiddenPart},
    {"light_plane_part", kLightPlanePart},
    {"most_light_planes", kMostLightPlanes},
    {"virtual_samples", kVirtualSamples},
    {"sample_turn_px", kSampleTurnPx},
    {"one_surface_cosine", kOneSurfaceCosine},
    {"one_surface_part", kOneSurfacePart},
    {"blur_reach", kBlurReach},
    {"least_motion_px", kLeastMotionPx},
    {"most_motion_px", kMostMotionPx},
    {"most_motion_samples", kMostMotionSamples},
    {"grain_sigmas", kGrainSigmas},
    {"grain_texels", kGrainTexels},
    {"block_px", kBlockPx},
    {"speckle_tof_px", kSpeckleTofPx},
    {"mirror_speckle_tof_px", kMirrorSpeckleTofPx},
    {"mirror_part", kMirrorPart},
    {"speckle_blocks", kSpeckleBlocks},
    {"near_blocks", kNearBlocks},
    {"band_blocks", kBandBlocks},
    {"deep_blocks", kDeepBlocks},
    {"no_limit_w", kNoLimitW},
    {"hole_part", kHolePart},
    {"behind_hole", kBehindHole},
    {"share_noise", kShareNoise},
    {"share_part", kSharePart},
    {"share_apart", kShareApart},
    {"share_shadow", kShareShadow},
    {"share_least", kShareLeast},
    {"color_noise", kColorNoise},
    {"color_flicker", kColorFlicker},
    {"darkest_shadow", kDarkestShadow},
    {"shadow_sigma", kShadowSigma},
    {"color_vote_cap", kColorVoteCap},
    {"brighter", kBrighter},
    {"brighter_light", kBrighterLight},
    {"brighter_vote_cap", kBrighterVoteCap},
    {"deepest_shadow", kDeepestShadow},
    {"other_color", kOtherColor},
    {"room_vote_cap", kRoomVoteCap},
    {"spread_odds", kSpreadOdds},
    {"depth_tap_radius", kDepthTapRadius},
    {"fill_reach_px", kFillReachPx},
    {"fill_shadow", kFillShadow},
    {"fill_slack_px", kFillSlackPx},
    {"fill_ratio", kFillRatio},
    {"foreground_weight", kForegroundWeight},
    {"inside_weight", kInsideWeight},
    {"inside_footprints", kInsideFootprints},
    {"inside_share", kInsideShare},
    {"inside_odds", kInsideOdds},
    {"background_weight", kBackgroundWeight},
    {"unknown_share", kUnknownShare},
    {"light_tile_px", kLightTilePx},
    {"blocker_tap_count", kBlockerTapCount},
    {"shadow_tap_count", kShadowTapCount},
    {"lift_texels", kLiftTexels},
    {"least_radius_texel", kLeastRadiusTexel},
    {"least_distance2", kLeastDistance2},
    {"normal_footprints", kNormalFootprints},
    {"most_lamps", kMostLamps},
    {"part_blocker_tap_count", kPartBlockerTapCount},
    {"part_shadow_tap_count", kPartShadowTapCount},
    {"ambient_term_count", kAmbientTermCount},
    {"diffuse_band1", kDiffuseBand1},
    {"diffuse_band2", kDiffuseBand2},
    {"dielectric", kDielectric},
    {"least_roughness", kLeastRoughness},
    {"people_radius_m", kPeopleRadiusM},
    {"people_step_m", kPeopleStepM},
    {"small_block_m", kSmallBlockM},
    {"least_ball_blocks", kLeastBallBlocks},
    {"most_ball_blocks", kMostBallBlocks},
    {"matte_tile_footprints", kMatteTileFootprints},
    {"matte_window_tiles", kMatteWindowTiles},
    {"matte_spread2", kMatteSpread2},
    {"matte_gain", kMatteGain},
    {"contact_inside", kContactInside},
    {"contact_nodes", kContactNodes},
    {"contact_outside", kContactOutside},
    {"most_contacts", kMostContacts},
    {"sent_part", kSentPart},
    {"tone_pieces", kTonePieces},
    {"tone_first_knot", kToneFirstKnot},
    {"most_faces", kMostFaces},
    {"focus_sharp_px", kFocusSharpPx},
    {"focus_one_surface", kFocusOneSurface},
    {"focus_same_blur_px", kFocusSameBlurPx},
    {"focus_no_light", kFocusNoLight},
    {"focus_fast_from_px", kFocusFastFromPx},
    {"focus_area_steps", kFocusAreaSteps},
    {"focus_tile_wide", kFocusTileWide},
    {"focus_tile_high", kFocusTileHigh},
    {"contact_slack_m", kContactSlackM},
    {"rec709_red", kRec709Red},
    {"rec709_green", kRec709Green},
    {"rec709_blue", kRec709Blue},
};

/// Constants of scalar type that a stage defines outside functions, by name.
std::map<std::string, double> constants_of(std::string_view stage_name) {
  const shaders::Stage* stage = shaders::find_stage(stage_name);
  EXPECT_NE(stage, nullptr);
  std::map<std::string, double> found;
  const std::string text(stage->text);
  static const std::regex kDefinition(R"(\nconst (?:int|float) (\w+) = ([-0-9.e]+);)");
  for (std::sregex_iterator it(text.begin(), text.end(), kDefinition), end; it != end; ++it)
    EXPECT_TRUE(found.emplace((*it)[1], std::stod((*it)[2])).second) << (*it)[1] << " twice";
  return found;
}

TEST(Constants, shaders_have_the_same_numbers) {
  const auto found = constants_of("key_votes.frag");
  EXPECT_EQ(found.size(), kOurs.size()) << "each number of the table is listed in this test";
  for (const auto& [name, value] : kOurs) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_EQ(static_cast<float>(found.at(name)), static_cast<float>(value)) << name;
  }
}

TEST(Constants, no_shader_has_a_number_of_its_own_under_such_a_name) {
  static const std::regex kLocal(R"(\n +const (?:int|float) (\w+) = )");
  for (const shaders::Stage& stage : shaders::all_stages()) {
    for (const auto& [name, value] : constants_of(stage.name))
      EXPECT_TRUE(kOurs.contains(name)) << stage.name << ": " << name << " is not in the table";
    const std::string text(stage.text);
    for (std::sregex_iterator it(text.begin(), text.end(), kLocal), end; it != end; ++it)
      EXPECT_FALSE(kOurs.contains((*it)[1])) << stage.name << ": " << (*it)[1];
  }
}

}  // namespace
}  // namespace mixrig::test
