// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/take_source.h"

#include <utility>

#include "host/capture/take/take.h"

namespace mixrig::take {
namespace {

/// Turns an error into kData: a picture that cannot be read is bad data of the take, not a wrong
/// name given by the user.
Result<void> as_data(Result<void> result) {
  if (result) return {};
  Error error = std::move(result).error();
  error.code = ErrorCode::kData;
  return error;
}

class TakeSource final : public capture::CaptureSource {
 public:
  explicit TakeSource(TakeReader reader) : reader_(std::move(reader)) {}
  const capture::SourceInfo& info() const override { return reader_.info(); }
  Result<bool> read(int number, capture::Capture& capture) override {
    MIXRIG_TRY(as_data(reader_.read(number, capture)));
    return true;
  }
  Result<void> read_truth(int number, capture::Truth& truth) override {
    return as_data(reader_.read_truth(number, truth));
  }

 private:
  TakeReader reader_;
};

}  // namespace

Result<std::unique_ptr<capture::CaptureSource>> open_take_source(
    const std::filesystem::path& path) {
  MIXRIG_ASSIGN(TakeReader reader, TakeReader::open(path));
  return std::unique_ptr<capture::CaptureSource>(std::make_unique<TakeSource>(std::move(reader)));
}

}  // namespace mixrig::take
