#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow: writes only depth (gl_convention.h: near / z).
void main() {}
