// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Rigs of sequences: ASL's sensor.yaml and KITTI's calibrations.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/joined_numbers.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/formats/asl_sensor.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/kitti_calib.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "tests/support/data_folder.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::error_message;
using test::Folder;

/// A sensor.yaml as EuRoC writes it, of a camera placed on a body.
std::string sensor_text(const Camera& camera, const Pose& T_body_camera) {
  const OpenCvIntrinsics in = opencv_intrinsics(camera);
  std::string data;
  for (int r = 0; r < 3; ++r) {
    data += fmt::format("{}, {}, {}, {},\n         ", T_body_camera.R(r, 0), T_body_camera.R(r, 1),
                        T_body_camera.R(r, 2), T_body_camera.t[r]);
  }
  std::string k;
  for (const double c : in.coefficients) k += (k.empty() ? "" : ", ") + fmt::format("{}", c);
  return fmt::format(
      "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\ncomment: made\n"
      "T_BS:\n  cols: 4\n  rows: 4\n  data: [{}0.0, 0.0, 0.0, 1.0]\nrate_hz: 20\n"
      "resolution: [{}, {}]\ncamera_model: pinhole\nintrinsics: [{}, {}, {}, {}] #fu, fv, cu, cv\n"
      "distortion_model: {}\ndistortion_coefficients: [{}]\n",
      data, camera.size_px[0], camera.size_px[1], in.fx_px, in.fy_px, in.cx_px, in.cy_px,
      in.fisheye  ? "equidistant"
      : k.empty() ? "none"
                  : "radial-tangential",
      k);
}

const Pose T_body_left{rotation_from_vector({0.3, -1.4, 0.6}), {0.1, -0.2, 0.05}};

std::vector<std::filesystem::path> write_sensors(const Rig& rig,
                                                 const std::filesystem::path& root) {
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const std::filesystem::path folder = root / fmt::format("cam{}", i);
    std::filesystem::create_directories(folder);
    files.push_back(folder / "sensor.yaml");
    std::ofstream(files.back()) << sensor_text(rig.cameras[i],
                                               T_body_left * rig.T_camera_first[i].inverse());
  }
  return files;
}

void expect_same_geometry(const Rig& read, const Rig& written, double tolerance = 1e-12) {
  ASSERT_EQ(read.cameras.size(), written.cameras.size());
  for (std::size_t i = 0; i < read.cameras.size(); ++i) {
    EXPECT_EQ(read.cameras[i].size_px, written.cameras[i].size_px);
    EXPECT_EQ(model_name(read.cameras[i].model), model_name(written.cameras[i].model));
    EXPECT_LT((read.cameras[i].parameters - written.cameras[i].parameters).norm(),
              tolerance * written.cameras[i].parameters.norm());
    EXPECT_LT((read.T_camera_first[i].R - written.T_camera_first[i].R).norm(), tolerance);
    EXPECT_LT((read.T_camera_first[i].t - written.T_camera_first[i].t).norm(), tolerance);
  }
}

TEST(AslSensor, AFolderMayMissACamera) {
  const Folder folder;
  const Rig rig = test::rig_of_cameras(Pinhole{}, 3);
  const auto files = write_sensors(rig, folder.path() / "mav0");
  std::filesystem::remove_all(files[1].parent_path());
  EXPECT_EQ(asl_sensor_files(folder.path()),
            (std::vector<std::filesystem::path>{files[0], files[2]}));
  const ImportedRig read = read_asl_sensors({folder.path()});
  ASSERT_EQ(read.rig.cameras.size(), 2u);
  EXPECT_LT((read.rig.T_camera_first[1].t - rig.T_camera_first[2].t).norm(), 1e-9);
}

TEST(AslSensor, RigIsThatOfItsFilesAndOfItsFolders) {
  for (const char* model : {"pinhole", "opencv4", "fisheye4"}) {
    for (const int cameras : {1, 2, 3}) {
      const Folder folder;
      const Rig rig = test::rig_of_cameras(camera_model(model), cameras);
      const auto files = write_sensors(rig, folder.path() / "mav0");
      const ImportedRig by_files = read_asl_sensors(files);
      expect_same_geometry(by_files.rig, rig);
      ASSERT_TRUE(by_files.T_body_first);
      EXPECT_LT((by_files.T_body_first->t - T_body_left.t).norm(), 1e-12);
      for (const auto& root : {folder.path(), folder.path() / "mav0"}) {
        EXPECT_EQ(asl_sensor_files(root), files);
        const ImportedRig by_folder = read_asl_sensors({root});
        expect_same_geometry(by_folder.rig, rig);
        EXPECT_EQ(by_folder.rig.cameras[0].name, "cam0");
      }
    }
  }
}

TEST(AslSensor, SaysWhatIsWrong) {
  const Folder folder;
  const Rig rig = test::rig_of_cameras(camera_model("opencv4"), 1);
  const std::string good = sensor_text(rig.cameras[0], T_body_left);
  struct Change {
    const char *from, *to, *said;
  };
  for (const Change& change : std::vector<Change>{
           {"sensor_type: camera", "sensor_type: imu", "is of the sensor \"imu\""},
           {"camera_model: pinhole", "camera_model: omni", "unsupported camera model \"omni\""},
           {"radial-tangential", "fov", "unsupported distortion model \"fov\""},
           {"distortion_coefficients: [", "distortion_coefficients: [0, 0, 0, 0, ", "coefficients"},
           {"T_BS:", "T_SB:", "T_BS"},
           {"0.0, 0.0, 0.0, 1.0]", "0.0, 0.0, 1.0, 1.0]", "its last row is not 0 0 0 1"},
           {"cols: 4", "cols: 3", "4x3, not 4x4"},
           {"resolution: [", "resolution: [0.5, ", "resolution"}}) {
    std::string text = good;
    ASSERT_NE(text.find(change.from), std::string::npos) << change.from;
    text.replace(text.find(change.from), std::string(change.from).size(), change.to);
    const std::string said =
        error_message([&] { read_asl_sensors({folder.write("left.yaml", text)}); });
    EXPECT_NE(said.find(change.said), std::string::npos) << change.to << "\n  said " << said;
    EXPECT_NE(said.find("left.yaml"), std::string::npos) << said;
  }
  const std::string said = error_message([&] { read_asl_sensors({folder.path()}); });
  EXPECT_NE(said.find("without a cam0/sensor.yaml"), std::string::npos) << said;
}

std::string numbers(const Eigen::Matrix<double, 3, 4>& P) {
  std::string text;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) text += (text.empty() ? "" : " ") + fmt::format("{:.12e}", P(r, c));
  }
  return text;
}

/// K [I | t] of a pinhole camera.
Eigen::Matrix<double, 3, 4> projection(const Eigen::Vector3d& t) {
  Eigen::Matrix3d K;
  K << 700, 0, 600, 0, 710, 180, 0, 0, 1;
  Eigen::Matrix<double, 3, 4> P;
  P << K, K * t;
  return P;
}

const Eigen::Vector3d to_the_right{-0.54, 0.001, -0.003};

TEST(KittiCalib, PairIsReadInEveryLayout) {
  const std::string a = numbers(projection({0, 0, 0})), b = numbers(projection(to_the_right));
  ImportOptions options;
  options.size_px = Eigen::Vector2i(1241, 376);
  for (const std::string& text :
       {"P0: " + a + "\nP1: " + b + "\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n", a + "\n" + b + "\n",
        a + " " + b, a + b, "# a comment\n\n" + a + "\r\n" + b + "\r\n",
        "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 1.241e+03 3.76e+02\nP_rect_00: " + a +
            "\nS_rect_01: 1.241e+03 3.76e+02\nP_rect_01: " + b + "\n"}) {
    EXPECT_TRUE(looks_like_kitti_calib(text)) << text;
    const ImportedRig read = parse_kitti_calib(text, "calib.txt", options);
    ASSERT_EQ(read.rig.cameras.size(), 2u) << text;
    EXPECT_EQ(read.rig.cameras[0].size_px, Eigen::Vector2i(1241, 376));
    EXPECT_EQ(model_name(read.rig.cameras[0].model), "pinhole");
    EXPECT_DOUBLE_EQ(read.rig.cameras[1].f_px(), 710);
    EXPECT_DOUBLE_EQ(read.rig.cameras[1].ax() * 710, 700);
    EXPECT_EQ(read.rig.T_camera_first[1].R, Eigen::Matrix3d::Identity());
    EXPECT_LT((read.rig.T_camera_first[1].t - to_the_right).norm(), 1e-9);
    EXPECT_EQ(read.notes.size(), text.find("Tr") != text.npos || text.find("time") != text.npos);
  }
}

TEST(KittiCalib, FourCamerasKeepTheirNames) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    text += fmt::format("P{}: {}\n", i, numbers(projection({-0.1 * i, 0, 0})));
  }
  ImportOptions options;
  options.size_px = Eigen::Vector2i(1242, 375);
  const Rig rig = parse_kitti_calib(text, "calib.txt", options).rig;
  ASSERT_EQ(rig.cameras.size(), 4u);
  EXPECT_EQ(rig.cameras[3].name, "P3");
  EXPECT_NEAR(rig.T_camera_first[3].t.x(), -0.3, 1e-12);
}

TEST(KittiCalib, NineNumbersAreOneCamera) {
  ImportOptions options;
  options.size_px = Eigen::Vector2i(540, 360);
  const Rig rig = parse_kitti_calib("500 0 270\n0 495 170\n0 0 1\n", "K.txt", options).rig;
  ASSERT_EQ(rig.cameras.size(), 1u);
  EXPECT_DOUBLE_EQ(rig.cameras[0].f_px(), 495);
  EXPECT_DOUBLE_EQ(rig.cameras[0].ox_px(), 270);
}

TEST(KittiCalib, SaysWhatIsWrong) {
  const std::string a = numbers(projection({0, 0, 0}));
  const auto said = [&](const std::string& text, bool sized = true) {
    ImportOptions options;
    if (sized) options.size_px = Eigen::Vector2i(10, 10);
    return error_message([&] { parse_kitti_calib(text, "calib.txt", options); });
  };
  const auto expect = [&](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find("calib.txt"), 0u) << message;
  };
  expect(said("P0: " + a, false), "does not state the size");
  expect(said("P0: " + a), "is outside images of 10x10; use the calibration of these images");
  expect(said("P0: 1 2 3"), "has 3 numbers, not 12");
  expect(said("P0: " + a + "\nP0: " + a), ":2: P0: stands a second time");
  expect(said("P0: " + a + "\n" + a), "with and without names");
  expect(said("Tr: " + a), "holds no projection matrix");
  expect(said("1 2 3\n4 5 6\n"), "holds 6 numbers");
  expect(said("P0: 1 1 0 0 0 1 0 0 0 0 1 0"), "skew");
  expect(said("P0: 0 0 0 0 0 0 0 0 0 0 1 0"), "calib.txt");
  expect(said("P0: nan 0 0 0 0 1 0 0 0 0 1 0"), "\"nan\" is not a finite number");
  expect(said("S_rect_00: 10 0.5\nP_rect_00: " + a), "is not a size");
  expect(said(""), "holds 0 numbers");
  EXPECT_FALSE(looks_like_kitti_calib("words of a page\n"));
  EXPECT_FALSE(looks_like_kitti_calib(""));
}

TEST(JoinedNumbers, TakesApartWhatALostLineEndJoined) {
  using Numbers = std::vector<double>;
  EXPECT_EQ(joined_numbers(" 1 -2.5\t3e2 \r", "here"), (Numbers{1, -2.5, 300}));
  EXPECT_EQ(joined_numbers("0.0e+007.07e+02", "here"), (Numbers{0, 707}));
  EXPECT_EQ(joined_numbers("-1.5e-16-9.5e-01 2", "here"), (Numbers{-1.5e-16, -0.95, 2}));
  EXPECT_EQ(joined_numbers("1.0e-1002.0e+00", "here"), (Numbers{1e-100, 2}));
  EXPECT_EQ(joined_numbers("1e+100", "here"), (Numbers{1e100}));
  EXPECT_TRUE(joined_numbers(" ", "here").empty());
  for (const char* wrong : {"1.2.3", "x", "1e+00x", "inf", "nan", "1e+002e+003e+00", "1e+1"}) {
    const std::string said = error_message([&] { joined_numbers(wrong, "here"); });
    EXPECT_EQ(said.empty(), std::string(wrong) == "1e+1") << wrong;
  }
}

TEST(SequenceRigs, StillRoomAndDriveAreRead) {
  const auto data = test::data_folder();
  if (!data || !std::filesystem::is_directory(*data / "sequences")) {
    GTEST_SKIP() << "VERNIER_DATA has no sequences";
  }
  const std::filesystem::path room = *data / "sequences/still_room";
  const Rig stereo = read_asl_sensors({room / "left.yaml", room / "right.yaml"}).rig;
  ASSERT_EQ(stereo.cameras.size(), 2u);
  EXPECT_EQ(stereo.cameras[1].name, "right");
  // The baseline that the publication of the data states: 11 cm.
  EXPECT_NEAR(stereo.T_camera_first[1].t.norm(), 0.110, 0.001);
  EXPECT_LT(stereo.T_camera_first[1].t.x(), 0);

  ImportOptions options;
  options.size_px = Eigen::Vector2i(1241, 376);
  const Rig drive = read_kitti_calib(*data / "sequences/drive/calib.txt", options).rig;
  ASSERT_EQ(drive.cameras.size(), 2u);
  EXPECT_NEAR(drive.T_camera_first[1].t.x(), -0.54, 0.01);
}

}  // namespace
}  // namespace vernier
