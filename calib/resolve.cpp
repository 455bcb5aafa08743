// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/resolve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "calib/error.h"
#include "calib/held_parameters.h"
#include "calib/ordered_parallel.h"
#include "calib/packed_views.h"

namespace vernier {
namespace {

constexpr std::size_t chunk_groups = 16;  // whose sums are taken together: 128 frames
constexpr double least_rcond = 3e-14;     // of the scaled reduced system
constexpr double far_step = 10;           // standard deviations
constexpr double least_rate = 0.03;       // of convergence that is counted on

double sum(const Lanes& lanes) {
  const double* a = lanes.of;
  return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

/// The reduced system in the tangent of (rig, warp where that is free).
struct System {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient, diagonal;
  double chi2 = 0, frames_drop = 0;
};

}  // namespace

struct Resolver::Problem {
  BoardState around;
  ReprojectionProblem cost;
  ResolveOptions options;
  PackedViews views;
  Eigen::Matrix2Xd pixels_px;
  int rig_parameters, parameters;  // without and with the warp
  double dof;

  Problem(const BoardObservations& observations,
          const BoardState& state,
          ReprojectionProblem problem,
          const ResolveOptions& chosen)
      : around(state),
        cost(std::move(problem)),
        options(chosen),
        views(observations, state, cost),
        pixels_px(views.observed_px(observations)),
        rig_parameters(parameter_count(state.rig)),
        parameters(rig_parameters + (views.warp() ? 2 : 0)) {
    dof = 2.0 * static_cast<double>(views.corners()) - parameters -
          6.0 * static_cast<double>(state.frames.size());
  }
};

namespace {

/// One solution under way: what the last linearisation left.
class Solution {
 public:
  Solution(const PackedViews& views,
           const ReprojectionProblem& cost,
           std::vector<Lanes> pixels,
           int parameters,
           int threads)
      : views_(views),
        cost_(cost),
        pixels_(std::move(pixels)),
        parameters_(parameters),
        threads_(threads),
        factors_(views.groups().size() * frame_factor_size(parameters_)),
        chunks_((views.groups().size() + chunk_groups - 1) / chunk_groups,
                ReducedSums(parameters_)) {}

  System linearise(const BoardState& state, double damping);
  /// The state after a step of rig and warp, each board following.
  BoardState moved(const BoardState& state, const Eigen::VectorXd& step) const;

 private:
  void sum_chunk(const BoardState& state,
                 const std::vector<CameraPlace>& places,
                 const std::vector<Eigen::VectorXd>& intrinsics,
                 double damping,
                 std::size_t chunk);
  System reduced() const;
  Eigen::MatrixXd kernel_by_step(const Rig& rig) const;

  const PackedViews& views_;
  const ReprojectionProblem& cost_;
  std::vector<Lanes> pixels_;
  int parameters_, threads_;
  std::vector<Lanes> factors_;
  std::vector<ReducedSums> chunks_;
};

void Solution::sum_chunk(const BoardState& state,
                         const std::vector<CameraPlace>& places,
                         const std::vector<Eigen::VectorXd>& intrinsics,
                         double damping,
                         std::size_t chunk) {
  ReducedSums& total = chunks_[chunk];
  total = ReducedSums(parameters_);
  std::vector<std::vector<Lanes>> blocks;
  for (const Camera& camera : state.rig.cameras) {
    blocks.emplace_back(packed_size(view_columns(camera.model, views_.warp())));
  }
  std::vector<const double*> sums(places.size());
  const std::size_t end = std::min((chunk + 1) * chunk_groups, views_.groups().size());
  for (std::size_t g = chunk * chunk_groups; g < end; ++g) {
    const FrameGroup& group = views_.groups()[g];
    for (std::size_t c = 0; c < places.size(); ++c) {
      sums[c] = nullptr;
      if (group.cameras[c].corners == 0) continue;
      Lanes poses[12];
      camera_poses(state, static_cast<int>(c), group, poses);
      sum_views(views_.lanes(group, static_cast<int>(c), state, intrinsics[c].data(), poses[0].of,
                             pixels_),
                blocks[c][0].of);
      sums[c] = blocks[c][0].of;
    }
    Lanes absent;
    for (int l = 0; l < kernel_lanes; ++l) absent.of[l] = group.frames[l] < 0 ? 1 : 0;
    eliminate_frames(places, sums, absent, damping, &factors_[g * frame_factor_size(parameters_)],
                     total);
  }
}

Eigen::MatrixXd Solution::kernel_by_step(const Rig& rig) const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(parameters_, parameters_);
  const int n = parameter_count(rig);
  M.topLeftCorner(n, n) = kernel_by_tangent(rig);
  return M;
}

System Solution::reduced() const {
  const int n = parameters_;
  System system{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (const ReducedSums& part : chunks_) {  // in their order, whoever summed them
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) {
        system.information(j, i) += sum(part.information[packed_index(i, j, n)]);
      }
      system.gradient[i] += sum(part.gradient[i]);
      system.diagonal[i] += sum(part.diagonal[i]);
    }
    system.chi2 += sum(part.chi2);
    system.frames_drop += sum(part.frames_drop);
  }
  return system;
}

System Solution::linearise(const BoardState& state, double damping) {
  const std::vector<CameraPlace> places = camera_places(state.rig, views_.warp());
  std::vector<Eigen::VectorXd> intrinsics;
  for (const Camera& camera : state.rig.cameras) intrinsics.push_back(kernel_intrinsics(camera));
  for_each_index(chunks_.size(), threads_,
                 [&](std::size_t chunk) { sum_chunk(state, places, intrinsics, damping, chunk); });
  System system = reduced();
  system.information.diagonal() += damping * system.diagonal;
  const Eigen::MatrixXd M = kernel_by_step(state.rig);
  const Eigen::MatrixXd S = system.information.selfadjointView<Eigen::Lower>();
  system.information = M.transpose() * S * M;
  system.gradient = M.transpose() * system.gradient;
  system.diagonal = M.cwiseAbs2().transpose() * system.diagonal;
  const int n = parameter_count(state.rig);
  for (const RigPrior& prior : cost_.priors) {
    const PriorOffset offset = prior_offset(prior, state.rig);
    const Eigen::MatrixXd pull = offset.by_rig.transpose() * prior.information;
    const Eigen::MatrixXd information = pull * offset.by_rig;
    system.information.topLeftCorner(n, n) += information;
    system.gradient.head(n) += pull * offset.delta;
    system.diagonal.head(n) += information.diagonal();
    system.chi2 += offset.delta.dot(prior.information * offset.delta);
  }
  return system;
}

/// The free directions of (rig, warp); empty where all are free.
Eigen::MatrixXd directions(const Rig& rig, const std::vector<bool>& held, int parameters) {
  if (held.empty()) return {};
  const Eigen::MatrixXd of_rig = free_directions(rig, held);
  const Eigen::Index warp = parameters - of_rig.rows();
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(parameters, of_rig.cols() + warp);
  E.topLeftCorner(of_rig.rows(), of_rig.cols()) = of_rig;
  E.bottomRightCorner(warp, warp).setIdentity();
  return E;
}

/// Held components of a rotation vector stay to the bit, not to first order only.
void put_back_held(const Rig& before, const std::vector<bool>& held, Rig& rig) {
  for (int c = 1; !held.empty() && c < static_cast<int>(rig.cameras.size()); ++c) {
    const auto i = static_cast<std::size_t>(pose_index(rig, c));
    if (!held[i] && !held[i + 1] && !held[i + 2]) continue;
    const Eigen::Vector3d old = vector_from_rotation(before.T_camera_first[c].R);
    Eigen::Vector3d r = vector_from_rotation(rig.T_camera_first[c].R);
    for (int k = 0; k < 3; ++k) r[k] = held[i + k] ? old[k] : r[k];
    rig.T_camera_first[c].R = held[i] && held[i + 1] && held[i + 2] ? before.T_camera_first[c].R
                                                                    : rotation_from_vector(r);
  }
}

BoardState Solution::moved(const BoardState& state, const Eigen::VectorXd& step) const {
  BoardState next = state;
  next.rig = retract(state.rig, step.head(parameter_count(state.rig)));
  put_back_held(state.rig, cost_.held, next.rig);
  if (views_.warp()) next.warp_m += step.tail<2>();
  const Eigen::VectorXd kernel_step = kernel_by_step(state.rig) * step;
  for (std::size_t g = 0; g < views_.groups().size(); ++g) {
    Lanes twists[6];
    frame_steps(&factors_[g * frame_factor_size(parameters_)], kernel_step, twists);
    for (int l = 0; l < kernel_lanes; ++l) {
      const int frame = views_.groups()[g].frames[l];
      if (frame < 0) continue;
      const auto at = [&](int k) { return twists[k].of[l]; };
      const Eigen::Matrix3d turn = rotation_from_vector({at(0), at(1), at(2)});
      Pose& T = next.T_first_board[frame];
      T = {turn * T.R, turn * T.t + Eigen::Vector3d(at(3), at(4), at(5))};
    }
  }
  return next;
}

/// A step of the rig and how much it is worth.
struct Step {
  bool sound = false;  // the system is positive definite with room to spare
  Eigen::VectorXd tangent;
  double length = 0;     // sqrt(δᵀ S δ), standard deviations times σ̂ / σ
  double predicted = 0;  // fall of χ²
};

Step solve(const System& system, const Eigen::MatrixXd& E) {
  Step step;
  const bool all = E.size() == 0;
  Eigen::MatrixXd S = system.information;
  Eigen::VectorXd g = system.gradient, scale = system.diagonal;
  if (!all) {
    S = E.transpose() * S * E;
    g = E.transpose() * g;
    scale = E.cwiseAbs2().transpose() * scale;
  }
  scale = scale.cwiseSqrt().cwiseInverse();
  S = scale.asDiagonal() * S * scale.asDiagonal();
  if (!S.allFinite() || !g.allFinite()) return step;
  const Eigen::LLT<Eigen::MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return step;
  step.sound = S.rows() == 0 || factor.rcond() > least_rcond;
  const Eigen::VectorXd half = factor.matrixL().solve(scale.cwiseProduct(-g));
  const Eigen::VectorXd z = scale.cwiseProduct(Eigen::VectorXd(factor.matrixU().solve(half)));
  step.tangent = all ? z : E * z;
  step.length = half.norm();
  step.predicted = half.squaredNorm() + system.frames_drop;
  if (!step.tangent.allFinite()) step.sound = false;
  return step;
}

/// How far the rig may still be from the minimum after a step of `length`, in units of σ̂.
double error_after(double length, double previous) {
  const double rate = std::max(previous > 0 ? length / previous : 0.0, least_rate);
  if (rate >= 1) return std::numeric_limits<double>::infinity();
  return length * rate / (1 - rate);
}

constexpr double least_unit_px = 1e-3;  // residuals below this are taken for exact

/// Marquardt's factor: none while Gauss–Newton steps succeed, so that these converge at their own
/// rate; in a curved valley the least that the steps accept.
struct Damping {
  double value = 0;
  void ease() { value = value < 1e-9 ? 0 : value / 10; }
  /// From nothing, by little where the step that failed was short.
  void raise(bool far) { value = value == 0 ? (far ? 1e-4 : 1e-10) : value * 30; }
  bool hopeless() const { return value > 1e8; }
};

/// Throws Error where the problem is not one of this rig and these corners.
void check(const BoardObservations& observations,
           const Rig& rig,
           const ReprojectionProblem& problem) {
  const int n = parameter_count(rig);
  if (!problem.held.empty() && static_cast<int>(problem.held.size()) != n) {
    throw Error("held parameters", "there is not one flag a parameter of the rig",
                "make them with held_mask");
  }
  for (const RigPrior& prior : problem.priors) {
    if (prior.information.rows() != n || prior.information.cols() != n ||
        parameter_names(prior.mean) != parameter_names(rig)) {
      throw Error("prior", "it is of other parameters than the rig's", "make it with rig_prior");
    }
  }
  bool fits =
      problem.corner_weights.empty() || problem.corner_weights.size() == observations.views.size();
  for (std::size_t v = 0; fits && v < problem.corner_weights.size(); ++v) {
    fits = problem.corner_weights[v].size() == observations.views[v].ids.size();
  }
  if (!fits) throw Error("corner weights", "there is not one a corner", "give one a corner");
  if (!(problem.pixel_sigma_px > 0)) {
    throw Error("pixel sigma", "it is not positive", "give a standard deviation in pixels");
  }
}

}  // namespace

Resolver::Resolver(const BoardObservations& observations,
                   const BoardState& around,
                   ReprojectionProblem problem,
                   ResolveOptions options) {
  check(observations, around.rig, problem);
  problem_ = std::make_shared<const Problem>(observations, around, std::move(problem), options);
}

ResolveResult Resolver::resolve() const { return resolve(problem_->pixels_px, problem_->around); }

ResolveResult Resolver::resolve(const Eigen::Matrix2Xd& pixels_px) const {
  return resolve(pixels_px, problem_->around);
}

ResolveResult Resolver::resolve(const Eigen::Matrix2Xd& pixels_px, const BoardState& start) const {
  const ResolveOptions& options = problem_->options;
  const ReprojectionProblem& cost = problem_->cost;
  Solution solution(problem_->views, cost, problem_->views.pack(pixels_px), problem_->parameters,
                    options.threads);
  ResolveResult result;
  result.state = start;
  Damping damping;
  System system = solution.linearise(start, 0);
  double previous = 0;  // length of the last undamped step
  bool was_singular = false;
  for (result.iterations = 1; result.iterations < cost.max_iterations;) {
    result.chi2 = system.chi2;
    const Step step = solve(system, directions(result.state.rig, cost.held, problem_->parameters));
    if (!step.sound) {
      // Once damped the frames and the rig may leave the bad region; undamped again they must do.
      if (damping.hopeless() || (was_singular && damping.value == 0)) return result;
      was_singular = true;
      damping.raise(true);
      system = solution.linearise(result.state, damping.value);
      ++result.iterations;
      continue;
    }
    const double unit = std::clamp(std::sqrt(system.chi2 / std::max(problem_->dof, 1.0)),
                                   least_unit_px / cost.pixel_sigma_px, 1.0);
    const double left = damping.value > 0 ? step.length : error_after(step.length / unit, previous);
    const BoardState next = solution.moved(result.state, step.tangent);
    if (damping.value == 0 && left < options.tolerance_sigma) {
      result.state = next;
      result.chi2 = std::max(0.0, system.chi2 - step.predicted);
      result.error_left_sigma = left;
      result.status = ResolveStatus::converged;
      return result;
    }
    const double used = damping.value;
    damping.ease();
    System after = solution.linearise(next, damping.value);
    ++result.iterations;
    if (after.chi2 <= system.chi2 * (1 + 1e-12)) {
      previous = used == 0 ? step.length / unit : 0;
      result.error_left_sigma = left;
      result.state = next;
      system = std::move(after);
    } else {
      damping.value = used;
      damping.raise(step.length > far_step * unit);
      if (damping.hopeless()) break;
      system = solution.linearise(result.state, damping.value);
      ++result.iterations;
    }
  }
  result.chi2 = system.chi2;
  result.status = ResolveStatus::iteration_limit;
  return result;
}

Eigen::MatrixXd Resolver::covariance(const BoardState& state) const {
  const int n = problem_->parameters;
  Solution solution(problem_->views, problem_->cost, problem_->views.pack(problem_->pixels_px), n,
                    problem_->options.threads);
  const System system = solution.linearise(state, 0);
  Eigen::MatrixXd E = directions(state.rig, problem_->cost.held, n);
  if (E.size() == 0) E = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd S = E.transpose() * system.information * E;
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * S * scale.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.rcond() > least_rcond)) {
    throw Error("calibration", "the views leave a direction free",
                "add views at other tilts and distances, or use a model with fewer parameters");
  }
  const Eigen::MatrixXd half =
      factor.matrixL().solve(Eigen::MatrixXd(scale.asDiagonal() * E.transpose()));
  return (half.transpose() * half)
      .topLeftCorner(problem_->rig_parameters, problem_->rig_parameters);
}

}  // namespace vernier
