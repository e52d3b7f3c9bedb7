// SPDX-License-Identifier: Apache-2.0
// Ambient light that virtual objects hide, and light that they send instead (contact_shade.h).
// Camera axes, metres. Needs common/constants.glsl.
// The texture holds HiddenShares: x, y, z of `up` in the lower half of the rows, of `down` in the
// upper half; the grids of the objects lie one behind the other.
layout(binding = 8) uniform sampler3D contact_hidden;
uniform int contact_count;
uniform mat4 object_from_camera[most_contacts];
uniform vec3 contact_low_m[most_contacts], contact_high_m[most_contacts];
uniform float contact_reach_m[most_contacts];
uniform vec3 contact_sent[6 * most_contacts];

struct Contact {
  vec3 sent;   // light that the objects send
  float open;  // remaining share of the ambient light
};

vec3 hidden_shares(int i, int half_of, vec3 node) {
  vec3 size = vec3(contact_nodes, 2 * contact_nodes, contact_nodes * contact_count);
  vec3 at = node + vec3(0.0, half_of * contact_nodes, i * contact_nodes);
  return texture(contact_hidden, (at + 0.5) / size).rgb;
}

// Light of the box's sides that face a point `off` the box.
vec3 light_sent(int i, vec3 off) {
  float all = dot(off, off);
  vec3 sum = vec3(0);
  for (int k = 0; k < 3; ++k) {
    float square = off[k] * off[k] / max(all, 1e-12);
    float up = all > 0.0 ? (off[k] > 0.0 ? square : 0.0) : 1.0 / 6.0;
    float down = all > 0.0 ? (off[k] < 0.0 ? square : 0.0) : 1.0 / 6.0;
    sum += up * contact_sent[6 * i + k] + down * contact_sent[6 * i + k + 3];
  }
  return sum;
}

// Contact light at a point. `lift` is 1 for a virtual surface, which is lifted off itself, and 0
// for a real one.
Contact contact_at(vec3 position_m, vec3 normal, float lift) {
  Contact sum = Contact(vec3(0), 1.0);
  for (int i = 0; i < contact_count; ++i) {
    vec3 low = contact_low_m[i], high = contact_high_m[i], size = max(high - low, 1e-6);
    vec3 n = mat3(object_from_camera[i]) * normal;
    vec3 at = (object_from_camera[i] * vec4(position_m, 1.0)).xyz +
              lift * 0.5 / float(contact_inside) * (high - low) * n;
    vec3 above = max(at - high, 0.0), below = max(low - at, 0.0), off = above - below;
    vec3 far = abs(off);
    float reach = contact_reach_m[i];
    if (max(far.x, max(far.y, far.z)) >= reach) continue;
    vec3 node = float(contact_outside) * (1.0 + sqrt(above / reach) - sqrt(below / reach)) +
                (clamp(at, low, high) - low) * (float(contact_inside) / size);
    node = clamp(node, 0.0, float(contact_nodes - 1));
    vec3 squares = n * n;
    float hidden = dot(squares * step(0.0, n), hidden_shares(i, 0, node)) +
                   dot(squares * step(0.0, -n), hidden_shares(i, 1, node));
    hidden = sum.open * min(hidden, 1.0);
    sum.open -= hidden;
    sum.sent += mix(sent_part, 1.0, lift) * hidden * light_sent(i, off);
  }
  return sum;
}
