// SPDX-License-Identifier: Apache-2.0
// The numbers of the passes that both back ends share. shaders/embed.cmake reads the lines
// `inline constexpr TYPE kName = VALUE;` of this file and writes them to common/constants.glsl as
// `const TYPE name = VALUE;`, so a number stands here and nowhere else. What a scene or a take
// decides is in passes.h instead.
#pragma once

namespace mixrig::render {

// --- All passes
/// Metres: nearer surfaces are not drawn. The GPU's window depth is this over z.
inline constexpr double kNearestM = 0.01;
/// A pixel shows a person from this matte on.
inline constexpr float kPersonMatte = 0.5F;
/// A pixel shows an object from this share on: more than two of its four samples.
inline constexpr float kVirtualShare = 0.51F;

// --- correct. All parts are of the depth unless said otherwise.
/// Metres: no depth camera measures farther; what claims to is unknown.
inline constexpr float kFarthestM = 1e4F;
/// A step is at most this part, however noisy the pixel: otherwise dark surfaces would swallow
/// people in front of them.
inline constexpr float kSteepest = 0.1F;
/// Of noise that only the bends around tell: at most the step of a surface this steep (tangent; it
/// is seen at 3.4 degrees). The scene's own steps bend too, and held links between a dark wall and
/// what stands before it.
inline constexpr float kSteepestSlope = 17.0F;
/// A larger bend is a step of the scene, not noise.
inline constexpr float kLargestBend = 0.04F;
/// Three depths lie on one plane up to this part of a step: less breaks noisy walls, more bridges
/// real steps.
inline constexpr float kPlanePart = 0.7F;
/// A single neighbour is averaged within this part of a step, a pair of opposite ones within the
/// whole: one side alone would pull a sloping surface over.
inline constexpr float kSmoothPart = 0.5F;
/// A pixel stays if this many of its eight neighbours lie at its depth; one may be another stray.
inline constexpr int kLeastSupporters = 2;
/// A hole is filled if so many of its eight neighbours are known: those of a corner.
inline constexpr int kLeastKnown = 3;
/// A stray piece has nothing but unknown pixels and surfaces farther than this factor around it. A
/// pixel that saw two surfaces can be a whole period of the modulation too near: at 120 MHz 1.25 m.
inline constexpr float kStrayGap = 1.2F;
/// ToF pixels: a stray piece lies within so many of each of its pixels, along rows and columns.
inline constexpr int kStrayReachPx = 10;
/// Square metres: a piece that is larger is a thing. A hand has about 0.01.
inline constexpr float kStrayAreaM2 = 0.002F;

// --- warp
/// w of a cut cell's corner is at least this part of its vertex' w: gradients at borders are noisy
/// and must not carry a corner far behind its surface.
inline constexpr float kLeastCornerPart = 0.5F;
/// How far a surface reaches past its last sample towards a farther one, in halves of a ToF pixel:
/// where the other camera looks past its border at what the ToF camera does not see, which is
/// better unknown than wrong...
inline constexpr float kOpenReach = 0.2F;
/// ...and where it covers what the ToF camera sees beside it: pixels that saw both surfaces are
/// more often taken for the farther one.
inline constexpr float kShutReach = 1.2F;
/// Pixels of the view that open or shut from where on these hold; 1 where none do, and between them
/// in proportion.
inline constexpr float kReachRampPx = 2.0F;
/// The nearer surface's share of a pixel at a step that measured nothing: it saw both.
inline constexpr float kHoleShare = 0.5F;
/// What differs from one surface by less than this share is noise.
inline constexpr float kMixedShare = 0.1F;
/// A depth that lies outside of both surfaces by this part of the step is of neither.
inline constexpr float kShareSlack = 0.1F;
/// Steps of less than this part of the depth tell no share.
inline constexpr float kSharePartOfDepth = 0.025F;
/// Halves of a ToF pixel: a surface reaches farther past no sample.
inline constexpr float kMostReach = 3.0F;
/// Where the plate is known: samples of its colour along a link, a quarter of a ToF pixel apart.
inline constexpr int kBorderSamples = 10;
/// Variance of square roots of linear light, of noise and blur. Colours tell a border by half where
/// they are so many of these deviations apart.
inline constexpr float kBorderSpread2 = 2e-4F;
inline constexpr float kBorderApart = 4.0F;
/// Variance of what samples are off the line between both colours, of the square of their distance:
/// light mixes along a line, its roots by up to 0.13 of the distance off it (red before cyan).
inline constexpr float kBorderBent2 = 0.02F;
/// Where a gap opens, the border by colours lies farther in by this, times what the reach is less
/// than whole: a pixel too far is wrong, one too near is unknown.
inline constexpr float kBorderBack = 0.6F;
/// Most indices of a cell: four quarters of two triangles.
inline constexpr int kCellIndices = 24;

// --- background, where it is drawn for each pose
/// A learned colour is not of the drawn surface if their depths differ by more than this part.
inline constexpr float kHiddenPart = 0.05F;
/// What is drawn lies on a plane for light if it is off it by no more than this part of the depth:
/// planes go through the feet of objects, up to 5 % off what was measured.
inline constexpr float kLightPlanePart = 0.08F;
/// Planes for light of a background model, at most: 16 a face.
inline constexpr int kMostLightPlanes = 96;

// --- virtual
/// Samples along each axis of a pixel, 2 x 2: coverage in quarters. They are turned (rotated grid):
/// the upper two lie right of the middles of their quarters and the lower two left of them, the
/// left ones above and the right ones below, so that no two share a row or a column and an edge
/// along an axis has five levels of coverage, not three.
inline constexpr int kVirtualSamples = 2;
/// By how much, px.
inline constexpr float kSampleTurnPx = 0.125F;
/// Samples of a pixel are of its nearest surface while their normals are within this cosine of that
/// of the nearest sample, and their inverse depths at least this part of its own. The other ones
/// are a surface of their own, lit by itself: the mean of two normals is that of neither.
inline constexpr float kOneSurfaceCosine = 0.9F;
inline constexpr float kOneSurfacePart = 0.98F;

// --- key: where votes decide
/// Side of a block in pixels. The cpu back end counts a block's row of states as one 64-bit word.
inline constexpr int kBlockPx = 8;
/// Least size of a person in ToF pixels; less is a speckle of depth noise.
inline constexpr float kSpeckleTofPx = 6.0F;
/// The same where more pixels around show what a mirror shows: a dark head in it has little depth,
/// some of it too near by noise.
inline constexpr float kMirrorSpeckleTofPx = 24.0F;
/// What is unknown in a block is background where the 3x3 blocks around show what a mirror shows,
/// at least this part of their foreground: hair and sleeves in a mirror have no depth, and look
/// like people.
inline constexpr float kMirrorPart = 0.1F;
/// Foreground is counted in the blocks within this radius, 5x5: a person's border that only touches
/// a block is no speckle.
inline constexpr int kSpeckleBlocks = 2;
/// Blocks within this radius of foreground are near it, 7x7: pixels without depth may be people
/// there (dark hair).
inline constexpr int kNearBlocks = 3;
/// Blocks within this radius of a border of the foreground are the band, 3x3: ToF depth is wrong by
/// a few pixels there.
inline constexpr int kBandBlocks = 1;
/// A block of the band also compares with people's colour in the nearest block within this radius
/// whose neighbours are all foreground: beside a border depth may lie over the room, and the mean
/// of a shirt and trousers is neither.
inline constexpr int kDeepBlocks = 3;
/// Depth of people's pixels that have none of their own: foreground is looked for so far along rows
/// and columns. Between two surfaces whose depths have this ratio lies what the ToF camera cannot
/// see, where they are as far apart as the parallax says, times kFillShadow, and kFillSlackPx.
inline constexpr int kFillReachPx = 24;
inline constexpr float kFillShadow = 1.25F;
inline constexpr float kFillSlackPx = 3.0F;
inline constexpr float kFillRatio = 1.06F;
/// A learned limit from here on means: no background depth, so depth cannot decide (doubt).
inline constexpr float kNoLimitW = 1e30F;
/// Of a camera that stands still: what is nearer than the background around such a place, by this
/// factor of its limit, is foreground all the same (a mirror, glass, black things).
inline constexpr float kHolePart = 1.1F;
/// And what is farther than it by this factor of that limit is background: who is seen in a mirror
/// is no person there.
inline constexpr float kBehindHole = 0.85F;

// --- key: colour votes, in log odds
/// Least standard deviation of a linear colour: camera noise in the dark...
inline constexpr float kColorNoise = 0.004F;
/// ...and flicker of light, as a part of the luminance.
inline constexpr float kColorFlicker = 0.05F;
/// A shadow darkens the background to this part at most; what is darker has another colour.
inline constexpr float kDarkestShadow = 0.85F;
/// Standard deviation of that darkening: at kDarkestShadow it counts as half of one.
inline constexpr float kShadowSigma = 0.3F;
/// Largest vote of one pixel's colour, a probability of 98 %: measured background outweighs it.
inline constexpr float kColorVoteCap = 4.0F;
/// What is brighter than the learned background by this factor and this linear light is no shadow
/// of a person: its vote for people may be larger, and outweighs measured background (white shoes
/// on the floor, whose depths differ by less than the noise). On walk 7 (kinect2, 640x512) key_iou
/// is 0.938 with a cap of 4, 0.942 with 6 and 8; with 6 for darker colours too 0.914.
inline constexpr float kBrighter = 1.1F;
inline constexpr float kBrighterLight = 0.02F;
inline constexpr float kBrighterVoteCap = 6.0F;
/// So it is with what no shade of the learned background explains: off its light times any factor
/// from this on to 1 by so many variances (a grey sole on a red rug, whose measured depth is the
/// rug's). With a factor of 0.5 the shadows of people are keyed.
inline constexpr float kDeepestShadow = 0.3F;
inline constexpr float kOtherColor = 16.0F;
/// The same where the room's colour is that of the pixels around: a rougher guess. On walk 3 to 9
/// (kinect2, 640x512) key_iou is 0.929 with 4, 0.931 with 2.5, 0.928 with 1.5.
inline constexpr float kRoomVoteCap = 2.5F;
/// Three channels of half a log ratio of variances (normal densities).
inline constexpr float kSpreadOdds = 1.5F;

// --- key: depth votes, in log odds
/// Taps to either side, half a ToF footprint apart: 5x5 of them.
inline constexpr int kDepthTapRadius = 2;
/// Measured people: they lag in ToF depth and reach over edges, so they count less. With 4 colour
/// no longer wins where depth reaches over by more than a footprint (key_iou of talk 8 0.967 to
/// 0.976, of edges 5 with sr3000 0.979 to 0.977).
inline constexpr float kForegroundWeight = 3.0F;
/// But where people are measured all around, colours do not take them away by little: a shirt like
/// the wall has no holes. All around are as many taps as above, half a block apart or this many ToF
/// footprints, whichever is more; of them this share is people (one may show background). Most of
/// 3x3 colours must be people's by more than these log odds: those of a gap between two legs, which
/// the ToF camera does not resolve, are less (seeds 5 and 8: people 90 % over -5.8, room under
/// -7.6).
inline constexpr float kInsideWeight = 6.0F;
inline constexpr float kInsideFootprints = 2.5F;
inline constexpr float kInsideShare = 0.95F;
inline constexpr float kInsideOdds = -7.0F;
/// Measured background is sure, while colour may be a shadow.
inline constexpr float kBackgroundWeight = 5.0F;
/// What a tap without measurement counts as, between background 0 and foreground 1: a little less
/// than even, so that holes alone do not become people.
inline constexpr float kUnknownShare = 0.4F;

// --- key: the matte is refined
/// Side of a tile in ToF footprints, before it is rounded down to 1, 2 or 4 pixels.
inline constexpr float kMatteTileFootprints = 1.6F;
/// Tiles to either side in which the matte is a line of the colour, 5x5 of them.
inline constexpr int kMatteWindowTiles = 2;
/// Variance of square roots of linear light up to which colours are alike, and the line is flat.
inline constexpr float kMatteSpread2 = 2e-4F;
/// The line is made steeper around one half: least squares leave a veil on both sides of a border.
inline constexpr float kMatteGain = 1.25F;

// --- key: the matte by both colours, where people's and background's differ enough
/// Standard deviation of a pixel about its share of two colours: noise, and part of the luminance.
inline constexpr float kShareNoise = 0.01F;
inline constexpr float kSharePart = 0.1F;
/// The share counts by half where the colours are as many deviations apart.
inline constexpr float kShareApart = 4.0F;
/// Background that is darker by no more than this may be in the shadow of people, and tells no
/// share: of people's colour counts what it differs from the most alike of these.
inline constexpr float kShareShadow = 0.4F;
/// Least part of a window that people fill.
inline constexpr float kShareLeast = 0.02F;

// --- light
/// Side of a tile in pixels: people's light is found once a tile, no ToF camera sees finer.
inline constexpr int kLightTilePx = 4;
/// Taps of the search for shadow casters, and of the shadow filter: the filter's steps of 1/24 are
/// what is seen, the search needs only a mean depth. Cost grows with both.
inline constexpr int kBlockerTapCount = 12;
inline constexpr int kShadowTapCount = 24;
/// The same of one of the four parts of a panel.
inline constexpr int kPartBlockerTapCount = 6;
inline constexpr int kPartShadowTapCount = 8;
/// Texels by which a receiver is lifted along its normal off its own shadow.
inline constexpr float kLiftTexels = 2.0F;
/// Of a ray of a lamp and the normal of what it lights: planes of surfaces count as no steeper.
inline constexpr float kSteepestCosine = -0.1F;
/// Texels: a filter is never narrower.
inline constexpr float kLeastRadiusTexel = 1.0F;
/// Square metres: nothing is lit from nearer than a millimetre.
inline constexpr float kLeastDistance2 = 1e-6F;
/// ToF footprints to either side over which a person's normal is measured.
inline constexpr float kNormalFootprints = 2.0F;
/// Most lamps of the gles back end: 4.5 KiB of the 16 KiB that every driver's uniform block has.
inline constexpr int kMostLamps = 32;

// --- light: what objects hide of the ambient light (contact_shade.h)
/// Cells of an object's grid along an axis: within its box, and beyond it on each side.
inline constexpr int kContactInside = 19;
inline constexpr int kContactOutside = 6;
inline constexpr int kContactNodes = 32;
/// Share of the light of an object's sides that real surfaces get. It is below 1 because the
/// shadows on these sides are not known.
inline constexpr float kSentPart = 0.5F;
/// Most objects with such a grid: OpenGL ES has 3D textures of 256 layers.
inline constexpr int kMostContacts = 8;

// --- light: gloss, and ambient light by direction
/// Spherical harmonics of second order: 1 + 3 + 5.
inline constexpr int kAmbientTermCount = 9;
/// What a diffuse surface keeps of the first and second order (Ramamoorthi and Hanrahan 2001).
inline constexpr float kDiffuseBand1 = 0.6666667F;
inline constexpr float kDiffuseBand2 = 0.25F;
/// A dielectric mirrors this share at right angles (glTF 2.0, appendix B).
inline constexpr float kDielectric = 0.04F;
/// What is smoother is drawn so: normals have 8 bits, and a lobe must not be narrower than their
/// steps.
inline constexpr float kLeastRoughness = 0.2F;

// --- shadow: people
/// Metres: half of a person's thickness is at most this, and at most half of the silhouette.
inline constexpr float kPeopleRadiusM = 0.12F;
/// Blocks: a ball is never smaller, so that those of neighbouring blocks leave no gap.
inline constexpr float kLeastBallBlocks = 0.71F;
/// Metres: of blocks that are smaller every second one along both axes has a ball, for all four.
inline constexpr float kSmallBlockM = 0.025F;
/// Metres: what differs by more in depth is another surface.
inline constexpr float kPeopleStepM = 0.3F;
/// Blocks in which the silhouette is looked for, at most: people nearer than a metre cast thinner
/// shadows.
inline constexpr int kMostBallBlocks = 16;

// --- background
/// Faces of a background model: those of a cube.
inline constexpr int kMostFaces = 6;

// --- mix
/// Metres: an object this far behind the background still touches it; noise of the learned depth.
inline constexpr float kContactSlackM = 0.02F;

// --- look (picture_look.h)
/// Texels: the grain repeats after so many, a power of two.
inline constexpr int kGrainTexels = 256;
/// Standard deviations that a byte of the grain reaches.
inline constexpr float kGrainSigmas = 3.5F;
/// Taps of the lens's blur to either side.
inline constexpr int kBlurReach = 2;
/// Pixels: shorter ways over the exposure blur nothing that is seen; longer ones are cut, so that
/// samples are at most 2 px apart.
inline constexpr float kLeastMotionPx = 0.3F;
inline constexpr float kMostMotionPx = 48.0F;
/// Samples of the exposure.
inline constexpr int kMostMotionSamples = 24;

// --- focus
/// Pixels: discs of this radius and less are one pixel.
inline constexpr float kFocusSharpPx = 0.6F;
/// Of 1/z: neighbours that are nearer to each other are one surface.
inline constexpr float kFocusOneSurface = 0.06F;
/// Pixels: or those whose discs differ by less in radius.
inline constexpr float kFocusSameBlurPx = 0.75F;
/// A layer with a smaller share of a pixel is empty.
inline constexpr float kFocusNoLight = 1e-5F;
/// Pixels: the fast rung takes every second tap from twice this radius, every third from three
/// times.
inline constexpr int kFocusFastFromPx = 5;
/// Steps a pixel of the table of disc areas.
inline constexpr int kFocusAreaSteps = 16;
/// Pixels of a tile: of the rows of it one greatest disc is known.
inline constexpr int kFocusTileWide = 32;
inline constexpr int kFocusTileHigh = 8;

// exposure: pieces of the curve of the camera's tones, and the end of the first one. Knots double.
inline constexpr int kTonePieces = 6;
inline constexpr float kToneFirstKnot = 0.03125F;

}  // namespace mixrig::render
