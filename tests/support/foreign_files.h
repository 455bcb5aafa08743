// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "tests/support/scenes.h"

namespace vernier::test {

/// A folder that is gone with the test.
class Folder {
 public:
  Folder() {
    std::string pattern = testing::TempDir() + "vernierXXXXXX";
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

  std::vector<std::filesystem::path> write(
      const std::vector<vernier::internal::ExportedFile>& files) const {
    std::vector<std::filesystem::path> written;
    for (const vernier::internal::ExportedFile& file : files)
      written.push_back(write(file.name.string(), file.text));
    return written;
  }

 private:
  std::filesystem::path path_;
};

/// One to three cameras with names, sizes and poses of their own, none of them round numbers.
inline Rig rig_of_cameras(const CameraModel& model, int count) {
  Rig rig = stereo_rig(model);
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "camera2";
  rig.cameras[2].size_px = {1281, 719};
  rig.cameras[2].parameters *= 1.0 + 1.0 / 3;
  rig.cameras[2].parameters[1] = 0.9;
  rig.T_camera_first[1].t[1] = 0.002 / 3;
  rig.T_camera_first.push_back({rotation_from_vector({-2.1, 1.3, 0.7}), {0.3, -1.0 / 7, 1e-7}});
  rig.cameras.resize(static_cast<std::size_t>(count));
  rig.T_camera_first.resize(static_cast<std::size_t>(count));
  return rig;
}

}  // namespace vernier::test
