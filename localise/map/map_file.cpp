// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "calib/base/all_within.h"
#include "calib/base/file_in_progress.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "localise/map/corner_part.h"
#include "localise/map/extension_turn.h"
#include "localise/map/native_bytes.h"
#include "localise/map/part_checksum.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "stereo/segment.h"

namespace vernier::localise {

using namespace internal;
using vernier::internal::FileInProgress;

namespace {

// A file is a head and parts; all numbers are little-endian.
//   head: "VERNMAP\0", version (4 bytes), number of nodes (4)
//   part: kind (4 bytes), 4 bytes of 0, length (8), checksum (8), then so many bytes, filled up to
//   8 kind 1, a rig: height_m, pitch_rad (doubles), then a rig.json kind 2, nodes recorded with the
//   rig before: their number (8), then each: x_m, y_m, heading_rad,
//     number of lines (4) and of image lines (4), lines of kind (8), a_m, b_m, sigma_m (doubles),
//     image lines of a_px, b_px (doubles)
//   kind 3, corners of the nodes of the part after it, if any has some: localise/map/corner_part.h
constexpr std::string_view magic{"VERNMAP\0", 8};
// The version is 1 without corners, so that older programs read it.
constexpr std::uint32_t version = 1, version_with_corners = 2;
constexpr std::uint32_t rig_part = 1, node_part = 2, corner_part = 3;
constexpr std::size_t head_bytes = 16, part_head_bytes = 24;
constexpr std::size_t line_bytes = 64, image_line_bytes = 32, node_bytes = 32;
constexpr std::uint64_t most_nodes = 1'000'000, most_lines = 10'000;
constexpr double most_metres = 1e6, most_pixels = 1e7;
constexpr std::size_t nodes_a_part = 1000;
static_assert(std::endian::native == std::endian::little);

std::size_t filled(std::size_t bytes) { return (bytes + 7) / 8 * 8; }

/// Numbers from a part, one after the other. Throws Error at its end.
class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& place) : rest_(bytes), place_(place) {}

  template <class T>
  T take() {
    if (rest_.size() < sizeof(T)) fail("a part is shorter than what it should hold");
    return internal::take<T>(rest_);
  }
  double number(double most) {
    const auto value = take<double>();
    if (!(std::abs(value) <= most)) fail("a number is not finite or beyond all limits");
    return value;
  }
  Eigen::Vector3d point() {
    const double x = number(most_metres), y = number(most_metres);
    return {x, y, number(most_metres)};
  }
  Eigen::Vector2d pixel() {
    const double u = number(most_pixels);
    return {u, number(most_pixels)};
  }
  std::string_view rest() const { return rest_; }
  [[noreturn]] void fail(const std::string& how) const {
    throw Error(place_, "is damaged: " + how, "make the map again");
  }

 private:
  std::string_view rest_;
  const std::string& place_;
};

/// A file in memory, read as it is needed.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
      throw Error(file.string(),
                  std::string("is no file that can be read: ") + std::strerror(errno),
                  "check its name and permissions");
    }
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
      const bool is_folder = S_ISDIR(status.st_mode);
      ::close(descriptor);
      throw Error(file.string(), is_folder ? "is a folder" : "is no file that can be read",
                  is_folder ? "name a map file" : "check its name and permissions");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) bytes_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    ::close(descriptor);
    if (bytes_ == MAP_FAILED) {
      throw Error(file.string(), "does not fit into memory", "run it where there is more");
    }
  }
  ~MappedFile() {
    if (bytes_) ::munmap(bytes_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return {static_cast<const char*>(bytes_), size_}; }

 private:
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

void append_part(FileInProgress& out, std::uint32_t kind, std::string bytes) {
  std::string head;
  put(head, kind);
  put<std::uint32_t>(head, 0);
  put<std::uint64_t>(head, bytes.size());
  put(head, part_checksum(bytes));
  bytes.resize(filled(bytes.size()));
  out.append(head);
  out.append(bytes);
}

void check(const MapNode& node, std::size_t index) {
  const auto beyond = [](double x, double most) { return !(std::abs(x) <= most); };
  bool wrong = beyond(node.pose.x_m, most_metres) || beyond(node.pose.y_m, most_metres) ||
               beyond(node.pose.heading_rad, most_metres) ||
               beyond(node.view.mount.height_m, most_metres) ||
               beyond(node.view.mount.pitch_rad, most_metres) ||
               node.view.lines.size() > most_lines || node.view.image_lines.size() > most_lines;
  for (const PlaceLine& line : node.view.lines) {
    wrong = wrong || !vernier::internal::all_within(line.a_m, most_metres) ||
            !vernier::internal::all_within(line.b_m, most_metres) ||
            beyond(line.sigma_m, most_metres);
  }
  for (const stereo::ImageSegment& line : node.view.image_lines) {
    wrong = wrong || !vernier::internal::all_within(line.a_px, most_pixels) ||
            !vernier::internal::all_within(line.b_px, most_pixels);
  }
  if (wrong || !writable(node.view.corners)) {
    throw Error("map node " + std::to_string(index),
                wrong ? "holds a number that is not finite or beyond all limits, or more than "
                        "10000 lines"
                      : "holds a corner that is none, more than 10000, or descriptors of more "
                        "than one length",
                "leave the node out");
  }
}

void put_node(std::string& to, const MapNode& node) {
  for (const double x : {node.pose.x_m, node.pose.y_m, node.pose.heading_rad}) put(to, x);
  put(to, static_cast<std::uint32_t>(node.view.lines.size()));
  put(to, static_cast<std::uint32_t>(node.view.image_lines.size()));
  for (const PlaceLine& line : node.view.lines) {
    put(to, static_cast<std::uint64_t>(line.kind));
    for (const Eigen::Vector3d& end : {line.a_m, line.b_m}) {
      for (int i = 0; i < 3; ++i) put(to, end[i]);
    }
    put(to, line.sigma_m);
  }
  for (const stereo::ImageSegment& line : node.view.image_lines) {
    for (const Eigen::Vector2d& end : {line.a_px, line.b_px}) {
      for (int i = 0; i < 2; ++i) put(to, end[i]);
    }
  }
}

/// The rig and mount with which a view was recorded, as a part.
std::string rig_bytes(const PlaceView& view) {
  if (!view.rig) throw Error("map", "a node has no rig", "set PlaceView::rig");
  std::string bytes;
  put(bytes, view.mount.height_m);
  put(bytes, view.mount.pitch_rad);
  RigEstimate estimate;
  estimate.rig = *view.rig;
  return bytes + format_rig(estimate, KeepEvidence::no);
}

/// Appends nodes; `rig` is the last rig of the file so far.
void append_nodes(FileInProgress& out, std::span<const MapNode> nodes, std::string rig) {
  std::size_t begin = 0;
  const PlaceView* last = nullptr;
  const auto as_last = [&](const PlaceView& view) {
    return last && view.rig == last->rig && view.mount.height_m == last->mount.height_m &&
           view.mount.pitch_rad == last->mount.pitch_rad;
  };
  while (begin < nodes.size()) {
    std::size_t end = begin;
    std::string bytes;
    for (; end < nodes.size() && end - begin < nodes_a_part; ++end) {
      const PlaceView& view = nodes[end].view;
      check(nodes[end], end);
      if (!as_last(view)) {
        std::string needed = rig_bytes(view);
        if (needed != rig) {
          if (end > begin) break;
          append_part(out, rig_part, needed);
          rig = std::move(needed);
        }
        last = &view;
      }
      put_node(bytes, nodes[end]);
    }
    std::string part;
    put<std::uint64_t>(part, end - begin);
    // Before the nodes: a file cut between the two has too few nodes.
    const auto written = nodes.subspan(begin, end - begin);
    if (have_corners(written)) append_part(out, corner_part, corner_bytes(written));
    append_part(out, node_part, part + bytes);
    begin = end;
  }
}

std::string head_of(std::uint64_t nodes, bool with_corners) {
  std::string head(magic);
  put(head, with_corners ? version_with_corners : version);
  put(head, static_cast<std::uint32_t>(nodes));
  return head;
}

/// Calls of_part(kind, bytes) for the checked parts of a map, and gives the number of nodes that
/// its head states.
template <class OfPart>
std::uint64_t visit_parts(std::string_view bytes, const std::string& place, const OfPart& of_part) {
  if (bytes.substr(0, magic.size()) != magic || bytes.size() < head_bytes) {
    throw Error(place, "is not a map", "make one with vernier map make or write_map()");
  }
  Bytes after_magic(bytes.substr(magic.size()), place);
  const auto of_file = after_magic.take<std::uint32_t>();
  const auto nodes = after_magic.take<std::uint32_t>();
  if (of_file != version && of_file != version_with_corners) {
    throw Error(place, "is a map of version " + std::to_string(of_file),
                "this program reads versions 1 and 2: make the map again");
  }
  std::size_t at = head_bytes;
  while (at < bytes.size()) {
    Bytes head(bytes.substr(at), place);
    const auto kind = head.take<std::uint32_t>();
    const auto zero = head.take<std::uint32_t>();
    const auto length = head.take<std::uint64_t>();
    const auto sum = head.take<std::uint64_t>();
    if (zero != 0 || kind < rig_part || kind > (of_file == version ? node_part : corner_part)) {
      head.fail("a part has no known kind");
    }
    if (length > head.rest().size() || filled(length) > head.rest().size()) {
      head.fail("it is cut off");
    }
    const std::string_view content = head.rest().substr(0, length);
    if (part_checksum(content) != sum) head.fail("a part does not have its checksum");
    of_part(kind, content);
    at += part_head_bytes + filled(length);
  }
  return nodes;
}

[[noreturn]] void fail_count(const std::string& place) {
  throw Error(place, "is damaged: it has another number of nodes than its head says",
              "make the map again");
}

}  // namespace

void write_map(const std::filesystem::path& file, const TopologicalMap& map) {
  if (map.nodes.size() > most_nodes) {
    throw Error(file.string(), "would have more than 1000000 nodes", "write several maps");
  }
  FileInProgress out(file);
  out.append(head_of(map.nodes.size(), have_corners(map.nodes)));
  append_nodes(out, map.nodes, "");
  out.commit();
}

TopologicalMap read_map(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  const std::string place = file.string();
  TopologicalMap map;
  std::shared_ptr<const Rig> rig;
  CameraMount mount;
  std::optional<std::string_view> corners;  // of the nodes that come next
  const auto read_part = [&](std::uint32_t kind, std::string_view content) {
    Bytes bytes(content, place);
    if (corners && kind != node_part) bytes.fail("its corners belong to no nodes");
    if (kind == corner_part) {
      corners = content;
      return;
    }
    if (kind == rig_part) {
      mount.height_m = bytes.number(most_metres);
      mount.pitch_rad = bytes.number(most_metres);
      rig = std::make_shared<const Rig>(
          parse_rig(std::string(bytes.rest()), place + ": rig").estimate.rig);
      return;
    }
    if (!rig) bytes.fail("its first nodes have no rig");
    const auto count = bytes.take<std::uint64_t>();
    if (count > most_nodes - map.nodes.size() || count > bytes.rest().size() / node_bytes) {
      bytes.fail("it has more nodes than it can hold");
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      MapNode node;
      node.pose.x_m = bytes.number(most_metres);
      node.pose.y_m = bytes.number(most_metres);
      node.pose.heading_rad = bytes.number(most_metres);
      node.view.rig = rig;
      node.view.mount = mount;
      const auto lines = bytes.take<std::uint32_t>(), images = bytes.take<std::uint32_t>();
      if (lines > most_lines || images > most_lines ||
          lines * line_bytes + images * image_line_bytes > bytes.rest().size()) {
        bytes.fail("a node has more lines than it can hold");
      }
      node.view.lines.reserve(lines);
      for (std::uint32_t k = 0; k < lines; ++k) {
        const auto of_line = bytes.take<std::uint64_t>();
        if (of_line > static_cast<std::uint64_t>(LineKind::oblique)) {
          bytes.fail("a line has no known kind");
        }
        PlaceLine line;
        line.kind = static_cast<LineKind>(of_line);
        line.a_m = bytes.point();
        line.b_m = bytes.point();
        line.sigma_m = bytes.number(most_metres);
        node.view.lines.push_back(line);
      }
      node.view.image_lines.reserve(images);
      for (std::uint32_t k = 0; k < images; ++k) {
        const Eigen::Vector2d a = bytes.pixel();
        node.view.image_lines.push_back({a, bytes.pixel()});
      }
      map.nodes.push_back(std::move(node));
    }
    if (!bytes.rest().empty()) bytes.fail("a part is longer than what it should hold");
    if (!corners) return;
    read_corners(*std::exchange(corners, std::nullopt), std::span(map.nodes).last(count),
                 [&](const std::string& how) { bytes.fail(how); });
  };
  if (visit_parts(mapped.bytes(), place, read_part) != map.nodes.size() || corners) {
    fail_count(place);
  }
  return map;
}

void extend_map(const std::filesystem::path& file, std::span<const MapNode> nodes) {
  const ExtensionTurn turn(file);
  const MappedFile mapped(file);
  std::string rig;
  const std::string place = file.string();
  std::uint64_t count = 0;
  bool with_corners = have_corners(nodes);
  const auto look_at = [&](std::uint32_t kind, std::string_view content) {
    with_corners = with_corners || kind == corner_part;
    if (kind == rig_part) rig = content;
    if (kind == node_part) count += Bytes(content, place).take<std::uint64_t>();
  };
  if (visit_parts(mapped.bytes(), place, look_at) != count) fail_count(place);
  if (count + nodes.size() > most_nodes) {
    throw Error(file.string(), "would have more than 1000000 nodes", "begin another map");
  }
  FileInProgress out(file);
  out.append(head_of(count + nodes.size(), with_corners));
  out.append(mapped.bytes().substr(head_bytes));
  append_nodes(out, nodes, rig);
  out.commit();
}

}  // namespace vernier::localise
