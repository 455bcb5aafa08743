// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/view_file.h"

#include <cstddef>
#include <string>
#include <string_view>

#include "calib/base/file_in_progress.h"
#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "localise/views/view_json.h"

namespace vernier::localise {

using namespace internal;
using vernier::internal::FileInProgress;
using vernier::internal::JsonNode;
using vernier::internal::TextLines;

std::vector<RecordedLooks> read_views(const std::filesystem::path& file,
                                      const std::shared_ptr<const Rig>& rig) {
  constexpr std::size_t most_positions = 100'000, longest_line = 64'000'000;
  std::vector<RecordedLooks> views;
  TextLines lines(file, longest_line);
  std::string_view line;
  while (lines.next(line)) {
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (views.size() == most_positions) {
      throw Error(lines.place(), "is one of more than 100,000 positions", "split the file");
    }
    const Json json = vernier::internal::parse_json_line(line, lines.place());
    views.push_back(parse_looks(JsonNode(json, lines.place() + ":"), rig));
  }
  if (views.empty()) {
    throw Error(file.string(), "holds no views", "give one JSON object a line, see file-formats");
  }
  return views;
}

std::string view_line(const RecordedLooks& view) {
  Json json;
  if (view.pose) json["pose"] = pose_json(*view.pose);
  json["looks"] = looks_json(view.looks);
  return json.dump() + "\n";
}

void write_views(const std::filesystem::path& file, std::span<const RecordedLooks> views) {
  FileInProgress out(file);
  for (const RecordedLooks& recorded : views) out.append(view_line(recorded));
  out.commit();
}

}  // namespace vernier::localise
