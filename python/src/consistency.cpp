// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/consistency.hpp"

#include <numeric>

#include <fmt/ranges.h>
#include <nanobind/stl/array.h>

#include "array_like.hpp"
#include "posemix/slam/truth_match.hpp"
#include "record.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_words(nb::module_& m) {
  Words<ErrorAxes>(m, "ErrorAxes", "Axes along which errors are reported; the NEES is the same.")
      .value(ErrorAxes::body, "Those of the estimated pose.")
      .value(ErrorAxes::reference, "Those of the frame in which the pose is stated, at the body.");
  Words<Alignment>(m, "Alignment",
                   "The motion of estimates onto the truth before they are compared.")
      .value(Alignment::none, "No motion.")
      .value(Alignment::first, "The first pair agrees, which then does not count.")
      .value(Alignment::se3, "The rigid motion that brings the positions nearest.");
  Words<ConsistencyVerdict>(m, "ConsistencyVerdict", "The verdict on a series of errors.")
      .value(ConsistencyVerdict::consistent, "Nothing against the covariances.")
      .value(ConsistencyVerdict::overconfident, "Errors are larger than the covariances say.")
      .value(ConsistencyVerdict::cautious, "Errors are smaller than the covariances say.");
}

void bind_parts(nb::module_& m) {
  using I = Interval;
  Record<I>(m, "Interval", "Bounds of an interval.")
      .field("low", &I::low, "float", "Lower bound.")
      .field("high", &I::high, "float", "Upper bound.")
      .done();
  using C = Coverage;
  Record<C>(m, "Coverage", "Shares of errors within 1, 2 and 3 sigma.")
      .field("shares", &C::shares, "collections.abc.Sequence[float]", "Shares of the frames.",
             [](const C& self) {
               return nb::make_tuple(self.shares[0], self.shares[1], self.shares[2]);
             })
      .field("nominal", &C::nominal, "collections.abc.Sequence[float]", "Their expectations.",
             [](const C& self) {
               return nb::make_tuple(self.nominal[0], self.nominal[1], self.nominal[2]);
             })
      .done();
  using F = FrameConsistency;
  Record<F>(m, "FrameConsistency", "NEES of one frame, not divided by the degrees of freedom.")
      .field("stamp_s", &F::stamp_s, "float", "Time of the frame [s].")
      .field("nees", &F::nees, "float", "NEES of the pose.")
      .field("rotation_nees", &F::rotation_nees, "float",
             "NEES of the rotation alone; 0 where none of it can be observed.")
      .field("position_nees", &F::position_nees, "float", "NEES of the position alone.")
      .done();
}

void bind_summary(nb::module_& m) {
  using N = NeesSummary;
  Record<N>(m, "NeesSummary", "The NEES of a series, per degree of freedom: 1 when consistent.")
      .field("dof", &N::dof, "int", "Degrees of freedom that can be observed.")
      .field("anees", &N::anees, "float", "Mean over the frames.")
      .field("median", &N::median, "float", "Median over the frames.")
      .field("worst", &N::worst, "float", "Largest over the frames.")
      .field("worst_stamp_s", &N::worst_stamp_s, "float", "Time of the largest [s].")
      .field("effective_frames", &N::effective_frames, "float",
             "The number of independent frames that carry as much information.")
      .field("interval", &N::interval, "Interval",
             "95 % confidence interval of the ANEES for one series with such correlations.")
      .field(
          "band", &N::band, "Interval",
          "Interval that has the ANEES of a consistent estimate with such correlations in 95 % of "
          "the cases.")
      .field("independent_band", &N::independent_band, "Interval",
             "The same for independent frames.")
      .field("frame_band", &N::frame_band, "Interval",
             "Interval that has the NEES of one frame in 95 % of the cases.")
      .field("within_frame_band", &N::within_frame_band, "float",
             "Share of the frames within that.")
      .field("coverage", &N::coverage, "Coverage", "Coverage of the ellipsoids NEES <= 1, 4, 9.")
      .field(
          "verdict", &N::verdict, "ConsistencyVerdict",
          "Verdict by a confidence interval of the ANEES: of 95 % for the whole pose, of 99 % for "
          "rotation and position.")
      .done();
}

void bind_directions(nb::module_& m) {
  using A = AxisConsistency;
  Record<A>(m, "AxisConsistency", "The error along one axis.")
      .field("axis", &A::axis, "str", "Name of the axis: \"rotation x\", ..., \"position z\".")
      .field("mean_error", &A::mean_error, "float", "Mean [rad or m].")
      .field("rms_error", &A::rms_error, "float", "Root mean square [rad or m].")
      .field("rms_sd", &A::rms_sd, "float", "Root of the mean variance [rad or m].")
      .field("normalized_mean", &A::normalized_mean, "float",
             "Mean of error over standard deviation; 0 without a bias.")
      .field("normalized_rms", &A::normalized_rms, "float",
             "Root mean square of error over standard deviation; 1 when consistent.")
      .field("bias_significance", &A::bias_significance, "float",
             "Standard errors by which the mean differs from zero.")
      .field("coverage", &A::coverage, "Coverage", "Coverage of 1, 2, 3 standard deviations.")
      .done();
  using D = ErrorDirection;
  Record<D>(m, "ErrorDirection", "A direction of the error.")
      .field("ratio", &D::ratio, "float", "Mean squared error over mean variance along it.")
      .field("limit", &D::limit, "float",
             "Ratio beyond which 0.5 % of consistent series of this length are.")
      .field("correlation", &D::correlation, "numpy.typing.ArrayLike",
             "Correlation with the error along each axis, shape (6,).")
      .field("name", &D::name, "str", "The axes that it is most of.")
      .done();
}

void bind_consistency_report(nb::module_& m) {
  using R = ConsistencyReport;
  Record<R>(m, "ConsistencyReport", "Whether the errors of a series are as its covariances say.")
      .field("frames", &R::frames, "list[FrameConsistency]", "NEES of every frame.")
      .field("pose", &R::pose, "NeesSummary", "Summary of the whole pose.")
      .field("rotation", &R::rotation, "NeesSummary | None",
             "Summary of the rotation; None where none of it can be observed.")
      .field("position", &R::position, "NeesSummary", "Summary of the position.")
      .field("axes", &R::axes, "list[AxisConsistency]", "Axes that can be observed.")
      .field("most_overconfident", &R::most_overconfident, "ErrorDirection",
             "The direction with the largest ratio of squared error to variance.")
      .field("most_cautious", &R::most_cautious, "ErrorDirection",
             "The direction with the smallest ratio.")
      .field("constant_share", &R::constant_share, "float",
             "Part of the mean squared normalised error that is one constant error.")
      .field("verdict", &R::verdict, "ConsistencyVerdict",
             "The worst verdict on pose, rotation, position and extreme directions.")
      .field("findings", &R::findings, "list[str]",
             "The verdict in words, the most important first.")
      .shown_as([](const R& report) {
        std::string text = fmt::format("Consistency of {} frames:", report.frames.size());
        for (const std::string& finding : report.findings) text += "\n  " + finding;
        return text;
      })
      .done();
}

/// The stamps of `n` poses: 0, 1, 2, ... unless given.
std::vector<double> stamps_of(const std::optional<ArrayLike>& given, std::size_t n,
                              const char* name) {
  std::vector<double> stamps(n);
  std::iota(stamps.begin(), stamps.end(), 0.0);
  if (!given) return stamps;
  const Eigen::VectorXd values = given->flat();
  if (static_cast<std::size_t>(values.size()) != n) {
    throw InvalidInput(
        fmt::format("{} has {} entries; expected one per pose, {}", name, values.size(), n));
  }
  return {values.begin(), values.end()};
}

std::vector<StampedEstimate> estimates_of(const PoseArray& poses, const ArrayLike& covariances,
                                          const std::vector<double>& stamps) {
  const std::vector<std::size_t> shape = covariances.shape();
  if (shape != std::vector<std::size_t>{poses.size(), 6, 6}) {
    throw InvalidInput(fmt::format("covariances has shape ({}{}); expected ({}, 6, 6)",
                                   fmt::join(shape, ", "), shape.size() == 1 ? "," : "",
                                   poses.size()));
  }
  const Matrices matrices = matrices_of(covariances, 6, "covariances");
  std::vector<StampedEstimate> estimates;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Map<const Matrix6d> covariance(matrices.data() + 36 * k);
    const Matrix6d checked =
        checked_covariance(Matrix6d(covariance), 6, fmt::format("covariances[{}]", k));
    estimates.push_back({stamps[k], ConcentratedGaussian<SE3d>::trusted(poses[k], checked)});
  }
  return estimates;
}

/// Estimates and truth entry by entry, or by their stamps where the truth has its own.
std::vector<EstimateWithTruth> pairs_of(const std::vector<StampedEstimate>& estimates,
                                        const PoseArray& truth, const std::vector<double>& stamps,
                                        const std::optional<ArrayLike>& truth_stamps,
                                        const MatchSettings& settings) {
  if (!truth_stamps && truth.size() != estimates.size()) {
    throw InvalidInput(
        fmt::format("{} true poses for {} estimates; expected as many, or stamps and truth_stamps",
                    truth.size(), estimates.size()));
  }
  const std::vector<double> times =
      truth_stamps ? stamps_of(truth_stamps, truth.size(), "truth_stamps") : stamps;
  std::vector<StampedTruth> stamped;
  for (std::size_t k = 0; k < truth.size(); ++k) stamped.push_back({times[k], truth[k]});
  return match_to_truth(estimates, stamped, settings);
}

constexpr const char* kConsistencyDoc =
    R"(Whether the errors of poses are as large as their covariances say.

NEES = e^T P^-1 e of every frame, its mean per degree of freedom (ANEES) with an interval that allows for errors that
are alike from frame to frame, coverage, errors along each axis, and the direction that is most at fault.

Parameters
----------
estimates : SE3, shape (n,)
    Estimated poses.
covariances : array_like, shape (n, 6, 6)
    Of xi in X = Exp(xi) X0, rotation [rad] before translation [m]. `posemix.interop` converts other conventions.
truth : SE3, shape (n,) or (m,)
    True poses: one per estimate, or at times of their own.
stamps, truth_stamps : array_like, shape (n,) and (m,), optional
    Times [s], increasing. With `truth_stamps` the poses nearest in time are compared, else the k-th with the k-th.
max_difference_s : float
    Largest difference of the stamps of a pair [s].
alignment : Alignment
    How estimates are moved onto the truth first. It takes a part of the error away that the covariances count.
symmetries : SymmetryGroup, optional
    Of the object whose pose it is: the nearest of the equivalent true poses counts, and what continuous symmetries
    leave open does not.
axes : ErrorAxes
    Axes along which errors are reported.

Raises
------
ValueError
    For arrays that do not fit, a covariance that is not positive definite, stamps that do not increase, and fewer
    than two pairs.

References
----------
Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, section 5.4.

Examples
--------
>>> import numpy as np
>>> from posemix import SE3, consistency
>>> errors = np.random.default_rng(1).normal(scale=0.02, size=(500, 6))
>>> truth = SE3.identity(500)
>>> report = consistency(SE3.exp(errors), np.tile(0.01**2 * np.eye(6), (500, 1, 1)), truth)
>>> report.verdict.name, round(report.pose.anees)
('overconfident', 4)
)";

}  // namespace

void bind_consistency(nb::module_& m) {
  bind_words(m);
  bind_parts(m);
  bind_summary(m);
  bind_directions(m);
  bind_consistency_report(m);
  m.def(
      "consistency",
      [](const PoseArray& estimates, const ArrayLike& covariances, const PoseArray& truth,
         const std::optional<ArrayLike>& stamps, const std::optional<ArrayLike>& truth_stamps,
         double max_difference_s, Alignment alignment,
         const std::optional<SymmetryGroup>& symmetries, ErrorAxes axes) {
        const std::vector<double> times = stamps_of(stamps, estimates.size(), "stamps");
        const auto pairs = pairs_of(estimates_of(estimates, covariances, times), truth, times,
                                    truth_stamps, {max_difference_s, alignment});
        const nb::gil_scoped_release unlocked;
        return consistency_of(pairs,
                              {.symmetries = symmetries.value_or(SymmetryGroup()), .axes = axes});
      },
      "estimates"_a, "covariances"_a, "truth"_a, nb::kw_only(), "stamps"_a = nb::none(),
      "truth_stamps"_a = nb::none(), "max_difference_s"_a = MatchSettings{}.max_difference_s,
      "alignment"_a = Alignment::none, "symmetries"_a = nb::none(), "axes"_a = ErrorAxes::body,
      kConsistencyDoc);
}

}  // namespace posemix::python
