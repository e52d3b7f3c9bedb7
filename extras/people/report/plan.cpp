// SPDX-License-Identifier: Apache-2.0
#include "extras/people/report/plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "extras/people/report/plan_pictures.h"
#include "extras/people/watch/plan_room.h"
#include "extras/people/watch/touch_stage.h"
#include "hal/base/angles.h"
#include "hal/base/partial_path.h"
#include "host/math/image_io/image_io.h"
#include "host/scene/gltf/glb_writer.h"

namespace mixrig::session {
namespace {

constexpr float kPathHeight_m = 0.01F;  ///< over the floor, so that it does not hide the lines

std::optional<Eigen::Vector3d> brightest_lamp_m(const geometry::Light& light) {
  const auto power = [](const geometry::Lamp& lamp) {
    return lamp.intensity.x() + lamp.intensity.y() + lamp.intensity.z();
  };
  const auto lamp = std::max_element(
      light.lamps.begin(), light.lamps.end(),
      [&](const geometry::Lamp& a, const geometry::Lamp& b) { return power(a) < power(b); });
  if (lamp == light.lamps.end()) return std::nullopt;
  return lamp->position_m;
}

std::vector<Eigen::Vector2d> all_places(const std::vector<PersonPath>& people) {
  std::vector<Eigen::Vector2d> places;
  for (const PersonPath& path : people)
    for (const PathPlace& place : path.places) places.push_back(place.on_floor_m);
  return places;
}

std::vector<scene::Polyline> lines_of(const std::vector<PersonPath>& people) {
  std::vector<scene::Polyline> lines;
  for (const PersonPath& path : people) {
    scene::Polyline line{"person " + std::to_string(path.id), {}};
    for (const PathPlace& place : path.places)
      line.points_m.emplace_back(static_cast<float>(place.on_floor_m.x()),
                                 static_cast<float>(place.on_floor_m.y()), kPathHeight_m);
    if (line.points_m.size() > 1) lines.push_back(std::move(line));
  }
  return lines;
}

Result<void> suggest(const Session& session, const PlanOptions& options, const plan::FloorMap& map,
                     const std::vector<plan::RoomPoint>& points, Plan& plan) {
  if (options.places == 0) return {};
  if (plan.free_m2 == 0)
    return Error{ErrorCode::kData,
                 "plan: no free floor was seen to suggest places on: the scene needs a background "
                 "whose floor is at height 0 of its world"};
  Image<float> depth_m;
  const plan::RoomView view =
      view_of_room(points, plan.people.view, *plan.people.first_pose, depth_m);
  plan::PlacingOptions placing = options.placing;
  placing.lamp_m = brightest_lamp_m(session.setup.light);
  plan.places = plan::suggest_places(map, all_places(plan.people.people), options.box, view,
                                     options.places, placing);
  return {};
}

/// Rows of seconds, from the corner up.
nlohmann::json to_json(const plan::DwellGrid& grid) {
  nlohmann::json rows = nlohmann::json::array();
  for (int y = 0; y < grid.time_s.height(); ++y) {
    nlohmann::json row = nlohmann::json::array();
    for (int x = 0; x < grid.time_s.width(); ++x)
      row.push_back(std::round(100.0 * grid.time_s.at(x, y)) / 100);
    rows.push_back(std::move(row));
  }
  return {{"cell_m", grid.cell_m},
          {"corner_m", {grid.corner_m.x(), grid.corner_m.y()}},
          {"time_s", std::move(rows)}};
}

Result<void> write_pictures(const std::filesystem::path& folder, const PlanDrawing& drawing,
                            const PeopleReport& people) {
  MIXRIG_TRY(image_io::write_png(folder / "plan.png", draw_plan(drawing).view()));
  MIXRIG_TRY(image_io::write_png(folder / "picture.png",
                                 draw_in_picture(drawing, people.first_picture).view()));
  MIXRIG_TRY(
      image_io::write_png(folder / "dwell.png", draw_dwell(drawing, people.dwell.grid()).view()));
  const std::vector<scene::Polyline> lines = lines_of(people.people);
  if (lines.empty()) return {};
  return scene::write_glb(lines, folder / "paths.glb");
}

}  // namespace

Result<Plan> make_plan(Session& session, const PlanOptions& options, const Clock& clock,
                       const ProgressFn& progress) {
  MIXRIG_ASSIGN(PartialPath folder, make_partial_folder(options.out, kPlanReport));
  Plan plan;
  plan.people.keeps_places = true;
  MIXRIG_ASSIGN(auto sink, PeopleSink::create(folder.path(), options.people, plan.people));
  if (!session.scene.objects.empty() || session.scene.events) {
    MIXRIG_ASSIGN(auto touch,
                  TouchStage::create(session, folder.path(), nullptr, plan.events.emplace()));
    sink->watch_touch(std::move(touch));
  }
  RunOptions run_options;
  run_options.frames = options.frames;
  run_options.judge = false, run_options.true_people = true;
  run_options.watch_room = false;
  RunParts parts;
  parts.stop = options.stop;
  parts.sinks.push_back(std::move(sink));
  MIXRIG_TRY(run(session, run_options, clock, progress, std::move(parts)));
  if (!plan.people.first_pose)
    return Error{ErrorCode::kData,
                 "plan: no frame has a pose of the camera: give camera.pose in the scene"};
  const std::vector<plan::RoomPoint> points = room_points(session, *plan.people.first_pose);
  const plan::FloorMap map = plan::map_floor(points);
  plan.free_m2 = map.free_m2();
  plan.open_m2 = plan::open_m2(map, options.placing.margin_m);
  MIXRIG_TRY(suggest(session, options, map, points, plan));
  MIXRIG_TRY(write_pictures(folder.path(),
                            {map, plan.people.people, plan.places, options.box,
                             options.placing.margin_m, *plan.people.first_pose, plan.people.view},
                            plan.people));
  MIXRIG_TRY(write_file(folder.path() / kPlanReport, to_json(plan).dump(2) + "\n"));
  MIXRIG_TRY(folder.commit());
  return plan;
}

nlohmann::json to_json(const Plan& plan) {
  nlohmann::json json = to_json(plan.people);
  if (plan.events) json["events"] = to_json(*plan.events);
  json["free_m2"] = plan.free_m2;
  json["open_m2"] = plan.open_m2;
  json["dwell"] = to_json(plan.people.dwell.grid());
  json["places"] = nlohmann::json::array();
  for (const plan::FreePlace& p : plan.places)
    json["places"].push_back({{"position_m", {p.at_m.x(), p.at_m.y(), 0.0}},
                              {"yaw_deg", p.yaw_rad / kDeg},
                              {"score", p.score},
                              {"visible_share", p.visible_share},
                              {"shadow_share", p.shadow_share},
                              {"path_m", p.path_m},
                              {"room_m", p.room_m}});
  return json;
}

}  // namespace mixrig::session
