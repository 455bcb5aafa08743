// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/planning/views_needed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/quantile.h"
#include "calib/statistics/random.h"
#include "calib/statistics/scatter_dof.h"
#include "calib/uncertainty/target_quantity.h"

namespace vernier::internal {
namespace {

constexpr auto plan_source = static_cast<std::uint32_t>(DrawSource::planned_views);
constexpr int fewest_to_calibrate = 3;
constexpr int drawn_one_by_one = 100;  ///< later views are as informative as the mean of a pool

/// A pool with what all of its sequences need.
struct PreparedPool {
  const ViewPool* pool;
  TargetQuantity wanted;
  Eigen::MatrixXd gradient;  ///< rows x free
  Eigen::MatrixXd taken, mean;
};

std::vector<PreparedPool> prepared(const ViewKnowledge& known,
                                   const std::string& what,
                                   double at_m) {
  std::vector<PreparedPool> pools;
  for (const ViewPool& pool : known.pools) {
    const TargetQuantity wanted = target_quantity(pool.rig, what, at_m);
    const auto p = pool.free.cols();
    PreparedPool ready{&pool, wanted, wanted.gradient * pool.free, Eigen::MatrixXd::Zero(p, p),
                       Eigen::MatrixXd::Zero(p, p)};
    for (const Eigen::MatrixXd& S : pool.taken) ready.taken += S;
    for (const PlannedViews& kind : pool.following) {
      const double weight = kind.share / static_cast<double>(kind.views.size());
      for (const Eigen::MatrixXd& S : kind.views) ready.mean += weight * S;
    }
    pools.push_back(std::move(ready));
  }
  return pools;
}

/// At a noise of 1 px; infinite if the information is singular.
double unit_sd(const Eigen::MatrixXd& gradient, const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Cholesky factor(scale.asDiagonal() * information * scale.asDiagonal());
  if (!factor.is_positive_definite()) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd half =
      factor.solve_lower(Eigen::MatrixXd((gradient * scale.asDiagonal()).transpose()));
  return std::sqrt(half.squaredNorm() / static_cast<double>(gradient.rows()));
}

/// Information of the views so far and of priors, at 1 px.
Eigen::MatrixXd information_so_far(const PreparedPool& pool, double noise_px) {
  if (pool.pool->prior.size() == 0) return pool.taken;
  return pool.taken + noise_px * noise_px * pool.pool->prior;
}

/// How the views so far determine a quantity, without what priors say of it.
struct ByViews {
  double sd = 0;     ///< at the noise that `sd_px` says
  double views = 0;  ///< as many equal ones would
};

ByViews by_views(const PreparedPool& pool, double sd_px) {
  const Eigen::MatrixXd a =
      solve_symmetric(information_so_far(pool, sd_px), Eigen::MatrixXd(pool.gradient.transpose()));
  double sum = 0, squares = 0;
  for (const Eigen::MatrixXd& S : pool.pool->taken) {
    const double part = a.cwiseProduct(S * a).sum();
    sum += part;
    squares += part * part;
  }
  return {sd_px * std::sqrt(sum / static_cast<double>(pool.gradient.rows())),
          squares > 0 ? sum * sum / squares : 0};
}

/// σφ for a quantity.
struct NoiseOfTarget {
  double sd_px, log_sd;
};

NoiseOfTarget noise_of_target(const ViewKnowledge& known, const PreparedPool& pool) {
  constexpr double widest = 0.5;
  NoiseOfTarget noise{known.noise_px, known.noise_log_sd};
  const Eigen::MatrixXd& contributions = known.by_scatter.contributions;
  if (contributions.size() == 0 || !(known.inflation > 1)) return noise;
  const double tau = widest * (1 - 1 / known.inflation);
  const auto weight_of = [&](double dof) {
    return dof > 0 ? tau * tau / (tau * tau + 0.5 / dof) : 0;
  };
  const ByViews so_far = by_views(pool, noise.sd_px);
  const double scatter = sd_of(pool.wanted, contributions), dof = so_far.views - 1;
  const double w = scatter > 0 && so_far.sd > 0 ? weight_of(dof) : 0;
  const double u = weight_of(scatter_dof(static_cast<double>(contributions.cols())));
  noise.sd_px *= std::pow(known.by_scatter.in_sigma, u * (1 - w));
  if (w > 0) noise.sd_px *= std::pow(scatter / so_far.sd * std::exp(0.5 / dof), w);
  noise.log_sd = std::hypot(noise.log_sd, tau * std::sqrt(1 - w));
  return noise;
}

/// One sequence of views, added one by one.
class Sequence {
 public:
  Sequence(const PreparedPool& pool,
           const ViewKnowledge& known,
           const NoiseOfTarget& noise,
           std::uint64_t seed,
           int number)
      : pool_(pool),
        draws_({.seed = seed,
                .trial = static_cast<std::uint32_t>(number),
                .source = plan_source,
                .eye = 2}),
        noise_px_(noise.sd_px * std::exp(noise.log_sd * draws_.normal())),
        information_(information_so_far(pool, noise_px_)),
        views_(known.taken) {}

  int views() const { return views_; }
  double sd() const { return noise_px_ * unit_sd(pool_.gradient, information_); }

  void add_view() {
    const auto& views = kind().views;
    information_ += views[draws_.below(static_cast<std::uint32_t>(views.size()))];
    ++views_;
  }

  /// After `more` views as informative as the mean.
  double sd_after_mean(int more) const {
    return noise_px_ * unit_sd(pool_.gradient, information_ + more * pool_.mean);
  }

  /// The first number of views that reaches the target, at most `most`.
  int first_within(double target_sd, int most) {
    while (views_ < fewest_to_calibrate) add_view();
    for (int i = 0; i < drawn_one_by_one && views_ < most; ++i) {
      if (sd() <= target_sd) return views_;
      add_view();
    }
    if (sd() <= target_sd || views_ >= most) return views_;
    int low = 0, high = most - views_;
    if (sd_after_mean(high) > target_sd) return most;
    while (high - low > 1) {
      const int middle = low + (high - low) / 2;
      (sd_after_mean(middle) <= target_sd ? high : low) = middle;
    }
    return views_ + high;
  }

  double sd_at(int number) {
    while (views_ < number && drawn_ < drawn_one_by_one) {
      add_view();
      ++drawn_;
    }
    return views_ < number ? sd_after_mean(number - views_) : sd();
  }

 private:
  const PlannedViews& kind() {
    const auto& kinds = pool_.pool->following;
    if (kinds.size() == 1) return kinds[0];
    double left = draws_.uniform();
    std::size_t k = 0;
    while (k + 1 < kinds.size() && left > kinds[k].share) left -= kinds[k++].share;
    return kinds[k];
  }

  const PreparedPool& pool_;
  RandomStream draws_;
  double noise_px_;
  Eigen::MatrixXd information_;
  int views_, drawn_ = 0;
};

/// The target that a sequence aims at.
double drawn_target(double target_sd, const ViewPlanOptions& options, int sequence) {
  RandomStream draws({.seed = options.seed,
                      .trial = static_cast<std::uint32_t>(sequence),
                      .feature = 1,
                      .source = plan_source,
                      .eye = 2});
  const double z = draws.normal();
  const double log_sd = z < 0 ? options.target_log_sd_below : options.target_log_sd_above;
  return target_sd * std::exp(log_sd * z);
}

template <class Work>
void for_sequences(const ViewKnowledge& known,
                   const std::string& what,
                   double at_m,
                   const ViewPlanOptions& options,
                   Work work) {
  const std::vector<PreparedPool> pools = prepared(known, what, at_m);
  const NoiseOfTarget noise = noise_of_target(known, pools[0]);
  for (int i = 0; i < options.sequences; ++i) {
    Sequence sequence(pools[static_cast<std::size_t>(i) % pools.size()], known, noise, options.seed,
                      i);
    work(sequence);
  }
}

Interval middle_of(const std::vector<double>& values, double confidence) {
  const double outside = 0.5 * (1 - confidence);
  return {quantile(values, outside, QuantileKind::lower),
          quantile(values, 1 - outside, QuantileKind::upper)};
}

/// Of all intervals with this ratio of ends the one that holds the most values, and the
/// share it holds.
std::pair<Interval, double> fullest_interval(std::vector<double> values, double ratio) {
  std::sort(values.begin(), values.end());
  std::pair<Interval, double> best{{0, 0}, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto end = std::upper_bound(values.begin(), values.end(), ratio * values[i]);
    const double share =
        static_cast<double>(end - values.begin() - static_cast<std::ptrdiff_t>(i)) /
        static_cast<double>(values.size());
    if (share > best.second) best = {{values[i], std::floor(ratio * values[i])}, share};
  }
  return best;
}

/// Of all intervals that hold this share of the values the one with the smallest ratio of ends, and
/// the share it holds.
std::pair<Interval, double> narrowest_interval(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  const auto held = static_cast<std::size_t>(std::ceil(share * n));
  Interval best{values.front(), values.back()};
  for (std::size_t i = 0; i + held <= values.size(); ++i) {
    const Interval next{values[i], values[i + held - 1]};
    if (next.high * best.low < best.high * next.low) best = next;
  }
  return {best, static_cast<double>(held) / n};
}

}  // namespace

ViewsNeeded views_needed(const ViewKnowledge& known,
                         const std::string& what,
                         double at_m,
                         double target_sd,
                         const ViewPlanOptions& options) {
  if (!(target_sd > 0)) throw Error("target", "is not a number above 0", "give one");
  std::vector<double> numbers;
  for_sequences(known, what, at_m, options, [&](Sequence& sequence) {
    const double target = drawn_target(target_sd, options, static_cast<int>(numbers.size()));
    numbers.push_back(sequence.first_within(target, options.most_views));
  });
  ViewsNeeded needed;
  needed.views = static_cast<int>(quantile(numbers, 0.5, QuantileKind::lower));
  needed.interval = middle_of(numbers, options.confidence);
  needed.confidence = options.confidence;
  if (needed.interval.high > options.widest * needed.interval.low) {
    std::tie(needed.interval, needed.confidence) = fullest_interval(numbers, options.widest);
    if (needed.confidence < options.least_confidence) {
      std::tie(needed.interval, needed.confidence) =
          narrowest_interval(numbers, options.least_confidence);
    }
    needed.views = std::clamp(needed.views, static_cast<int>(needed.interval.low),
                              static_cast<int>(needed.interval.high));
  }
  needed.is_reached = needed.interval.high < options.most_views;
  return needed;
}

std::vector<SdAfter> sd_after(const ViewKnowledge& known,
                              const std::string& what,
                              double at_m,
                              const std::vector<int>& numbers,
                              const ViewPlanOptions& options) {
  std::vector<std::vector<double>> sds(numbers.size());
  for_sequences(known, what, at_m, options, [&](Sequence& sequence) {
    for (std::size_t i = 0; i < numbers.size(); ++i) sds[i].push_back(sequence.sd_at(numbers[i]));
  });
  std::vector<SdAfter> after;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    after.push_back({numbers[i], quantile(sds[i], 0.5, QuantileKind::lower),
                     middle_of(sds[i], options.confidence)});
  }
  return after;
}

}  // namespace vernier::internal
