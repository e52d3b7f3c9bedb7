// SPDX-License-Identifier: Apache-2.0
#include "host/app/explain.h"

#include <cstdio>

#include "host/app/run.h"
#include "host/measure/percentile.h"
#include "host/render/prepare.h"

namespace mixrig::app {
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

std::vector<PassLine> passes_of(const render::CompositorSetup& setup, const render::Tables& tables,
                                const render::FrameParams& frame) {
  const std::string view = text(setup.view.size_px), tof = text(setup.tof.size_px());
  const render::Rect& rect = frame.virtual_rect;
  const std::string virtual_size =
      rect.empty() ? "-" : text(Size{rect.x1 - rect.x0, rect.y1 - rect.y0});
  const std::size_t maps = maps_used(frame.lamps);
  const bool objects = !setup.objects.empty();
  return {
      {"upload", view, "inputs to where they are drawn"},
      {"plate", view,
       tables.plate_is_view ? "the lens is ideal: pixels are taken as they are"
                            : "samples the plate through its lens"},
      {"correct", tof,
       std::string(setup.depth_is_distance ? "distance to z, " : "") +
           "flying pixels, depth steps"},
      {"warp", view, "the depth camera stands beside the colour camera"},
      {"virtual", virtual_size,
       objects ? count(setup.objects.size(), "object") + ", " +
                     count(triangles(setup), "triangle") + "; again only when the camera moves"
               : "not run: the scene has no object"},
      {"shadow", count(maps, "map"),
       maps > 0 ? "lamps that objects stand in front of; again only when a map's size changes"
                : "not run: no lamp throws an object's shadow"},
      {"key", view,
       tables.has_background ? std::string("foreground against the learned background") +
                                   (setup.key.color ? ", by colour where depth is in doubt" : "") +
                                   (setup.capture_box ? ", cropped to the capture volume" : "")
                             : "not run: the scene has no background, nothing is foreground"},
      {"light", view,
       maps > 0 ? "shadows of virtual objects on what is real" : "shades virtual objects"},
      {"mix", view, "colour, mixed depth, segmented depth and matte in one pass"},
      {"readback", view, "results back from there"},
  };
}

void add_times(const RunReport& report, std::vector<PassLine>& passes) {
  for (std::size_t i = 0; i < report.stage_ms.size(); ++i)
    for (PassLine& pass : passes)
      if (pass.name == render::name(static_cast<render::Stage>(i)))
        pass.p50_ms = measure::quantile(report.stage_ms[i], 0.5);
  // Transfers cost something on a GPU only.
  std::erase_if(passes, [](const PassLine& pass) {
    return pass.p50_ms < 0.005 && (pass.name == "upload" || pass.name == "readback");
  });
}

std::vector<ShadowMapLine> maps_of(const Session& session, const render::FrameParams& frame) {
  std::vector<ShadowMapLine> lines;
  for (std::size_t i = 0; i < frame.lamps.size(); ++i) {
    const int size = frame.lamps[i].map_size_texel;
    lines.push_back({session.scene.light.lamps[i].name, size,
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
                                   const render::FrameParams& frame) {
  std::vector<BufferLine> lines;
  add(lines, "rays of the ToF camera", tables.tof_ray);
  add(lines, "plate map", tables.plate_px);
  add(lines, "key limit", tables.key_limit_w);
  add(lines, "background normals", tables.background_normal);
  if (session.background) {
    add(lines, "background depth", session.background->depth_m);
    add(lines, "background depth spread", session.background->depth_sigma_m);
    add(lines, "background colour", session.background->color);
    add(lines, "background colour spread", session.background->color_sigma);
  }
  for (const render::LampParams& lamp : frame.lamps) {
    if (lamp.map_size_texel == 0) continue;
    const auto side = static_cast<std::size_t>(lamp.map_size_texel);
    lines.push_back({"shadow map", text(Size{lamp.map_size_texel, lamp.map_size_texel}),
                     side * side * sizeof(float)});
  }
  const Size view = session.setup.view.size_px;
  lines.push_back({"outputs", text(view), view.area() * (sizeof(Rgb8) + 2 * sizeof(float) + 1)});
  return lines;
}

template <typename... Values>
std::string line(const char* format, Values... values) {
  char out[200];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

}  // namespace

Result<Explanation> explain(Session& session, int frames, const Clock& clock,
                            const ProgressFn& progress) {
  RunOptions options;
  FrameRange range = session.default_frames();
  if (range.first <= range.second) {
    range.second = std::min(range.second, range.first + frames - 1);
    options.frames = range;
  }
  options.judge = false;
  MIXRIG_ASSIGN(const RunReport report, run(session, options, clock, progress));
  take::TakeFrame first;
  MIXRIG_ASSIGN(const bool there, session.source->read(range.first, first));
  if (!there) return Error{ErrorCode::kData, "the source has no frame to look at"};
  const render::Tables tables = render::make_tables(session.setup);
  render::FramePreparer preparer(session.setup);
  preparer.update(session.world_from_target(first));

  Explanation out;
  out.scene = session.scene.path.string();
  out.source = session.source->info().name;
  out.backend = report.backend;
  out.renderer = report.renderer;
  out.frames = static_cast<int>(report.frame_ms.size());
  out.frame_p50_ms = measure::quantile(report.frame_ms, 0.5);
  out.rss_mb = report.rss_mb;
  out.passes = passes_of(session.setup, tables, preparer.params());
  add_times(report, out.passes);
  out.shadow_maps = maps_of(session, preparer.params());
  out.buffers = buffers_of(session, tables, preparer.params());
  return out;
}

nlohmann::json to_json(const Explanation& e) {
  nlohmann::json out = {{"scene", e.scene},
                        {"source", e.source},
                        {"backend", e.backend},
                        {"renderer", e.renderer},
                        {"frames", e.frames},
                        {"frame_p50_ms", e.frame_p50_ms},
                        {"rss_mb", e.rss_mb},
                        {"passes", nlohmann::json::array()},
                        {"shadow_maps", nlohmann::json::array()},
                        {"buffers", nlohmann::json::array()}};
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
  std::string out = e.scene + " in " + e.source + ", " + e.backend + " (" + e.renderer + ")\n";
  out += line("  %-10s %-11s %8s  %s\n", "pass", "size", "p50 ms", "why");
  for (const PassLine& p : e.passes)
    out +=
        line("  %-10s %-11s %8.2f  %s\n", p.name.c_str(), p.size.c_str(), p.p50_ms, p.why.c_str());
  out += line("  %-10s %-11s %8.2f  median of %d frames\n", "frame", "", e.frame_p50_ms, e.frames);
  if (!e.shadow_maps.empty()) out += line("  %-22s %-11s %s\n", "shadow map", "texels", "why");
  for (const ShadowMapLine& m : e.shadow_maps)
    out += line("  %-22s %-11s %s\n", m.lamp.c_str(),
                m.size_texel > 0 ? text(Size{m.size_texel, m.size_texel}).c_str() : "none",
                m.why.c_str());
  out += line("  %-26s %-11s %8s\n", "buffer", "size", "MB");
  for (const BufferLine& b : e.buffers)
    out += line("  %-26s %-11s %8.1f\n", b.name.c_str(), b.size.c_str(),
                static_cast<double>(b.bytes) / 1e6);
  return out + line("  peak of the whole process  %20.0f MB\n", e.rss_mb);
}

}  // namespace mixrig::app
