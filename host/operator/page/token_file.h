// SPDX-License-Identifier: Apache-2.0
// The page's token in a file, which outlives a run. Private to this module.
#pragma once

#include <optional>
#include <string>

#include <sys/stat.h>

#include "hal/base/result.h"

namespace mixrig::page {

/// A file whose text, without its end of line, is the token. Used on the server's thread.
class TokenFile {
 public:
  explicit TokenFile(std::string path) : path_(std::move(path)) {}
  /// The file's token: 16 to 128 letters, digits, '-' and '_'. Where there is no file, it is made
  /// with a new token, for its owner alone. Errors: kUsage where others may read or write it, or
  /// for another text; kIo.
  Result<std::string> read();
  /// What read() returns where the file has changed, or is gone, since the last call of either;
  /// else nullopt.
  std::optional<Result<std::string>> changed();

 private:
  std::string path_;
  struct stat seen_ {};
};

}  // namespace mixrig::page
