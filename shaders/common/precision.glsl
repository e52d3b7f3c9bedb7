// SPDX-License-Identifier: Apache-2.0
// Depth and positions need 32 bits; colour is used in the same precision.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp sampler3D;
