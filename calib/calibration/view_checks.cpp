// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/view_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/outliers.h"
#include "calib/calibration/tilt_check.h"
#include "calib/calibration/view_pair.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

/// The frames of two cameras that are consistent with one pose between them.
struct Agreement {
  Rig rig;                          ///< the two cameras and the pose they agree on
  std::vector<double> together_px;  ///< one per pair
  std::vector<bool> fits;           ///< one per pair
  std::size_t count = 0;            ///< of those that fit
  std::size_t gross = 0;            ///< with an error too large for an approximate start
};

Agreement agreement(const PairConsensus& consensus, PairReading reading) {
  Agreement result{consensus.agreed_rig(reading), {}, {}, 0, 0};
  for (std::size_t i = 0; i < consensus.pairs().size(); ++i) {
    const double together = consensus.together_px(i, reading, result.rig);
    result.together_px.push_back(together);
    result.fits.push_back(consensus.fits(i, together));
    result.gross += consensus.is_gross_misfit(together);
    result.count += result.fits.back();
  }
  return result;
}

/// Direction of the board's diagonal in the image.
Eigen::Vector2d diagonal(const BoardView& view) {
  const auto [low, high] = std::minmax_element(view.ids.begin(), view.ids.end());
  return (view.pixels_px[high - view.ids.begin()] - view.pixels_px[low - view.ids.begin()])
      .normalized();
}

/// The camera (0 or 1 of the pair) whose board pose differs more from its other frames.
int odd_one(const PairConsensus& consensus, std::size_t index, const std::vector<bool>& fits) {
  Eigen::Vector2d usual[2] = {{0, 0}, {0, 0}};
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i]) continue;
    usual[0] += diagonal(consensus.pairs()[i].first);
    usual[1] += diagonal(consensus.pairs()[i].second);
  }
  const ViewPair& pair = consensus.pairs()[index];
  return usual[0].dot(diagonal(pair.first)) < usual[1].dot(diagonal(pair.second)) ? 0 : 1;
}

std::string image_place(const BoardView& view, int camera) {
  BoardView named = view;
  named.camera = camera;
  return view_label(named);
}

std::string and_more(std::size_t more) {
  return more == 0 ? "" : fmt::format(" (and {} more frame{} like it)", more, more == 1 ? "" : "s");
}

/// A frame that fits under another reading.
struct Repair {
  std::size_t pair;
  double as_is_px, repaired_px;
};

/// The views as if the images of a camera were mirrored, left to right, and its corners numbered
/// again from the left as seen; std::nullopt if the target is not symmetric.
std::optional<BoardObservations> mirrored_images(const BoardObservations& observations,
                                                 int camera) {
  const auto& target_m = observations.target_m;
  const auto [low, high] = std::minmax_element(
      target_m.begin(), target_m.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  const double sum = low->x() + high->x(), near = 1e-3 * (high->x() - low->x());
  std::vector<int> replaced;
  for (const Eigen::Vector3d& X : target_m) {
    const Eigen::Vector2d wanted(sum - X.x(), X.y());
    const auto at = std::find_if(target_m.begin(), target_m.end(), [&](const auto& other) {
      return (other.template head<2>() - wanted).norm() < near;
    });
    if (at == target_m.end()) return std::nullopt;
    replaced.push_back(static_cast<int>(at - target_m.begin()));
  }
  BoardObservations mirrored = observations;
  for (BoardView& view : mirrored.views) {
    if (view.camera != camera) continue;
    for (int& id : view.ids) id = replaced[static_cast<std::size_t>(id)];
    for (auto& p : view.pixels_px) p.x() = observations.size_px[camera].x() - 1 - p.x();
  }
  return mirrored;
}

/// Checks two cameras of the rig.
class PairCheck {
 public:
  PairCheck(const BoardObservations& observations, const Rig& rig, int first, int second)
      : observations_(observations),
        rig_(rig),
        first_(first),
        second_(second),
        consensus_(observations, rig, first, second) {}

  void run(ObservationDiagnosis& diagnosis) const {
    const std::size_t n = consensus_.pairs().size();
    if (n < 2) return;
    const Agreement as_is = agreement(consensus_, PairReading::as_is);
    if (as_is.count == n) return;
    if (consensus_.has_half_turn_ambiguity()) complain_if_turned_throughout(as_is.count);
    if (2 * as_is.count >= n) {
      complain_of_frames(as_is, diagnosis);
    } else {
      complain_of_pairing(as_is, diagnosis);
    }
  }

 private:
  std::string cameras() const { return fmt::format("cameras {} and {}", first_, second_); }

  /// Whether the board looks the same after a quarter turn.
  bool is_square_board() const {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& point : observations_.target_m) box.extend(point);
    return std::abs(box.sizes().x() - box.sizes().y()) < 1e-3 * box.sizes().x();
  }

  void complain_if_turned_throughout(std::size_t as_is) const {
    const std::size_t n = consensus_.pairs().size();
    const Agreement turned = agreement(consensus_, PairReading::turned);
    if (turned.count <= as_is || 2 * turned.count < n) return;
    throw Error(fmt::format("camera {}", second_),
                fmt::format("its corners are numbered half a turn (180 degrees) away from those "
                            "of camera {} in {} of {} frames",
                            first_, turned.count, n),
                "reverse the order of the corners in one of the two cameras, or turn its images by "
                "180 degrees");
  }

  void complain_of_pairing(const Agreement& as_is, ObservationDiagnosis& diagnosis) const {
    const std::size_t n = consensus_.pairs().size();
    const std::size_t agreeing = as_is.count;
    for (const int shift : {1, -1, 2, -2}) {
      const PairConsensus shifted(observations_, rig_, first_, second_, shift);
      const std::size_t pairs = shifted.pairs().size();
      if (pairs < 3) continue;
      const std::size_t count = agreement(shifted, PairReading::as_is).count;
      if (2 * count < pairs || count <= agreeing) continue;
      throw Error(
          cameras(),
          fmt::format(
              "their images are paired wrongly: {} of {} frames do not agree on the pose between "
              "the cameras, but {} of {} do when camera {}'s images are taken {} frame{} "
              "{}",
              n - agreeing, n, count, pairs, second_, std::abs(shift),
              std::abs(shift) == 1 ? "" : "s", shift > 0 ? "later" : "earlier"),
          "number the images so that simultaneous ones have the same number");
    }
    if (2 * as_is.gross <= n) return;  // the approximate start may be the reason
    if (const auto mirrored = mirrored_images(observations_, second_)) {
      const PairConsensus reflected(*mirrored, rig_, first_, second_);
      const std::size_t count = agreement(reflected, PairReading::as_is).count;
      if (2 * count >= n && count > agreeing) {
        throw Error(cameras(),
                    fmt::format("the images of one of them are mirrored: {} of {} frames agree on "
                                "the pose between the two as they are, {} with those of one camera "
                                "mirrored",
                                agreeing, n, count),
                    "give that camera's images unmirrored");
      }
    }
    const std::string fault = fmt::format(
        "only {} of {} frames agree on the pose between the two: their images are not simultaneous "
        "or are paired wrongly, or the cameras moved relative to each other",
        agreeing, n);
    std::string cure = "check the pairing; hold the board still or trigger both at once";
    if (is_square_board()) {
      cure +=
          "; the corners of a square board may be numbered a quarter turn apart if one camera "
          "is mounted so";
    }
    if (n >= 4) throw Error(cameras(), fault, cure);
    diagnosis.trust_warnings.push_back(cameras() + ": " + fault + "; " + cure);
  }

  void complain_of_frames(const Agreement& as_is, ObservationDiagnosis& diagnosis) const {
    std::vector<Repair> turned, exchanged;
    std::vector<std::size_t> gross;
    for (std::size_t i = 0; i < as_is.fits.size(); ++i) {
      if (as_is.fits[i]) continue;
      const double together = consensus_.together_px(i, PairReading::as_is, as_is.rig);
      const auto repaired = [&](PairReading reading, std::vector<Repair>& list) {
        const double px = consensus_.together_px(i, reading, as_is.rig);
        const bool helps = consensus_.fits(i, px) && 2 * px < together;
        if (helps) list.push_back({i, together, px});
        return helps;
      };
      if (consensus_.has_half_turn_ambiguity() && repaired(PairReading::turned, turned)) continue;
      if (repaired(PairReading::exchanged, exchanged)) continue;
      if (!consensus_.is_gross_misfit(together)) continue;  // the solution will show
      gross.push_back(i);
      const ViewPair& pair = consensus_.pairs()[i];
      std::string doubt = fmt::format(
          "{}: each image fits the board to {:.1f} px, but not both together ({:.1f} px): they are "
          "not simultaneous or the corners of one are numbered from another corner of the board; "
          "leave the frame out",
          image_place(pair.second, second_), pair.alone_px, together);
      diagnosis.frame_doubts.push_back({pair.second.frame, std::move(doubt)});
    }
    if (!turned.empty()) throw_turned(turned, as_is.fits);
    if (!exchanged.empty()) throw_exchanged(exchanged);
    complain_if_crossed(gross, as_is);
  }

  /// Two frames each of which fits with the second image of the other.
  void complain_if_crossed(const std::vector<std::size_t>& gross, const Agreement& as_is) const {
    const auto& pairs = consensus_.pairs();
    for (std::size_t a = 0; a < gross.size(); ++a) {
      for (std::size_t b = a + 1; b < gross.size(); ++b) {
        const std::size_t i = gross[a], j = gross[b];
        const double one_px = consensus_.crossed_px(i, j, as_is.rig);
        const double other_px = consensus_.crossed_px(j, i, as_is.rig);
        if (!consensus_.fits(i, one_px) || !consensus_.fits(j, other_px)) continue;
        throw Error(fmt::format("{} and {}", image_place(pairs[i].second, second_),
                                image_place(pairs[j].second, second_)),
                    fmt::format("each belongs to the other frame (they fit to {:.0f} and {:.0f} px "
                                "as they are, to {:.1f} and {:.1f} px exchanged)",
                                as_is.together_px[i], as_is.together_px[j], one_px, other_px),
                    "exchange the two images or leave both frames out");
      }
    }
  }

  [[noreturn]] void throw_turned(const std::vector<Repair>& repairs,
                                 const std::vector<bool>& fits) const {
    const Repair& worst = repairs.front();
    const ViewPair& pair = consensus_.pairs()[worst.pair];
    const int side = odd_one(consensus_, worst.pair, fits);
    throw Error(image_place(side == 0 ? pair.first : pair.second, side == 0 ? first_ : second_),
                fmt::format("its corners are numbered half a turn (180 degrees) away from those of "
                            "camera {} (together they fit to {:.0f} px as they are, to {:.1f} px "
                            "turned){}",
                            side == 0 ? second_ : first_, worst.as_is_px, worst.repaired_px,
                            and_more(repairs.size() - 1)),
                "reverse the order of its corners or leave the frame out");
  }

  [[noreturn]] void throw_exchanged(const std::vector<Repair>& repairs) const {
    const Repair& worst = repairs.front();
    const ViewPair& pair = consensus_.pairs()[worst.pair];
    throw Error(fmt::format("{} and {}", image_place(pair.first, first_),
                            image_place(pair.second, second_)),
                fmt::format("left and right are swapped against the other frames (they fit to "
                            "{:.0f} px as they are, to {:.1f} px exchanged){}",
                            worst.as_is_px, worst.repaired_px, and_more(repairs.size() - 1)),
                "exchange the two images or leave the frame out");
  }

  const BoardObservations& observations_;
  const Rig& rig_;
  int first_, second_;
  PairConsensus consensus_;
};

/// The earlier camera with most frames in common with `camera`.
int best_partner(const BoardObservations& observations, int camera) {
  std::vector<int> shared(camera, 0);
  for (const BoardView& a : observations.views) {
    if (a.camera != camera) continue;
    for (const BoardView& b : observations.views) {
      if (b.frame == a.frame && b.camera < camera) ++shared[b.camera];
    }
  }
  return static_cast<int>(std::max_element(shared.begin(), shared.end()) - shared.begin());
}

/// Whether one board pose per frame explains all its images within the tolerance for an approximate
/// start: then no pair of cameras needs to be checked.
bool all_fit(const BoardObservations& observations, const BoardState& start) {
  int longest = 0;
  for (const Camera& camera : start.rig.cameras) {
    longest = std::max(longest, camera.size_px.maxCoeff());
  }
  auto begin = observations.views.begin();
  for (std::size_t f = 0; f < start.frames.size(); ++f) {
    auto end = begin;
    while (end != observations.views.end() && end->frame == start.frames[f]) ++end;
    const BoardPoseFit fit = fit_board_pose(observations.target_m, std::span(begin, end), start.rig,
                                            start.T_first_board[f], 5);
    if (!(fit.rms_px <= sound_share * longest)) return false;
    begin = end;
  }
  return true;
}

/// Checks the position of the second camera of a pair.
void check_baseline(const BoardState& start, ObservationDiagnosis& diagnosis) {
  if (start.rig.cameras.size() != 2) return;
  const Eigen::Vector3d centre = start.rig.T_camera_first[1].inverse().t;
  double distance = 0;
  for (const Pose& T : start.T_first_board) {
    distance += T.t.norm() / static_cast<double>(start.T_first_board.size());
  }
  if (centre.norm() < 1e-3 * distance) {
    diagnosis.trust_warnings.push_back(
        fmt::format("both cameras are at the same position ({:.2g} m apart, the board at {:.2g} "
                    "m): the images may be from one camera",
                    centre.norm(), distance));
  } else if (centre.x() < 0 && -centre.x() > centre.tail<2>().cwiseAbs().maxCoeff()) {
    diagnosis.trust_warnings.push_back(
        fmt::format("camera 1 (\"{}\") is {:.3g} m to the left of camera 0 (\"{}\"): the cameras "
                    "seem to be exchanged; swap left and right, or take the rig as it is if they "
                    "stand like this: rectification allows for it",
                    start.rig.cameras[1].name, -centre.x(), start.rig.cameras[0].name));
  }
}

}  // namespace

ObservationDiagnosis check_views(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ViewCheckOptions& options) {
  ObservationDiagnosis diagnosis;
  const bool sound = all_fit(observations, start);
  for (int c = 1; !sound && c < static_cast<int>(start.rig.cameras.size()); ++c) {
    PairCheck(observations, start.rig, best_partner(observations, c), c).run(diagnosis);
  }
  if (options.tilts) {
    const std::vector<int> rest = frames_without(diagnosis.frame_doubts, start.frames);
    diagnosis.add(check_tilts(at_frames(observations, rest), at_frames(start, rest)));
  }
  check_baseline(start, diagnosis);
  return diagnosis;
}

std::vector<int> frames_without(const std::vector<FrameDoubt>& doubts,
                                const std::vector<int>& frames) {
  std::vector<int> sound = frames;
  for (const FrameDoubt& doubt : doubts) std::erase(sound, doubt.frame);
  return sound;
}

std::vector<std::string> unrefuted(const std::vector<FrameDoubt>& doubts,
                                   const BoardObservations& inliers,
                                   const BoardState& state,
                                   const std::vector<CornerOutlier>& outliers) {
  if (doubts.empty()) return {};
  constexpr double usual = 2;  // times the median residual
  const CornerResiduals residuals = corner_residuals(inliers, state);
  std::map<int, double> worst_px;  // of a frame's views, their median residual
  std::vector<double> medians_px;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    std::vector<double> lengths_px;
    for (const Eigen::Vector2d& r : residuals[v]) lengths_px.push_back(r.norm());
    medians_px.push_back(median_or_zero(std::move(lengths_px)));
    double& worst = worst_px[inliers.views[v].frame];
    worst = std::max(worst, medians_px.back());
  }
  const double most_px = usual * median_or_zero(medians_px);
  std::vector<std::string> texts;
  for (const FrameDoubt& doubt : doubts) {
    const auto own = worst_px.find(doubt.frame);
    const bool fits =
        own != worst_px.end() && own->second <= most_px &&
        std::none_of(outliers.begin(), outliers.end(),
                     [&](const CornerOutlier& corner) { return corner.frame == doubt.frame; });
    if (!fits) texts.push_back(doubt.text);
  }
  return texts;
}

}  // namespace vernier::internal
