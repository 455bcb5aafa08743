// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/resolve.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "calib/board_warp.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/held_parameters.h"
#include "calib/outliers.h"
#include "calib/simulated_board.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

constexpr double sigma_px = 0.2;

/// Two cameras of one model with enough views for every model.
SimulatedBoard scene(const Rig& rig, int frames = 24, double pixel_sigma_px = sigma_px) {
  return simulate_board(rig, {9, 7, 0.03}, 7, 0,
                        {.frames = frames, .pixel_sigma_px = pixel_sigma_px, .distance_m = 0.9});
}

/// Corners left out so that no two views have the same ones.
void make_partial(BoardObservations& observations) {
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    BoardView& view = observations.views[v];
    for (std::size_t i = view.ids.size(); i-- > 12;) {
      if ((i * 7 + v * 13) % (3 + v % 5) != 0) continue;
      view.ids.erase(view.ids.begin() + static_cast<std::ptrdiff_t>(i));
      view.pixels_px.erase(view.pixels_px.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

Rig three_cameras() {
  Rig rig = test::stereo_rig(OpenCv4{});
  rig.cameras[1] = test::stereo_rig(Radial1{}).cameras[1];
  rig.cameras.push_back(test::stereo_rig(Fisheye4{}).cameras[0]);
  rig.cameras[2].name = "third";
  rig.T_camera_first.push_back({rotation_from_vector({0.02, 0.03, -0.01}), {0.15, 0.01, 0}});
  return rig;
}

/// χ² at a state, by the plain code, and the standard deviations of the rig there were nothing
/// held.
struct Reference {
  double chi2 = 0;
  double residuals = 0;
  Eigen::VectorXd sd;

  Reference(const BoardObservations& observations,
            const BoardState& state,
            const ReprojectionProblem& problem = {}) {
    const double variance = problem.pixel_sigma_px * problem.pixel_sigma_px;
    const CornerResiduals all = corner_residuals(observations, state);
    for (std::size_t v = 0; v < all.size(); ++v) {
      for (std::size_t i = 0; i < all[v].size(); ++i) {
        const double w = problem.corner_weights.empty() ? 1 : problem.corner_weights[v][i];
        chi2 += w * all[v][i].squaredNorm() / variance;
        residuals += 2;
      }
    }
    for (const RigPrior& prior : problem.priors) chi2 += prior_chi2(prior, state.rig);
    const auto n = parameter_count(state.rig);
    const auto held = problem.held.empty() ? std::vector<bool>(n, false) : problem.held;
    const Eigen::MatrixXd E = free_directions(state.rig, held);
    auto equations = restricted(
        reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp), E);
    for (const RigPrior& prior : problem.priors) {
      const Eigen::MatrixXd by_free = prior_offset(prior, state.rig).by_rig * E;
      add_prior(equations, by_free.transpose() * prior.information * by_free);
    }
    sd = (E * minimum_variance_bound(equations, free_names(state.rig, held)) * E.transpose())
             .diagonal()
             .cwiseSqrt();
    for (double& s : sd) s = s > 0 ? s : std::numeric_limits<double>::infinity();  // held
  }
};

/// The last Newton step from a state to the minimum, in the rig's tangent, by the plain code's
/// normal equations. These know no weights: then none.
Eigen::VectorXd newton_step(const BoardObservations& observations,
                            const BoardState& state,
                            const ReprojectionProblem& problem) {
  auto equations =
      reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp);
  Eigen::VectorXd g = equations.scores.rowwise().sum();
  if (!problem.corner_weights.empty()) return Eigen::VectorXd::Zero(g.size());
  for (const RigPrior& prior : problem.priors) {
    const PriorOffset offset = prior_offset(prior, state.rig);
    equations.information += offset.by_rig.transpose() * prior.information * offset.by_rig;
    g += offset.by_rig.transpose() * prior.information * offset.delta;
  }
  Eigen::MatrixXd E = Eigen::MatrixXd::Identity(g.size(), g.size());
  if (!problem.held.empty()) E = free_directions(state.rig, problem.held);
  const Eigen::MatrixXd S = E.transpose() * equations.information * E;
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(scale.asDiagonal() * S * scale.asDiagonal()));
  const Eigen::VectorXd z =
      scale.asDiagonal() * factor.solve(scale.cwiseProduct(-E.transpose() * g));
  return E * z;
}

/// The re-solver's answer from `start` is the minimum by the plain code, and Ceres' from the same
/// start. Ceres accepts no step that the rounding of the cost (1e-12 px²) hides, so it may stop
/// some 1e-6 standard deviations short, and 1e-2 along opencv8's valley: it is taken the last
/// Newton step before it is compared.
void expect_as_ceres(const BoardObservations& observations,
                     const BoardState& start,
                     const ReprojectionProblem& problem = {}) {
  const double short_stop = model_name(start.rig.cameras[0].model) == "opencv8" ? 1e3 : 1;
  const BoardState ceres = minimise_reprojection(observations, start, problem);
  const Reference at(observations, ceres, problem);
  const ResolveResult ours = Resolver(observations, start, problem).resolve();
  ASSERT_EQ(ours.status, ResolveStatus::converged);
  EXPECT_NEAR(ours.chi2 / at.chi2, 1, 1e-9 * short_stop);
  EXPECT_NEAR(Reference(observations, ours.state, problem).chi2 / ours.chi2, 1, 1e-9);
  const double unit = std::min(1.0, std::sqrt(at.chi2 / at.residuals));
  const auto sigmas = [&](const Eigen::VectorXd& delta) {
    return delta.cwiseQuotient(at.sd).cwiseAbs().maxCoeff() / unit;
  };
  EXPECT_LT(sigmas(newton_step(observations, ours.state, problem)), 1e-6);
  const Rig minimum = retract(ceres.rig, newton_step(observations, ceres, problem));
  EXPECT_LT(sigmas(difference(ours.state.rig, minimum)),
            (problem.corner_weights.empty() ? 1e-6 : 1e-5) * short_stop);
  EXPECT_LT(sigmas(difference(ours.state.rig, ceres.rig)), 1e-5 * short_stop);
}

/// A start `sigmas` standard deviations away in every parameter, boards moved as well.
BoardState perturbed(const SimulatedBoard& board,
                     double sigmas,
                     const ReprojectionProblem& problem = {}) {
  BoardState start = board.truth;
  const Reference at(board.observations, start, problem);
  Eigen::VectorXd sign = Eigen::VectorXd::Ones(at.sd.size());
  for (Eigen::Index i = 1; i < sign.size(); i += 2) sign[i] = -1;
  sign = at.sd.array().isFinite().select(sign, 0);
  const Eigen::VectorXd sd = at.sd.array().isFinite().select(at.sd, 0);
  start.rig = retract(start.rig, sigmas * sigma_px * sign.cwiseProduct(sd));
  for (Pose& T : start.T_first_board) {
    Eigen::Matrix<double, 6, 1> step;
    step << 1e-3, -1e-3, 2e-3, 1e-3, 1e-3, -2e-3;
    T = retract(T, 0.2 * sigmas * step);
  }
  return start;
}

class ResolverOfEveryModel : public testing::TestWithParam<const char*> {
 protected:
  SimulatedBoard board() const { return scene(test::stereo_rig(camera_model(GetParam()))); }

  /// The denominator's coefficients nearly imitate the numerator's, which leaves a curved valley
  /// for a minimum: they are held. CovarianceIsTheBound has them free.
  ReprojectionProblem problem(const Rig& rig) const {
    if (model_name(rig.cameras[0].model) != "opencv8") return {};
    return {.held = held_mask(
                rig,
                {{"left.k4"}, {"left.k5"}, {"left.k6"}, {"right.k4"}, {"right.k5"}, {"right.k6"}})};
  }
};

TEST_P(ResolverOfEveryModel, FromTheTruth) {
  const SimulatedBoard board = this->board();
  expect_as_ceres(board.observations, board.truth, problem(board.truth.rig));
}

TEST_P(ResolverOfEveryModel, FromSomeStandardDeviationsAway) {
  const SimulatedBoard board = this->board();
  const ReprojectionProblem problem = this->problem(board.truth.rig);
  expect_as_ceres(board.observations, perturbed(board, 5, problem), problem);
}

TEST_P(ResolverOfEveryModel, WithPartialBoards) {
  SimulatedBoard board = this->board();
  make_partial(board.observations);
  expect_as_ceres(board.observations, board.truth, problem(board.truth.rig));
}

TEST_P(ResolverOfEveryModel, FromTheCornersAlone) {
  SimulatedBoard board = this->board();
  check_and_sort(board.observations);
  const CameraModel model = camera_model(GetParam());
  BoardState start = initial_state(board.observations, {model, model});
  expect_as_ceres(board.observations, start, problem(start.rig));
}

INSTANTIATE_TEST_SUITE_P(
    Models,
    ResolverOfEveryModel,
    testing::Values("pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"));

TEST(Resolver, OneCamera) {
  Rig rig = test::stereo_rig(OpenCv5{});
  rig.cameras.pop_back();
  rig.T_camera_first.pop_back();
  const SimulatedBoard board = scene(rig, 13);
  expect_as_ceres(board.observations, perturbed(board, 3));
}

TEST(Resolver, ThreeCamerasOfDifferentModels) {
  const SimulatedBoard board = scene(three_cameras(), 21);
  expect_as_ceres(board.observations, perturbed(board, 3));
}

TEST(Resolver, FramesThatSomeCamerasMissed) {
  SimulatedBoard board = scene(three_cameras(), 40);
  std::erase_if(board.observations.views, [](const BoardView& view) {
    return (view.frame % 3 == 1 && view.camera == view.frame % 2) ||
           (view.frame > 30 && view.frame % 3 != 1 && view.camera > 0);
  });
  make_partial(board.observations);
  expect_as_ceres(board.observations, board.truth);
}

TEST(Resolver, OtherPixelsAreAnotherCalibration) {
  const Rig rig = test::stereo_rig(OpenCv4{});
  const SimulatedBoard board = scene(rig);
  const auto other = simulate_board(rig, {9, 7, 0.03}, 7, 5,
                                    {.frames = 24, .pixel_sigma_px = 0.2, .distance_m = 0.9});
  Eigen::Matrix2Xd pixels(2, 24 * 2 * 63);
  Eigen::Index i = 0;
  for (const BoardView& view : other.observations.views) {
    for (const auto& q : view.pixels_px) pixels.col(i++) = q;
  }
  const ResolveResult ours = Resolver(board.observations, board.truth).resolve(pixels);
  EXPECT_EQ(ours.status, ResolveStatus::converged);
  EXPECT_LE(ours.iterations, 6);
  EXPECT_EQ(parameters(ours.state.rig),
            parameters(Resolver(other.observations, other.truth).resolve().state.rig));
  EXPECT_GT(
      difference(ours.state.rig, Resolver(board.observations, board.truth).resolve().state.rig)
          .norm(),
      1e-4);
}

TEST(Resolver, IsTheSameToTheBitForAnyThreads) {
  const SimulatedBoard board = scene(test::stereo_rig(Radial1{}), 300);
  const ResolveResult one = Resolver(board.observations, board.truth).resolve();
  const ResolveResult four =
      Resolver(board.observations, board.truth, {}, {.threads = 4}).resolve();
  EXPECT_EQ(parameters(one.state.rig), parameters(four.state.rig));
  EXPECT_EQ(one.chi2, four.chi2);
  for (std::size_t f = 0; f < 300; ++f) {
    EXPECT_EQ(one.state.T_first_board[f].t, four.state.T_first_board[f].t);
  }
}

/// Corners of a board bent by `warp_m`.
SimulatedBoard bent(SimulatedBoard board, const Eigen::Vector2d& warp_m) {
  const auto target = warped_target(board.observations.target_m, warp_m);
  for (BoardView& view : board.observations.views) {
    const Camera& camera = board.truth.rig.cameras[view.camera];
    const Pose T =
        board.truth.rig.T_camera_first[view.camera] * board.truth.T_first_board[view.frame];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] += project(camera, T * target[view.ids[i]]) -
                           project(camera, T * board.observations.target_m[view.ids[i]]);
    }
  }
  return board;
}

TEST(Resolver, KnownWarpIsKept) {
  SimulatedBoard board = bent(scene(test::stereo_rig()), {2e-3, -1e-3});
  const double flat = Resolver(board.observations, board.truth).resolve().chi2;
  board.truth.warp_m = {2e-3, -1e-3};
  const ResolveResult known = Resolver(board.observations, board.truth).resolve();
  EXPECT_EQ(known.status, ResolveStatus::converged);
  EXPECT_EQ(known.state.warp_m, board.truth.warp_m);
  EXPECT_LT(known.chi2, 0.7 * flat);
  expect_as_ceres(board.observations, board.truth);
}

TEST_P(ResolverOfEveryModel, FreeWarpIsFound) {
  SimulatedBoard board = bent(this->board(), {2e-3, -1e-3});
  ReprojectionProblem problem = this->problem(board.truth.rig);
  problem.warp = BoardWarp::free;
  expect_as_ceres(board.observations, board.truth, problem);
  const ResolveResult result = Resolver(board.observations, board.truth, problem).resolve();
  EXPECT_LT((result.state.warp_m - Eigen::Vector2d(2e-3, -1e-3)).norm(), 1e-4);
}

TEST_P(ResolverOfEveryModel, CovarianceIsTheBound) {
  SimulatedBoard board = this->board();
  make_partial(board.observations);
  const int n = parameter_count(board.truth.rig);
  RigPrior prior{board.truth.rig, Eigen::MatrixXd::Zero(n, n)};
  const std::vector<std::string> names = parameter_names(board.truth.rig);
  for (int i = 0; i < n; ++i) {  // tells numerator and denominator of opencv8 apart
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (name.ends_with("k4") || name.ends_with("k5") || name.ends_with("k6")) {
      prior.information(i, i) = 1e4;
    }
  }
  for (const BoardWarp warp : {BoardWarp::known, BoardWarp::free}) {
    ReprojectionProblem problem{.pixel_sigma_px = sigma_px, .priors = {prior}, .warp = warp};
    problem.held = held_mask(board.truth.rig, {{"right.ax"}, {"right.tz_m"}});
    const Reference plain(board.observations, board.truth, problem);
    const Eigen::VectorXd sd = Resolver(board.observations, board.truth, problem)
                                   .covariance(board.truth)
                                   .diagonal()
                                   .cwiseSqrt();
    for (Eigen::Index i = 0; i < sd.size(); ++i) {
      const bool held = problem.held[static_cast<std::size_t>(i)];
      EXPECT_NEAR(sd[i] / plain.sd[i], held ? 0 : 1, 1e-5) << i;
    }
  }
}

TEST(Resolver, HeldParametersStay) {
  const SimulatedBoard board = scene(test::stereo_rig(OpenCv5{}));
  const ReprojectionProblem problem{
      .held = held_mask(board.truth.rig, {{"left.ax"}, {"right.ax"}, {"right.wy_rad"}})};
  BoardState start = perturbed(board, 2);
  expect_as_ceres(board.observations, start, problem);
  const ResolveResult held = Resolver(board.observations, start, problem).resolve();
  ASSERT_EQ(held.status, ResolveStatus::converged);
  EXPECT_EQ(held.state.rig.cameras[0].ax(), start.rig.cameras[0].ax());
  EXPECT_EQ(held.state.rig.cameras[1].ax(), start.rig.cameras[1].ax());
  EXPECT_NEAR(vector_from_rotation(held.state.rig.T_camera_first[1].R)[1],
              vector_from_rotation(start.rig.T_camera_first[1].R)[1], 1e-15);
}

TEST(Resolver, PriorsAreInTheCost) {
  const SimulatedBoard board = scene(test::stereo_rig());
  const int n = parameter_count(board.truth.rig);
  const Eigen::VectorXd sd = sigma_px * Reference(board.observations, board.truth).sd;
  RigPrior prior{retract(board.truth.rig, 3 * sd), Eigen::MatrixXd::Zero(n, n)};
  prior.mean.T_camera_first[1].R =
      rotation_from_vector({0.02, 0, 0.01}) * prior.mean.T_camera_first[1].R;
  prior.information.diagonal() = sd.cwiseAbs2().cwiseInverse();
  expect_as_ceres(board.observations, board.truth, {.pixel_sigma_px = sigma_px, .priors = {prior}});
}

TEST(Resolver, WeightsAreInTheCost) {
  const SimulatedBoard board = scene(test::stereo_rig());
  ReprojectionProblem problem;
  for (const BoardView& view : board.observations.views) {
    auto& weights = problem.corner_weights.emplace_back();
    for (const int id : view.ids) weights.push_back((id + view.frame) % 4 / 3.0);
  }
  expect_as_ceres(board.observations, board.truth, problem);
}

TEST(Resolver, ExactCornersGiveTheTruth) {
  SimulatedBoard board = scene(test::stereo_rig(OpenCv4{}), 24, 0);
  const BoardState truth = board.truth;
  const ResolveResult result =
      Resolver(board.observations, initial_state(board.observations, {OpenCv4{}, OpenCv4{}}))
          .resolve();
  EXPECT_EQ(result.status, ResolveStatus::converged);
  EXPECT_LT(difference(result.state.rig, truth.rig).norm(), 1e-7);
  EXPECT_LT(result.chi2, 1e-15);
}

TEST(Resolver, SaysWhenADirectionIsFree) {
  // One frame, parallel to the image: focal length and distance cannot be told apart.
  SimulatedBoard board = scene(test::stereo_rig(Pinhole{}), 1, 0);
  board.observations.views.pop_back();
  board.observations.size_px.pop_back();
  board.truth.rig.cameras.pop_back();
  board.truth.rig.T_camera_first.pop_back();
  board.truth.T_first_board[0] = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 1}};
  for (std::size_t i = 0; i < board.observations.target_m.size(); ++i) {
    board.observations.views[0].pixels_px[i] =
        project(board.truth.rig.cameras[0],
                board.truth.T_first_board[0] * board.observations.target_m[i]) +
        Eigen::Vector2d(0.1 * std::sin(5.0 * static_cast<double>(i)), 0);
  }
  EXPECT_EQ(Resolver(board.observations, board.truth).resolve().status, ResolveStatus::singular);
  // A frame whose corners lie on a line does not fix its board.
  SimulatedBoard line = scene(test::stereo_rig(), 20);
  for (BoardView& view : line.observations.views) {
    if (view.frame != 3) continue;
    view.ids.resize(9);  // one row of corners
    view.pixels_px.resize(9);
  }
  const ResolveResult result = Resolver(line.observations, line.truth).resolve();
  EXPECT_EQ(result.status, ResolveStatus::singular);
  EXPECT_TRUE(parameters(result.state.rig).allFinite());
}

TEST(Resolver, NamesWhatIsWrong) {
  const SimulatedBoard board = scene(test::stereo_rig(), 8);
  const auto message = [](const auto& f) {
    try {
      f();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  const Resolver resolver(board.observations, board.truth);
  Eigen::Matrix2Xd pixels = Eigen::Matrix2Xd::Zero(2, 8 * 2 * 63);
  pixels(1, 77) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([&] { resolver.resolve(pixels); }),
            "corner 77: its pixel is not finite; leave the corner out");
  EXPECT_EQ(message([&] { resolver.resolve(Eigen::Matrix2Xd::Zero(2, 5)); }),
            "pixels: there are 5 for 1008 corners; give one a corner, in the order of the "
            "observations");
  BoardState other = board.truth;
  other.frames[3] = 99;
  EXPECT_NE(message([&] { Resolver(board.observations, other); }).find("frame 3: the state has no"),
            std::string::npos);
  const auto fault = [&](const ReprojectionProblem& problem) {
    return message([&] { Resolver(board.observations, board.truth, problem); });
  };
  EXPECT_EQ(fault({.held = {true}}),
            "held parameters: there is not one flag a parameter of the rig; make them with "
            "held_mask");
  EXPECT_EQ(fault({.priors = {{board.truth.rig, Eigen::MatrixXd::Identity(3, 3)}}}),
            "prior: it is of other parameters than the rig's; make it with rig_prior");
  EXPECT_EQ(fault({.corner_weights = {{1.0}}}),
            "corner weights: there is not one a corner; give one a corner");
  EXPECT_EQ(fault({.pixel_sigma_px = 0}),
            "pixel sigma: it is not positive; give a standard deviation in pixels");
}

}  // namespace
}  // namespace vernier
