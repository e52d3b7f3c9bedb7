// SPDX-License-Identifier: Apache-2.0
// The page's own files, embedded at build time (files/).
#pragma once

#include <string_view>
#include <vector>

#include "host/operator/page/request.h"

namespace mixrig::page {

struct File {
  std::string_view name, text;
};
const std::vector<File>& all_files();

/// Answer with the file; 404 for an unknown name.
Answer file_answer(std::string_view name);

}  // namespace mixrig::page
