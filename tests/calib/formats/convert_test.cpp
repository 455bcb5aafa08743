// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>

#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/formats/colmap_cameras.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/kalibr_camchain.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/formats/opencv_calibration_file.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_file.h"
#include "stereo/rectification/rectified_camera_info.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

using test::error_message;
using test::Folder;
using test::rig_of_cameras;

const char* const model_names[] = {"pinhole", "radial1", "opencv4",
                                   "opencv5", "opencv8", "fisheye4"};

/// The same cameras, names and poses: parameters to 1e-12 of themselves.
void expect_equal(const Rig& read, const Rig& written) {
  ASSERT_EQ(read.cameras.size(), written.cameras.size());
  for (std::size_t i = 0; i < read.cameras.size(); ++i) {
    const Camera &a = read.cameras[i], &b = written.cameras[i];
    ASSERT_EQ(model_name(a.model), model_name(b.model));
    EXPECT_EQ(a.size_px, b.size_px);
    EXPECT_EQ(a.name, b.name);
  }
  const Eigen::VectorXd difference_of_all = difference(read, written), a = parameters(written);
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(difference_of_all[i], 0, 1e-12 * (std::abs(a[i]) + 1))
        << parameter_names(written)[static_cast<std::size_t>(i)];
  }
}

std::vector<ExportedFile> ros_files(const Rig& rig) {
  std::vector<ExportedFile> files;
  for (const RosCameraInfo& info : rectified_camera_info(rig)) {
    files.push_back(format_ros_camera_info(info));
  }
  return files;
}

struct RoundTrip {
  std::string model;
  int cameras;
};

class ConvertedModel : public testing::TestWithParam<RoundTrip> {
 protected:
  Rig rig() const { return rig_of_cameras(camera_model(GetParam().model), GetParam().cameras); }
  bool model_is(const std::string& name) const { return GetParam().model == name; }
  Folder folder_;
};

std::vector<RoundTrip> round_trips() {
  std::vector<RoundTrip> all;
  for (const char* model : model_names) {
    for (int cameras = 1; cameras <= 3; ++cameras) all.push_back({model, cameras});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Convert,
                         ConvertedModel,
                         testing::ValuesIn(round_trips()),
                         [](const auto& p) {
                           return p.param.model + "_" + std::to_string(p.param.cameras);
                         });

TEST_P(ConvertedModel, Mrcal) {
  if (model_is("fisheye4")) {
    EXPECT_EQ(error_message([&] { mrcal_cameramodels(rig()); }),
              "camera \"left\": mrcal has no lens model like fisheye4; calibrate with opencv8, or "
              "choose another format");
    return;
  }
  const auto files = folder_.write(mrcal_cameramodels(rig()));
  expect_equal(read_mrcal_cameramodels(files).rig, rig());
}

TEST_P(ConvertedModel, OpenCv) {
  const auto whole = folder_.write(opencv_calibration(rig()));
  ASSERT_EQ(whole.size(), 1u);
  expect_equal(read_opencv_calibration(whole).rig, rig());
  const auto files = folder_.write(opencv_intrinsics_and_extrinsics(rig()));
  ASSERT_EQ(files.size(), GetParam().cameras == 1 ? 1u : 2u);
  const ImportedRig read = read_opencv_calibration(files);
  expect_equal(read.rig, rig());
  EXPECT_TRUE(read.notes.empty());
}

TEST_P(ConvertedModel, Kalibr) {
  if (model_is("opencv5") || model_is("opencv8")) {
    EXPECT_NE(error_message([&] {
                kalibr_camchain(rig());
              }).find("camera \"left\": Kalibr's radtan cannot represent k3 = -0.01 of the model"),
              std::string::npos);
    return;
  }
  expect_equal(read_kalibr_camchain(folder_.write(kalibr_camchain(rig()))[0]).rig, rig());
}

TEST_P(ConvertedModel, Ros) {
  const auto files = folder_.write(ros_files(rig()));
  if (GetParam().cameras == 3) {
    EXPECT_NE(error_message([&] { read_ros_camera_info(files); }).find("has no poses"),
              std::string::npos);
    return;
  }
  expect_equal(read_ros_camera_info(files).rig, rig());
}

TEST_P(ConvertedModel, Colmap) {
  const Rig before = rig();
  const auto files = folder_.write(colmap_cameras(before));
  expect_equal(read_colmap_cameras(folder_.path()).rig, before);  // rig_config.json
  std::filesystem::remove(folder_.path() / "rig_config.json");
  expect_equal(read_colmap_cameras(files[0]).rig, before);  // images.txt
}

TEST_P(ConvertedModel, RigJson) {
  EXPECT_EQ(parse_rig(format_rig({rig(), {}, {}, {}, {}, {}}), "rig.json")
                .estimate.rig.cameras[0]
                .parameters,
            rig().cameras[0].parameters);
}

TEST(Convert, SmallestModelThatHoldsTheCoefficients) {
  const auto model_of = [](std::vector<double> k) {
    return std::string(model_name(
        camera_from_opencv({500, 500, 320, 240, false, std::move(k)}, {640, 480}, "f").model));
  };
  EXPECT_EQ(model_of({}), "pinhole");
  EXPECT_EQ(model_of({0, 0, 0, 0, 0}), "pinhole");
  EXPECT_EQ(model_of({0.1, 0, 0, 0, 0}), "radial1");
  EXPECT_EQ(model_of({0, 0, 1e-300, 0, 0}), "opencv4");
  EXPECT_EQ(model_of({0, 0, 0, 0, 1e-9}), "opencv5");
  EXPECT_EQ(model_of({0, 0, 0, 0, 0, 0, 0, 1e-9}), "opencv8");
  EXPECT_EQ(model_of({0, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0, 0, 0, 0}), "opencv8");
  EXPECT_EQ(error_message([&] {
              model_of({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0});
            }),
            "f: the coefficient s3 = 2 of its distortion is not in the model opencv8; no supported "
            "model includes it");
  EXPECT_EQ(error_message([&] {
              model_of({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.5});
            }),
            "f: the coefficient ty = -0.5 of its distortion is not in the model opencv8; no "
            "supported model includes it");
}

TEST(Convert, AModelAskedForMustHoldTheCoefficients) {
  const OpenCvIntrinsics in{500, 500, 320, 240, false, {0.1, 0, 1e-3, 0}};
  const Camera camera = camera_from_opencv(in, {640, 480}, "f", OpenCv8{});
  EXPECT_EQ(camera.parameters.size(), 12);
  EXPECT_EQ(camera.parameters[6], 1e-3);
  EXPECT_EQ(error_message([&] {
              camera_from_opencv(in, {640, 480}, "f", Radial1{});
            }),
            "f: the coefficient p1 = 0.001 of its distortion is not in the model radial1; choose a "
            "larger model or none");
  EXPECT_EQ(error_message([&] {
              camera_from_opencv(in, {640, 480}, "f", Fisheye4{});
            }),
            "f: is not a fisheye camera, which the model fisheye4 cannot represent; choose another "
            "model or none");
}

TEST(Convert, CoefficientsThatAreZeroFitASmallerFormat) {
  Rig rig = rig_of_cameras(OpenCv8{}, 2);
  for (Camera& camera : rig.cameras) camera.parameters.tail(4).setZero();
  Folder folder;
  const Rig read = read_kalibr_camchain(folder.write(kalibr_camchain(rig))[0]).rig;
  EXPECT_EQ(model_name(read.cameras[1].model), "opencv4");
  EXPECT_EQ(read.cameras[1].parameters.tail(4), rig.cameras[1].parameters.segment(4, 4));
}

TEST(Convert, NearestRotation) {
  const Eigen::Matrix3d R = rotation_from_vector({0.3, -2, 1});
  EXPECT_EQ(nearest_rotation(R, "f"), R);  // not a bit is changed
  const Eigen::Matrix3d rounded = (R * 1e7).array().round() / 1e7;
  const Eigen::Matrix3d nearest = nearest_rotation(rounded, "f");
  EXPECT_LT((nearest.transpose() * nearest - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((nearest - R).norm(), 3e-7);
  EXPECT_NE(error_message([&] {
              nearest_rotation(1.00001 * R, "f");
            }).find("f: is not a rotation: it deviates from orthonormal by 2e-05"),
            std::string::npos);
  EXPECT_NE(error_message([&] { nearest_rotation(-R, "f"); }).find("a reflection"),
            std::string::npos);
  EXPECT_NE(error_message([&] { nearest_rotation(R * NAN, "f"); }).find("not a rotation"),
            std::string::npos);
}

TEST(Convert, NamesThatAreNoFiles) {
  Rig rig = rig_of_cameras(Radial1{}, 2);
  for (const char* name : {"", "../left", "a/b", "..", "a\nb", "\\server"}) {
    rig.cameras[1].name = name;
    for (const auto& format : std::vector<std::function<void()>>{[&] { mrcal_cameramodels(rig); },
                                                                 [&] { ros_files(rig); },
                                                                 [&] { colmap_cameras(rig); }}) {
      EXPECT_NE(error_message(format).find("its name is not valid as a file name"),
                std::string::npos)
          << name;
    }
  }
  rig.cameras[1].name = "the right";
  EXPECT_NE(error_message([&] { colmap_cameras(rig); }).find("cannot contain blanks"),
            std::string::npos);
}

TEST(Convert, LengthsInMillimetres) {
  Rig rig = rig_of_cameras(Radial1{}, 2);
  rig.T_camera_first[1].t *= 1000;
  Folder folder;
  const ImportOptions mm{.unit_m = 0.001};
  const Eigen::Vector3d t_m = rig.T_camera_first[1].t / 1000;
  const auto expect_metres = [&](const ImportedRig& read) {
    EXPECT_LT((read.rig.T_camera_first[1].t - t_m).norm(), 1e-15);
  };
  expect_metres(read_opencv_calibration(folder.write(opencv_calibration(rig)), mm));
  expect_metres(read_kalibr_camchain(folder.write(kalibr_camchain(rig))[0], mm));
  expect_metres(read_mrcal_cameramodels(folder.write(mrcal_cameramodels(rig)), mm));
  expect_metres(read_ros_camera_info(folder.write(ros_files(rig)), mm));
  expect_metres(read_colmap_cameras(folder.write(colmap_cameras(rig))[0], mm));
}

}  // namespace
}  // namespace vernier
