// SPDX-License-Identifier: Apache-2.0
#include "host/output/sheet/sheet_sink.h"

#include <algorithm>
#include <utility>

#include "host/math/image_io/image_io.h"

namespace mixrig::output {

SheetSink::SheetSink(std::filesystem::path file, std::string title, std::vector<int> frames)
    : file_(std::move(file)), frames_(std::move(frames)), sheet_(std::move(title)) {}

render::OutputMask SheetSink::wanted(int number) const {
  const bool shown = std::find(frames_.begin(), frames_.end(), number) != frames_.end();
  return shown ? ContactSheet::kWanted : 0;
}

Result<void> SheetSink::write(const CompositePtr& composite) {
  ImageView<const Rgb8> truth;
  if (composite->truth) truth = composite->truth->composite;
  sheet_.add_row(composite->capture->number, plate_of(*composite->capture), composite->images,
                 truth, composite->worst_piece);
  return {};
}

Result<void> SheetSink::finish() {
  if (sheet_.empty()) return {};
  return image_io::write_png(file_, sheet_.draw().view());
}

}  // namespace mixrig::output
