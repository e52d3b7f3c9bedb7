// SPDX-License-Identifier: Apache-2.0
// Reflections of lamps and room (glTF 2.0, appendix B), and ambient light by direction. Camera
// axes, linear light; terms as in AmbientTerms. Needs common/constants.glsl and common/lamps.glsl.
uniform bool by_direction;
uniform vec3 ambient_terms[ambient_term_count];
uniform mat3 world_from_camera;
uniform float lobe_losses[9], lobe_grazings[6];

// What a point reflects. Its colour is base (1 - metallic) (1 - specular lost) diffuse + f0 straight
// + f90 grazing, with lost the part of a dielectric's diffuse light that is reflected.
struct Surface {
  vec3 base;  // premultiplied by the coverage
  float coverage, metallic, specular;
  float alpha;  // square of the roughness
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

Surface surface_of(vec3 base, float coverage, vec3 gloss) {
  float r = max(gloss.y, least_roughness);
  return Surface(base, coverage, gloss.x, gloss.z, r * r);
}

// Colour for diffuse light, and shares of reflected light by Schlick's two terms.
vec3 reflected(Surface s, vec3 diffuse, float lost, vec3 straight, vec3 grazing) {
  vec3 f0 = mix(vec3(dielectric * s.specular * s.coverage), s.base, s.metallic);
  float f90 = mix(s.specular, 1.0, s.metallic) * s.coverage;
  return (1.0 - s.metallic) * (1.0 - s.specular * lost) * s.base * diffuse + f0 * straight +
         f90 * grazing;
}

float across_of(vec3 normal, vec3 to_eye) { return max(dot(normal, to_eye), 1e-3); }

// Colour by a lamp that gives `light` to the point.
vec3 of_lamp(int i, vec3 position_m, vec3 normal, Surface s, vec3 light) {
  vec3 to_lamp = lamps[i].position_m.xyz - position_m, to_eye = normalize(-position_m);
  float away = max(length(to_lamp), 1e-6), radius = lamps[i].radius_m;
  float receiver = max(dot(normal, to_lamp) / away, 1e-3), across = across_of(normal, to_eye);
  vec3 middle = normalize(to_lamp / away + to_eye);
  float a2 = s.alpha * s.alpha, seen = 0.5 * radius / away;
  float wide2 = min(a2 + seen * seen, 1.0);
  float cosine = clamp(dot(normal, middle), 0.0, 1.0);
  float spread = cosine * cosine * (wide2 - 1.0) + 1.0;
  float mask = receiver * sqrt(across * across * (1.0 - a2) + a2) +
               across * sqrt(receiver * receiver * (1.0 - a2) + a2);
  vec3 mirrored = light * (wide2 / (spread * spread) * 0.5 / mask);
  float fresnel = pow(1.0 - clamp(dot(to_eye, middle), 0.0, 1.0), 5.0);
  return reflected(s, light, dielectric + (1.0 - dielectric) * fresnel,
                   mirrored * (1.0 - fresnel), mirrored * fresnel);
}

// Polynomials of host/render/contract/lobe.h.
float lobe_loss(int i, float c) {
  return lobe_losses[i] + c * (lobe_losses[i + 1] + c * lobe_losses[i + 2]);
}
float lobe_edge(int i, float r) {
  return lobe_grazings[i] + r * (lobe_grazings[i + 1] + r * lobe_grazings[i + 2]);
}

// Colour by ambient light.
vec3 of_ambient(vec3 position_m, vec3 normal, Surface s) {
  vec3 to_eye = normalize(-position_m);
  vec3 mirrored = 2.0 * dot(normal, to_eye) * normal - to_eye;
  vec3 seen = ambient_from(mirrored, 1.0 + (diffuse_band1 - 1.0) * s.alpha,
                           1.0 + (diffuse_band2 - 1.0) * s.alpha);
  float r = sqrt(s.alpha), c = across_of(normal, to_eye), f2 = (1.0 - c) * (1.0 - c);
  float all = 1.0 - r * (lobe_loss(0, c) + r * (lobe_loss(3, c) + r * lobe_loss(6, c)));
  float grazing = max(f2 * (lobe_edge(0, r) + f2 * lobe_edge(3, r)), 0.0);
  float straight = max(all - grazing, 0.0);
  return reflected(s, diffuse_ambient(normal), dielectric * straight + grazing, straight * seen,
                   grazing * seen);
}
