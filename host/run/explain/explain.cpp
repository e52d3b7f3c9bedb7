// SPDX-License-Identifier: Apache-2.0
#include "host/run/explain/explain.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/render/frame/frame_order.h"
#include "host/render/tables/prepare.h"
#include "host/run/loop/run.h"
#include "host/run/session/frame_cost.h"

namespace mixrig::session {
namespace {

std::string count(std::size_t n, const std::string& thing) {
  return std::to_string(n) + " " + thing + (n == 1 ? "" : "s");
}

std::size_t triangles(const render::CompositorSetup& setup) {
  std::size_t indices = 0;
  for (const auto& object : setup.objects)
    for (const auto& mesh : object.meshes) indices += mesh.indices.size();
  return indices / 3;
}

std::size_t maps_used(const std::vector<render::LampParams>& lamps) {
  std::size_t used = 0;
  for (const auto& lamp : lamps) used += lamp.map_size_texel > 0;
  return used;
}

std::string key_reason(const render::CompositorSetup& setup, render::KeyBy by) {
  if (by == render::KeyBy::kNothing)
    return "not run: the scene has neither background nor capture volume, nothing is foreground";
  const bool volume = by == render::KeyBy::kVolume;
  std::string reason = volume ? "foreground is what lies in the capture volume over its floor"
                              : "foreground against the learned background";
  if (setup.key.color) reason += ", by colour where depth is uncertain";
  if (setup.key.color && setup.key.refine) reason += ", the matte refined by the plate";
  if (render::joins_mattes(setup))
    reason += ", the matte before joins where the plate stayed alike";
  if (setup.capture_box && !volume) reason += ", cropped to the capture volume";
  return reason;
}

std::string light_reason(const render::CompositorSetup& setup, std::size_t maps, bool keyed) {
  if (setup.objects.empty()) return "not run: the scene has no object";
  std::string reason = maps == 0 ? "shades virtual objects"
                       : keyed   ? "shadows of virtual objects on real surfaces, shading of "
                                   "virtual objects"
                                 : "shading of virtual objects; without a background no real "
                                   "surface is known that could receive a shadow";
  if (setup.people_cast_shadows && keyed && !setup.light.lamps.empty())
    reason += "; people cast shadows on virtual surfaces";
  if (render::needs_room_shade(setup)) reason += "; what the room hides of the lamps, found once";
  if (setup.light.contact) reason += "; objects hide ambient light, found once";
  return reason;
}

std::string mix_reason(const render::CompositorSetup& setup) {
  const std::string what = "colour, mixed depth, segmented depth and matte in one pass";
  if (!setup.backdrop) return setup.open_walls ? what + "; walls hide no virtual object" : what;
  return what + (setup.backdrop->picture.empty()
                     ? "; the real background is left out, what nothing covers is transparent"
                     : "; a picture replaces the real background");
}

std::vector<PassLine> passes_of(const render::CompositorSetup& setup, const render::Tables& tables,
                                const render::FrameParams& frame) {
  const std::string view = text(setup.view.size_px), tof = text(setup.tof.size_px());
  const render::Rect& rect = frame.virtual_rect;
  const std::string virtual_size =
      rect.empty() ? "-" : text(Size{rect.x1 - rect.x0, rect.y1 - rect.y0});
  const std::size_t maps = maps_used(frame.lamps);
  const bool objects = !setup.objects.empty(), keyed = frame.key.by != render::KeyBy::kNothing;
  return {
      {"upload", view, "inputs to the device that draws"},
      {"plate", view,
       tables.plate_is_view ? "the lens is ideal: pixels are copied"
                            : fmt::format("samples the plate through its lens{}{}",
                                          setup.lens_moves ? ", which moves" : "",
                                          setup.vignetting.is_none() ? "" : ", evens its corners")},
      {"correct", setup.tof2 ? tof + " + " + text(setup.tof2->model.size_px()) : tof,
       std::string(setup.depth_is_distance ? "distance to z, " : "") +
           "flying pixels, depth steps" +
           (setup.tof2 ? "; what both depth cameras measure agrees, what one sees through goes"
                       : "")},
      {"warp", view,
       setup.tof2 ? "both depth cameras have other positions than the colour camera: the nearest "
                    "surface"
                  : "the depth camera has another position than the colour camera"},
      {"background", !setup.background_models.empty() ? view : "-",
       !setup.background_models.empty()
           ? "the model of the empty room, drawn for the pose of each frame"
           : "not run: the camera stands still"},
      {"virtual", virtual_size,
       objects ? count(setup.objects.size(), "object") + ", " +
                     count(triangles(setup), "triangle") + "; again only when the camera moves"
               : "not run: the scene has no object"},
      {"shadow", count(maps, "map"),
       maps > 0 ? "lamps with objects in front of them; again only when a map's size changes"
                : "not run: no lamp casts an object's shadow"},
      {"key", view, key_reason(setup, frame.key.by)},
      {"light", view, light_reason(setup, maps, keyed)},
      {"mix", view, mix_reason(setup)},
      {"focus", setup.focus ? view : "-",
       setup.focus ? "depth of field of a thin lens, by mixed depth"
                   : "not run: the scene has no [focus]"},
      {"readback", view, "results from the device that draws"},
  };
}

/// Which pose source is used, and what happens where it has none.
std::string pose_text(const Session& session, const capture::Capture& first) {
  const scene::CameraPoses& wanted = session.scene.camera;
  std::string text = session.poses->info().description;
  if (session.scene.pose_source == scene::PoseSource::kTake)
    return text + " (" + std::string(capture::name(first.pose_origin)) + ")";
  if (!session.poses->info().moves) return text;
  return text + fmt::format(
                    "; lost where there is none or it is older than {:.0f} ms: virtual "
                    "objects are {}",
                    1e3 * wanted.max_age_s,
                    wanted.when_lost == scene::WhenLost::kHide ? "hidden" : "frozen");
}

void add_times(const RunReport& report, std::vector<PassLine>& passes) {
  for (std::size_t i = 0; i < report.frames.stage_ms.size(); ++i)
    for (PassLine& pass : passes)
      if (pass.name == render::name(static_cast<render::Stage>(i)))
        pass.p50_ms = report.frames.stage_ms[i].quantile(0.5);
  // Transfers cost something on a GPU only.
  std::erase_if(passes, [](const PassLine& pass) {
    return pass.p50_ms < 0.005 && (pass.name == "upload" || pass.name == "readback");
  });
}

std::vector<ShadowMapLine> maps_of(const Session& session, const render::FrameParams& frame) {
  std::vector<ShadowMapLine> lines;
  for (std::size_t i = 0; i < frame.lamps.size(); ++i) {
    const int size = frame.lamps[i].map_size_texel, lamp = frame.lamps[i].part_of;
    // The parts of a panel are alike.
    if (i > 0 && frame.lamps[i - 1].part_of == lamp) continue;
    lines.push_back({session.scene.light.lamps[static_cast<std::size_t>(lamp)].name, size,
                     size > 0 ? "as many texels as its casters span in the view"
                              : "dark, faces away from all casters, or there is none"});
  }
  return lines;
}

template <typename T>
void add(std::vector<BufferLine>& lines, const char* name, const Image<T>& image) {
  if (image.empty()) return;
  lines.push_back({name, text(image.size()),
                   static_cast<std::size_t>(image.stride()) *
                       static_cast<std::size_t>(image.height()) * sizeof(T)});
}

std::vector<BufferLine> buffers_of(const Session& session, const render::Tables& tables,
                                   const render::FrameParams& frame, bool by_gpu) {
  std::vector<BufferLine> lines;
  add(lines, "rays of the ToF camera", tables.tof_ray);
  if (!by_gpu) {  // a GPU computes the lens for each pixel
    add(lines, "plate map", tables.plate_px);
    add(lines, "plate gain", tables.plate_gain);
  }
  add(lines, "key limit", tables.key_limit_w);
  add(lines, "key limit of reflections", tables.hole_behind_w);
  add(lines, "background as light falls on it", tables.light_depth_m);
  add(lines, "background normals", tables.background_normal);
  if (session.background) {
    add(lines, "background depth", session.background->depth_m);
    add(lines, "background depth spread", session.background->depth_sigma_m);
    add(lines, "background colour", session.background->color);
    add(lines, "background colour spread", session.background->color_sigma);
  }
  for (const model::RoomFaces& room : session.rooms) {
    add(lines, "room depth", room.depth_m);
    add(lines, "room depth spread", room.depth_sigma_m);
    add(lines, "room colour", room.color);
  }
  const auto add_map = [&](const char* name, const render::LampParams& lamp) {
    const auto side = static_cast<std::size_t>(lamp.map_size_texel);
    if (side > 0)
      lines.push_back({name, text(Size{lamp.map_size_texel, lamp.map_size_texel}),
                       side * side * sizeof(float)});
  };
  for (const render::LampParams& lamp : frame.lamps) add_map("shadow map", lamp);
  for (const render::LampParams& lamp : frame.people_lamps) add_map("shadow map of people", lamp);
  const Size view = session.setup.view.size_px;
  lines.push_back({"outputs", text(view), view.area() * (sizeof(Rgb8) + 2 * sizeof(float) + 1)});
  return lines;
}

}  // namespace

Result<Explanation> explain(Session& session, int frames, RunExtras extras, const Clock& clock,
                            const ProgressFn& progress) {
  RunOptions options;
  FrameRange range = session.default_frames();
  if (range.first <= range.second) {
    range.second = std::min(range.second, range.first + frames - 1);
    options.frames = range;
  }
  options.judge = false;
  MIXRIG_ASSIGN(const RunReport report,
                run(session, options, clock, progress, {.extras = std::move(extras)}));
  capture::Capture first;
  MIXRIG_ASSIGN(const bool there, session.source->read(range.first, first));
  if (!there) return Error{ErrorCode::kData, "the source has no frame to composite"};
  const render::Tables tables = render::make_tables(session.setup);
  render::FramePreparer preparer(session.setup);
  preparer.update(session.world_from_target(first));

  Explanation out;
  out.scene = session.scene.path.string();
  out.source = session.source->info().name;
  out.backend = report.compositor.backend;
  out.renderer = report.compositor.renderer;
  out.frames = static_cast<int>(report.frames.frame_ms.count());
  out.frame_p50_ms = report.frames.frame_ms.quantile(0.5);
  out.rss_mb = report.rss_mb;
  out.calibration = session.calibration.where + ": " + session.calibration.why;
  out.camera = pose_text(session, first);
  out.levels = scene::to_text(scene::rungs_of(session.scene), session.setup.focus.has_value());
  out.quality = report.quality;
  MIXRIG_ASSIGN(out.still_p50_ms, frame_cost_ms(session, first, 1, frames, 0, clock));
  if (session.poses->info().moves) {
    constexpr double kStep_m = 0.001;
    MIXRIG_ASSIGN(out.moving_p50_ms, frame_cost_ms(session, first, 1, frames, kStep_m, clock));
  }
  out.passes = passes_of(session.setup, tables, preparer.params());
  add_times(report, out.passes);
  for (const auto& extra : report.extras)
    for (PassLine& line : extra->passes()) out.passes.push_back(std::move(line));
  out.shadow_maps = maps_of(session, preparer.params());
  out.buffers = buffers_of(session, tables, preparer.params(), out.backend == "gles");
  return out;
}

nlohmann::json to_json(const Explanation& e) {
  nlohmann::json out = {{"scene", e.scene},
                        {"source", e.source},
                        {"backend", e.backend},
                        {"renderer", e.renderer},
                        {"frames", e.frames},
                        {"frame_p50_ms", e.frame_p50_ms},
                        {"still_p50_ms", e.still_p50_ms},
                        {"moving_p50_ms", nullptr},
                        {"calibration", e.calibration},
                        {"camera", e.camera},
                        {"levels", e.levels},
                        {"rss_mb", e.rss_mb},
                        {"passes", nlohmann::json::array()},
                        {"shadow_maps", nlohmann::json::array()},
                        {"buffers", nlohmann::json::array()}};
  if (e.moving_p50_ms) out["moving_p50_ms"] = *e.moving_p50_ms;
  if (e.quality) out["quality"] = to_json(*e.quality);
  for (const PassLine& p : e.passes)
    out["passes"].push_back(
        {{"name", p.name}, {"size", p.size}, {"why", p.why}, {"p50_ms", p.p50_ms}});
  for (const ShadowMapLine& m : e.shadow_maps)
    out["shadow_maps"].push_back({{"lamp", m.lamp}, {"size_texel", m.size_texel}, {"why", m.why}});
  for (const BufferLine& b : e.buffers)
    out["buffers"].push_back({{"name", b.name}, {"size", b.size}, {"bytes", b.bytes}});
  return out;
}

std::string to_text(const Explanation& e) {
  std::string out = fmt::format("{} in {}, {} ({})\n", e.scene, e.source, e.backend, e.renderer);
  out += fmt::format("  calibration  {}\n  camera       {}\n", e.calibration, e.camera);
  out += fmt::format("  quality      {}: {}\n", e.levels,
                     e.quality ? "chosen for quality.budget_ms" : "as the scene says");
  out += fmt::format("  {:<10} {:<11} {:>8}  {}\n", "pass", "size", "p50 ms", "why");
  if (e.quality) out += to_text(*e.quality);
  for (const PassLine& p : e.passes)
    out += fmt::format("  {:<10} {:<11} {:>8.2f}  {}\n", p.name, p.size, p.p50_ms, p.why);
  out += fmt::format("  {:<10} {:<11} {:>8.2f}  median of {} frames\n", "frame", "", e.frame_p50_ms,
                     e.frames);
  out += fmt::format("  {:<10} {:<11} {:>8.2f}  one frame repeatedly, the camera stands still\n",
                     "still", "", e.still_p50_ms);
  if (e.moving_p50_ms)
    out += fmt::format("  {:<10} {:<11} {:>8.2f}  the same, the camera moves\n", "moving", "",
                       *e.moving_p50_ms);
  if (!e.shadow_maps.empty())
    out += fmt::format("  {:<22} {:<11} {}\n", "shadow map", "texels", "why");
  for (const ShadowMapLine& m : e.shadow_maps)
    out += fmt::format("  {:<22} {:<11} {}\n", m.lamp,
                       m.size_texel > 0 ? text(Size{m.size_texel, m.size_texel}) : "none", m.why);
  out += fmt::format("  {:<26} {:<11} {:>8}\n", "buffer", "size", "MB");
  for (const BufferLine& b : e.buffers)
    out += fmt::format("  {:<26} {:<11} {:>8.1f}\n", b.name, b.size,
                       static_cast<double>(b.bytes) / 1e6);
  return out + fmt::format("  peak of the whole process  {:>20.0f} MB\n", e.rss_mb);
}

}  // namespace mixrig::session
