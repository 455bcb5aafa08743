// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/mesh_file.h"

#include <array>
#include <string>
#include <string_view>

#include "calib/base/small_letters.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "sim/import/mesh.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

Mesh read_mesh(const std::filesystem::path& file, const MeshSelection& selection) {
  const std::string ending = small_letters(file.extension().string());
  std::error_code fault;
  const bool is_folder = std::filesystem::is_directory(file, fault);
  if (!is_folder && !std::filesystem::is_regular_file(file, fault)) {
    const bool there = std::filesystem::exists(file, fault);
    throw Error(file.string(), there ? "is no regular file" : "no such file", "check the name");
  }
  const bool has_tracks = is_folder || (ending == ".txt" && holds_line_tracks(file));
  const bool has_names = !has_tracks && ending != ".txt" && ending != ".ply";
  if (!selection.leave_out.empty() && !has_names) {
    throw Error(file.string(), "has no names of parts that could be left out", "edit the file");
  }
  if (selection.least_images > 0 && !has_tracks) {
    throw Error(file.string(), "holds no line tracks, which know their images",
                "leave out the least number of images");
  }
  if (has_tracks) return read_line_tracks(file, selection.least_images);
  if (ending == ".txt") return read_line_list(file);
  if (ending == ".ply") return read_ply(file);
  return read_with_assimp(file, selection.leave_out);
}

Mesh read_line_list(const std::filesystem::path& file) {
  Mesh mesh;
  mesh.format = "list of lines";
  mesh.up_axis = 2;
  mesh.unit_m = 1;
  mesh.up_because = mesh.unit_because = "as in all lists";
  TextLines lines(file);
  std::string_view line;
  while (lines.next(line)) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || line[begin] == '#') continue;
    const auto fields = split_fields(line.substr(begin), " \t\r,;");
    std::array<double, 6> numbers{};
    std::size_t count = 0;
    for (const std::string_view field : fields) {
      if (field.empty()) continue;
      const double number = parse_real(field, lines.place(), "coordinate");
      if (count < numbers.size()) numbers[count] = number;
      ++count;
    }
    if (count != numbers.size()) {
      throw Error(lines.place(), "has " + std::to_string(count) + " numbers",
                  "give x1 y1 z1 x2 y2 z2, in metres");
    }
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(numbers[0], numbers[1], numbers[2]);
    mesh.vertices.emplace_back(numbers[3], numbers[4], numbers[5]);
    mesh.lines.push_back({first, first + 1});
    if (mesh.lines.size() > most_triangles) {
      throw Error(lines.place(), "is one of more than " + std::to_string(most_triangles),
                  "split the file");
    }
  }
  return mesh;
}

}  // namespace vernier::sim::internal
