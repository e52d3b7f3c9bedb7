// SPDX-License-Identifier: Apache-2.0
// The numbers of the passes that both back ends share. shaders/embed.cmake reads the lines
// `inline constexpr TYPE kName = VALUE;` of this file and writes them to common/constants.glsl as
// `const TYPE name = VALUE;`, so a number stands here and nowhere else. What a scene or a take
// decides is in passes.h instead.
#pragma once

namespace mixrig::render {

// --- All passes
/// Metres: nearer surfaces are not drawn. The GPU's window depth is this value over z.
inline constexpr double kNearestM = 0.01;
/// Least matte, 0..1, at which a pixel counts as a person.
inline constexpr float kPersonMatte = 0.5F;
/// Least coverage at which a pixel counts as an object: more than two of its four samples.
inline constexpr float kVirtualShare = 0.51F;

// --- correct (docs/method/compositor.md). "Part" means a part of the depth unless said otherwise.
/// Metres: larger depth values are unknown; no depth camera measures farther.
inline constexpr float kFarthestM = 1e4F;
/// Each term of the depth-step threshold that grows with noise is at most this part: a larger one
/// would hide people in front of dark surfaces.
inline constexpr float kSteepest = 0.1F;
/// Upper limit of the depth-step threshold's term by bends (second differences): the step between
/// pixels of a surface this steep (tangent; seen at 3.4 degrees). The scene's own steps bend too,
/// and must not link a dark wall to what stands before it.
inline constexpr float kSteepestSlope = 17.0F;
/// Three depths in line count as one plane if they are off it by up to this part of the step
/// threshold: less breaks noisy walls, more bridges real steps.
inline constexpr float kPlanePart = 0.7F;
/// Smoothing averages a single neighbour within this part of the step threshold, and a pair of
/// opposite ones within the whole: one side alone would bias a sloping surface.
inline constexpr float kSmoothPart = 0.5F;
/// A pixel is kept if at least this many of its eight neighbours lie at its depth; a single one may
/// be another stray.
inline constexpr int kLeastSupporters = 2;
/// A hole is filled if at least this many of its eight neighbours are known, as many as at a
/// corner.
inline constexpr int kLeastKnown = 3;
/// A stray piece has nothing but unknown pixels and surfaces farther than this factor around it. A
/// pixel that saw two surfaces can be a whole period of the modulation too near: at 120 MHz 1.25 m.
inline constexpr float kStrayGap = 1.2F;
/// ToF pixels: a stray piece lies within so many of each of its pixels, along rows and columns.
inline constexpr int kStrayReachPx = 14;
/// Square metres: a piece that is larger is a thing. A hand has about 0.01.
inline constexpr float kStrayAreaM2 = 0.004F;

// --- warp
/// w of a cut cell's corner is at least this part of its vertex' w: gradients at borders are noisy
/// and must not carry a corner far behind its surface.
inline constexpr float kLeastCornerPart = 0.5F;
/// How far a surface is extended past its last sample towards a farther one, in halves of a ToF
/// pixel, where the colour camera sees a gap behind the border that the ToF camera does not see:
/// unknown is better than wrong there.
inline constexpr float kOpenReach = 0.2F;
/// How far it is extended, in the same unit, where it covers in the view what the ToF camera sees
/// beside it: pixels that saw both surfaces more often measure the farther depth.
inline constexpr float kShutReach = 1.2F;
/// View pixels of gap or overlap from which kOpenReach and kShutReach apply in full; the extension
/// is 1 at none, and interpolated between.
inline constexpr float kReachRampPx = 2.0F;
/// Share of the nearer surface in a ToF pixel at a step that has no measurement: it saw both.
inline constexpr float kHoleShare = 0.5F;
/// A mixed pixel's share that is off a pure one by less than this is noise.
inline constexpr float kMixedShare = 0.1F;
/// A depth that lies outside both surfaces by more than this part of the step belongs to neither.
inline constexpr float kShareSlack = 0.1F;
/// At steps of less than this part of the depth no share of the surfaces is estimated.
inline constexpr float kSharePartOfDepth = 0.025F;
/// Most extension of a surface past its last sample, in halves of a ToF pixel.
inline constexpr float kMostReach = 3.0F;
/// Most indices of a cell: four quarters of two triangles each.
inline constexpr int kCellIndices = 24;

// --- background, where it is drawn for each pose
/// A learned colour is not used where the model's depth there differs from the drawn depth by more
/// than this part.
inline constexpr float kHiddenPart = 0.05F;
/// A drawn depth takes its place on a light plane if it is off it by at most this part of the
/// depth: planes may be moved up to 5 % to go through the feet of objects.
inline constexpr float kLightPlanePart = 0.08F;
/// Most light planes of a background model: 16 a face.
inline constexpr int kMostLightPlanes = 96;

// --- virtual
/// Samples along each axis of a pixel: 2 x 2 give coverage in quarters. They form a rotated grid:
/// the upper two are right of the centres of their quarters and the lower two left of them, the
/// left ones above and the right ones below. No two share a row or a column, so an edge along an
/// axis has five levels of coverage, not three.
inline constexpr int kVirtualSamples = 2;
/// Offset of the samples from the centres of their quarters along each axis, pixels.
inline constexpr float kSampleTurnPx = 0.125F;
/// Samples belong to a pixel's nearest surface if their normals are within this cosine of the
/// nearest sample's and their inverse depths at least kOneSurfacePart of its own. The others form a
/// second surface with its own light: a mean normal would fit neither.
inline constexpr float kOneSurfaceCosine = 0.9F;
inline constexpr float kOneSurfacePart = 0.98F;

// --- key: blocks in which votes decide
/// Side of a block, pixels. The cpu back end counts a block's row of states as one 64-bit word.
inline constexpr int kBlockPx = 8;
/// Added to the state of a pixel whose depth may be a mirror's, in the gles back end.
inline constexpr int kStateMirrored = 4;
/// Least area of a person, ToF pixels; less is a speckle of depth noise.
inline constexpr float kSpeckleTofPx = 6.0F;
/// Least area, ToF pixels, where around it more pixels show a mirror's depth than foreground: a
/// dark head in a mirror has few depth values, some of them too near by noise.
inline constexpr float kMirrorSpeckleTofPx = 24.0F;
/// Unknown pixels of a block are background where mirror pixels in the 3x3 blocks around are more
/// than this part of the foreground there: hair and sleeves seen in a mirror have no depth and look
/// like people.
inline constexpr float kMirrorPart = 0.1F;
/// Radius, blocks, in which foreground is counted (5x5), so that a person's border which only
/// touches a block is no speckle.
inline constexpr int kSpeckleBlocks = 2;
/// Radius, blocks, around foreground within which pixels without depth may be people, 7x7 (dark
/// hair).
inline constexpr int kNearBlocks = 3;
/// Radius, blocks, around a border of the foreground that belongs to the band, 3x3: ToF depth is
/// wrong by a few pixels there.
inline constexpr int kBandBlocks = 1;
/// Radius, blocks, in which a band block looks for the nearest block whose neighbours are all
/// foreground, to compare with people's colour there too: beside a border depth may lie over the
/// room, and the mean of a shirt and trousers is neither.
inline constexpr int kDeepBlocks = 3;
/// Pixels, along rows and columns, in which foreground depth is looked for to fill people's pixels
/// without depth. The nearest one counts. The ToF camera cannot see between two that differ by more
/// than kFillRatio within kFillShadow times their parallax, plus kFillSlackPx: the farther counts
/// if its matte is over kFillSure, since less may be the room.
inline constexpr int kFillReachPx = 24;
inline constexpr float kFillShadow = 1.25F;
inline constexpr float kFillSlackPx = 3.0F;
inline constexpr float kFillRatio = 1.06F;
inline constexpr float kFillSure = 0.9F;
/// Limits of the key from here on mean that the background has no depth there: depth cannot decide
/// (doubt).
inline constexpr float kNoLimitW = 1e30F;

// --- key: colour votes, in log odds
/// Least standard deviation of a linear colour in the dark, by camera noise.
inline constexpr float kColorNoise = 0.004F;
/// Added to kColorNoise for flicker of light, as a part of the luminance.
inline constexpr float kColorFlicker = 0.05F;
/// The darkest shadow of the background, as a factor of its light; what is darker counts as another
/// colour.
inline constexpr float kDarkestShadow = 0.85F;
/// Largest colour vote of a pixel, a probability of 98 %; measured background outweighs it.
inline constexpr float kColorVoteCap = 4.0F;
/// Largest vote for people of a colour that no shadow explains: it outweighs measured background
/// (white shoes on the floor, whose depths differ by less than the noise).
inline constexpr float kOtherVoteCap = 6.0F;
/// Still camera: such a colour's squared distance to the learned one, times any factor from
/// kDeepestShadow to 1, exceeds kOtherColor variances (a grey sole on a red rug, whose depth is the
/// rug's). A least factor of 0.5 would key the shadows of people.
inline constexpr float kDeepestShadow = 0.3F;
inline constexpr float kOtherColor = 16.0F;
/// Largest colour vote where the room's colour is estimated from the pixels around, which is a
/// rougher guess.
inline constexpr float kRoomVoteCap = 2.5F;
/// Standard deviation of the light on people's surfaces, as a part of it: they turn away from the
/// lamps, while their hue stays.
inline constexpr float kPeopleShade = 0.17F;
/// Weight of the votes of neighbours along each axis, beside 1 of the pixel itself. A camera that
/// moves takes the mean over 3x3: the background drawn for its pose is off by parts of a pixel.
inline constexpr float kVoteSide = 0.25F;
/// Weight of the log ratio of two variances in the log odds of normal densities: one half for each
/// of three channels.
inline constexpr float kSpreadOdds = 1.5F;

// --- key: depth votes, in log odds
/// Radius of the depth taps, half a ToF footprint apart: 5x5 of them.
inline constexpr int kDepthTapRadius = 2;
/// Weight of measured foreground: people lag in ToF depth and extend over edges, so colour may
/// outvote it where depth is off by more than a footprint.
inline constexpr float kForegroundWeight = 3.0F;
/// Weight of measured background: depth is sure there, while colour may be a shadow.
inline constexpr float kBackgroundWeight = 5.0F;
/// Value of a tap without measurement, between background 0 and foreground 1: below one half, so
/// that holes alone do not become people.
inline constexpr float kUnknownShare = 0.4F;

// --- key: the matte is refined
/// Side of a tile in ToF footprints, before it is rounded down to 1, 2 or 4 pixels.
inline constexpr float kMatteTileFootprints = 1.6F;
/// Radius, tiles, of the window in which the matte is fitted as a line of the colour, 5x5.
inline constexpr int kMatteWindowTiles = 2;
/// Ridge of that fit: variance of square roots of linear light up to which colours count as alike
/// and the line is flat.
inline constexpr float kMatteSpread2 = 2e-4F;
/// Slope factor of the matte around one half: least squares leave a veil on both sides of a border.
inline constexpr float kMatteGain = 1.25F;

// --- key: the matte from both colours, where those of people and background differ enough
/// Standard deviation of a pixel about its mixture of two colours: kShareNoise, plus kSharePart of
/// its luminance.
inline constexpr float kShareNoise = 0.01F;
inline constexpr float kSharePart = 0.1F;
/// The share by colours counts by half where the colours are this many standard deviations apart.
inline constexpr float kShareApart = 4.0F;
/// Darkest shadow of the background, as a factor of its light, that the share allows for: people's
/// colour is compared with the most alike of these shades.
inline constexpr float kShareShadow = 0.4F;
/// Least part of a window that people must fill for a share by colours.
inline constexpr float kShareLeast = 0.02F;

// --- key: the previous matte is blended in
/// Share of the previous matte where the plate has not changed.
inline constexpr float kBeforeShare = 0.7F;
/// Change of the root of light (of 255, mean over channels and 3x3 pixels) at which that share
/// falls to 1/e: some times a sensor's noise.
inline constexpr float kBeforeAlike = 8.0F;

// --- light
/// Side of a tile, pixels: people's light is found once a tile, since no ToF camera resolves finer.
inline constexpr int kLightTilePx = 4;
/// More light than this part counts as all of it: half floats may hold less than 1 for 1.
inline constexpr float kAllLight = 0.999F;
/// Taps that search for shadow casters, and taps of the shadow filter: the filter's steps of 1/24
/// are visible, the search needs only a mean depth. Cost grows with both.
inline constexpr int kBlockerTapCount = 12;
inline constexpr int kShadowTapCount = 24;
/// Taps of the search and of the filter for one of the four parts of a panel.
inline constexpr int kPartBlockerTapCount = 6;
inline constexpr int kPartShadowTapCount = 8;
/// Part of a turn between the places of neighbouring taps: the golden ratio's.
inline constexpr float kTapTurn = 0.61803399F;
/// Texels by which a receiver is lifted along its normal off its own shadow.
inline constexpr float kLiftTexels = 2.0F;
/// Largest cosine between a lamp's ray and the normal of the lit surface that its plane is computed
/// with (negative: facing the lamp).
inline constexpr float kSteepestCosine = -0.1F;
/// Least radius of a shadow filter, texels.
inline constexpr float kLeastRadiusTexel = 1.0F;
/// Least squared distance between lamp and surface, square metres: a millimetre.
inline constexpr float kLeastDistance2 = 1e-6F;
/// Distance, ToF footprints to either side, over which a person's normal is measured.
inline constexpr float kNormalFootprints = 2.0F;
/// Most lamps of the gles back end: with their maps of objects and of people they take 11 KiB of the
/// 16 KiB that every driver's uniform block has.
inline constexpr int kMostLamps = 32;

// --- light: ambient light that objects hide (contact_shade.h)
/// Cells of an object's grid along an axis: within its box, and beyond it on each side;
/// kContactNodes are the grid points.
inline constexpr int kContactInside = 19;
inline constexpr int kContactOutside = 6;
inline constexpr int kContactNodes = 32;
/// Part of the light of an object's sides that a real surface receives: the sides' own shadows are
/// not known (docs/method/light.md).
inline constexpr float kSentPart = 0.5F;
/// Most objects with such a grid: OpenGL ES guarantees 256 layers of 3D textures.
inline constexpr int kMostContacts = 8;

// --- light: gloss, and ambient light by direction
/// Terms of spherical harmonics up to second order: 1 + 3 + 5.
inline constexpr int kAmbientTermCount = 9;
/// Factors of the first and second order in diffuse reflection (Ramamoorthi and Hanrahan 2001).
inline constexpr float kDiffuseBand1 = 0.6666667F;
inline constexpr float kDiffuseBand2 = 0.25F;
/// Reflectance of a dielectric at normal incidence (glTF 2.0, appendix B).
inline constexpr float kDielectric = 0.04F;
/// Smoother surfaces are drawn with this roughness: normals have 8 bits, and a lobe must not be
/// narrower than their steps.
inline constexpr float kLeastRoughness = 0.2F;

// --- shadow: people
/// Metres: largest radius of a ball that stands for a part of a person, whose radius is at most its
/// distance to the silhouette too.
inline constexpr float kPeopleRadiusM = 0.12F;
/// Least radius of a ball in blocks, so that balls of neighbouring blocks leave no gap.
inline constexpr float kLeastBallBlocks = 0.71F;
/// Metres: where blocks are smaller, every second one along both axes has a ball for all four.
inline constexpr float kSmallBlockM = 0.025F;
/// Metres: points that differ more in depth are different surfaces.
inline constexpr float kPeopleStepM = 0.3F;
/// Largest radius, blocks, in which the silhouette is searched: people nearer than a metre cast
/// thinner shadows.
inline constexpr int kMostBallBlocks = 16;

// --- background
/// Most faces of a background model: those of a cube.
inline constexpr int kMostFaces = 6;

// --- mix
/// Metres: an object up to this far behind the background still touches it, because the learned
/// depth is noisy.
inline constexpr float kContactSlackM = 0.02F;

// --- look (picture_look.h)
/// Period of the grain table along each axis, texels; a power of two.
inline constexpr int kGrainTexels = 256;
/// Standard deviations that the largest byte of the grain table stands for.
inline constexpr float kGrainSigmas = 3.5F;
/// Taps of the lens blur to either side.
inline constexpr int kBlurReach = 2;
/// Pixels of motion over the exposure: less than kLeastMotionPx is not drawn, more than
/// kMostMotionPx is cut, so that samples are at most 2 px apart.
inline constexpr float kLeastMotionPx = 0.3F;
inline constexpr float kMostMotionPx = 48.0F;
/// Most samples of the exposure.
inline constexpr int kMostMotionSamples = 24;

// --- focus
/// Pixels: discs of up to this radius are drawn as one pixel.
inline constexpr float kFocusSharpPx = 0.6F;
/// Relative difference of 1/z up to which neighbours are one surface.
inline constexpr float kFocusOneSurface = 0.06F;
/// Pixels: neighbours whose disc radii differ by less are one surface too.
inline constexpr float kFocusSameBlurPx = 0.75F;
/// A layer that covers less than this share of a pixel counts as empty.
inline constexpr float kFocusNoLight = 1e-5F;
/// Pixels: with Focus::fast every second tap is taken from twice this disc radius on, every third
/// from three times.
inline constexpr int kFocusFastFromPx = 5;
/// Steps a pixel of the radius in the table of disc areas.
inline constexpr int kFocusAreaSteps = 16;
/// Size in pixels of a tile, for which the largest disc is known.
inline constexpr int kFocusTileWide = 32;
inline constexpr int kFocusTileHigh = 8;

// --- exposure: pieces of the camera's tone curve, and the end of the first one; later ends double.
inline constexpr int kTonePieces = 6;
inline constexpr float kToneFirstKnot = 0.03125F;

}  // namespace mixrig::render
