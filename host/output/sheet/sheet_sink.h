// SPDX-License-Identifier: Apache-2.0
// Sink that writes a contact sheet of a few frames of a run.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/output/sheet/contact_sheet.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::output {

/// Draws a row for each frame, and writes the sheet as a PNG in finish().
class SheetSink final : public CompositeSink {
 public:
  /// `frames`: numbers of the frames to show.
  SheetSink(std::filesystem::path file, std::string title, std::vector<int> frames);
  std::string_view name() const override { return "sheet"; }
  render::OutputMask wanted(int number) const override;
  Result<void> write(const CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  std::filesystem::path file_;
  std::vector<int> frames_;
  ContactSheet sheet_;
};

}  // namespace mixrig::output
