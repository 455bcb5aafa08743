// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/segments_file.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace localise::internal;

void run_segments_file(std::string_view bytes) {
  const auto images = accepted([&] { return read_segments(input_file(bytes, "s.jsonl")); });
  if (!images) return;
  std::string text;
  for (const SegmentsOfImage& image : *images) text += segments_line(image);
  const std::filesystem::path written = input_folder() / "t.jsonl";
  std::ofstream(written, std::ios::binary) << text;
  const std::vector<SegmentsOfImage> again = read_segments(written);
  require(again.size() == images->size(), "the images are kept");
  for (std::size_t i = 0; i < again.size(); ++i) {
    const auto &a = (*images)[i].segments, &b = again[i].segments;
    require((*images)[i].image == again[i].image && a.size() == b.size(), "segments are kept");
    for (std::size_t k = 0; k < a.size(); ++k) {
      require(a[k].in_space.a_m == b[k].in_space.a_m && a[k].in_space.b_m == b[k].in_space.b_m &&
                  a[k].in_space.covariance_m2 == b[k].in_space.covariance_m2 &&
                  a[k].image_px.a_px == b[k].image_px.a_px && a[k].reliable == b[k].reliable,
              "segments are kept as they are");
    }
  }
}

std::vector<std::string> segments_file_seeds() {
  SegmentsOfImage image{"00003.png", {}};
  ImageSegmentInSpace& segment = image.segments.emplace_back();
  segment.image_px = {{10.25, 20}, {300, 21.5}};
  segment.in_space.a_m = {-1, 0.1, 3};
  segment.in_space.b_m = {1, 0.125, 3.5};
  segment.in_space.covariance_m2.setIdentity();
  return {segments_line(image), segments_line({"b.png", {}}) + segments_line(image)};
}

const Registered registered{
    {"segments_file", 4000, "segments", run_segments_file, segments_file_seeds}};

}  // namespace
}  // namespace vernier::fuzz
