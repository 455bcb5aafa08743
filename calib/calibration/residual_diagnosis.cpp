// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/residual_diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/change_findings.h"
#include "calib/calibration/lens_field.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/outliers.h"
#include "calib/calibration/view_pair.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

/// Another solution, of the corners that its lens model has rays for.
struct Trial {
  BoardState state;
  double sum_px2 = 0;      ///< of its squared residuals
  double sum_now_px2 = 0;  ///< of the same corners at the solution that is judged
  std::size_t corners = 0;

  double unexplained() const { return sum_px2 / sum_now_px2; }
};

double sum_of_squares(const CornerResiduals& residuals) {
  double sum = 0;
  for (const auto& view : residuals) {
    for (const Eigen::Vector2d& r : view) sum += r.squaredNorm();
  }
  return sum;
}

double rms_of(double sum_px2, std::size_t corners) {
  return std::sqrt(sum_px2 / (2.0 * static_cast<double>(std::max<std::size_t>(1, corners))));
}

class Diagnosis {
 public:
  Diagnosis(const BoardObservations& observations,
            const BoardState& state,
            const ReprojectionProblem& problem,
            const ResidualDiagnosisOptions& options)
      : observations_(observations),
        state_(state),
        problem_(problem),
        options_(options),
        residuals_(corner_residuals(observations, state)),
        sum_px2_(sum_of_squares(residuals_)) {
    for (const BoardView& view : observations.views) corners_ += view.ids.size();
  }

  std::vector<ResidualFinding> run() {
    if (!(sum_px2_ > 0)) return {};
    const bool by_lens = check_lens();
    check_board();
    if (!by_lens && !check_change()) check_simultaneity();
    check_images();
    check_cameras();
    std::erase_if(findings_, [&](const auto& f) { return f.share < options_.min_share; });
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    if (!by_lens) check_pixels();
    check_missing();
    return findings_;
  }

 private:
  double rms() const { return rms_of(sum_px2_, corners_); }

  std::size_t corners_in(const BoardObservations& some) const {
    std::size_t corners = 0;
    for (const BoardView& view : some.views) corners += view.ids.size();
    return corners;
  }

  /// Sum of squared residuals (px²) of these corners at the solution that is judged.
  double sum_now_px2(const BoardObservations& some) const {
    return sum_of_squares(corner_residuals(some, state_));
  }

  /// The views, or those corners of them that a lens model has rays for, solved with another
  /// problem; std::nullopt if that fails.
  std::optional<Trial> solved(const BoardObservations& seen,
                              const BoardState& start,
                              ReprojectionProblem trial) const {
    trial.max_iterations = 60;
    try {
      Trial result{minimise_reprojection(seen, start, trial), 0, sum_now_px2(seen),
                   corners_in(seen)};
      result.sum_px2 = sum_of_squares(corner_residuals(seen, result.state));
      if (std::isfinite(result.sum_px2) && result.sum_now_px2 > 0) return result;
    } catch (const Error&) {
    }
    return std::nullopt;
  }

  /// Priors and held values belong to the model they were given for, so only a free problem is
  /// solved with another model.
  std::optional<Trial> with_model(const CameraModel& model) const {
    constexpr double most_corners = 0.9;  // what fits fewer is no model of these images
    const std::vector<CameraModel> models(state_.rig.cameras.size(), model);
    ReprojectionProblem trial = problem_;
    trial.held.clear();
    try {
      BoardObservations seen = observations_;
      BoardState start = initial_state(seen, models);
      start.warp_m = state_.warp_m;
      std::vector<std::string> unsaid;
      leave_out_beyond_field(seen, start, {}, trial, unsaid);
      const auto left = static_cast<double>(corners_in(seen));
      if (left < most_corners * static_cast<double>(corners_)) return std::nullopt;
      return solved(seen, start, std::move(trial));
    } catch (const Error&) {
      return std::nullopt;
    }
  }

  /// Mean residual along the radius (pixels; positive: prediction beyond the corner) over the outer
  /// third of the radii that corners reach.
  double outward_at_edge_px() const {
    std::vector<std::pair<double, double>> radial;  // radius, residual along it
    for (std::size_t v = 0; v < residuals_.size(); ++v) {
      const BoardView& view = observations_.views[v];
      const Camera& camera = state_.rig.cameras[view.camera];
      for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const Eigen::Vector2d from_centre =
            view.pixels_px[i] - Eigen::Vector2d(camera.ox_px(), camera.oy_px());
        const double radius = from_centre.norm();
        if (radius > 1) radial.emplace_back(radius, residuals_[v][i].dot(from_centre) / radius);
      }
    }
    if (radial.empty()) return 0;
    const double farthest = std::max_element(radial.begin(), radial.end())->first;
    double sum = 0;
    int count = 0;
    for (const auto& [radius, along] : radial) {
      if (radius < 2.0 / 3 * farthest) continue;
      sum += along;
      ++count;
    }
    return sum / std::max(1, count);
  }

  bool is_free() const {
    return problem_.priors.empty() &&
           std::find(problem_.held.begin(), problem_.held.end(), true) == problem_.held.end();
  }

  /// Whether another lens explains nearly all: poses that do not agree, or pixels that do not seem
  /// square, by a wrong lens need not be wrong.
  bool check_lens() {
    // What noise alone leaves of residuals five times as large as it is 4 %; a fault beside the
    // lens that is worth a word of its own is at least min_share.
    constexpr double nearly_all = 0.95;
    if (!is_free()) return false;
    std::set<std::string_view> tried;
    for (const CameraModel& model : models_of(state_.rig)) tried.insert(model_name(model));
    std::optional<Trial> best;
    std::string_view best_name;
    for (const CameraModel& model :
         {CameraModel{OpenCv5{}}, CameraModel{Fisheye4{}}, CameraModel{OpenCv8{}}}) {
      if (tried.contains(model_name(model))) continue;
      const std::optional<Trial> trial = with_model(model);
      // a richer model must be worth its coefficients
      if (!trial || (best && trial->unexplained() > 0.9 * best->unexplained())) continue;
      best = trial;
      best_name = model_name(model);
    }
    if (!best) return false;
    const double share = 1 - best->unexplained();
    findings_.push_back(
        {share,
         fmt::format("the lens needs another model: {} fits the same corners to {:.2f} px instead "
                     "of {:.2f} px (predictions are now {:.2f} px too far {} on average near the "
                     "image's edge); calibrate with --model {}",
                     best_name, rms_of(best->sum_px2, best->corners),
                     rms_of(best->sum_now_px2, best->corners), std::abs(outward_at_edge_px()),
                     outward_at_edge_px() > 0 ? "out" : "in", best_name),
         share >= nearly_all});
    return share >= nearly_all;
  }

  void check_board() {
    if (problem_.warp == BoardWarp::free) return;
    ReprojectionProblem trial = problem_;
    trial.warp = BoardWarp::free;
    const std::optional<Trial> bent = solved(observations_, state_, std::move(trial));
    if (!bent) return;
    const Eigen::Vector2d warp_mm = 1e3 * bent->state.warp_m;
    findings_.push_back(
        {1 - bent->unexplained(),
         fmt::format(
             "the board is not flat: a warp of {:.2g} mm in x and {:.2g} mm in y fits to {:.2f} px "
             "instead of {:.2f} px; estimate the board's shape or use a stiff board",
             warp_mm.x(), warp_mm.y(), rms_of(bent->sum_px2, corners_), rms())});
  }

  /// Whether the rig changed once. A change in every frame is left to check_simultaneity, which
  /// names the frames, unless that explains much less.
  bool check_change() {
    if (!is_free()) return false;
    const std::optional<ResidualFinding> change = change_finding(observations_, state_);
    if (!change) return false;
    if (change->text.find("the rig changed") != 0) {
      const std::size_t before = findings_.size();
      check_simultaneity();
      if (findings_.size() > before && 2 * findings_.back().share > change->share) return true;
      findings_.resize(before);
    }
    findings_.push_back(*change);
    return true;
  }

  void check_simultaneity() {
    BoardObservations warped = observations_;
    warped.target_m = warped_target(warped.target_m, state_.warp_m);
    for (int second = 1; second < static_cast<int>(state_.rig.cameras.size()); ++second) {
      const PairConsensus pair(warped, state_.rig, 0, second);
      if (pair.pairs().size() < 2) continue;
      // the pose that the better half agrees on: the solution's own bends towards the bad frames
      const Rig rig = pair.agreed_rig(PairReading::as_is);
      std::vector<double> together;
      for (std::size_t i = 0; i < pair.pairs().size(); ++i) {
        together.push_back(pair.together_px(i, PairReading::as_is, rig));
      }
      // a few frames far off spoil the intrinsics of all: then only these are meant
      const double far_px = 2.5 * median_or_zero(together);
      const bool some_far =
          std::any_of(together.begin(), together.end(), [&](double px) { return px > far_px; });
      std::vector<std::pair<double, std::size_t>> apart;
      double alone_sum = 0, together_sum = 0;
      for (std::size_t i = 0; i < pair.pairs().size(); ++i) {
        const ViewPair& views = pair.pairs()[i];
        if (!(together[i] > 2 * views.alone_px) || (some_far && together[i] <= far_px)) continue;
        const double corners =
            2.0 * static_cast<double>(views.first.ids.size() + views.second.ids.size());
        apart.emplace_back(together[i], i);
        alone_sum += corners * views.alone_px * views.alone_px;
        together_sum += corners * together[i] * together[i];
      }
      if (apart.empty()) continue;
      std::sort(apart.rbegin(), apart.rend());
      std::vector<std::string> names;
      names.reserve(apart.size());
      for (const auto& [px, i] : apart) {
        names.push_back(fmt::format("{} ({:.1f} px against {:.1f})", pair.pairs()[i].first.frame,
                                    px, pair.pairs()[i].alone_px));
      }
      findings_.push_back(
          {std::min(1.0, (together_sum - alone_sum) / sum_px2_),
           fmt::format("cameras 0 and {} did not see the board at the same pose in {} of {} frames "
                       "(each image fits alone, but not both together): {}; hold the board still, "
                       "trigger both at once, or leave these frames out",
                       second, apart.size(), pair.pairs().size(), some_of(names))});
    }
  }

  void check_images() {
    std::vector<double> rms_px;
    std::vector<double> sums;
    for (const auto& view : residuals_) {
      double sum = 0;
      for (const Eigen::Vector2d& r : view) sum += r.squaredNorm();
      sums.push_back(sum);
      rms_px.push_back(rms_of(sum, view.size()));
    }
    const double usual = median_or_zero(rms_px);
    std::vector<std::pair<double, std::size_t>> poor;
    double poor_sum = 0;
    std::size_t poor_corners = 0;
    for (std::size_t v = 0; v < rms_px.size(); ++v) {
      if (!(rms_px[v] > 2.5 * usual)) continue;
      poor.emplace_back(rms_px[v], v);
      poor_sum += sums[v];
      poor_corners += residuals_[v].size();
    }
    if (poor.empty()) return;
    std::sort(poor.rbegin(), poor.rend());
    std::vector<std::string> names;
    names.reserve(poor.size());
    for (const auto& [px, v] : poor) {
      names.push_back(fmt::format("{} ({:.1f} px)", view_label(observations_.views[v]), px));
    }
    findings_.push_back(
        {poor_sum / sum_px2_,
         fmt::format("{} of {} images account for {:.0f} % of the squared residuals: {}; the "
                     "others have {:.2f} px rms: inspect these images, or leave them out",
                     poor.size(), residuals_.size(), 100 * poor_sum / sum_px2_, some_of(names),
                     rms_of(sum_px2_ - poor_sum, corners_ - poor_corners))});
  }

  void check_cameras() {
    if (state_.rig.cameras.size() < 2) return;
    for (int c = 0; c < static_cast<int>(state_.rig.cameras.size()); ++c) {
      std::vector<double> own, others;
      double sum = 0;
      for (std::size_t v = 0; v < residuals_.size(); ++v) {
        double view_sum = 0;
        for (const Eigen::Vector2d& r : residuals_[v]) view_sum += r.squaredNorm();
        const bool is_own = observations_.views[v].camera == c;
        (is_own ? own : others).push_back(rms_of(view_sum, residuals_[v].size()));
        if (is_own) sum += view_sum;
      }
      // the median image of each, so that single bad ones do not count against the camera
      const double own_px = median_or_zero(std::move(own)),
                   others_px = median_or_zero(std::move(others));
      if (!(own_px > 2.5 * others_px)) continue;
      findings_.push_back(
          {sum / sum_px2_, fmt::format("camera {} (\"{}\") has residuals of {:.2f} px, the others "
                                       "{:.2f} px: check its focus, its images and its lens model",
                                       c, state_.rig.cameras[c].name, own_px, others_px)});
    }
  }

  void check_pixels() {
    for (const Camera& camera : state_.rig.cameras) {
      if (std::abs(camera.ax() - 1) < 0.05) continue;
      findings_.push_back(
          {0, fmt::format("camera \"{}\" seems to have pixels {:.0f} % {} than high: if not, the "
                          "board's squares are not square or its given dimensions are wrong",
                          camera.name, 100 * std::abs(1 / camera.ax() - 1),
                          camera.ax() < 1 ? "wider" : "narrower")});
    }
  }

  void check_missing() {
    const std::vector<std::string> whole = images_left_out(options_.outliers, observations_);
    if (!whole.empty()) {
      findings_.push_back({0, fmt::format("{} image{} left out as a whole, because no pose of the "
                                          "board fits the rest: {}; inspect {}",
                                          whole.size(), whole.size() == 1 ? " was" : "s were",
                                          some_of(whole), whole.size() == 1 ? "it" : "them")});
    }
    const auto found = static_cast<int>(observations_.views.size());
    if (options_.images_without_board > found / 2) {
      findings_.push_back(
          {0, fmt::format("the board was found in only {} of {} images: give sharp, evenly lit "
                          "images with the whole board in view",
                          found, found + options_.images_without_board)});
    }
  }

  static std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t most = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, names.size()); ++i) {
      text += (i == 0 ? "" : ", ") + names[i];
    }
    return names.size() > most ? text + fmt::format(" and {} more", names.size() - most) : text;
  }

  const BoardObservations& observations_;
  const BoardState& state_;
  const ReprojectionProblem& problem_;
  const ResidualDiagnosisOptions& options_;
  CornerResiduals residuals_;
  double sum_px2_ = 0;
  std::size_t corners_ = 0;
  std::vector<ResidualFinding> findings_;
};

}  // namespace

std::vector<ResidualFinding> diagnose_residuals(const BoardObservations& observations,
                                                const BoardState& state,
                                                const ReprojectionProblem& problem,
                                                const ResidualDiagnosisOptions& options) {
  return Diagnosis(observations, state, problem, options).run();
}

}  // namespace vernier::internal
