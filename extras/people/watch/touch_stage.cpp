// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/touch_stage.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <nlohmann/json.hpp>

#include "extras/people/watch/object_motion.h"
#include "extras/people/watch/plan_room.h"

namespace mixrig::session {
namespace {

std::uint64_t& count_of(TouchReport& report, touch::EventKind kind) {
  return report.counts[static_cast<std::size_t>(kind)];
}

std::vector<bool> give_way(const scene::Scene& scene, const ObjectMotion* motion) {
  std::vector<bool> out;
  for (const scene::Object& object : scene.objects)
    out.push_back(motion != nullptr && object.physics);
  return out;
}

}  // namespace

std::vector<touch::Shape> shapes_of(const scene::Scene& scene) {
  std::vector<touch::Shape> shapes;
  for (const scene::Object& object : scene.objects) {
    std::vector<touch::Triangles> meshes;
    for (const scene::Mesh& mesh : object.model.meshes)
      if (!object.hidden) meshes.push_back({mesh.positions_m, mesh.indices});
    shapes.push_back(touch::make_shape(meshes, object.scale));
  }
  return shapes;
}

Result<std::unique_ptr<TouchStage>> TouchStage::create(
    const Session& session, const std::optional<std::filesystem::path>& folder,
    ObjectMotion* motion, TouchReport& report) {
  std::unique_ptr<TouchStage> stage(new TouchStage(session, motion, report));
  if (folder) {
    stage->file_ = *folder / kFile;
    stage->lines_.open(stage->file_);
    if (!stage->lines_)
      return system_error(ErrorCode::kIo, "cannot write '" + stage->file_.string() + "'", errno);
  }
  MIXRIG_ASSIGN(stage->out_, EventOut::open(session.scene));
  return stage;
}

TouchStage::TouchStage(const Session& session, ObjectMotion* motion, TouchReport& report)
    : session_(session),
      motion_(motion),
      report_(report),
      watch_(shapes_of(session.scene), {}, give_way(session.scene, motion)) {}

Result<void> TouchStage::see(const output::Composite& composite,
                             std::span<const plan::Person> people, double time_s) {
  if (!std::exchange(has_room_, true))
    watch_.set_room(room_points(session_, composite.world_from_target));
  frame_ = composite.capture->number, time_s_ = time_s;
  poses_ = composite.world_from_object;
  if (poses_.empty())
    for (const scene::Object& object : session_.scene.objects)
      poses_.push_back(object.world_from_object);
  if (!composite.objects_shown) poses_.clear();
  const HostTime begin = clock_.now();
  const auto events = watch_.add({{composite.images.segmented_depth_m, composite.view,
                                   composite.world_from_target, composite.images.mixed_depth_m},
                                  people,
                                  poses_,
                                  session_.setup.noise,
                                  time_s});
  if (motion_ != nullptr) {
    push(people, composite.world_from_target.translation_m, time_s);
    motion_->take_hits(time_s, hits_);
  }
  report_.touch_ms.add(milliseconds(clock_.now() - begin));
  out_->tell(people, frame_, time_s);
  MIXRIG_TRY(tell(hits_));
  return tell(events);
}

/// Gives the surface of people around the objects that move to ObjectMotion.
void TouchStage::push(std::span<const plan::Person> people, const Eigen::Vector3d& eye_m,
                      double time_s) {
  near_m_.clear();
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (!motion_->moves(i) || watch_.shapes()[i].parts.empty()) continue;
    const Eigen::AlignedBox3f& box = watch_.shapes()[i].box_m;
    const Eigen::Vector3f middle = (poses_[i] * box.center().cast<double>()).cast<float>();
    const float reach_m =
        0.5F * box.sizes().norm() + static_cast<float>(touch::PusherFinder::kReach_m);
    for (const plan::Person& person : people)
      for (const plan::SurfacePoint& p : person.surface)
        if ((p.at_m - middle).squaredNorm() < reach_m * reach_m) near_m_.push_back(p.at_m);
  }
  motion_->push(near_m_, eye_m, time_s);
}

Result<void> TouchStage::tell(std::span<const touch::Event> events) {
  for (const touch::Event& event : events) {
    ++count_of(report_, event.kind);
    const std::string text = event_json(event, session_.scene, frame_);
    if (!file_.empty()) lines_ << text << '\n' << std::flush;
    out_->tell(event, text);
  }
  if (!file_.empty() && !lines_)
    return system_error(ErrorCode::kIo, "cannot write '" + file_.string() + "'", errno);
  return {};
}

Result<void> TouchStage::finish() {
  MIXRIG_TRY(tell(watch_.finish(time_s_)));
  report_.json = out_->json_counts(), report_.osc = out_->osc_counts();
  if (file_.empty()) return {};
  lines_.close();
  if (!lines_) return system_error(ErrorCode::kIo, "cannot write '" + file_.string() + "'", errno);
  return {};
}

nlohmann::json to_json(const TouchReport& report) {
  nlohmann::json json;
  for (const touch::EventKind kind : {touch::EventKind::kEnter, touch::EventKind::kStay,
                                      touch::EventKind::kLeave, touch::EventKind::kHit})
    json[std::string(touch::name(kind))] = report.counts[static_cast<std::size_t>(kind)];
  json["datagrams"] = {{"sent", report.json.sent}, {"dropped", report.json.dropped}};
  json["osc"] = {{"sent", report.osc.sent}, {"dropped", report.osc.dropped}};
  json["touch_ms"] = {{"p50", report.touch_ms.quantile(0.5)},
                      {"p95", report.touch_ms.quantile(0.95)},
                      {"max", report.touch_ms.max()}};
  return json;
}

}  // namespace mixrig::session
