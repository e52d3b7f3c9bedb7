#version 310 es
// SPDX-License-Identifier: Apache-2.0
// One triangle over the whole target; passes take their pixel from gl_FragCoord.
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
