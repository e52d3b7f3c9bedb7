// SPDX-License-Identifier: Apache-2.0
// A program started by a test; it ends with the test, or after a time limit.
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mixrig::test {

class ChildProcess {
 public:
  /// Runs `words` under timeout(1). Standard output goes to `log`, standard error to `errors`, or
  /// to `log` if that is empty.
  ChildProcess(std::vector<std::string> words, int limit_s, const std::string& log = "/dev/null",
               const std::string& errors = "") {
    words.insert(words.begin(), {"timeout", std::to_string(limit_s)});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    constexpr int kMode = O_WRONLY | O_CREAT | O_TRUNC | O_NOCTTY | O_CLOEXEC;
    const int out = open(log.c_str(), kMode, 0600);
    const int err = errors.empty() ? out : open(errors.c_str(), kMode, 0600);
    const int in = open("/dev/null", O_RDONLY);
    dup2(in, 0);
    dup2(out, 1);
    dup2(err, 2);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);  // timeout(1) passes it on
    wait();
  }

  /// Sends a signal; timeout(1) passes SIGINT and SIGTERM on to the program.
  void signal(int number) const { kill(pid_, number); }

  /// Process id of the program itself; 0 where it has ended or not begun.
  pid_t program() const {
    const std::string self = std::to_string(pid_);
    std::ifstream children("/proc/" + self + "/task/" + self + "/children");
    pid_t child = 0;
    children >> child;
    return child;
  }

  /// Exit status; 124 where the limit ended it.
  int wait() {
    int status = 0;
    if (pid_ > 0) waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace mixrig::test
