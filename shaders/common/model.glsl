// SPDX-License-Identifier: Apache-2.0
// Pixels of the view in the camera of the background model. Needs common/view.glsl.
uniform mat4 model_from_camera;
uniform vec2 model_focal_px, model_center_px;

struct ModelPlace {
  vec2 px;        // in the model camera
  ivec2 nearest;
  float z_m;      // in the model camera's axes
  bool inside;    // of the model's images
};

mat3 model_rotation() { return mat3(model_from_camera); }

// Of the surface at inverse depth w > 0; w = 0 is nowhere.
ModelPlace place_in_model(ivec2 at, float w, ivec2 model_size) {
  vec3 q = model_rotation() * ray_of(at) + w * model_from_camera[3].xyz;
  vec2 px = model_focal_px * q.xy / q.z + model_center_px;
  bool inside = w > 0.0 && q.z > 0.0 && min(px.x, px.y) >= -0.5 &&
                all(lessThan(px, vec2(model_size) - 0.5));
  return ModelPlace(px, inside ? ivec2(px + 0.5) : ivec2(0), q.z / w, inside);
}
