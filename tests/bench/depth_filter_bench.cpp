// SPDX-License-Identifier: Apache-2.0
// Measures the depth filters of Cortes Reina (2015, section 2.3.3) over their kernel size on a
// studio take with truth: wrong pixels (his figure 32) and time (figure 33). Given a name, it also
// writes plots, with our own correction as `mixrig run` measures it on the same frames. usage:
// depth_filter_bench TAKE FIRST LAST [PLOTS OUR_WRONG_PERCENT OUR_MS]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "host/capture/depth/window_filters.h"
#include "host/capture/take/take_source.h"
#include "host/judge/measure/band.h"
#include "host/judge/measure/splat.h"
#include "host/math/image_io/image_io.h"
#include "host/output/report/plot.h"

namespace mixrig {
namespace {

constexpr float kWrong_m = 0.1F;  // Cortes Reina 2015, section 4.2
constexpr double kSigma_m = 0.05, kSigmaLuma = 0.05;
constexpr int kBandWidth_px = 8;

/// One frame: depth as z of the ToF camera and in the view, the luma of the plate in the view,
/// truth.
struct Scene {
  Image<float> tof_z_m, view_m, luma;
  capture::Truth truth;
  Image<std::uint8_t> band;
};

/// The rig of the take.
struct Rig {
  explicit Rig(const capture::SourceInfo& info)
      : cameras(info), view(info.view ? *info.view : geometry::ideal_view(info.target)) {
    const Size size = info.tof.size_px();
    rays.reset(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const auto ray = info.tof.unproject({x, y});
        rays.row(y)[x] =
            ray ? measure::Ray{static_cast<float>(ray->x()), static_cast<float>(ray->y())}
                : measure::Ray{NAN, NAN};
      }
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn =
        info.target_from_tof.rotation.toRotationMatrix();
    std::copy_n(turn.data(), 9, motion.rotation.begin());
    const Eigen::Vector3d& shift = info.target_from_tof.translation_m;
    motion.translation_m = {shift.x(), shift.y(), shift.z()};
  }
  Image<float> warped(const Image<float>& z_m) const {
    Image<float> out;
    out.reset(view.size_px);
    measure::splat(z_m.view(), rays.view(), motion,
                   {view.fx_px, view.fy_px, view.cx_px, view.cy_px}, out.view());
    return out;
  }
  const capture::SourceInfo& cameras;
  geometry::Pinhole view;
  Image<measure::Ray> rays;
  measure::Motion motion;
};

Image<float> z_of(const Rig& rig, const Image<float>& depth_m) {
  Image<float> z_m = depth_m;
  if (rig.cameras.depth_kind == capture::DepthKind::kZ) return z_m;
  for (int y = 0; y < z_m.height(); ++y)
    for (int x = 0; x < z_m.width(); ++x) {
      const measure::Ray ray = rig.rays.row(y)[x];
      z_m.row(y)[x] /= std::sqrt(1 + ray.x * ray.x + ray.y * ray.y);
    }
  return z_m;
}

Image<float> luma_of(const Rig& rig, const Image<Rgb8>& plate) {
  Image<float> luma;
  luma.reset(rig.view.size_px);
  for (int y = 0; y < luma.height(); ++y)
    for (int x = 0; x < luma.width(); ++x) {
      const Eigen::Vector2d ray = rig.view.unproject({x, y});
      const auto px = rig.cameras.target.project({ray.x(), ray.y(), 1});
      if (!px) continue;
      const int u = std::clamp(static_cast<int>(std::lround(px->x())), 0, plate.width() - 1),
                v = std::clamp(static_cast<int>(std::lround(px->y())), 0, plate.height() - 1);
      const Rgb8 color = plate.at(u, v);
      luma.at(x, y) = (0.299F * color.r + 0.587F * color.g + 0.114F * color.b) / 255;
    }
  return luma;
}

struct Wrong {
  long pixels = 0, wrong = 0, band = 0, band_wrong = 0;
  void add(const Image<float>& view_m, const Scene& scene) {
    for (int y = 0; y < view_m.height(); ++y)
      for (int x = 0; x < view_m.width(); ++x) {
        const float truth = scene.truth.depth_m.at(x, y);
        if ((scene.truth.labels.at(x, y) & capture::Truth::kTofSees) == 0 || !(truth > 0)) continue;
        const float z = view_m.at(x, y);
        const bool bad = !measure::is_known(z) || std::abs(z - truth) > kWrong_m;
        ++pixels, wrong += bad;
        if (scene.band.at(x, y) != 0) ++band, band_wrong += bad;
      }
  }
  double percent() const {
    return 100.0 * static_cast<double>(wrong) / static_cast<double>(pixels);
  }
  double band_percent() const {
    return 100.0 * static_cast<double>(band_wrong) / static_cast<double>(band);
  }
};

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

using Filter = std::function<Image<float>(const Scene&, depth::Window, double& seconds)>;

/// Figures 32 and 33: a curve for each filter over its kernel size.
struct Curves {
  report::Plot wrong{
      "wrong by more than 10 cm, over kernel size", "kernel, pixels", "wrong, %", {}};
  report::Plot time{"time of a frame over kernel size", "kernel, pixels", "CPU time, ms", {}};
  static void add_level(report::Plot& plot, double level) {
    plot.series.push_back({"our correction", {{1, level, ""}, {13, level, ""}}});
  }
};

void run(const char* name, const std::vector<Scene>& scenes, const Filter& filter, Curves& curves) {
  curves.wrong.series.push_back({name, {}});
  curves.time.series.push_back({name, {}});
  double first_s = 0, first_percent = 0;
  for (const int radius : {0, 1, 2, 3, 4, 6}) {
    Wrong wrong;
    double seconds = 0;
    for (const Scene& scene : scenes) wrong.add(filter(scene, {radius}, seconds), scene);
    const double kernel = 2 * radius + 1;
    curves.wrong.series.back().points.push_back({kernel, wrong.percent(), ""});
    curves.time.series.back().points.push_back(
        {kernel, 1e3 * seconds / static_cast<double>(scenes.size()), ""});
    if (radius == 0) first_s = seconds, first_percent = wrong.percent();
    std::printf("| %s | %d | %.2f | %.1f | %+.1f | %.2f | %.1f |\n", name, 2 * radius + 1,
                wrong.percent(), wrong.band_percent(), 100 * (wrong.percent() / first_percent - 1),
                1e3 * seconds / static_cast<double>(scenes.size()), seconds / first_s);
  }
}

int bench(const std::string& take, int first, int last, Curves& curves) {
  const auto source = take::open_take_source(take);
  if (!source) return std::fprintf(stderr, "%s\n", to_line(source.error()).c_str()), 2;
  const Rig rig((*source)->info());
  std::vector<Scene> scenes(static_cast<std::size_t>(std::max(0, last - first + 1)));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    capture::Capture capture;
    const int number = static_cast<int>(i) + first;
    if (!(*source)->read(number, capture) || !(*source)->read_truth(number, scenes[i].truth))
      return std::fprintf(stderr, "%s: frame %d has no truth\n", take.c_str(), number), 2;
    scenes[i].tof_z_m = z_of(rig, capture.depth_m);
    scenes[i].view_m = rig.warped(scenes[i].tof_z_m);
    scenes[i].luma = luma_of(rig, capture.plate);
    scenes[i].band = measure::step_band(scenes[i].truth.depth_m.view(), kWrong_m, kBandWidth_px);
  }
  std::printf(
      "| filter | kernel | wrong %% | in the band %% | against kernel 1 %% | ms | time |\n"
      "|---|---|---|---|---|---|---|\n");
  const auto before_warp = [&](const auto& filter) {
    return [&rig, filter](const Scene& scene, depth::Window window, double& seconds) {
      Image<float> out;
      out.reset(scene.tof_z_m.size());
      const double begin = cpu_s();
      filter(scene.tof_z_m.view(), window, out.view());
      seconds += cpu_s() - begin;
      return rig.warped(out);
    };
  };
  run("Gaussian", scenes, before_warp(depth::gaussian), curves);
  run("median", scenes, before_warp(depth::median), curves);
  run("bilateral", scenes, before_warp([](auto in, depth::Window window, auto out) {
        depth::bilateral(in, window, kSigma_m, out);
      }),
      curves);
  run(
      "joint bilateral", scenes,
      [](const Scene& scene, depth::Window window, double& seconds) {
        Image<float> out;
        out.reset(scene.view_m.size());
        const double begin = cpu_s();
        depth::joint_bilateral(scene.view_m.view(), scene.luma.view(), window, kSigma_m, kSigmaLuma,
                               out.view());
        seconds += cpu_s() - begin;
        return out;
      },
      curves);
  return 0;
}

int plot(Curves& curves, const std::string& name, double our_wrong_percent, double our_ms) {
  Curves::add_level(curves.wrong, our_wrong_percent);
  Curves::add_level(curves.time, our_ms);
  constexpr Size kSize{720, 480};
  for (const auto& [plot, suffix] :
       {std::pair{&curves.wrong, "_wrong.png"}, std::pair{&curves.time, "_time.png"}})
    if (const auto written = image_io::write_png(name + suffix, report::draw(*plot, kSize));
        !written)
      return std::fprintf(stderr, "%s\n", to_line(written.error()).c_str()), 1;
  return 0;
}

}  // namespace
}  // namespace mixrig

int main(int count, char** arguments) {
  if (count != 4 && count != 7)
    return std::fprintf(
               stderr,
               "usage: depth_filter_bench TAKE FIRST LAST [PLOTS OUR_WRONG_PERCENT OUR_MS]\n"),
           2;
  mixrig::Curves curves;
  const int status =
      mixrig::bench(arguments[1], std::atoi(arguments[2]), std::atoi(arguments[3]), curves);
  if (status != 0 || count == 4) return status;
  return mixrig::plot(curves, arguments[4], std::atof(arguments[5]), std::atof(arguments[6]));
}
