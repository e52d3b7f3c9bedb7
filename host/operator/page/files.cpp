// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/files.h"

namespace mixrig::page {
namespace {

std::string type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  if (name.ends_with(".yaml")) return "application/yaml";
  return "text/plain; charset=utf-8";
}

}  // namespace

Answer file_answer(std::string_view name) {
  for (const File& file : all_files())
    if (file.name == name) return {200, type_of(name), std::string(file.text), {}};
  return refusal(404, "there is no such file");
}

}  // namespace mixrig::page
