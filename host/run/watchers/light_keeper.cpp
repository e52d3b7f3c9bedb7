// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/light_keeper.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "hal/base/srgb.h"
#include "host/math/geometry/lamp.h"
#include "host/render/frame/exposure.h"
#include "host/render/tables/prepare.h"
#include "host/room/lamps/body_columns.h"
#include "host/room/lamps/light_change.h"

namespace mixrig::session {
namespace {

constexpr int kSoon = 2;      // frames to the next measurement if one found a change not in use
constexpr int kLookStep = 5;  // frames: six measurements a second at 30 Hz
constexpr std::size_t kMostEvents = 100;
constexpr double kTold = 0.2;       // change of a factor that is an event
constexpr double kSame = 0.15;      // least change: occlusion of lamps by the room is not exact
constexpr double kOfLight = 0.02;   // least change as a share of all light: people hide lamps too
constexpr double kCertain = 3;      // least change in its sigmas
constexpr double kAgreed = 0.6;     // least LightChange::agreed: a shadow shows on few surfaces
constexpr int kLeastSurfaces = 3;   // least number of surfaces that show a change
constexpr double kRepeated = 0.15;  // largest difference of two measurements that agree
constexpr double kSurface_m = 1;    // side of the cells in which places are one surface
constexpr double kHidden = 0.15;    // least share in a place's light of a lamp that must be visible
constexpr double kLeastSeen = 0.5;  // least share of a source's evidence, else its factor stays
constexpr int kPeopleStep_px = 4;   // between pixels of people
constexpr double kExplained = 0.5;  // least share of explained places, else nothing is changed
constexpr float kDarkest = 0.02F, kBrightest = 0.85F;  // linear

float luminance_of(const Rgb8& c) {
  const auto& linear = linear_of_srgb_bytes();
  return render::luminance({linear[c.r], linear[c.g], linear[c.b]});
}

/// Ratio of each lamp's light to its learned light; 1 if the change is insignificant. Half the
/// threshold holds for a lamp that has changed before.
std::vector<double> factors_of(const lights::LightChange& change, const std::vector<double>& told) {
  std::vector<double> factors;
  for (Eigen::Index j = 0; j < change.shown.size(); ++j) {
    const double factor = change.shown[j] / change.gain;
    const double least =
        std::max({kSame, kCertain * change.sigma[j] / change.gain, kOfLight / change.part[j]});
    const bool changed = told[static_cast<std::size_t>(j)] != 1;
    const bool is_seen = change.agreed[j] >= kAgreed && change.surfaces[j] >= kLeastSurfaces;
    const bool is_same = std::abs(factor - 1) < (changed ? 0.5 : 1.0) * least;
    factors.push_back(is_same || !(is_seen || changed) ? 1 : factor);
  }
  return factors;
}

/// Numbers for cells of a surface: places that lie together and face one side.
class SurfaceCells {
 public:
  int number_of(const glm::dvec3& at_m, const glm::dvec3& normal) {
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    const glm::ivec3 cell(glm::floor(at_m / kSurface_m));
    const auto next = static_cast<int>(numbers_.size());
    return numbers_.try_emplace({cell.x, cell.y, cell.z, axis}, next).first->second;
  }

 private:
  std::map<std::tuple<int, int, int, int>, int> numbers_;
};

}  // namespace

/// write() and finish() on the thread of the sink; take() on any.
class LightSink final : public output::CompositeSink {
 public:
  explicit LightSink(const Session& session)
      : session_(session),
        tables_(render::make_tables(session.setup)),
        meter_(tables_, session.setup.background),
        told_(1 + session.setup.light.lamps.size(), 1.0),
        seen_(told_),
        used_(told_) {}

  std::string_view name() const override { return "light"; }
  render::OutputMask wanted(int /*number*/) const override {
    return render::kMatte | render::kSegmentedDepth;
  }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }
  std::vector<float> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(found_, {});
  }
  /// Whether the last measurement found a change that is not in use yet.
  bool looks_soon() const { return looks_soon_; }
  const LightReport& report() const { return report_; }

 private:
  /// A place of the meter and what gave light to it when it was learned.
  struct Known {
    render::ExposureMeter::Place place;
    double learned = 0;  ///< luminance
    Eigen::VectorXd share;
    int surface = 0;
    Eigen::Vector3d at_m{0, 0, 0};  ///< world
  };
  void learn(const geometry::Pose& world_from_camera);
  void gather(const output::Composite& composite);
  lights::BodyColumns people(const output::Composite& composite);
  bool may_be_hidden(const Known& known, const lights::BodyColumns& people) const;
  std::vector<double> repeated(const std::vector<double>& now);
  void tell(int frame, const std::vector<double>& factors);

  const Session& session_;
  render::Tables tables_;
  render::ExposureMeter meter_;
  std::vector<Known> known_;
  Eigen::VectorXd told_by_all_;  ///< sum of squares of each source's share, over known_
  std::vector<lights::WatchedPlace> places_;
  std::vector<Eigen::Vector3d> people_m_;
  std::vector<double> told_;         ///< factors of the last events
  std::vector<double> seen_, used_;  ///< factors of the last look; those that were taken over
  std::atomic<bool> looks_soon_ = false;
  SystemClock clock_;
  LightReport report_;
  std::mutex mutex_;
  std::vector<float> found_;  ///< guarded by mutex_
};

/// Shares of the light by source, at the places that are known and neither dark nor saturated. What
/// the room hides of the lamps is left out.
void LightSink::learn(const geometry::Pose& world_from_camera) {
  const render::CompositorSetup& setup = session_.setup;
  const glm::dmat4 world_from = render::to_glm(world_from_camera.matrix());
  const std::vector<geometry::Lamp>& lamps = setup.light.lamps;
  const double ambient = render::luminance(render::to_glm(setup.light.ambient));
  SurfaceCells cells;
  for (const render::ExposureMeter::Place& place : meter_.places()) {
    const Rgbf& c = setup.background.color.row(place.view_y)[place.view_x];
    const float learned = render::luminance({c.r, c.g, c.b});
    const float z = tables_.light_depth_m.row(place.view_y)[place.view_x];
    const render::PackedNormal n = tables_.background_normal.row(place.view_y)[place.view_x];
    if (place.plate_x < 0 || !(learned > kDarkest && learned < kBrightest) || !(z > 0)) continue;
    if (n.x == 0 && n.y == 0 && n.z == 0) continue;
    const Eigen::Vector2d ray = setup.view.unproject(Eigen::Vector2d(place.view_x, place.view_y));
    const glm::dvec3 at_m(world_from * glm::dvec4(ray.x() * z, ray.y() * z, z, 1));
    const glm::dvec3 normal = glm::dmat3(world_from) * glm::normalize(glm::dvec3(n.x, n.y, n.z));
    Known known{place, learned, Eigen::VectorXd(1 + lamps.size()), cells.number_of(at_m, normal),
                render::to_eigen(at_m)};
    known.share[0] = ambient;
    for (std::size_t k = 0; k < lamps.size(); ++k)
      known.share[static_cast<Eigen::Index>(k) + 1] =
          geometry::irradiance(lamps[k], known.at_m, render::to_eigen(normal)) *
          double{render::luminance(render::to_glm(lamps[k].intensity))};
    if (!(known.share.sum() > 0)) continue;
    known.share /= known.share.sum();
    known_.push_back(std::move(known));
  }
  places_.reserve(known_.size());
  told_by_all_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(told_.size()));
  for (const Known& known : known_) told_by_all_ += known.share.cwiseAbs2();
}

/// Columns around the surface of people that the camera sees, in world axes.
lights::BodyColumns LightSink::people(const output::Composite& composite) {
  const Image<float>& depth_m = composite.images.segmented_depth_m;
  const Eigen::Matrix4d world_from = composite.world_from_target.matrix();
  people_m_.clear();
  for (int y = 0; y < depth_m.height(); y += kPeopleStep_px)
    for (int x = 0; x < depth_m.width(); x += kPeopleStep_px) {
      const double z = depth_m.row(y)[x];
      if (!(z > 0)) continue;
      const Eigen::Vector2d ray = session_.setup.view.unproject(Eigen::Vector2d(x, y));
      people_m_.push_back((world_from * Eigen::Vector4d(ray.x() * z, ray.y() * z, z, 1)).head<3>());
    }
  return lights::BodyColumns(people_m_);
}

bool LightSink::may_be_hidden(const Known& known, const lights::BodyColumns& people) const {
  const std::vector<geometry::Lamp>& lamps = session_.setup.light.lamps;
  for (std::size_t k = 0; k < lamps.size(); ++k)
    if (known.share[static_cast<Eigen::Index>(k) + 1] > kHidden &&
        people.hides(lamps[k].position_m, known.at_m))
      return true;
  return false;
}

/// Fills places_ with places that neither people nor their shadows cover.
void LightSink::gather(const output::Composite& composite) {
  const Image<Rgb8>& plate = plate_of(*composite.capture);
  const lights::BodyColumns bodies = people(composite);
  places_.clear();
  for (const Known& known : known_) {
    const render::ExposureMeter::Place& at = known.place;
    if (composite.images.matte.row(at.view_y)[at.view_x] > 0) continue;
    const float seen = luminance_of(plate.row(at.plate_y)[at.plate_x]);
    if (!(seen < kBrightest) || may_be_hidden(known, bodies)) continue;
    places_.push_back({known.share, at.gain * seen / known.learned, known.surface});
  }
}

/// Factors on which two measurements in a row agree; the others stay as they are in use, and so do
/// those of sources whose light people cover or may hide.
std::vector<double> LightSink::repeated(const std::vector<double>& now) {
  bool differs = false;
  Eigen::VectorXd told_by = Eigen::VectorXd::Zero(told_by_all_.size());
  for (const lights::WatchedPlace& place : places_) told_by += place.share.cwiseAbs2();
  for (std::size_t j = 0; j < now.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    if (told_by[at] < kLeastSeen * told_by_all_[at]) continue;
    if (std::abs(now[j] - seen_[j]) <= kRepeated) used_[j] = now[j];
    differs |= std::abs(now[j] - used_[j]) > kRepeated;
  }
  looks_soon_ = differs;
  seen_ = now;
  return used_;
}

Result<void> LightSink::write(const output::CompositePtr& composite) {
  if (!composite->pose.ok()) return {};
  const HostTime begin = clock_.now();
  if (known_.empty()) learn(composite->world_from_target);
  gather(*composite);
  const auto change = lights::fit_light_change(places_);
  ++report_.looks;
  if (!change || change->places_weight < kExplained || change->gain_weight < 0.3) {
    ++report_.unexplained;
    return {};
  }
  // The compositor multiplies its light by the gain that its meter reads.
  const glm::vec3 gain = meter_.gain(plate_of(*composite->capture));
  const double read = render::luminance(gain);
  const std::vector<double> now = repeated(factors_of(*change, told_));
  std::vector<float> factors;
  for (const double factor : now)
    factors.push_back(static_cast<float>(factor * change->gain / read));
  tell(composite->capture->number, now);
  report_.watch_ms.add(milliseconds(clock_.now() - begin));
  const std::lock_guard lock(mutex_);
  found_ = std::move(factors);
  return {};
}

void LightSink::tell(int frame, const std::vector<double>& factors) {
  for (std::size_t j = 0; j < told_.size(); ++j) {
    if (std::abs(factors[j] - told_[j]) < kTold) continue;
    told_[j] = factors[j];
    if (report_.changed.size() >= kMostEvents) continue;
    report_.changed.push_back(
        {frame, j == 0 ? "ambient" : session_.scene.light.lamps[j - 1].name, factors[j]});
    const LampEvent& event = report_.changed.back();
    log_info("light", fmt::format("frame {}: {} gives {:.2f} times the light that it did", frame,
                                  event.lamp, event.factor));
  }
}

nlohmann::json to_json(const LightReport& report) {
  nlohmann::json changed = nlohmann::json::array();
  for (const LampEvent& event : report.changed)
    changed.push_back({{"frame", event.frame}, {"lamp", event.lamp}, {"factor", event.factor}});
  return {{"changed", changed},
          {"looks", report.looks},
          {"unexplained", report.unexplained},
          {"watch_ms", report.watch_ms.count() > 0 ? report.watch_ms.quantile(0.5) : 0.0}};
}

Result<void> LightKeeper::open(WorkGate* gate) {
  const render::CompositorSetup& setup = session_.setup;
  if (setup.background.color.empty() || setup.lens_moves || setup.light.lamps.empty() ||
      setup.objects.empty() || (session_.poses && session_.poses->info().moves))
    return Error{
        ErrorCode::kFormat,
        session_.scene.path.string() +
            ": light.follow: needs lamps, a virtual object, a camera that stands still, and a "
            "background of empty frames in place of a scanned room: remove follow"};
  watch_.open(std::make_unique<LightSink>(session_), live_, gate);
  return {};
}

Result<void> LightKeeper::push(const output::CompositePtr& composite) {
  constexpr render::OutputMask kNeeded = render::kMatte | render::kSegmentedDepth;
  const int number = composite->capture->number;
  if (!is_open() || (composite->images.wanted & kNeeded) != kNeeded) return {};
  const bool is_soon = watch_.sink()->looks_soon() && number >= last_look_ + kSoon;
  if (number < next_look_ && !is_soon) return {};
  next_look_ = number - number % kLookStep + kLookStep, last_look_ = number;
  return watch_.push(composite);
}

void LightKeeper::take_factors() {
  if (!is_open()) return;
  if (std::vector<float> found = watch_.sink()->take(); !found.empty()) factors_ = std::move(found);
}

render::FrameLight LightKeeper::changed(const scene::Light& light,
                                        const std::optional<render::FrameLight>& live) {
  render::FrameLight now{render::to_glm(light.ambient), static_cast<float>(light.exposure)};
  if (live) now.ambient = live->ambient, now.exposure = live->exposure;
  intensity_.resize(light.lamps.size());
  for (std::size_t k = 0; k < intensity_.size(); ++k) {
    const bool edited = live && k < live->intensity.size();
    intensity_[k] = edited ? live->intensity[k] : render::to_glm(light.lamps[k].intensity);
    if (k + 1 < factors_.size()) intensity_[k] *= factors_[k + 1];
  }
  if (!factors_.empty()) now.ambient *= factors_[0];
  now.intensity = intensity_;
  return now;
}

Result<void> LightKeeper::finish() { return watch_.finish(); }

LightReport LightKeeper::report() const { return watch_.sink()->report(); }

}  // namespace mixrig::session
