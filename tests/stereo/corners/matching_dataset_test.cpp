// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Corners and matches of real pairs against their ground truth. Most constants were chosen with all
// eleven Middlebury pairs in view, with an eye on four of them first (told apart below), so none of
// these is held out; the aloe is.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>
#include <vector>

#include "calib/base/grey_image.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/corners/match_images.h"
#include "tests/support/data_folder.h"
#include "tests/support/stereo_scenes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

const std::set<std::string> tuned = {"barn2", "teddy", "Art", "motorcycle"};

/// What a datasheet and a careful mount say: rows known to about a pixel.
RigEstimate prior_of(const test::StereoScene& scene) {
  RigEstimate prior;
  prior.rig = test::rig_of(scene);
  Eigen::VectorXd sigma(14);
  sigma << 0.002 * scene.f_px, 0.002, 0.5, 0.5, 0.002 * scene.f_px, 0.002, 0.5, 0.5,  //
      5e-4, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3;
  prior.covariance =
      Covariance{CovarianceKind::prior, parameter_names(prior.rig), sigma.cwiseAbs2().asDiagonal()};
  return prior;
}

struct SceneScore {
  int visible = 0, repeated = 0, by_chance = 0;  ///< left corners
  int accepted = 0, wrong = 0;                   ///< matches of visible ones
  int occluded = 0, occluded_wrong = 0;          ///< matches of occluded ones
  int outline = 0, outline_wrong = 0;            ///< matches of visible ones at outlines
  int tail = 0, outline_tail = 0;                ///< right ones of |z| > 3
  std::vector<double> dy,
      z;  ///< of the right ones, less the scene's median dy: its rectification's

  SceneScore& operator+=(const SceneScore& o) {
    visible += o.visible, repeated += o.repeated, by_chance += o.by_chance;
    accepted += o.accepted, wrong += o.wrong;
    occluded += o.occluded, occluded_wrong += o.occluded_wrong;
    outline += o.outline, outline_wrong += o.outline_wrong;
    tail += o.tail, outline_tail += o.outline_tail;
    dy.insert(dy.end(), o.dy.begin(), o.dy.end());
    z.insert(z.end(), o.z.begin(), o.z.end());
    return *this;
  }
};

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + static_cast<long>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Of values about 0.
double robust_sd(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  return 1.4826 * median(values);
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::string line(const SceneScore& s) {
  char text[600];
  std::snprintf(
      text, sizeof text,
      "visible %d, repeatability %.3f (by chance %.3f), matched %.3f, wrong %d of %d = %.4f; "
      "occluded "
      "corners matched %d, of them wrong %d; at outlines %d matches, wrong %d; |z| > 3: %d, at "
      "outlines %d; dy sd %.3f px (robust %.3f), z sd %.2f (robust %.2f)",
      s.visible, double(s.repeated) / s.visible, double(s.by_chance) / s.visible,
      double(s.accepted) / s.visible, s.wrong, s.accepted, double(s.wrong) / s.accepted, s.occluded,
      s.occluded_wrong, s.outline, s.outline_wrong, s.tail, s.outline_tail, rms(s.dy),
      robust_sd(s.dy), rms(s.z), robust_sd(s.z));
  return text;
}

bool has_corner_near(const std::vector<ImageCorner>& corners,
                     const test::StereoTruth& truth,
                     const Eigen::Vector2d& left_px,
                     const Eigen::Vector2d& offset) {
  return std::any_of(corners.begin(), corners.end(), [&](const ImageCorner& corner) {
    return truth.error_px(left_px, corner.pixel_px - offset) <= 1.5;
  });
}

SceneScore score(const test::StereoScene& scene, const ImageMatchingOptions& options) {
  const test::StereoTruth truth = test::read_truth(scene);
  const auto [left, right] =
      corner_images(read_grey_image(scene.left), read_grey_image(scene.right), test::rig_of(scene),
                    {.count = options.corners, .cells = options.cells});
  SceneScore s;
  for (const ImageCorner& corner : left.corners) {
    if (!truth.visible(corner.pixel_px)) continue;
    ++s.visible;
    s.repeated += has_corner_near(right.corners, truth, corner.pixel_px, {0, 0});
    s.by_chance += has_corner_near(right.corners, truth, corner.pixel_px, {13, 11});
  }
  const ImageMatching matching =
      match_images({0, scene.left, scene.right}, prior_of(scene), "prior", options);
  EXPECT_EQ(matching.corners_left, static_cast<int>(left.corners.size()));
  std::vector<double> sigma;
  std::vector<bool> outline;
  for (const CornerMatch& match : matching.matches) {
    if (!truth.visible(match.left_px)) {
      const auto x = cvRound(match.left_px.x()), y = cvRound(match.left_px.y());
      const bool hidden = truth.occluded.at<uchar>(y, x) > 0;
      s.occluded += hidden;
      s.occluded_wrong += hidden && truth.error_px(match.left_px, match.right_px) > 2;
      continue;
    }
    ++s.accepted;
    const bool at_outline = truth.at_outline(match.left_px);
    s.outline += at_outline;
    if (truth.error_px(match.left_px, match.right_px) > 2) {
      ++s.wrong;
      s.outline_wrong += at_outline;
    } else {
      s.dy.push_back(match.left_px.y() - match.right_px.y());
      sigma.push_back(std::sqrt(2.0) * match.sigma_px);
      outline.push_back(at_outline);
    }
  }
  const double offset = median(s.dy);
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    s.dy[i] -= offset;
    s.z.push_back(s.dy[i] / sigma[i]);
    s.tail += std::abs(s.z[i]) > 3;
    s.outline_tail += std::abs(s.z[i]) > 3 && outline[i];
  }
  return s;
}

TEST(MatchingOnMiddlebury, CornersAreRepeatedAndFewMatchesAreWrong) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  SceneScore of_tuned, of_others, of_all;
  for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
    ImageMatchingOptions options;
    options.band.nearest_m = test::nearest_m(scene);
    const SceneScore s = score(scene, options);
    RecordProperty(scene.name, line(s));
    (tuned.count(scene.name) ? of_tuned : of_others) += s;
    of_all += s;
  }
  RecordProperty("tuned_on", line(of_tuned));
  RecordProperty("others", line(of_others));
  RecordProperty("all", line(of_all));
  for (const SceneScore& s : {of_others, of_all}) {
    EXPECT_GE(double(s.repeated) / s.visible, 0.82);
    EXPECT_LE(double(s.wrong) / s.accepted, 0.015);
    EXPECT_GE(double(s.accepted) / s.visible, 0.70);
  }
}

/// A right image that is turned about its centre and reduced.
struct RightImage {
  RightImage(const test::StereoScene& scene, double turn_rad, double reduction, RigEstimate& prior)
      : file(std::filesystem::path(testing::TempDir()) / (scene.name + "_right.png")) {
    cv::Mat grey = read_grey_image(scene.right), changed;
    const Eigen::Matrix2d linear = Eigen::Rotation2Dd(turn_rad).toRotationMatrix() / reduction;
    const Eigen::Vector2d size(grey.cols, grey.rows);
    const Eigen::Vector2i changed_size =
        ((linear.cwiseAbs() * size).array() - 1e-6).ceil().cast<int>();
    from_scene = Eigen::Translation2d(0.5 * (changed_size.cast<double>().array() - 1).matrix()) *
                 Eigen::Affine2d(linear) * Eigen::Translation2d(-0.5 * (size.array() - 1).matrix());
    if (reduction > 1) {
      cv::GaussianBlur(grey, grey, {0, 0}, 0.5 * std::sqrt(reduction * reduction - 1));
    }
    cv::Mat map(2, 3, CV_64F);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 3; ++j) map.at<double>(i, j) = from_scene.matrix()(i, j);
    }
    cv::warpAffine(grey, changed, map, {changed_size.x(), changed_size.y()}, cv::INTER_CUBIC);
    cv::imwrite(file.string(), changed);

    Camera& camera = prior.rig.cameras[1];
    const Eigen::Vector2d centre = from_scene * Eigen::Vector2d(camera.ox_px(), camera.oy_px());
    camera.parameters.head<4>() << camera.f_px() / reduction, 1, centre;
    camera.size_px = changed_size;
    Pose& T = prior.rig.T_camera_first[1];
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T = {turn * T.R, turn * T.t};
  }
  std::filesystem::path file;
  Eigen::Affine2d from_scene;
};

/// Matches of a pair whose right camera is rolled and has larger pixels; errors in the scene's own
/// right image. The four pairs chose the thresholds, by other angles and sizes.
TEST(MatchingOnMiddlebury, OfARolledCameraOrOtherPixelsIsAsGood) {
  const auto folder = test::data_folder();
  if (!folder) GTEST_SKIP() << "VERNIER_DATA is not set";
  struct Case {
    double turn_deg, reduction, least_share;
  };
  for (const auto& [turn_deg, reduction, least_share] :
       {Case{90, 1, 0.95}, Case{7, 1, 0.9}, Case{-130, 1, 0.85}, Case{25, 1.4, 0.55}}) {
    SceneScore as_taken, changed;
    for (const test::StereoScene& scene : test::middlebury_scenes(*folder)) {
      if (tuned.count(scene.name)) continue;
      ImageMatchingOptions options;
      options.band.nearest_m = test::nearest_m(scene);
      as_taken += score(scene, options);
      RigEstimate prior = prior_of(scene);
      const RightImage right(scene, turn_deg * std::numbers::pi / 180, reduction, prior);
      const test::StereoTruth truth = test::read_truth(scene);
      const Eigen::Affine2d to_scene = right.from_scene.inverse();
      SceneScore own;
      for (const CornerMatch& match :
           match_images({0, scene.left, right.file}, prior, "prior", options).matches) {
        if (!truth.visible(match.left_px)) continue;
        ++own.accepted;
        const Eigen::Vector2d right_px = to_scene * match.right_px;
        own.wrong += truth.error_px(match.left_px, right_px) > 2;
        own.dy.push_back((match.left_px.y() - right_px.y()));
        own.z.push_back(std::sqrt(1 + reduction * reduction) * match.sigma_px);
      }
      const double offset = median(own.dy);
      for (std::size_t i = 0; i < own.z.size(); ++i) own.z[i] = (own.dy[i] - offset) / own.z[i];
      changed += own;
    }
    const std::string name = std::to_string(turn_deg) + " degrees, " + std::to_string(reduction);
    RecordProperty(name, std::to_string(changed.accepted) + " of " +
                             std::to_string(as_taken.accepted) + " matches, wrong " +
                             std::to_string(changed.wrong) + ", robust sd of z " +
                             std::to_string(robust_sd(changed.z)));
    EXPECT_GE(changed.accepted, least_share * as_taken.accepted) << name;
    EXPECT_LE(changed.wrong, 0.03 * changed.accepted) << name;
    EXPECT_LE(robust_sd(changed.z), 1.3) << name;
  }
}

/// The one pair that no constant was chosen with, nor the number of corners here. It misses the bar
/// of 0.82 for repeatability: 0.80 was measured, the bound below is against getting worse.
TEST(MatchingOnAloe, HasHardlyAnyWrongUnseen) {
  const std::filesystem::path folder = "/usr/share/doc/opencv-doc/examples/data";
  if (!std::filesystem::exists(folder / "aloeL.jpg")) GTEST_SKIP() << "no opencv-doc";
  const test::StereoScene scene = test::aloe_scene(folder);
  ImageMatchingOptions options;
  options.corners = 1500;
  options.band.nearest_m = test::nearest_m(scene);
  const SceneScore s = score(scene, options);
  RecordProperty(scene.name, line(s));
  EXPECT_GE(double(s.repeated) / s.visible, 0.78);
  EXPECT_LE(double(s.wrong) / s.accepted, 0.015);
}

}  // namespace
}  // namespace vernier
