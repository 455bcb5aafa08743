// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calib/camera.h"
#include "calib/formats/colmap_cameras.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/kalibr_camchain.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/formats/opencv_calibration_file.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/texts.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::error_message;
using test::Folder;
using test::rig_of_cameras;

/// A change of a good file and what is said of it.
struct Change {
  const char *from, *to, *error_output;
};

/// The text with its first `from` replaced.
template <typename Read>
void expect_complaints(const std::string& name,
                       const std::string& good,
                       const std::vector<Change>& changes,
                       const Read& read) {
  Folder folder;
  EXPECT_EQ(error_message([&] { read(folder.write(name, good)); }), "");
  for (const Change& change : changes) {
    const std::string text = test::replaced(good, change.from, change.to);
    const std::string said = error_message([&] { read(folder.write(name, text)); });
    EXPECT_NE(said.find(change.error_output), std::string::npos)
        << change.to << "\n  said " << said;
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

/// Every beginning of a file is refused or read, most are refused, and none ends the program.
template <typename Read>
void expect_cuts_are_refused(const std::string& name, const std::string& good, const Read& read) {
  Folder folder;
  std::size_t refused = 0, tried = 0;
  for (std::size_t length = 0; length < good.size(); length += 7, ++tried) {
    const auto file = folder.write(name, good.substr(0, length));
    refused += !error_message([&] { read(file); }).empty();
  }
  EXPECT_GT(refused, tried * 3 / 4);  // the rest lacks only what may be left out
}

Rig one_camera(const CameraModel& model = OpenCv5{}) { return rig_of_cameras(model, 1); }

TEST(ConvertBadFiles, Mrcal) {
  const auto read = [](const std::filesystem::path& file) { read_mrcal_cameramodels({file}); };
  const std::string good = mrcal_cameramodels(one_camera())[0].text;
  expect_complaints(
      "left.cameramodel", good,
      {{"'lensmodel'", "'model'", "has no 'lensmodel'"},
       {"LENSMODEL_OPENCV5", "LENSMODEL_CAHVOR",
        ":2: lensmodel: unsupported lens model LENSMODEL_CAHVOR"},
       {"LENSMODEL_OPENCV5", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=150",
        "unsupported lens model LENSMODEL_SPLINED"},
       {"LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8", ":5: intrinsics: holds 9 values, not 12"},
       {"[ 526.05,", "[ 1e999,", ":5: \"1e999\" is not a number that a double can hold"},
       {"[ 526.05,", "[ nan,", "intrinsics[0]: is not a finite number"},
       {"[ 526.05,", "[ -526.05,", "its focal lengths are -526.05 and 525"},
       {"[ 526.05,", "[ 'f',", "intrinsics[0]: is not a finite number"},
       {"'extrinsics': [ 0,", "'extrinsics': [ 1,", "differs from rt_cam_ref"},
       {"'rt_cam_ref': [ 0,", "'rt_cam_ref': [", "rt_cam_ref: holds 5 values, not 6"},
       {"[ 640, 480 ]", "[ 640 ]", "imagersize: holds 1 values, not 2"},
       {"[ 640, 480 ]", "[ 640.5, 480 ]", "imagersize: is not [width, height]"},
       {"'imagersize'", "'intrinsics'", "has the key 'intrinsics' twice"},
       {"[ 640, 480 ],\n}", "[ 640, 480 ],\n", "ends too early: it was cut off"},
       {"[ 640, 480 ],\n}", "[ 640, 480 ],\n} f", "has something after its end"},
       {"'imagersize'", "'imagersize", "has a quote that is not closed"}},
      read);
  expect_cuts_are_refused("left.cameramodel", good, read);
}

TEST(ConvertBadFiles, MrcalKeysOfOldAndNewVersions) {
  Folder folder;
  std::vector<std::string> notes;
  const auto parse = [&](const std::string& text) {
    return parse_mrcal_cameramodel(text, "m", {}, notes);
  };
  const std::string core = "'intrinsics': (4, +3., 4, 5.5e0,), 'imagersize': [110, 400], ";
  const std::string pose = "[ 0., 1, 2, 33, 44e4, -55.3E-3, ]";
  // as mrcal 0.x, 2.2 and later versions wrote them, with entries of other kinds between
  for (const std::string& text :
       {"{'distortion_model': 'DISTORTION_NONE', " + core + "'extrinsics': " + pose + "}",
        "# note\n{ \"lens_model\": \"LENSMODEL_PINHOLE\", 'q': # c ]}\n b'a{\\'}', 'n': None, " +
            core + "'extrinsics': " + pose + "} # end",
        "{'lensmodel': 'LENSMODEL_' 'PINHOLE', " + core + "'rt_cam_ref': " + pose + "}"}) {
    const PlacedCamera read = parse(text);
    EXPECT_EQ(read.camera.size_px, Eigen::Vector2i(110, 400));
    EXPECT_EQ(read.camera.f_px(), 3);
    EXPECT_EQ(read.camera.oy_px(), 5.5);
    EXPECT_EQ(read.T_camera_reference.t, Eigen::Vector3d(33, 44e4, -55.3e-3));
  }
  EXPECT_TRUE(notes.empty());
  parse("{'lensmodel': 'LENSMODEL_PINHOLE', " + core + "'extrinsics': " + pose +
        ", 'icam_intrinsics': 0, 'optimization_inputs': b'0@}]'}");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "m: optimization_inputs is ignored");
}

// They were read, and the written rig.json was refused.
TEST(ConvertBadFiles, PosesBeyondAllLimits) {
  std::vector<std::string> notes;
  const auto said_of = [&](const std::string& pose) {
    return error_message([&] {
      parse_mrcal_cameramodel(
          "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [4, 3, 4, 5],\n"
          "'imagersize': [110, 400], 'extrinsics': " +
              pose + "}",
          "m", {}, notes);
    });
  };
  EXPECT_EQ(said_of("[0, 0, 0, 1e9, 0, -1e9]"), "");
  EXPECT_EQ(said_of("[0, 0, 0, 1e308, 0, 0]")
                .find("m:2: extrinsics: a position is not finite, or beyond 1e+09 m"),
            0u);
  EXPECT_EQ(said_of("[0, 1e308, 0, 0, 0, 0]").find("m:2: extrinsics: a rotation is beyond 1000"),
            0u);
  const Camera camera = one_camera().cameras[0];
  const Pose far{Eigen::Matrix3d::Identity(), {9e8, 0, 0}};
  EXPECT_EQ(error_message([&] {
              rig_of({{camera, far.inverse()}, {camera, far}});
            }),
            "camera \"right\": it is further than 1e+09 m from the first; correct its position, or "
            "the unit of length");
}

TEST(ConvertBadFiles, OpenCv) {
  const auto read = [](const std::filesystem::path& file) { read_opencv_calibration({file}); };
  const std::string good = opencv_calibration(rig_of_cameras(OpenCv5{}, 2))[0].text;
  expect_complaints(
      "rig.yml", good,
      {{"M1:", "N1:", "has no \"camera_matrix\""},
       {"D2:", "E2:", "has no \"D2\""},
       {"R:", "Q:", "has no \"R\""},
       {"T:", "S:", "has no \"T\""},
       {"[ 526.05, 0,", "[ 526.05, 0.125,", "M1: has a skew of 0.125"},
       {"[ 526.05, 0,", "[ .Nan, 0,", "M1.data[0]: \".Nan\" is not a finite number"},
       {"[ 526.05, 0,", "[ 526.05,", "M1.data: holds 8 numbers, not 9"},
       {"rows: 3\n   cols: 3", "rows: 2\n   cols: 3", "M1: is 2x3, not 3x3"},
       {"rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.12,",
        "rows: 1\n   cols: 6\n   dt: d\n   "
        "data: [ 0, -0.12,",
        "D1: holds 6 coefficients; OpenCV has 4, 5, 8, 12 or 14"},
       {"image_width_1: 640", "image_wide: 640", "does not give the image size"},
       {"image_width_1: 640", "image_width_1: -640", "is not a whole number above 0"},
       {"distortion_model_2: opencv", "distortion_model_2: omni",
        "unsupported distortion model \"omni\""},
       {"distortion_model_2: opencv", "distortion_model_2: fisheye", "cv::fisheye has 4"},
       {"---", "---\n\t: {", "is not YAML"}},
      read);
  expect_cuts_are_refused("rig.yml", good, read);
}

TEST(ConvertBadFiles, OpenCvSizesAndFisheyeMayBeSaidBesides) {
  Folder folder;
  const Rig rig = rig_of_cameras(Fisheye4{}, 2);
  std::string text = opencv_calibration(rig)[0].text;
  for (const char* i : {"1", "2"}) {
    text = test::replaced(text, std::string("image_width_") + i, std::string("w") + i);
    text = test::replaced(text, std::string("distortion_model_") + i + ": fisheye",
                          std::string("x: ") + i);
    text = test::replaced(text, std::string("x: ") + i, std::string("x") + i + ": 0");
  }
  const auto file = folder.write("stereo.yml", text);
  const ImportedRig read =
      read_opencv_calibration({file}, {.model = Fisheye4{}, .size_px = Eigen::Vector2i(640, 480)});
  EXPECT_EQ(read.rig.cameras[1].parameters.tail(4), rig.cameras[1].parameters.tail(4));
  EXPECT_TRUE(std::holds_alternative<Fisheye4>(read.rig.cameras[0].model));
  const ImportedRig brown = read_opencv_calibration({file}, {.size_px = Eigen::Vector2i(640, 480)});
  EXPECT_TRUE(std::holds_alternative<OpenCv4>(brown.rig.cameras[0].model));
  ASSERT_EQ(brown.notes.size(), 2u);
  EXPECT_NE(brown.notes[0].find("if they are from cv::fisheye, choose the model fisheye4"),
            std::string::npos);

  const auto sized = folder.write(opencv_calibration(rig));
  EXPECT_NE(error_message([&] {
              read_opencv_calibration(sized, {.size_px = Eigen::Vector2i(320, 240)});
            }).find("its images are 640x480 in the file, but 320x240 was given"),
            std::string::npos);
  EXPECT_NE(error_message([&] {
              read_opencv_calibration({sized[0], sized[0]});
            }).find("is also in another of the files"),
            std::string::npos);
}

TEST(ConvertBadFiles, Kalibr) {
  const auto read = [](const std::filesystem::path& file) { read_kalibr_camchain(file); };
  const std::string good = kalibr_camchain(rig_of_cameras(OpenCv4{}, 2))[0].text;
  expect_complaints(
      "camchain.yaml", good,
      {{"cam0:", "left:", "is not a camchain: it has no \"cam0\""},
       {"camera_model: pinhole", "camera_model: omni",
        ":3: cam0.camera_model: unsupported camera model"},
       {"radtan", "fov", "cam0.distortion_model: unsupported distortion model \"fov\""},
       {"intrinsics: [526.05, ", "intrinsics: [", "cam0.intrinsics: holds 3 numbers, not 4"},
       {"intrinsics: [526.05, ", "intrinsics: [nan, ", "cam0.intrinsics[0]: \"nan\" is not a"},
       {"resolution: [640, 480]", "resolution: [640, 0]", "is not [width, height]"},
       {"resolution", "size", "cam0: has no \"resolution\""},
       {"radtan", "\"rad\\ntan\"",
        "cam0.distortion_model: \"rad\\x0atan\" is not a single-line string"},
       {"cam1:", "cam0:", "the key \"cam0\" appears a second time"},
       {"T_cn_cnm1", "T_cam_imu", "cam1: has no \"T_cn_cnm1\""},
       {"[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.1, 1.0]", "its last row is not 0 0 0 1"},
       {"  - [0.0, 0.0, 0.0, 1.0]\n", "", "cam1.T_cn_cnm1: is 3x4, not 4x4"},
       {"  - [0.9", "  - [0.8", "cam1.T_cn_cnm1: is not a rotation"}},
      read);
  expect_cuts_are_refused("camchain.yaml", good, read);
}

/// The camchain with a T_cam_imu for each of the cameras listed, and T_cn_cnm1 if `steps`.
std::string with_imu(const Rig& rig, const std::vector<std::size_t>& cameras, bool steps) {
  const Pose T_imu{rotation_from_vector({1.2, -0.4, 0.3}), {0.05, -0.02, 0.3}};  // first from IMU
  std::string text = kalibr_camchain(rig)[0].text;
  if (!steps) {
    for (std::size_t at; (at = text.find("  T_cn_cnm1:")) != std::string::npos;) {
      const std::string last = "  - [0.0, 0.0, 0.0, 1.0]\n";
      text.erase(at, text.find(last, at) + last.size() - at);
    }
  }
  for (const std::size_t i : cameras) {
    const Pose T = rig.T_camera_first[i] * T_imu;
    std::string pose = "  T_cam_imu:\n";
    for (int r = 0; r < 3; ++r) {  // rounded as by hand
      pose += fmt::format("  - [{:.7f}, {:.7f}, {:.7f}, {:.7f}]\n", T.R(r, 0), T.R(r, 1), T.R(r, 2),
                          T.t[r]);
    }
    const std::string camera = fmt::format("cam{}:\n", i);
    text.insert(text.find(camera) + camera.size(), pose + "  - [0.0, 0.0, 0.0, 1.0]\n");
  }
  return text;
}

TEST(ConvertBadFiles, KalibrPosesFollowFromTheImu) {
  Folder folder;
  const Rig rig = rig_of_cameras(OpenCv4{}, 3);
  const ImportedRig read =
      read_kalibr_camchain(folder.write("c.yaml", with_imu(rig, {0, 1, 2}, false)));
  for (std::size_t i = 1; i < 3; ++i) {
    const Pose T = read.rig.T_camera_first[i] * rig.T_camera_first[i].inverse();
    EXPECT_LT(vector_from_rotation(T.R).norm(), 1e-6);
    EXPECT_LT((read.rig.T_camera_first[i].t - rig.T_camera_first[i].t).norm(), 1e-6);
  }
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("the pose is from T_cam_imu"), std::string::npos);
  const std::string gap = folder.write("gap.yaml", with_imu(rig, {1, 2}, false)).string();
  EXPECT_NE(
      test::error_message([&] { read_kalibr_camchain(gap); }).find("cam1: has no \"T_cn_cnm1\""),
      std::string::npos);
}

TEST(ConvertBadFiles, KalibrPosesGivenTwiceMustAgree) {
  Folder folder;
  const Rig rig = rig_of_cameras(OpenCv4{}, 3);
  // The chain is what is read; the second camera's pose from the IMU follows along it.
  const auto both = folder.write("c.yaml", with_imu(rig, {0, 2}, true));
  EXPECT_EQ(read_kalibr_camchain(both).rig.T_camera_first[1].t, rig.T_camera_first[1].t);
  Rig moved = rig;
  moved.T_camera_first[2].t.x() += 1e-3;
  std::string text = with_imu(moved, {0, 2}, true);
  const std::string chain = kalibr_camchain(rig)[0].text;
  const std::size_t own = chain.rfind("  T_cn_cnm1"), old = text.rfind("  T_cn_cnm1");
  text.replace(old, text.find("1.0]\n", old) - old, chain, own, chain.find("1.0]\n", own) - own);
  const std::string wrong = folder.write("w.yaml", text).string();
  EXPECT_NE(test::error_message([&] {
              read_kalibr_camchain(wrong);
            }).find("cam2: T_cn_cnm1 and the T_cam_imu of the two cameras disagree by"),
            std::string::npos);
}

TEST(ConvertBadFiles, KalibrChainsAndNames) {
  Folder folder;
  const Rig rig = rig_of_cameras(OpenCv4{}, 3);
  std::string text = kalibr_camchain(rig)[0].text;
  text = test::replaced(text, "/left/image_raw", "/davis/left/image_raw");
  text = test::replaced(text, "  T_cn_cnm1", "  timeshift_cam_imu: 0.01\n  T_cn_cnm1");
  const ImportedRig read = read_kalibr_camchain(folder.write("c.yaml", text));
  EXPECT_EQ(read.rig.cameras[0].name, "left");
  EXPECT_EQ(read.rig.cameras[2].name, "camera2");
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_NE(read.notes[0].find("cam1.timeshift_cam_imu is ignored"), std::string::npos);
  // The third camera's pose is the product of two links.
  EXPECT_LT((read.rig.T_camera_first[2].t - rig.T_camera_first[2].t).norm(), 1e-15);
  text = test::replaced(text, "/camera2/image_raw", "/right/image_raw");
  EXPECT_EQ(read_kalibr_camchain(folder.write("c.yaml", text)).rig.cameras[2].name, "cam2");
  // Names of ROS with parts are topics too; those with blanks are none.
  Rig named = rig;
  named.cameras[0].name = "/stereo/left";
  const std::string topics = kalibr_camchain(named)[0].text;
  EXPECT_NE(topics.find("/stereo/left/image_raw"), std::string::npos);
  EXPECT_EQ(topics.find("//"), std::string::npos);
  named.cameras[0].name = "my left";
  EXPECT_NE(test::error_message([&] { kalibr_camchain(named); }).find("is none of a ROS topic"),
            std::string::npos);
}

TEST(ConvertBadFiles, Ros) {
  const auto read = [](const std::filesystem::path& file) { read_ros_camera_info({file}); };
  RosCameraInfo info;
  info.camera = one_camera().cameras[0];
  const std::string good = format_ros_camera_info(info).text;
  expect_complaints(
      "left.yaml", good,
      {{"camera_matrix", "matrix", "has no \"camera_matrix\""},
       {"plumb_bob", "double_sphere", "unsupported distortion model \"double_sphere\""},
       {"plumb_bob", "rational_polynomial",
        "holds 5 coefficients, not a number that rational_polynomial"},
       {"data: [526.05, 0,", "data: [526.05, 1,", "has a skew of 1"},
       {"data: [526.05, 0,", "data: [0, 0,", "0: the camera was never calibrated"},
       {"image_width: 640", "image_width: 640.5", "image_width: 640.5 is not a whole number"},
       {"cols: 3\n  data: [1, 0", "cols: 3\n  data: [2, 0",
        "rectification_matrix: is not a rotation"}},
      read);
  expect_cuts_are_refused("left.yaml", good, read);
}

TEST(ConvertBadFiles, RosPairsWithoutABaselineAndMessages) {
  Folder folder;
  RosCameraInfo info;
  info.camera = one_camera().cameras[0];
  const auto file = folder.write("left.yaml", format_ros_camera_info(info).text);
  EXPECT_NE(error_message([&] {
              read_ros_camera_info({file, file});
            }).find("has no baseline"),
            std::string::npos);
  // of images that are reduced, or a part
  const auto reduced = folder.write("reduced.yaml", format_ros_camera_info(info).text +
                                                        "binning_x: 2\nbinning_y: 1\nroi:\n"
                                                        "  x_offset: 0\n  y_offset: 0\n"
                                                        "  height: 100\n  width: 0\n");
  const std::vector<std::string> notes = read_ros_camera_info({reduced}).notes;
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_NE(notes[0].find("binning_x is ignored: the rig is that of whole images"),
            std::string::npos)
      << notes[0];
  EXPECT_NE(notes[1].find("roi.height is ignored"), std::string::npos) << notes[1];
  const auto whole = folder.write("whole.yaml", format_ros_camera_info(info).text +
                                                    "roi:\n  x_offset: 0\n  y_offset: 0\n"
                                                    "  height: 480\n  width: 640\n");
  EXPECT_TRUE(read_ros_camera_info({whole}).notes.empty());
  // the message itself, as `rostopic echo` and `ros2 topic echo` print it
  const std::string end = "[500, 0, 320, 0, 500, 240, 0, 0, 1]\n";
  for (const char* keys : {"DKRP", "dkrp"}) {
    const auto message = [&](double shift) {
      const std::string k(keys);
      return "header:\n  frame_id: x\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\n" +
             k.substr(0, 1) + ": [0.1, 0.0, 0.0, 0.0, 0.0]\n" + k.substr(1, 1) + ": " + end +
             k.substr(2, 1) + ": [1, 0, 0, 0, 1, 0, 0, 0, 1]\n" + k.substr(3, 1) +
             ": [400, 0, 320, " + std::to_string(shift) + ", 0, 400, 240, 0, 0, 0, 1, 0]\n";
    };
    const Rig rig = read_ros_camera_info(
                        {folder.write("a.yaml", message(0)), folder.write("b.yaml", message(-48))})
                        .rig;
    EXPECT_EQ(rig.cameras[1].name, "b");
    EXPECT_EQ(model_name(rig.cameras[1].model), "radial1");
    EXPECT_DOUBLE_EQ(rig.T_camera_first[1].t.x(), -0.12);
    EXPECT_EQ(rig.T_camera_first[1].R, Eigen::Matrix3d::Identity());
  }
}

TEST(ConvertBadFiles, Colmap) {
  const std::vector<ExportedFile> files = colmap_cameras(rig_of_cameras(OpenCv4{}, 2));
  const auto read = [](const std::filesystem::path& file) { read_colmap_cameras(file); };
  Folder folder;
  expect_complaints("cameras.txt", colmap_cameras(one_camera(OpenCv4{}))[0].text,
                    {{"1 OPENCV", "1 FOV", ":2: unsupported camera model FOV"},
                     {"1 OPENCV", "1 FULL_OPENCV", ":2: has 12 words, not 16"},
                     {"1 OPENCV", "1 PINHOLE", ":2: has 12 words, not 8"},
                     {"1 OPENCV", "one OPENCV", ":2: \"one\" is not a finite number"},
                     {"640", "0", "its image size is 0 x 480"},
                     {"526.05", "nan", "\"nan\" is not a finite number"},
                     {"1 OPENCV", "#1 OPENCV", "holds no camera"}},
                    read);
  const auto cameras = folder.write("cameras.txt", files[0].text);
  EXPECT_NE(error_message([&] {
              read(cameras);
            }).find("holds 2 cameras, but no file next to it gives their poses"),
            std::string::npos);
  folder.write("images.txt", files[1].text + files[1].text);
  EXPECT_NE(error_message([&] { read(cameras); }).find("images.txt: holds 4 images of 2 cameras"),
            std::string::npos);
  folder.write("rig_config.json", test::replaced(files[3].text, "\"image_prefix\"", "\"prefix\""));
  EXPECT_NE(error_message([&] { read(cameras); }).find("has no \"image_prefix\""),
            std::string::npos);
  folder.write("rig_config.json", test::replaced(files[3].text, "cam_from_rig_rotation\": [",
                                                 "cam_from_rig_rotation\": [2, "));
  EXPECT_NE(error_message([&] { read(cameras); }).find("is not a quaternion of 4"),
            std::string::npos);
  folder.write("rigs.txt", "1 2 CAMERA 1 CAMERA 2 1 0.5 0 0 0 1 2 3\n");
  EXPECT_NE(
      error_message([&] { read(cameras); }).find("rigs.txt:1: its quaternion has the length 0.5"),
      std::string::npos);
  folder.write("rigs.txt", "1 2 CAMERA 1 CAMERA 2 1 0.995 0 0 0 1 2 3\n");
  EXPECT_EQ(error_message([&] { read(cameras); }).find("quaternion"), std::string::npos);
  folder.write("rigs.txt", "1 2 CAMERA 1 CAMERA 2 0\n");
  EXPECT_NE(error_message([&] { read(cameras); }).find("camera 2 has no pose"), std::string::npos);
  folder.write("rigs.txt", "1 2 CAMERA 1 CAMERA 3 1 1 0 0 0 1 2 3\n");
  EXPECT_NE(error_message([&] { read(cameras); }).find("cameras.txt has no camera 3"),
            std::string::npos);
  folder.write("rigs.txt", "1 1 CAMERA 1\n2 1 CAMERA 2\n");
  EXPECT_NE(error_message([&] { read(cameras); }).find("holds 2 rigs"), std::string::npos);
}

TEST(ConvertBadFiles, ColmapRigsSayWhichCameraIsFirst) {
  Folder folder;
  const auto cameras = folder.write("cameras.txt",
                                    "7 SIMPLE_RADIAL 640 480 500 320.5 240 0.25\n"
                                    "3 RADIAL_FISHEYE 640 480 500 320.5 240 0.25 0.5\n");
  folder.write("rigs.txt", "# Rigs\n1 2 CAMERA 7 CAMERA 3 1 0.6 0.8 0 0 1 2 3\n");
  const Rig rig = read_colmap_cameras(cameras).rig;
  EXPECT_EQ(model_name(rig.cameras[0].model), "radial1");
  EXPECT_EQ(rig.cameras[0].parameters, (Eigen::VectorXd(5) << 500, 1, 320, 239.5, 0.25).finished());
  EXPECT_EQ(rig.cameras[1].parameters,
            (Eigen::VectorXd(8) << 500, 1, 320, 239.5, 0.25, 0.5, 0, 0).finished());
  EXPECT_EQ(rig.T_camera_first[1].t, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(rig.T_camera_first[1].R(2, 1), 0.96, 1e-15);  // 2 w x: Hamilton's order
  EXPECT_EQ(rig.cameras[1].name, "right");
}

/// Two cameras whose poses and lenses differ, and rig_config.json with its entries exchanged.
class ColmapRigConfig : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("cameras.txt", files_[0].text);
    exchange("");
  }
  /// Without the keys that begin like this.
  void exchange(const std::string& without) {
    std::string text = files_[3].text;
    const std::size_t first = text.find("      {"), comma = text.find(",\n      {", first);
    const std::size_t end = text.find("\n    ]", comma);
    text = text.substr(0, first) + text.substr(comma + 2, end - comma - 2) + ",\n" +
           text.substr(first, comma - first) + text.substr(end);
    for (std::size_t at; !without.empty() && (at = text.find("\"" + without)) < text.size();) {
      text.replace(at + 1, 1, "_");  // unknown keys are passed over
    }
    folder_.write("rig_config.json", text);
  }
  ImportedRig read() { return read_colmap_cameras(folder_.path() / "cameras.txt"); }

  /// Each pose with its lens, whichever camera is first.
  void expect_right(const ImportedRig& read) {
    ASSERT_EQ(read.rig.cameras.size(), 2u);
    EXPECT_EQ(read.rig.cameras[0].name, "right");
    EXPECT_EQ(read.rig.cameras[0].f_px(), rig_.cameras[1].f_px());
    EXPECT_EQ(read.rig.cameras[1].f_px(), rig_.cameras[0].f_px());
    const Pose expected = rig_.T_camera_first[1].inverse();
    EXPECT_LT((read.rig.T_camera_first[1].t - expected.t).norm(), 1e-12);
    EXPECT_TRUE(read.notes.empty());
  }

  const Rig rig_ = rig_of_cameras(OpenCv4{}, 2);
  const std::vector<ExportedFile> files_ = colmap_cameras(rig_);
  Folder folder_;
};

TEST_F(ColmapRigConfig, EntriesAreMatchedByTheirParameters) {
  ASSERT_NE(rig_.cameras[0].f_px(), rig_.cameras[1].f_px());
  expect_right(read());
}

TEST_F(ColmapRigConfig, ElseByTheImagesUnderTheirPrefix) {
  exchange("camera_params");
  folder_.write("images.txt", files_[1].text);
  expect_right(read());
}

TEST_F(ColmapRigConfig, ElseByOrderWhichIsSaid) {
  exchange("camera_params");
  const ImportedRig read = this->read();
  EXPECT_EQ(read.rig.cameras[0].name, "right");
  EXPECT_EQ(read.rig.cameras[0].f_px(), rig_.cameras[0].f_px());
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_NE(read.notes[0].find("rig_config.json: its cameras are matched by order"),
            std::string::npos);
}

TEST_F(ColmapRigConfig, CamerasAlikeAreToldByTheirImages) {
  Rig rig = rig_;
  rig.cameras[1] = rig.cameras[0];
  rig.cameras[1].name = "right";
  for (const ExportedFile& file : colmap_cameras(rig)) folder_.write(file.name.string(), file.text);
  EXPECT_TRUE(read().notes.empty());
}

TEST(ConvertBadFiles, ColmapNamesAreEscaped) {
  Folder folder;
  Rig rig = rig_of_cameras(OpenCv4{}, 2);
  rig.cameras[1].name = "the\"right\"one";
  for (const ExportedFile& file : colmap_cameras(rig)) folder.write(file.name.string(), file.text);
  EXPECT_EQ(read_colmap_cameras(folder.path()).rig.cameras[1].name, rig.cameras[1].name);
}

}  // namespace
}  // namespace vernier
