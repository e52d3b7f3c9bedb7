// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/token_file.h"

#include <array>
#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "host/operator/page/request.h"

namespace mixrig::page {
namespace {

constexpr std::size_t kLeastToken = 16, kMostToken = 128;

struct TokenHandle {
  int fd = -1;
  ~TokenHandle() {
    if (fd >= 0) ::close(fd);
  }
};

Error token_error(const std::string& path, const std::string& what) {
  return Error{ErrorCode::kUsage, "--page-token " + path + ": " + what};
}

/// Writes a new token under a temporary name, which mkstemp makes for the owner alone.
Result<std::string> make_token_file(const std::string& path) {
  const std::string token = random_token(), text = token + "\n";
  std::string partial = path + ".XXXXXX";
  const TokenHandle file{::mkstemp(partial.data())};
  const bool whole =
      file.fd >= 0 &&
      ::write(file.fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      ::fsync(file.fd) == 0 && ::rename(partial.c_str(), path.c_str()) == 0;
  if (whole) return token;
  const Error error =
      system_error(ErrorCode::kIo, "--page-token " + path + ": cannot be written", errno);
  if (file.fd >= 0) ::unlink(partial.c_str());
  return error;
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_ino == b.st_ino && a.st_dev == b.st_dev && a.st_size == b.st_size &&
         a.st_mode == b.st_mode && a.st_ctim.tv_sec == b.st_ctim.tv_sec &&
         a.st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

}  // namespace

Result<std::string> TokenFile::read() {
  // A pipe of that name must not make the page wait.
  const TokenHandle file{::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.fd < 0 && errno == ENOENT) {
    auto token = make_token_file(path_);
    if (token) (void)::stat(path_.c_str(), &seen_);
    return token;
  }
  if (file.fd < 0 || ::fstat(file.fd, &seen_) != 0)
    return system_error(ErrorCode::kIo, "--page-token " + path_ + ": cannot be read", errno);
  if (!S_ISREG(seen_.st_mode)) return token_error(path_, "is no file: give another name");
  if ((seen_.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return token_error(path_, "others may read it: chmod 600 it");
  std::array<char, kMostToken + 2> bytes{};
  const ssize_t got = ::read(file.fd, bytes.data(), bytes.size());
  std::string token(bytes.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  if (token.ends_with('\n')) token.pop_back();
  constexpr const char* kOfToken =
      "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_";
  if (token.size() < kLeastToken || token.size() > kMostToken ||
      token.find_first_not_of(kOfToken) != std::string::npos)
    return token_error(
        path_, "holds no token of 16 to 128 letters and digits: remove it, and a new one is made");
  return token;
}

std::optional<Result<std::string>> TokenFile::changed() {
  struct stat now {};
  (void)::stat(path_.c_str(), &now);  // a file that is gone is all zeros
  if (same_file(now, seen_)) return std::nullopt;
  seen_ = now;
  return read();
}

}  // namespace mixrig::page
