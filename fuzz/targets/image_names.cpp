// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board/frame_numbering.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using vernier::internal::FrameNumbering;
using vernier::internal::parse_image_name;

void run_image_names(std::string_view bytes) {
  std::vector<std::int64_t> numbers;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::string name(bytes.substr(at, end - at));
    at = end + 1;
    if (name.empty()) continue;  // no image has such a name
    const auto parsed = accepted([&] { return parse_image_name(name); });
    if (parsed) numbers.push_back(parsed->frame);
  }
  const FrameNumbering numbering(numbers);
  for (const std::int64_t a : numbers) {
    for (const std::int64_t b : numbers) {
      require((a < b) == (numbering.frame(a) < numbering.frame(b)), "frames keep their order");
    }
  }
}

std::vector<std::string> image_names_seeds() {
  return {"left01.png\nleft02.png\nright01.jpg\n",
          "cam0/1403636579763555584.png\ncam1/1403636579763555584.png\n"};
}

const Registered registered_image_names{
    {"image_names", 400, "", run_image_names, image_names_seeds}};

}  // namespace
}  // namespace vernier::fuzz
