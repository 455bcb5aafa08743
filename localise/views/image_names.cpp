// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/image_names.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::localise::internal {
namespace {

using vernier::internal::in_quotes;

/// The parts of a path, the file's name first.
std::vector<std::string> parts_from_end(const std::filesystem::path& path) {
  std::vector<std::string> parts;
  for (const std::filesystem::path& part : path.lexically_normal()) parts.push_back(part.string());
  std::reverse(parts.begin(), parts.end());
  return parts;
}

/// How many folders of two paths are equal, at the same distance from their ends.
int equal_folders(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  int equal = 0;
  for (std::size_t i = 1; i < std::min(a.size(), b.size()); ++i) equal += a[i] == b[i];
  return equal;
}

/// The names of images by their file names, with and without the ending.
class NameTable {
 public:
  NameTable(const std::vector<std::string>& names, const std::string& place)
      : names_(names), place_(place) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::filesystem::path name(names[i]);
      parts_.push_back(parts_from_end(name));
      by_file_[name.filename().string()].push_back(i);
      if (name.stem() != name.filename()) by_stem_[name.stem().string()].push_back(i);
    }
  }

  std::optional<std::size_t> name_of(const std::filesystem::path& image) const {
    const std::string file = image.filename().string(), stem = image.stem().string();
    for (const auto& [table, key] :
         {std::pair(&by_file_, file), {&by_file_, stem}, {&by_stem_, stem}}) {
      const auto at = table->find(key);
      if (at != table->end()) return nearest(image, at->second);
    }
    return std::nullopt;
  }

 private:
  /// Of the names with one file name.
  std::size_t nearest(const std::filesystem::path& image,
                      const std::vector<std::size_t>& candidates) const {
    const std::vector<std::string> parts = parts_from_end(image);
    const auto equal = [&](std::size_t i) { return equal_folders(parts, parts_[i]); };
    std::size_t best = candidates[0];
    int most = equal(best);
    std::optional<std::size_t> as_good;
    for (std::size_t k = 1; k < candidates.size(); ++k) {
      const std::size_t i = candidates[k];
      const int count = equal(i);
      if (count == most) as_good = i;
      if (count <= most) continue;
      best = i;
      most = count;
      as_good.reset();
    }
    if (as_good) {
      throw Error(place_,
                  "both " + in_quotes(names_[best]) + " and " + in_quotes(names_[*as_good]) +
                      " can be " + in_quotes(image.string()),
                  "name the image with its folders");
    }
    return best;
  }

  const std::vector<std::string>& names_;
  const std::string& place_;
  std::vector<std::vector<std::string>> parts_;
  std::map<std::string, std::vector<std::size_t>> by_file_, by_stem_;
};

}  // namespace

std::vector<std::optional<std::size_t>> names_of_images(
    const std::vector<std::string>& names,
    const std::vector<std::filesystem::path>& images,
    const std::string& place) {
  const NameTable table(names, place);
  std::map<std::size_t, std::size_t> image_of_name;
  std::vector<std::optional<std::size_t>> found;
  for (std::size_t i = 0; i < images.size(); ++i) {
    found.push_back(table.name_of(images[i]));
    if (!found.back()) continue;
    const auto [other, is_first] = image_of_name.emplace(*found.back(), i);
    if (is_first) continue;
    throw Error(place,
                in_quotes(names[*found.back()]) + " stands for both " +
                    in_quotes(images[other->second].string()) + " and " +
                    in_quotes(images[i].string()),
                "name each with its folder, as in " + in_quotes(distinct_names(images)[i]));
  }
  return found;
}

std::vector<std::string> distinct_names(const std::vector<std::filesystem::path>& images) {
  std::vector<std::filesystem::path> names, folders;
  std::size_t deepest = 0;
  for (const std::filesystem::path& image : images) {
    names.push_back(image.filename());
    folders.push_back(image.parent_path());
    deepest = std::max(deepest, parts_from_end(image).size());
  }
  for (std::size_t more = 0; more < deepest; ++more) {
    if (std::set(names.begin(), names.end()).size() == names.size()) break;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (folders[i].filename().empty()) continue;
      names[i] = folders[i].filename() / names[i];
      folders[i] = folders[i].parent_path();
    }
  }
  std::vector<std::string> text;
  for (const std::filesystem::path& name : names) text.push_back(name.string());
  return text;
}

}  // namespace vernier::localise::internal
