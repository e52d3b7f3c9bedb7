// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/people_sink.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "extras/people/watch/touch_stage.h"

namespace mixrig::session {

Result<std::unique_ptr<PeopleSink>> PeopleSink::create(
    const std::optional<std::filesystem::path>& folder, const plan::PeopleOptions& options,
    PeopleReport& report) {
  std::unique_ptr<PeopleSink> sink(new PeopleSink(folder, options, report));
  if (!sink->table_)
    return system_error(ErrorCode::kIo, "cannot write '" + sink->file_.string() + "'", errno);
  return sink;
}

PeopleSink::~PeopleSink() = default;

void PeopleSink::watch_touch(std::unique_ptr<TouchStage> touch) { touch_ = std::move(touch); }

PeopleSink::PeopleSink(const std::optional<std::filesystem::path>& folder,
                       const plan::PeopleOptions& options, PeopleReport& report)
    : tracker_(options), report_(report) {
  if (!folder) return;
  file_ = *folder / kTable;
  table_.open(file_);
  table_ << "frame,time_s,id,x_m,y_m,sigma_x_m,sigma_y_m,speed_m_s,height_m,area_m2,sight\n";
}

Result<void> PeopleSink::write(const output::CompositePtr& composite) {
  if (!composite->pose.ok()) return {};
  if (!report_.first_pose) {
    report_.first_pose = composite->world_from_target;
    report_.view = composite->view;
    report_.first_picture = composite->images.color;
  }
  const double time_s = times_.next(composite->capture->time_s);
  const HostTime begin = clock_.now();
  const std::span<const plan::Person> people =
      tracker_.add({composite->images.segmented_depth_m, composite->view,
                    composite->world_from_target, composite->images.mixed_depth_m},
                   time_s);
  report_.track_ms.add(milliseconds(clock_.now() - begin));
  ++report_.frames;
  report_.most_at_once = std::max(report_.most_at_once, people.size());
  for (const plan::Person& person : people) keep(person, *composite, time_s);
  dwell(people, time_s);
  if (touch_) MIXRIG_TRY(touch_->see(*composite, people, time_s));
  if (composite->true_people) judge(people, *composite, time_s);
  if (!table_) return system_error(ErrorCode::kIo, "cannot write '" + file_.string() + "'", errno);
  return {};
}

void PeopleSink::keep(const plan::Person& person, const output::Composite& composite,
                      double time_s) {
  const bool seen = person.sight != plan::Sight::kHidden;
  PersonPath& path = paths_[person.id];
  if (path.frames == 0) path.id = person.id, path.first_s = person.since_s;
  path.last_s = time_s;
  ++path.frames;
  path.seen_frames += seen ? 1 : 0;
  path.height_m = std::max(path.height_m, person.height_m);
  const double step_m =
      path.places.empty() ? 0 : (person.on_floor_m - path.places.back().on_floor_m).norm();
  if (path.places.empty() || step_m >= kPathStep_m) {
    if (!report_.keeps_places) path.places.clear();
    path.places.push_back({time_s, person.on_floor_m, seen});
    path.length_m += step_m;
  }
  if (file_.empty()) return;
  table_ << fmt::format("{},{:.4f},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.2f},{:.3f},{}\n",
                        composite.capture->number, time_s, person.id, person.on_floor_m.x(),
                        person.on_floor_m.y(), std::sqrt(person.covariance(0, 0)),
                        std::sqrt(person.covariance(1, 1)), person.velocity_m_s.norm(),
                        person.height_m, person.area_m2, plan::name(person.sight));
}

void PeopleSink::dwell(std::span<const plan::Person> people, double time_s) {
  const double step_s = std::min(kLongestStep_s, time_s - dwelt_s_.value_or(time_s));
  for (const plan::Person& person : people) report_.dwell.add(person.on_floor_m, step_s);
  dwelt_s_ = time_s;
}

void PeopleSink::judge(std::span<const plan::Person> people, const output::Composite& composite,
                       double time_s) {
  is_judged_ = true;
  there_.clear(), found_.clear();
  for (const capture::TruePerson& p : *composite.true_people)
    there_.push_back({p.number, p.x_m, p.y_m, p.visible_m2});
  for (const plan::Person& p : people)
    found_.push_back({p.id, p.on_floor_m.x(), p.on_floor_m.y(), p.covariance(0, 0),
                      p.covariance(1, 1), p.covariance(0, 1)});
  const Eigen::Vector3d& eye_m = composite.world_from_target.translation_m;
  judge_.add(there_, found_, {eye_m.x(), eye_m.y()}, time_s);
}

Result<void> PeopleSink::finish() {
  if (touch_) MIXRIG_TRY(touch_->finish());
  if (!file_.empty()) table_.close();
  if (!table_) return system_error(ErrorCode::kIo, "cannot write '" + file_.string() + "'", errno);
  for (auto& [id, path] : paths_) report_.people.push_back(std::move(path));
  if (is_judged_) report_.error = judge_.errors();
  return {};
}

nlohmann::json to_json(const PeopleReport& report) {
  nlohmann::json people = nlohmann::json::array();
  for (const PersonPath& p : report.people)
    people.push_back({{"id", p.id},
                      {"first_s", p.first_s},
                      {"last_s", p.last_s},
                      {"frames", p.frames},
                      {"seen_frames", p.seen_frames},
                      {"height_m", p.height_m},
                      {"path_m", p.length_m}});
  nlohmann::json json{{"frames", report.frames},
                      {"most_at_once", report.most_at_once},
                      {"people", people},
                      {"track_ms",
                       {{"p50", report.track_ms.quantile(0.5)},
                        {"p95", report.track_ms.quantile(0.95)},
                        {"max", report.track_ms.max()}}}};
  if (!report.error) return json;
  const measure::PeopleErrors& e = *report.error;
  json["swaps"] = e.swaps;
  json["error"] = {{"rms_mm", e.rms_mm},
                   {"p95_mm", e.p95_mm},
                   {"max_mm", e.max_mm},
                   {"hidden_rms_mm", e.hidden_rms_mm},
                   {"nees", e.nees},
                   {"within_95_pct", e.within_95_pct},
                   {"missed_pct", e.missed_pct},
                   {"false_pct", e.false_pct},
                   {"swaps", e.swaps},
                   {"broken", e.broken},
                   {"crossings", e.crossings},
                   {"occlusions", e.occlusions},
                   {"survived", e.survived},
                   {"nees_low", e.nees_low},
                   {"nees_high", e.nees_high},
                   {"samples", e.samples},
                   {"judged", e.judged}};
  return json;
}

}  // namespace mixrig::session
