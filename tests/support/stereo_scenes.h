// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zlib.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::test {

/// A rectified pair with its ground truth, and what is known or assumed of its cameras.
struct StereoScene {
  std::string name;
  std::filesystem::path left, right, disparity, right_disparity;
  double disparity_scale = 1;  ///< grey values a pixel
  double f_px = 1000, baseline_m = 0.16;
  double offset_px = 0;         ///< disparity + offset = f b / z
  double max_disparity_px = 0;  ///< of its group of scenes
};

/// The eleven Middlebury pairs below `folder` (Scharstein and Szeliski 2002, 2003; Scharstein and
/// Pal 2007; Hirschmüller and Scharstein 2007; Scharstein et al. 2014). Those of 2001 and 2003 have
/// no calibration: 1000 px and 0.16 m are assumed.
inline std::vector<StereoScene> middlebury_scenes(const std::filesystem::path& folder) {
  std::vector<StereoScene> scenes;
  const auto add = [&](const std::string& name, const std::filesystem::path& at, int first,
                       int second, const char* image, double scale, double most) {
    StereoScene s;
    s.name = name;
    s.left = at / (image + std::to_string(first) + ".png");
    s.right = at / (image + std::to_string(second) + ".png");
    s.disparity = at / ("disp" + std::to_string(first) + ".png");
    s.right_disparity = at / ("disp" + std::to_string(second) + ".png");
    s.disparity_scale = scale;
    s.max_disparity_px = most;
    scenes.push_back(s);
  };
  const auto early = folder / "stereo_mb2001_2003";
  for (const char* name : {"barn2", "bull", "venus"}) add(name, early / name, 2, 6, "im", 8, 32);
  add("tsukuba", early / "tsukuba", 2, 6, "im", 16, 32);
  for (const char* name : {"teddy", "cones"}) add(name, early / name, 2, 6, "im", 4, 64);
  for (const char* name : {"Art", "Books", "Dolls"}) {
    add(name, folder / "stereo_mb2005" / name, 1, 5, "view", 3, 85);
    scenes.back().f_px = 3740.0 / 3;
    scenes.back().offset_px = 200.0 / 3;
  }
  add("Cloth3", folder / "stereo_mb2006" / "Cloth3", 1, 5, "view", 2, 100);
  scenes.back().f_px = 3740.0 / 2;
  StereoScene m{"motorcycle"};
  const auto late = folder / "stereo_mb2014_motorcycle";
  m.left = late / "motorcycle_left.png";
  m.right = late / "motorcycle_right.png";
  m.disparity = late / "motorcycle_disp.npz";
  m.f_px = 994.978;
  m.baseline_m = 0.193001;
  m.offset_px = 31.086;
  m.max_disparity_px = 70;
  scenes.push_back(m);
  return scenes;
}

/// The one array (float32, two dimensions) of a compressed NumPy archive; what is not finite is 0.
inline cv::Mat read_npz(const std::filesystem::path& file, cv::Size size) {
  std::ifstream in(file, std::ios::binary);
  const std::string zip((std::istreambuf_iterator<char>(in)), {});
  std::uint16_t name = 0, extra = 0;
  std::memcpy(&name, zip.data() + 26, 2);
  std::memcpy(&extra, zip.data() + 28, 2);
  std::string npy(10 + 1000 + sizeof(float) * size.area(), '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(zip.data())) + 30 + name + extra;
  stream.avail_in = static_cast<uInt>(zip.size() - 30 - name - extra);
  stream.next_out = reinterpret_cast<Bytef*>(npy.data());
  stream.avail_out = static_cast<uInt>(npy.size());
  inflateInit2(&stream, -MAX_WBITS);
  const int status = inflate(&stream, Z_FINISH);
  npy.resize(stream.total_out);
  inflateEnd(&stream);
  const std::size_t bytes = sizeof(float) * size.area();
  if (status != Z_STREAM_END || npy.size() < bytes) return {};
  cv::Mat values(size, CV_32F);
  std::memcpy(values.data, npy.data() + npy.size() - bytes, bytes);
  values.setTo(0, cv::abs(values) > 1e6);
  return values;
}

/// A pair that Debian's opencv-doc has, Middlebury's Aloe at full size: no constant of the matching
/// was chosen with a look at it.
inline StereoScene aloe_scene(const std::filesystem::path& folder) {
  StereoScene scene{"aloe"};
  scene.left = folder / "aloeL.jpg";
  scene.right = folder / "aloeR.jpg";
  scene.disparity = folder / "aloeGT.png";
  scene.f_px = 3740;
  scene.max_disparity_px = 255;
  return scene;
}

/// Ground truth at the left pixels.
struct StereoTruth {
  cv::Mat disparity;  ///< CV_32F, 0 where not known
  cv::Mat occluded;   ///< CV_8U: not seen by the right camera

  /// Known, seen in the right image and not within 10 pixels of its border.
  bool visible(const Eigen::Vector2d& left_px) const {
    const int x = cvRound(left_px.x()), y = cvRound(left_px.y());
    const float d = disparity.at<float>(y, x);
    return d > 0 && !occluded.at<uchar>(y, x) && left_px.x() - d > 10;
  }

  /// Within two pixels of a step of the disparity by more than a pixel, or of what is not known.
  bool at_outline(const Eigen::Vector2d& left_px) const {
    const int x = cvRound(left_px.x()), y = cvRound(left_px.y());
    const float own = disparity.at<float>(y, x);
    for (int j = -2; j <= 2; ++j) {
      for (int i = -2; i <= 2; ++i) {
        const float d = disparity.at<float>(y + j, x + i);
        if (!(d > 0) || std::abs(d - own) > 1) return true;
      }
    }
    return false;
  }

  /// How far a right pixel is from where the left one is seen, by the best of the disparities of
  /// the nine pixels about it: which surface a corner on an outline belongs to is not known.
  double error_px(const Eigen::Vector2d& left_px, const Eigen::Vector2d& right_px) const {
    const int x = cvRound(left_px.x()), y = cvRound(left_px.y());
    double least = 1e9;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const float d = disparity.at<float>(y + j, x + i);
        if (d > 0) least = std::min(least, std::abs(left_px.x() - d - right_px.x()));
      }
    }
    return std::hypot(least, left_px.y() - right_px.y());
  }
};

inline StereoTruth read_truth(const StereoScene& scene) {
  StereoTruth truth;
  const auto read = [&](const std::filesystem::path& file) {
    cv::Mat map;
    cv::imread(file.string(), cv::IMREAD_GRAYSCALE)
        .convertTo(map, CV_32F, 1 / scene.disparity_scale);
    return map;
  };
  const cv::Size size = cv::imread(scene.left.string(), cv::IMREAD_GRAYSCALE).size();
  const bool npz = scene.disparity.extension() == ".npz";
  truth.disparity = npz ? read_npz(scene.disparity, size) : read(scene.disparity);
  cv::Mat right;
  if (!scene.right_disparity.empty() && std::filesystem::exists(scene.right_disparity)) {
    right = read(scene.right_disparity);
  }
  // Occluded: the right image's truth disagrees there, or a nearer surface is seen there.
  cv::Mat nearest = cv::Mat::zeros(size, CV_32F);
  truth.occluded = cv::Mat::zeros(size, CV_8U);
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const float d = truth.disparity.at<float>(y, x);
        const int at = cvRound(x - d);
        if (!(d > 0) || at < 0) continue;
        float& front = nearest.at<float>(y, at);
        if (pass == 0) {
          front = std::max(front, d);
          continue;
        }
        bool hidden = front > d + 1.01f;
        if (!right.empty() && right.at<float>(y, at) > 0) {
          float apart = 99;
          for (int i = -1; i <= 1; ++i) {
            const float other = right.at<float>(y, std::clamp(at + i, 0, size.width - 1));
            if (other > 0) apart = std::min(apart, std::abs(other - d));
          }
          hidden = hidden || apart > 1.01f;
        }
        truth.occluded.at<uchar>(y, x) = hidden;
      }
    }
  }
  return truth;
}

/// The pair's pinhole rig.
inline Rig rig_of(const StereoScene& scene) {
  const cv::Size size = cv::imread(scene.left.string(), cv::IMREAD_GRAYSCALE).size();
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = Pinhole{};
    camera.size_px = {size.width, size.height};
    camera.parameters = Eigen::Vector4d(scene.f_px, 1, 0.5 * (size.width - 1) + i * scene.offset_px,
                                        0.5 * (size.height - 1));
    rig.cameras.push_back(camera);
  }
  rig.T_camera_first = {Pose{}, Pose{Eigen::Matrix3d::Identity(), {-scene.baseline_m, 0, 0}}};
  return rig;
}

/// Depth at which the disparity is the largest of the scene's group.
inline double nearest_m(const StereoScene& scene) {
  return scene.f_px * scene.baseline_m / (scene.max_disparity_px + scene.offset_px);
}

}  // namespace vernier::test
