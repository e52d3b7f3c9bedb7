// SPDX-License-Identifier: Apache-2.0
#include "hal/base/result.h"

#include <cstring>

namespace mixrig {

std::string to_line(const Error& error) {
  if (error.sys_errno == 0) return error.context;
  return error.context + " (" + std::strerror(error.sys_errno) + ")";
}

Error system_error(ErrorCode code, std::string context, int sys_errno) {
  return Error{code, std::move(context), sys_errno};
}

}  // namespace mixrig
