// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/camera.h"

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>

#include "calib/error.h"
#include "calib/estimate/observability.h"
#include "calib/estimate/resized_rig.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "tests/support/error_message.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

class EveryModel : public testing::TestWithParam<const char*> {
 protected:
  Camera camera() const { return test::stereo_rig(camera_model(GetParam())).cameras[1]; }
};

TEST_P(EveryModel, JacobianIsTheNumericOne) {
  const Camera camera = this->camera();
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.4, -0.3, 1.2), Eigen::Vector3d(0, 0, 2),
                                       Eigen::Vector3d(-0.9, 0.7, 1.7)}) {
    ProjectionJacobian J;
    const Eigen::Vector2d pixel = project(camera, point, J);
    EXPECT_EQ(pixel, project(camera, point));
    const auto by_point =
        test::numeric_jacobian([&](const Eigen::VectorXd& x) { return project(camera, x); }, point);
    EXPECT_LT((J.point - by_point).cwiseAbs().maxCoeff(), 1e-6);
    const auto by_camera = test::numeric_jacobian(
        [&](const Eigen::VectorXd& a) {
          Camera moved = camera;
          moved.parameters = a;
          return project(moved, point);
        },
        camera.parameters);
    EXPECT_LT((J.camera - by_camera).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST_P(EveryModel, UnprojectInvertsProject) {
  const Camera camera = this->camera();
  for (double u = 0; u < 640; u += 91) {
    for (double v = 0; v < 480; v += 79) {
      const Eigen::Vector2d pixel(u, v);
      EXPECT_LT((project(camera, unproject(camera, pixel)) - pixel).norm(), 1e-9);
    }
  }
}

TEST_P(EveryModel, TryProjectGivesWhatACameraImages) {
  Camera camera = this->camera();
  const Eigen::Vector3d point(0.2, -0.1, 1.5);
  EXPECT_EQ(try_project(camera, point), project(camera, point));
  EXPECT_EQ(try_project(camera, -point), std::nullopt);
  EXPECT_EQ(try_project(camera, {0.2, -0.1, 0}), std::nullopt);
  camera.parameters[0] = -camera.parameters[0];
  EXPECT_EQ(try_project(camera, point), std::nullopt);
}

TEST_P(EveryModel, NamesItself) {
  EXPECT_EQ(model_name(camera_model(GetParam())), GetParam());
  EXPECT_EQ(parameter_names(camera().model).size(),
            static_cast<std::size_t>(parameter_count(camera().model)));
}

INSTANTIATE_TEST_SUITE_P(
    Models,
    EveryModel,
    testing::Values("pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"));

TEST(Camera, UnknownModelNamesTheKnownOnes) {
  try {
    camera_model("radial2");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("fisheye4"), std::string::npos);
  }
}

TEST(Camera, UnprojectRefusesAFoldedImage) {
  Camera camera = test::stereo_rig().cameras[0];
  camera.parameters[4] = -2;  // folds at r = 0.41, inside the image
  EXPECT_THROW(unproject(camera, {0, 0}), Error);
  EXPECT_TRUE(try_project(camera, {0.38, 0, 1}).has_value());
  for (const double beyond : {0.45, 0.6, 0.9, 3.0}) {  // 1 - 2 r² is negative from 0.71 on
    EXPECT_EQ(try_project(camera, {beyond, 0, 1}), std::nullopt) << beyond;
  }
}

TEST(Camera, RadialModelsAreOpenCv8WithZeros) {
  Camera radial = test::stereo_rig().cameras[0], full = radial;
  full.model = OpenCv8{};
  full.parameters = Eigen::VectorXd::Zero(12);
  full.parameters.head<5>() = radial.parameters;
  const Eigen::Vector3d point(0.5, 0.4, 1.5);
  EXPECT_LT((project(radial, point) - project(full, point)).norm(), 1e-10);
}

TEST(CameraWithoutParameters, IsAnErrorThatNamesIt) {
  const std::string words =
      "camera \"left\": it has 0 parameters, not 5; give f_px, ax, ox_px, oy_px, then the model's "
      "distortion";
  const Camera camera;
  ProjectionJacobian jacobian;
  const auto message = [](const std::function<void()>& call) { return test::error_message(call); };
  EXPECT_EQ(message([&] { project(camera, {0, 0, 1}); }), words);
  EXPECT_EQ(message([&] { project(camera, {0, 0, 1}, jacobian); }), words);
  EXPECT_EQ(message([&] { unproject(camera, {320, 240}); }), words);
  EXPECT_EQ(message([&] { try_unproject(camera, {320, 240}); }), words);
  EXPECT_EQ(message([&] { camera.f_px(); }), words);
  EXPECT_EQ(message([&] { camera.oy_px(); }), words);
  EXPECT_EQ(message([&] { check_parameters(camera); }), words);
  EXPECT_EQ(message([&] { parameters(Rig{{camera}, {Pose{}}}); }), words);
  const Rig rig{{camera, camera}, {Pose{}, Pose{}}};
  EXPECT_EQ(message([&] { retract(rig, Eigen::VectorXd::Zero(16)); }), words);
  EXPECT_EQ(message([&] { vernier::internal::unobservable_directions(rig, {}); }), words);
  EXPECT_EQ(message([&] { vernier::internal::resized({.rig = rig}, {320, 240}); }), words);
}

TEST(CameraWithoutParameters, NorMayItHaveTooMany) {
  Camera camera = test::stereo_rig().cameras[0];
  camera.model = Pinhole{};
  EXPECT_EQ(camera.ax(), camera.parameters[1]);
  EXPECT_NE(test::error_message([&] {
              project(camera, {0, 0, 1});
            }).find("it has 5 parameters, not 4"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] {
              retract(Rig{{camera}, {Pose{}}}, Eigen::VectorXd::Zero(4));
            }).find("it has 5 parameters, not 4"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
