// SPDX-License-Identifier: Apache-2.0
// Rays against triangles by Embree 3.
#include "studio/tracer.h"

#include <cstring>

#include <embree3/rtcore.h>

namespace mixrig::studio {
namespace {

constexpr std::size_t kFineMesh =
    8000;  ///< triangles; people have more, furniture and object fewer

RTCDevice device_of(const TraceDevice& device) { return static_cast<RTCDevice>(device.handle()); }

RTCRay make_ray(const Vec3& origin, const Vec3& direction, float t_max) {
  RTCRay ray{};
  ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
  ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
  ray.tnear = 0, ray.tfar = t_max;
  ray.mask = ~0U;
  return ray;
}

void upload(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const void* data,
            std::size_t item_bytes, std::size_t count) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, item_bytes, count);
  std::memcpy(buffer, data, item_bytes * count);
}

}  // namespace

Result<TraceDevice> TraceDevice::create() {
  // One thread: the caller distributes the work, and builds are reproducible.
  RTCDevice device = rtcNewDevice("threads=1");
  if (device == nullptr)
    return Error{ErrorCode::kUnsupported,
                 "the ray tracer (Embree) does not start on this machine: it needs SSE2 or NEON"};
  TraceDevice result;
  result.handle_.reset(device, [](void* d) { rtcReleaseDevice(static_cast<RTCDevice>(d)); });
  return result;
}

TraceScene::TraceScene(const TraceDevice& device) : device_(device) {}
TraceScene::TraceScene(TraceScene&&) noexcept = default;
TraceScene& TraceScene::operator=(TraceScene&&) noexcept = default;
TraceScene::~TraceScene() = default;

void TraceScene::set(Mesh& mesh) {
  std::swap(mesh_, mesh);
  RTCScene scene = rtcNewScene(device_of(device_));
  scene_.reset(scene, [](void* s) { rtcReleaseScene(static_cast<RTCScene>(s)); });
  if (mesh_.indices.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device_of(device_), RTC_GEOMETRY_TYPE_TRIANGLE);
  upload(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh_.positions.data(), sizeof(Vec3),
         mesh_.positions.size());
  upload(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh_.indices.data(),
         3 * sizeof(std::uint32_t), mesh_.indices.size() / 3);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene);
}

bool TraceScene::intersect(const Vec3& origin, const Vec3& direction, float t_max, Hit& hit) const {
  if (empty()) return false;
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, t_max);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(static_cast<RTCScene>(scene_.get()), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const std::uint32_t* index = &mesh_.indices[3 * static_cast<std::size_t>(query.hit.primID)];
  const float b = query.hit.u, c = query.hit.v, a = 1 - b - c;
  hit.t = query.ray.tfar;
  hit.triangle = query.hit.primID;
  hit.material = mesh_.materials[query.hit.primID];
  hit.uv = a * mesh_.uv[index[0]] + b * mesh_.uv[index[1]] + c * mesh_.uv[index[2]];
  hit.normal =
      (a * mesh_.normals[index[0]] + b * mesh_.normals[index[1]] + c * mesh_.normals[index[2]])
          .normalized();
  hit.face = Vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  if (hit.face.dot(direction) > 0) hit.face = -hit.face;
  if (hit.normal.dot(hit.face) < 0) hit.normal = -hit.normal;
  return true;
}

bool TraceScene::blocked(const Vec3& from, const Vec3& to) const {
  if (empty()) return false;
  RTCRay ray = make_ray(from, to - from, 1.0F);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(static_cast<RTCScene>(scene_.get()), &context, &ray);
  return ray.tfar < 0;
}

std::uint16_t TraceScene::blocked16(const Vec3& from, const Vec3* targets,
                                    std::uint16_t wanted) const {
  if (empty() || wanted == 0) return 0;
  alignas(64) RTCRay16 rays;
  alignas(64) int valid[kLampSamples];
  for (int i = 0; i < kLampSamples; ++i) {
    valid[i] = (wanted >> i) & 1 ? -1 : 0;
    rays.org_x[i] = from.x(), rays.org_y[i] = from.y(), rays.org_z[i] = from.z();
    rays.dir_x[i] = targets[i].x() - from.x();
    rays.dir_y[i] = targets[i].y() - from.y();
    rays.dir_z[i] = targets[i].z() - from.z();
    rays.tnear[i] = 0, rays.tfar[i] = 1;
    rays.time[i] = 0, rays.mask[i] = ~0U, rays.id[i] = 0, rays.flags[i] = 0;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  // In a fine mesh the rays of a packet soon meet different triangles: one by one they are faster.
  context.flags = mesh_.materials.size() > kFineMesh ? RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT
                                                     : RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, static_cast<RTCScene>(scene_.get()), &context, &rays);
  unsigned blocked = 0;
  for (int i = 0; i < kLampSamples; ++i)
    if (valid[i] != 0 && rays.tfar[i] < 0) blocked |= 1U << i;
  return static_cast<std::uint16_t>(blocked);
}

}  // namespace mixrig::studio
