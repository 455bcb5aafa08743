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
using Path = std::filesystem::path;
using Indices = std::vector<std::optional<std::size_t>>;

/// The folders of a file, the innermost first.
std::vector<std::string> folders_from_end(const Path& file) {
  std::vector<std::string> folders;
  for (const Path& part : file.lexically_normal().parent_path()) folders.push_back(part.string());
  std::reverse(folders.begin(), folders.end());
  return folders;
}

/// Whether the folders agree as far as the shorter list goes.
bool agree(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  const std::size_t both = std::min(a.size(), b.size());
  return std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(both), b.begin());
}

int equal_folders(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  int equal = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) equal += a[i] == b[i];
  return equal;
}

/// Indices of files by their names, with and without the ending.
class FileTable {
 public:
  explicit FileTable(const std::vector<Path>& files) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      by_file_[files[i].filename().string()].push_back(i);
      by_stem_[files[i].stem().string()].push_back(i);
    }
  }

  /// Those that have the image's name: with its ending, else without.
  std::vector<std::size_t> named_as(const Path& image) const {
    const std::string file = image.filename().string(), stem = image.stem().string();
    for (const auto& [table, key] :
         {std::pair(&by_file_, file), {&by_file_, stem}, {&by_stem_, stem}}) {
      const auto at = table->find(key);
      if (at != table->end()) return at->second;
    }
    return {};
  }

 private:
  std::map<std::string, std::vector<std::size_t>> by_file_, by_stem_;
};

std::vector<Path> absolute(const std::vector<Path>& images) {
  std::vector<Path> all;
  for (const Path& image : images) all.push_back(std::filesystem::absolute(image));
  return all;
}

bool has_twice(const std::vector<Path>& files) {
  std::set<std::string> stems;
  return std::any_of(files.begin(), files.end(),
                     [&](const Path& file) { return !stems.insert(file.stem().string()).second; });
}

/// Throws Error where one file belongs to two images.
void refuse_shared(const Indices& found,
                   const std::vector<Path>& files,
                   const std::vector<Path>& images,
                   const std::string& place) {
  std::map<std::size_t, std::size_t> image_of_file;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!found[i]) continue;
    const auto [other, is_first] = image_of_file.emplace(*found[i], i);
    if (is_first) continue;
    throw Error(place,
                in_quotes(files[*found[i]].string()) + " stands for both " +
                    in_quotes(images[other->second].string()) + " and " +
                    in_quotes(images[i].string()),
                "name each with its folder, as in " + in_quotes(distinct_names(images)[i]));
  }
}

}  // namespace

Indices names_of_images(const std::vector<std::string>& names,
                        const std::vector<Path>& images,
                        const std::string& place) {
  const std::vector<Path> files(names.begin(), names.end()), whole = absolute(images);
  const FileTable table(files);
  const bool folders_count = has_twice(files) || has_twice(images);
  Indices found;
  for (const Path& image : whole) {
    std::vector<std::size_t> candidates = table.named_as(image);
    if (folders_count) {
      std::erase_if(candidates, [&](std::size_t i) {
        return !agree(folders_from_end(files[i]), folders_from_end(image));
      });
    }
    if (candidates.size() > 1) {
      throw Error(place,
                  "both " + in_quotes(names[candidates[0]]) + " and " +
                      in_quotes(names[candidates[1]]) + " stand for " + in_quotes(image.string()),
                  "keep one of them, or give both their folders");
    }
    found.push_back(candidates.empty() ? std::nullopt : std::optional(candidates[0]));
  }
  refuse_shared(found, files, images, place);
  return found;
}

std::vector<std::size_t> pose_names_of_images(const std::vector<std::string>& names,
                                              const std::vector<Path>& images,
                                              const std::string& place) {
  std::vector<std::size_t> all;
  for (const std::optional<std::size_t>& name : names_of_images(names, images, place)) {
    if (!name) {
      throw Error(place, "has no pose of " + in_quotes(images[all.size()].string()),
                  "add it, or leave the image out");
    }
    all.push_back(*name);
  }
  return all;
}

Indices files_of_images(const std::vector<Path>& files,
                        const std::vector<Path>& images,
                        const std::string& place) {
  const std::vector<Path> whole_files = absolute(files), whole_images = absolute(images);
  const FileTable table(whole_files);
  Indices found;
  for (const Path& image : whole_images) {
    const std::vector<std::string> folders = folders_from_end(image);
    int most = -1;
    std::optional<std::size_t> nearest;
    for (const std::size_t i : table.named_as(image)) {
      const int equal = equal_folders(folders_from_end(whole_files[i]), folders);
      if (equal == most) nearest.reset();
      if (equal <= most) continue;
      most = equal;
      nearest = i;
    }
    found.push_back(nearest);
  }
  refuse_shared(found, files, images, place);
  return found;
}

bool need_folders(const std::vector<std::string>& names) {
  return has_twice({names.begin(), names.end()});
}

std::vector<std::string> distinct_names(const std::vector<Path>& images) {
  std::vector<Path> names, folders;
  std::size_t deepest = 0;
  for (const Path& image : images) {
    names.push_back(image.filename());
    folders.push_back(image.parent_path());
    deepest = std::max(deepest, folders_from_end(image).size());
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
  for (const Path& name : names) text.push_back(name.string());
  return text;
}

}  // namespace vernier::localise::internal
