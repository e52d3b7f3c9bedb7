#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow: transforms a caster's vertex into a lamp's map.
//   position_m  object axes
#include "common/precision.glsl"
layout(location = 0) in vec3 position_m;
uniform mat4 clip_from_object;
void main() { gl_Position = clip_from_object * vec4(position_m, 1.0); }
