// SPDX-License-Identifier: Apache-2.0
// Positions of view pixels in the faces of the background model, which lie one below the other in
// its pictures. Needs common/view.glsl and common/constants.glsl.
uniform mat4 face_from_camera[most_faces];
uniform int faces, face_rows;
uniform bool several;  // there are several models: what this one did not see is left to the others
uniform vec2 model_focal_px, model_center_px;

struct ModelPlace {
  vec2 px;        // in the pictures
  ivec2 nearest;
  float z_m;    // in axes of the face
  bool inside;  // of the face
  float score;  // 0 to 1, larger for the model that saw the surface better
};

mat3 first_face_rotation() { return mat3(face_from_camera[0]); }

// Place of the surface at inverse depth w > 0, in the face whose axis is nearest; none for w = 0.
ModelPlace place_in_model(ivec2 at, float w, ivec2 model_size) {
  vec3 ray = ray_of(at), q = vec3(0);
  int face = 0;
  for (int i = 0; i < faces; ++i) {
    vec3 p = mat3(face_from_camera[i]) * ray + w * face_from_camera[i][3].xyz;
    if (i > 0 && p.z <= q.z) continue;
    q = p;
    face = i;
  }
  vec2 px = model_focal_px * q.xy / q.z + model_center_px;
  bool inside = w > 0.0 && q.z > 0.0 && min(px.x, px.y) >= -0.5 &&
                all(lessThan(px, vec2(model_size.x, face_rows) - 0.5));
  px.y += float(face * face_rows);
  float score = inside ? q.z / dot(q, q) : 0.0;
  return ModelPlace(px, inside ? ivec2(px + 0.5) : ivec2(0), q.z / w, inside, score / (1.0 + score));
}

// Whether the model saw the surface of a place and not another one before it.
bool is_seen(ModelPlace place, float seen_w) {
  return place.inside && seen_w > 0.0 && abs(1.0 - place.z_m * seen_w) <= hidden_part;
}
