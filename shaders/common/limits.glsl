// SPDX-License-Identifier: Apache-2.0
// Sizes as in host/render/passes.h and host/render/gles/light_pass.h.
const int max_lamps = 32, blocker_count = 12, shadow_count = 24, light_tile_px = 4;
