// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_fit.hpp"

#include <map>

#include <nanobind/stl/array.h>

#include "array_like.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/detector/default_noise.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_noise_fit_settings(nb::module_& m) {
  Words<NoiseCriterion>(m, "NoiseCriterion", "Criterion that decides between noise models.")
      .value(NoiseCriterion::bic, "The least BIC, with all detections taken for independent.")
      .value(NoiseCriterion::bic_independent_frames,
             "The least BIC, with correlated detections counted as fewer.")
      .value(NoiseCriterion::cross_validation,
             "The greatest log density of recordings that were held out.");
  using M = NoiseModeSettings;
  Settings<M>(m, "NoiseModeSettings",
              "Conditions under which clusters of wrong poses become modes of a noise model.")
      .field("radius_deg", &M::radius_deg, "float",
             "Radius of a cluster of rotations; a wider component is no mode.")
      .field("least_share", &M::least_share, "float", "Least weight of a mode.")
      .field("least_recordings", &M::least_recordings, "float",
             "Least effective number of recordings; 1 where a single recording is enough.")
      .field("most", &M::most, "int", "Most clusters that are tried.")
      .done();
  using S = NoiseFitSettings;
  Settings<S>(m, "NoiseFitSettings", "Settings of `fit_noise`.")
      .field("max_components", &S::max_components, "int",
             "Largest number of components without modes; models of 1, 2, ... are fitted.")
      .field("restarts", &S::restarts, "int", "Starts of EM for every number of components.")
      .field("frame", &S::frame, "NoiseFrame | None", "Axes of the covariances; chosen where None.")
      .field("full_covariance", &S::full_covariance, "bool",
             "Whether covariances are full; otherwise they are diagonal.")
      .field("free_means", &S::free_means, "bool",
             "Whether all components may have offsets; for the object's frame without clutter.")
      .field("clutter", &S::clutter, "bool",
             "Whether models have clutter, whose weight is estimated.")
      .field("clutter_volume_m3", &S::clutter_volume_m3, "float", "Volume of clutter [m^3].")
      .field("least_clutter", &S::least_clutter, "float", "Least weight of clutter.")
      .field("modes", &S::modes, "bool", "Whether modes are looked for; needs clutter.")
      .field("mode", &S::mode, "NoiseModeSettings", "Conditions under which clusters become modes.")
      .field("criterion", &S::criterion, "NoiseCriterion", "Criterion that decides between models.")
      .field("folds", &S::folds, "int",
             "Number of folds of the cross validation; below two there is none.")
      .field("max_rotation_sd_deg", &S::max_rotation_sd_deg, "float", "Bound of a component [deg].")
      .field("max_translation_sd_m", &S::max_translation_sd_m, "float",
             "Bound of a component [m, or fraction of the range].")
      .done();
}

void bind_correlation(nb::module_& m) {
  using D = DependentFrames;
  Record<D>(m, "DependentFrames", "Number of frames that count as one independent frame.")
      .field("about_zero", &D::about_zero, "float",
             "Number for whole recordings, whose common error counts; at least 1.")
      .field("within", &D::within, "float",
             "Number for errors about the mean of each recording; at least 1.")
      .done();
  using C = NoiseCorrelation;
  Record<C>(m, "NoiseCorrelation", "Correlation in time of the errors of a detector.")
      .field("inliers", &C::inliers, "int", "Number of detections within the gate.")
      .field("inlier", &C::inlier, "DependentFrames",
             "Dependence of the whitened residuals of inliers, over all axes.")
      .field("axes", &C::axes, "list[DependentFrames]",
             "Dependence of the residuals of inliers by axis.")
      .field("bias_sd", &C::bias_sd, kFloatArray,
             "Shape (6,): standard deviation of the error that a recording has in common [rad, m "
             "or fraction of the range].")
      .field("outlier_share", &C::outlier_share, "float", "Share of detections beyond the gate.")
      .field("outlier_run", &C::outlier_run, "float",
             "Mean length of a run of outliers [detections].")
      .field("outlier", &C::outlier, "DependentFrames",
             "Dependence of the indicator of outliers, about its mean.")
      .done();
}

void bind_slow_error(nb::module_& m) {
  Words<SlowErrorDecay>(m, "SlowErrorDecay",
                        "The quantities with which the correlation of a slow error decays.")
      .value(SlowErrorDecay::none, "There is no slow error: errors are white.")
      .value(SlowErrorDecay::angle, "The path of the viewing direction.")
      .value(SlowErrorDecay::time, "Time.")
      .value(SlowErrorDecay::angle_and_time, "Both.");
  using M = SlowErrorModel;
  Record<M>(m, "SlowErrorModel", "A model of slow errors at its greatest likelihood.")
      .field("decay", &M::decay, "SlowErrorDecay",
             "The quantities with which the correlation decays.")
      .field("common", &M::common, "bool",
             "Whether there is an error that a recording has in common.")
      .field("log_likelihood", &M::log_likelihood, "float",
             "Log-likelihood of the residuals of the inliers [nats].")
      .field("parameters", &M::parameters, "int", "Number of free parameters.")
      .field("bic", &M::bic, "float",
             "The criterion, parameters log(detections) - 2 log_likelihood.")
      .field("below_best", &M::below_best, "float",
             "Log-likelihood of the model of the least BIC less that of this one [nats].")
      .field("standard_error", &M::standard_error, "float",
             "Standard error of the difference; NaN with fewer than five recordings.")
      .done();
  using F = SlowErrorFit;
  Record<F>(m, "SlowErrorFit", "The white, slow and common errors of the inliers of a detector.")
      .field("slow", &F::slow, "SlowError | None", "The slow error; None where errors are white.")
      .field("common", &F::common, "numpy.typing.NDArray[numpy.float64] | None",
             "Shape (6, 6): covariance of the error in common, along the object's axes [rad, m].")
      .field("white", &F::white, kFloatArray, "Shape (6, 6): covariance of the white error.")
      .field("slow_sd", &F::slow_sd, kFloatArray,
             "Shape (6,): standard deviations of the slow error [rad, m or fraction of the range].")
      .field("slow_sd_error", &F::slow_sd_error, kFloatArray,
             "Shape (6,): their standard errors, NaN where they are not known.")
      .field(
          "white_sd", &F::white_sd, kFloatArray,
          "Shape (6,): standard deviations of the white error [rad, m or fraction of the range].")
      .field("white_sd_error", &F::white_sd_error, kFloatArray,
             "Shape (6,): their standard errors, NaN where they are not known.")
      .field("common_sd", &F::common_sd, kFloatArray,
             "Shape (6,): standard deviations of the error in common [rad, m].")
      .field("common_sd_error", &F::common_sd_error, kFloatArray,
             "Shape (6,): their standard errors, NaN where they are not known.")
      .field("correlation_angle_error_rad", &F::correlation_angle_error_rad, "float",
             "Standard error of the correlation angle [rad].")
      .field("correlation_time_error_s", &F::correlation_time_error_s, "float",
             "Standard error of the correlation time [s].")
      .field("detections", &F::detections, "int", "Number of inliers.")
      .field("recordings", &F::recordings, "int", "Number of recordings that have inliers.")
      .field("is_jackknife", &F::is_jackknife, "bool",
             "Whether standard errors are at least those of a jackknife over recordings.")
      .field("models", &F::models, "list[SlowErrorModel]", "All models that were tried.")
      .field("chosen", &F::chosen, "int", "Index of the chosen model in `models`.")
      .done();
}

/// How well a noise model explains the detections.
template <class Fit>
Record<Fit>& with_likelihood(Record<Fit>& fit) {
  return fit
      .field("log_likelihood", &Fit::log_likelihood, "float",
             "Log-likelihood, summed over the detections [nats].")
      .field("parameters", &Fit::parameters, "int", "Number of free parameters.")
      .field("bic", &Fit::bic, "float",
             "The criterion, parameters log(detections) - 2 log_likelihood.");
}

NoiseEmFit blank_em_fit() {
  return {default_detector_noise(), 0.0, {}, EmStatus::converged, 0, 0.0};
}

void bind_models(nb::module_& m) {
  using M = NoiseMode;
  Record<M>(m, "NoiseMode", "A cluster of wrong poses.")
      .field("offset", &M::offset, "posemix.lie.SE3", "T_object_mode.")
      .field("weight", &M::weight, "float", "Share of the detections.")
      .field("recordings", &M::recordings, "float", "Effective number of recordings that have it.")
      .field("rotation_sd_deg", &M::rotation_sd_deg, "float",
             "Standard deviation about the widest axis [deg].")
      .field("accepted", &M::accepted, "bool", "Whether the cluster fulfils the settings.")
      .done();
  using F = NoiseEmFit;
  Record<F> fit(m, "NoiseEmFit", "A noise model with a given number of components.");
  fit.made_from(&blank_em_fit)
      .field("noise", &F::noise, "DetectorNoise", "The model, without its dependence.");
  with_likelihood(fit)
      .field("history", &F::history, "list[float]",
             "Log-likelihood of the start and after every step.")
      .field("status", &F::status, "EmStatus", "Reason for which EM ended.")
      .done();
  using V = NoiseValidation;
  Record<V>(m, "NoiseValidation",
            "Quality of a kind of model at predicting detections to which it was not fitted.")
      .field("frame", &V::frame, "NoiseFrame", "Axes of the covariances.")
      .field("clutter", &V::clutter, "bool", "Whether the models have clutter.")
      .field("components", &V::components, "int", "Number of components.")
      .field("log_density", &V::log_density, "float", "Mean log density per detection [nats].")
      .field("by_fold", &V::by_fold, "list[float]", "Mean per detection by fold [nats].")
      .field("below_best", &V::below_best, "float", "Difference to the best of all kinds [nats].")
      .field("standard_error", &V::standard_error, "float", "Standard error of the difference.")
      .done();
}

constexpr const char* kFitNoiseDoc =
    R"(Learns the noise of a detector from detections of one class of objects with ground truth.

Mixtures of 1, 2, ... components with clutter are fitted by EM; the criterion chooses one of them and the frame of
its covariances. Wrong poses that recur become modes. The errors of inliers are separated into a white part, a slow one
that lasts while the view stays the same, and one that a recording has in common. The result is a model for filters.

Parameters
----------
truth, detected : SE3, shape (n,)
    T_camera_object by ground truth and by the detector, one per frame in the order of time; NaN in frames
    without ground truth or without a detection (`with_misses`).
recording : array_like, shape (n,), optional
    Name or number of the recording of every frame; a single recording if None.
stamps : array_like, shape (n,), optional
    Stamps of the frames [s], which do not decrease within a recording; if None, how long errors last is estimated in
    angles of view alone, and the mode time is zero.
settings : NoiseFitSettings, optional
    Models that are tried, and the criterion that chooses one.
seed : int or RandomStream
    Seed of the starts.

Returns
-------
NoiseFit
    The result, with the model in ``noise`` and its text in ``to_toml()``.

Raises
------
ValueError
    For numbers of poses that differ, fewer than two detections, stamps that decrease, and settings that contradict
    each other.

Examples
--------
>>> import numpy as np
>>> from posemix import SE3, NoiseFitSettings, NoiseFrame, fit_noise
>>> rng = np.random.default_rng(1)
>>> truth = SE3(translation=np.tile([0.0, 0.0, 1.0], (500, 1)))
>>> detected = truth * SE3.exp(rng.normal(size=(500, 6)) * [0.05, 0.05, 0.02, 0.01, 0.01, 0.03])
>>> fit = fit_noise(truth, detected, settings=NoiseFitSettings(max_components=2, frame=NoiseFrame.object))
>>> len(fit.noise.components)
1
>>> sd = np.sqrt(fit.noise.components[0].covariance.diagonal())
>>> bool(np.allclose(sd, [0.05, 0.05, 0.02, 0.01, 0.01, 0.03], rtol=0.1))
True
>>> fit.to_toml("cup").splitlines()[0]
'[noise.cup]'
)";

void bind_fit(nb::module_& m) {
  using F = NoiseFit;
  Record<F> fit(m, "NoiseFit", "A noise model, and how it was found; see `fit_noise`.");
  fit.made_from([] {
       return F{
           default_detector_noise(), NoiseFrame::object, 0.0, 0, 0.0, {}, 0, 1.0, {}, {}, {}, {}};
     })
      .field("noise", &F::noise, "DetectorNoise", "The chosen model, with its dependence.")
      .field("frame", &F::frame, "NoiseFrame", "Axes of its covariances.");
  with_likelihood(fit)
      .field("fits", &F::fits, "list[NoiseEmFit]",
             "The models in the frame with 1, 2, ... components, then the one with modes.")
      .field("chosen", &F::chosen, "int", "Index of the chosen model in `fits`.")
      .field("dependent_frames", &F::dependent_frames, "float",
             "Number of detections that count as one: median over the coordinates.")
      .field("modes", &F::modes, "list[NoiseMode]", "Modes that were tried.")
      .field("correlation", &F::correlation, "NoiseCorrelation",
             "Correlation of the errors in time.")
      .field("slow_error", &F::slow_error, "SlowErrorFit",
             "White, slow and common errors of the inliers, with standard errors.")
      .field("validation", &F::validation, "list[NoiseValidation]",
             "Results of the cross validation; empty without it.")
      .shown_as([](const F& self) {
        return fmt::format("<NoiseFit: {}, BIC {:.1f}>", nb::repr(nb::cast(self.noise)).c_str(),
                           self.bic);
      })
      .done()
      .def(
          "to_toml",
          [](const F& self, const std::string& name) {
            return format_noise_toml(name, self.noise);
          },
          "name"_a = "detector", "The table `[noise.NAME]` of a sequence file with all digits.");
  m.def(
      "fit_noise",
      [](const PoseArray& truth, const PoseArray& detected,
         const std::optional<ArrayLike>& recording, const std::optional<ArrayLike>& stamps,
         const std::optional<NoiseFitSettings>& settings, const Seed& seed) {
        std::vector<std::size_t> recordings(truth.size());
        if (recording) {
          const nb::object unique = nb::module_::import_("numpy").attr("unique");
          recordings =
              nb::borrow<ArrayLike>(nb::object(unique(*recording, "return_inverse"_a = true)[1]))
                  .indices();
        }
        const MaybePoses true_poses = maybe_poses(truth.rows, "truth");
        const MaybePoses detections = maybe_poses(detected.rows, "detected");
        if (true_poses.size() != recordings.size() || detections.size() != recordings.size()) {
          throw InvalidInput(fmt::format(
              "{} true poses, {} detections and {} recordings; expected as many of each",
              true_poses.size(), detections.size(), recordings.size()));
        }
        const Eigen::VectorXd seconds = stamps ? stamps->flat() : Eigen::VectorXd();
        if (stamps && static_cast<std::size_t>(seconds.size()) != recordings.size()) {
          throw InvalidInput(
              fmt::format("{} stamps and {} recordings of frames; expected as many of each",
                          seconds.size(), recordings.size()));
        }
        struct Frames {
          MaybePoses truth;
          MaybePoses detected;
          std::vector<double> stamps;
        };
        std::map<std::size_t, Frames> by_recording;
        for (std::size_t i = 0; i < recordings.size(); ++i) {
          Frames& frames = by_recording[recordings[i]];
          frames.truth.push_back(true_poses[i]);
          frames.detected.push_back(detections[i]);
          if (stamps) frames.stamps.push_back(seconds[static_cast<Eigen::Index>(i)]);
        }
        std::vector<NoiseTrack> tracks;
        for (const auto& [index, frames] : by_recording)
          tracks.push_back(noise_track(frames.truth, frames.detected, index, frames.stamps));
        const nb::gil_scoped_release unlocked;
        return fit_noise(tracks, settings.value_or(NoiseFitSettings{}), seed.stream());
      },
      "truth"_a, "detected"_a, nb::kw_only(), "recording"_a = nb::none(), "stamps"_a = nb::none(),
      "settings"_a = nb::none(), "seed"_a = 1, kFitNoiseDoc);
}

}  // namespace

void bind_noise_fit(nb::module_& m) {
  bind_noise_fit_settings(m);
  bind_correlation(m);
  bind_slow_error(m);
  bind_models(m);
  bind_fit(m);
}

}  // namespace posemix::python
