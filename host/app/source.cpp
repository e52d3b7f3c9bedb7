// SPDX-License-Identifier: Apache-2.0
#include "host/app/source.h"

#include <utility>

#ifdef MIXRIG_HAS_STUDIO
#include "host/app/studio_source.h"
#endif

namespace mixrig::app {
namespace {

#ifdef MIXRIG_HAS_STUDIO
constexpr const char* kKnownSources = "take:DIR, studio[:SCENARIO,SEED,RIG] or rig[:RIG.TOML]";
#else
constexpr const char* kKnownSources = "take:DIR or rig[:RIG.TOML]";
#endif

/// A file that fails in the middle of a take is bad data, not a wrong name given by the user.
Result<void> as_data(Result<void> result) {
  if (result) return {};
  Error error = std::move(result).error();
  error.code = ErrorCode::kData;
  return error;
}

class TakeSource final : public FrameSource {
 public:
  explicit TakeSource(take::TakeReader reader) : reader_(std::move(reader)) {}
  const take::TakeInfo& info() const override { return reader_.info(); }
  Result<bool> read(int number, take::TakeFrame& frame) override {
    MIXRIG_TRY(as_data(reader_.read(number, frame)));
    return true;
  }
  Result<void> read_truth(int number, take::TruthFrame& truth) override {
    return as_data(reader_.read_truth(number, truth));
  }

 private:
  take::TakeReader reader_;
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_take_source(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(take::TakeReader reader, take::TakeReader::open(path));
  return std::unique_ptr<FrameSource>(std::make_unique<TakeSource>(std::move(reader)));
}

Result<std::unique_ptr<FrameSource>> open_source(const std::string& uri) {
  const std::size_t colon = uri.find(':');
  const std::string kind = uri.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : uri.substr(colon + 1);
  if (kind == "take" && !rest.empty()) return open_take_source(rest);
#ifdef MIXRIG_HAS_STUDIO
  if (kind == "studio") return open_studio_source(rest);
#endif
  return Error{ErrorCode::kUsage,
               "--source \"" + uri + "\" is not a source: use " + std::string(kKnownSources)};
}

}  // namespace mixrig::app
