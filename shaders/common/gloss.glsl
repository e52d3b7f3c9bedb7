// SPDX-License-Identifier: Apache-2.0
// Reflections of lamps and room (glTF 2.0, appendix B), and ambient light by direction. Camera
// axes, linear light; terms as in AmbientTerms. Needs common/constants.glsl and common/lamps.glsl.
uniform bool by_direction;
uniform vec3 ambient_terms[ambient_term_count];
uniform mat3 world_from_camera;
uniform float lobe_losses[9], lobe_grazings[6];

// The colour of a surface is base (1 - metallic) (diffuse - specular lost) + f0 straight + f90
// grazing.
struct Shading {
  vec3 diffuse, straight, grazing, lost;
};
struct Lobe {
  vec3 normal, to_eye, mirrored;
  float alpha, across;
};

// Ambient light from a direction, with its bands scaled.
vec3 ambient_from(vec3 direction, float band1, float band2) {
  if (!by_direction) return ambient;
  vec3 d = world_from_camera * direction;
  vec3 first = ambient_terms[1] * d.y + ambient_terms[2] * d.z + ambient_terms[3] * d.x;
  vec3 second = ambient_terms[4] * (d.x * d.y) + ambient_terms[5] * (d.y * d.z) +
                ambient_terms[6] * (3.0 * d.z * d.z - 1.0) + ambient_terms[7] * (d.x * d.z) +
                ambient_terms[8] * (d.x * d.x - d.y * d.y);
  return max(ambient_terms[0] + band1 * first + band2 * second, 0.0);
}
vec3 diffuse_ambient(vec3 normal) { return ambient_from(normal, diffuse_band1, diffuse_band2); }

Lobe lobe_of(vec3 position_m, vec3 normal, float roughness) {
  vec3 to_eye = normalize(-position_m);
  float side = dot(normal, to_eye), r = max(roughness, least_roughness);
  return Lobe(normal, to_eye, 2.0 * side * normal - to_eye, r * r, max(side, 1e-3));
}

// Adds the reflection of a lamp that gives `light` to the point.
void add_lamp_gloss(int i, vec3 position_m, Lobe lobe, vec3 light, inout Shading sum) {
  vec3 to_lamp = lamps[i].position_m.xyz - position_m;
  float away = max(length(to_lamp), 1e-6), radius = lamps[i].radius_m;
  float receiver = max(dot(lobe.normal, to_lamp) / away, 1e-3);
  vec3 middle = normalize(to_lamp / away + lobe.to_eye);
  float a2 = lobe.alpha * lobe.alpha, seen = 0.5 * radius / away;
  float wide2 = min(a2 + seen * seen, 1.0);
  float cosine = clamp(dot(lobe.normal, middle), 0.0, 1.0);
  float spread = cosine * cosine * (wide2 - 1.0) + 1.0;
  float mask = receiver * sqrt(lobe.across * lobe.across * (1.0 - a2) + a2) +
               lobe.across * sqrt(receiver * receiver * (1.0 - a2) + a2);
  vec3 mirrored = light * (wide2 / (spread * spread) * 0.5 / mask);
  float fresnel = pow(1.0 - clamp(dot(lobe.to_eye, middle), 0.0, 1.0), 5.0);
  sum.straight += mirrored * (1.0 - fresnel);
  sum.grazing += mirrored * fresnel;
  sum.lost += light * (dielectric + (1.0 - dielectric) * fresnel);
}

// Polynomials of host/render/contract/lobe.h.
float lobe_loss(int i, float c) {
  return lobe_losses[i] + c * (lobe_losses[i + 1] + c * lobe_losses[i + 2]);
}
float lobe_edge(int i, float r) {
  return lobe_grazings[i] + r * (lobe_grazings[i + 1] + r * lobe_grazings[i + 2]);
}

// Adds the reflected ambient light.
void add_ambient_gloss(Lobe lobe, inout Shading sum) {
  vec3 seen = ambient_from(lobe.mirrored, 1.0 + (diffuse_band1 - 1.0) * lobe.alpha,
                           1.0 + (diffuse_band2 - 1.0) * lobe.alpha);
  float r = sqrt(lobe.alpha), c = lobe.across, f2 = (1.0 - c) * (1.0 - c);
  float all = 1.0 - r * (lobe_loss(0, c) + r * (lobe_loss(3, c) + r * lobe_loss(6, c)));
  float grazing = max(f2 * (lobe_edge(0, r) + f2 * lobe_edge(3, r)), 0.0);
  float straight = max(all - grazing, 0.0);
  sum.straight += straight * seen;
  sum.grazing += grazing * seen;
  sum.lost += (dielectric * straight + grazing) * diffuse_ambient(lobe.normal);
}

// Colour of a surface: base premultiplied by the coverage, gloss metallic, roughness, specular.
vec3 shown(vec3 base, float coverage, vec3 gloss, Shading light) {
  vec3 straight = mix(vec3(dielectric * gloss.z * coverage), base, gloss.x);
  float grazing = mix(gloss.z, 1.0, gloss.x) * coverage;
  return (1.0 - gloss.x) * base * max(light.diffuse - gloss.z * light.lost, 0.0) +
         straight * light.straight + grazing * light.grazing;
}
