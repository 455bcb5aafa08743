// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What the other tools make of our files, and we of theirs.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/persistence.hpp>

#include "calib/base/atomic_file.h"
#include "calib/camera.h"
#include "calib/formats/colmap_cameras.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/formats/opencv_calibration_file.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "stereo/rectification/rectified_camera_info.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

using test::Folder;
using test::rig_of_cameras;

/// Exit code of a command; its output goes to `output`.
int run(const std::string& command, const std::filesystem::path& output) {
  const int status = std::system((command + " >'" + output.string() + "' 2>/dev/null").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int mrcal(const std::string& words, const std::filesystem::path& output) {
  if (std::string(DEBIAN_PYTHON).find("NOTFOUND") != std::string::npos) return 77;
  return run(
      "'" DEBIAN_PYTHON "' '" VERNIER_SOURCE_DIR "/tests/calib/formats/mrcal_side.py' " + words,
      output);
}

/// Points before every camera of the pair, in the first one's frame.
std::vector<Eigen::Vector3d> points() {
  std::vector<Eigen::Vector3d> points;
  for (double z : {1.0, 3.7}) {
    for (double x : {-0.4, -0.1, 0.0, 0.3}) {
      for (double y : {-0.3, 0.05, 0.25}) points.emplace_back(x * z, y * z, z);
    }
  }
  return points;
}

const char* const brown_models[] = {"pinhole", "radial1", "opencv4", "opencv5", "opencv8"};

TEST(ConvertTools, MrcalProjectsOurCameramodelsToTheSamePixels) {
  Folder folder;
  std::string lines;
  for (const Eigen::Vector3d& x : points()) {
    lines += std::to_string(x[0]) + " " + std::to_string(x[1]) + " " + std::to_string(x[2]) + "\n";
  }
  folder.write("points", lines);
  for (const char* model : brown_models) {
    const Rig rig = rig_of_cameras(camera_model(model), 2);
    const auto files = folder.write(mrcal_cameramodels(rig));
    for (std::size_t c = 0; c < 2; ++c) {
      const int code =
          mrcal("project '" + files[c].string() + "' '" + (folder.path() / "points").string() + "'",
                folder.path() / "pixels");
      if (code == 77) GTEST_SKIP() << "no mrcal for " DEBIAN_PYTHON;
      ASSERT_EQ(code, 0);
      std::istringstream pixels(read_whole(folder.path() / "pixels"));
      for (const Eigen::Vector3d& x : points()) {
        Eigen::Vector2d theirs(NAN, NAN);
        pixels >> theirs[0] >> theirs[1];
        EXPECT_LT((theirs - project(rig.cameras[c], rig.T_camera_first[c] * x)).norm(), 1e-9)
            << model;
      }
    }
  }
}

TEST(ConvertTools, WeReadWhatMrcalWrites) {
  for (const char* model : brown_models) {
    Folder folder;
    const Rig rig = rig_of_cameras(camera_model(model), 2);
    for (const auto& file : folder.write(mrcal_cameramodels(rig))) {
      const int code =
          mrcal("rewrite '" + file.string() + "' '" + file.string() + "'", folder.path() / "out");
      if (code == 77) GTEST_SKIP() << "no mrcal for " DEBIAN_PYTHON;
      ASSERT_EQ(code, 0);
    }
    const std::string left = (folder.path() / "left.cameramodel").string();
    ASSERT_EQ(read_whole(left).find("rt_cam_ref"), std::string::npos);  // theirs, not ours
    const Rig read = read_mrcal_cameramodels({left, folder.path() / "right.cameramodel"}).rig;
    ASSERT_EQ(model_name(read.cameras[0].model), model);
    // mrcal prints ten digits
    const Eigen::VectorXd off = difference(read, rig), a = parameters(rig);
    for (Eigen::Index i = 0; i < a.size(); ++i) EXPECT_NEAR(off[i], 0, 1e-9 * std::abs(a[i]));
  }
}

/// OpenCV's reading of our file against our projection.
TEST(ConvertTools, OpenCvProjectsOurFilesToTheSamePixels) {
  Folder folder;
  std::vector<cv::Point3d> scene;
  for (const Eigen::Vector3d& x : points()) scene.emplace_back(x[0], x[1], x[2]);
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    const Rig rig = rig_of_cameras(camera_model(model), 2);
    const cv::FileStorage file(folder.write(opencv_calibration(rig))[0].string(),
                               cv::FileStorage::READ);
    cv::Mat R, T, r;
    file["R"] >> R;
    file["T"] >> T;
    cv::Rodrigues(R, r);
    for (int c = 0; c < 2; ++c) {
      cv::Mat K, D;
      file["M" + std::to_string(c + 1)] >> K;
      file["D" + std::to_string(c + 1)] >> D;
      const cv::Mat zero = cv::Mat::zeros(3, 1, CV_64F);
      std::vector<cv::Point2d> pixels;
      const bool fisheye = file["distortion_model_1"].string() == "fisheye";
      EXPECT_EQ(fisheye, std::string(model) == "fisheye4");
      if (fisheye) {
        cv::fisheye::projectPoints(scene, pixels, c ? r : zero, c ? T : zero, K, D);
      } else {
        cv::projectPoints(scene, c ? r : zero, c ? T : zero, K, D, pixels);
      }
      for (std::size_t i = 0; i < scene.size(); ++i) {
        const Eigen::Vector2d ours = project(rig.cameras[c], rig.T_camera_first[c] * points()[i]);
        EXPECT_LT((Eigen::Vector2d(pixels[i].x, pixels[i].y) - ours).norm(), 1e-9) << model;
      }
    }
  }
}

cv::Mat_<double> mat(const Eigen::MatrixXd& m) {
  cv::Mat_<double> out(static_cast<int>(m.rows()), static_cast<int>(m.cols()));
  for (int r = 0; r < out.rows; ++r) {
    for (int c = 0; c < out.cols; ++c) out(r, c) = m(r, c);
  }
  return out;
}

TEST(ConvertTools, WeReadWhatOpenCvWrites) {
  Folder folder;
  const Rig rig = rig_of_cameras(OpenCv5{}, 2);
  const std::string one = (folder.path() / "intrinsics.yml").string();
  const std::string two = (folder.path() / "extrinsics.yml").string();
  {  // as OpenCV's stereo_calib does
    cv::FileStorage file(one, cv::FileStorage::WRITE);
    for (std::size_t c = 0; c < 2; ++c) {
      const Camera& camera = rig.cameras[c];
      cv::Mat_<double> K = (cv::Mat_<double>(3, 3) << camera.f_px() * camera.ax(), 0,
                            camera.ox_px(), 0, camera.f_px(), camera.oy_px(), 0, 0, 1);
      file << "M" + std::to_string(c + 1) << K;
      file << "D" + std::to_string(c + 1) << mat(camera.parameters.tail(5).transpose());
    }
    file.open(two, cv::FileStorage::WRITE);
    file << "R" << mat(rig.T_camera_first[1].R) << "T" << mat(rig.T_camera_first[1].t);
    file << "Q" << mat(Eigen::Matrix4d::Identity());
  }
  const Rig read = read_opencv_calibration({one, two}, {.size_px = Eigen::Vector2i(640, 480)}).rig;
  EXPECT_EQ(read.T_camera_first[1].R, rig.T_camera_first[1].R);  // OpenCV writes 17 digits
  EXPECT_EQ(read.T_camera_first[1].t, rig.T_camera_first[1].t);
  EXPECT_EQ(read.cameras[1].parameters.tail(7), rig.cameras[1].parameters.tail(7));
  EXPECT_LT(difference(read, rig).cwiseAbs().maxCoeff(), 1e-12);
}

/// cv::stereoRectify's own R1, R2, P2, as ROS's camera_calibration writes them, tell R and T.
TEST(ConvertTools, RosPairsRectifiedByOpenCv) {
  const Rig rig = rig_of_cameras(OpenCv5{}, 2);
  std::vector<RosCameraInfo> infos = rectified_camera_info(rig);
  const auto intrinsics = [&](int c) {
    const Camera& camera = rig.cameras[static_cast<std::size_t>(c)];
    return cv::Mat_<double>((cv::Mat_<double>(3, 3) << camera.f_px() * camera.ax(), 0,
                             camera.ox_px(), 0, camera.f_px(), camera.oy_px(), 0, 0, 1));
  };
  cv::Mat_<double> R1, R2, P1, P2, Q;
  cv::stereoRectify(intrinsics(0), mat(rig.cameras[0].parameters.tail(5)), intrinsics(1),
                    mat(rig.cameras[1].parameters.tail(5)), {640, 480},
                    mat(rig.T_camera_first[1].R), mat(rig.T_camera_first[1].t), R1, R2, P1, P2, Q,
                    cv::CALIB_ZERO_DISPARITY, 0);
  const auto copy = [](const cv::Mat_<double>& from, auto& to) {
    for (int r = 0; r < from.rows; ++r) {
      for (int c = 0; c < from.cols; ++c) to(r, c) = from(r, c);
    }
  };
  copy(R1, infos[0].R_rectified_camera);
  copy(R2, infos[1].R_rectified_camera);
  copy(P1, infos[0].P);
  copy(P2, infos[1].P);
  Folder folder;
  const auto left = folder.write("left.yaml", format_ros_camera_info(infos[0]).text);
  const auto right = folder.write("right.yaml", format_ros_camera_info(infos[1]).text);
  EXPECT_LT(difference(read_ros_camera_info({left, right}).rig, rig).cwiseAbs().maxCoeff(), 1e-12);
}

/// Our own: corresponding points fall on one row, with the disparity f B / z, in the image.
TEST(ConvertTools, RosPairsRectifyToRows) {
  const Rig rig = rig_of_cameras(OpenCv5{}, 2);
  const std::vector<RosCameraInfo> infos = rectified_camera_info(rig);
  const double B = rig.T_camera_first[1].t.norm();
  for (const Eigen::Vector3d& x : points()) {
    Eigen::Vector2d pixels[2];
    for (std::size_t c = 0; c < 2; ++c) {
      // P is of the rectified left camera's points; its fourth column makes them the right one's
      const Eigen::Vector3d q = infos[c].P * (infos[0].R_rectified_camera * x).homogeneous();
      pixels[c] = q.hnormalized();
      const Eigen::Vector3d own = infos[c].R_rectified_camera * (rig.T_camera_first[c] * x);
      EXPECT_LT((infos[c].P.leftCols<3>() * own - q).norm(), 1e-9);
    }
    const double z = (infos[0].R_rectified_camera * x).z();
    EXPECT_NEAR(pixels[0].y(), pixels[1].y(), 1e-9);
    EXPECT_NEAR(pixels[0].x() - pixels[1].x(), infos[0].P(0, 0) * B / z, 1e-9);
  }
  EXPECT_NEAR(infos[0].P(0, 2), 319.5, 30);
  EXPECT_NEAR(infos[0].P(1, 2), 239.5, 30);
}

/// COLMAP reads our model, writes it in its binary form and then as text: we read the same rig.
TEST(ConvertTools, ColmapReadsAndWritesOurModels) {
  if (std::string(COLMAP_PROGRAM).find("NOTFOUND") != std::string::npos) {
    GTEST_SKIP() << "no colmap";
  }
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    Folder folder, binary, text;
    Rig rig = rig_of_cameras(camera_model(model), 3);
    if (std::string(model) == "radial1") rig.cameras[0].parameters[1] = 1;  // SIMPLE_RADIAL
    folder.write(colmap_cameras(rig));
    const auto convert = [](const Folder& from, const Folder& to, const std::string& type) {
      return run("QT_QPA_PLATFORM=offscreen '" COLMAP_PROGRAM "' model_converter --input_path '" +
                     from.path().string() + "' --output_path '" + to.path().string() +
                     "' --output_type " + type,
                 to.path() / "log");
    };
    ASSERT_EQ(convert(folder, binary, "BIN"), 0) << model;
    ASSERT_EQ(convert(binary, text, "TXT"), 0) << model;
    const Rig read = read_colmap_cameras(text.path()).rig;
    ASSERT_EQ(parameter_names(read), parameter_names(rig));
    EXPECT_LT(difference(read, rig).cwiseAbs().maxCoeff(), 1e-12) << model;
  }
}

}  // namespace
}  // namespace vernier
