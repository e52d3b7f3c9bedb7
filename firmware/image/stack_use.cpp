// SPDX-License-Identifier: Apache-2.0
// Largest stack of the firmware, from the compiler's call graphs (-fcallgraph-info=su):
// mixrig-stack-use FOLDER. Main loop, then every interrupt that may nest on top of it.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

struct Function {
  long own_bytes = 0;
  std::set<std::string> calls;
};
using Graph = std::map<std::string, Function>;

/// Assumed stack of functions of the C library and the compiler's helpers, which have no graph;
/// they are small.
constexpr long kUnknownBytes = 64;
/// Bytes that the core pushes on entry to an interrupt, with FPU registers and alignment.
constexpr long kExceptionFrameBytes = 108;

void read_graph(const std::filesystem::path& path, Graph& graph) {
  static const std::regex node(R"re(node: \{ title: "([^"]*)".*\\n(\d+) bytes)re");
  static const std::regex edge(R"re(edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)")re");
  std::ifstream in(path);
  std::smatch match;
  for (std::string line; std::getline(in, line);) {
    if (std::regex_search(line, match, node)) graph[match[1]].own_bytes = std::stol(match[2]);
    if (std::regex_search(line, match, edge)) graph[match[1]].calls.insert(match[2]);
  }
}

/// Largest stack of `name` and what it calls; sets `recursive` where there is a cycle.
long depth(const Graph& graph, const std::string& name, std::set<std::string>& path,
           bool& recursive) {
  const auto found = graph.find(name);
  if (found == graph.end()) return kUnknownBytes;
  if (!path.insert(name).second) {
    recursive = true;
    return 0;
  }
  long deepest = 0;
  for (const std::string& callee : found->second.calls) {
    deepest = std::max(deepest, depth(graph, callee, path, recursive));
  }
  path.erase(name);
  return found->second.own_bytes + deepest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: mixrig-stack-use FOLDER\n");
    return 2;
  }
  Graph graph;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
    if (entry.path().extension() == ".ci") read_graph(entry.path(), graph);
  }
  long total = 0;
  bool recursive = false;
  std::printf("stack:");
  for (const char* root : {"reset_handler", "tim2_handler", "usart1_handler"}) {
    if (graph.count(root) == 0) {
      std::fprintf(stderr, "\nerror: no call graph of %s in %s\n", root, argv[1]);
      return 1;
    }
    std::set<std::string> path;
    const long bytes = depth(graph, root, path, recursive);
    const bool interrupt = std::string(root) != "reset_handler";
    total += bytes + (interrupt ? kExceptionFrameBytes : 0);
    std::printf(" %s %ld,", root, bytes);
  }
  std::printf(" all nested %ld bytes\n", total);
  if (recursive) std::fprintf(stderr, "error: recursion, the stack has no bound\n");
  return recursive ? 1 : 0;
}
