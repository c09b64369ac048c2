// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_fit.hpp"

#include <map>

#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include "posemix/config/noise_toml.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_noise_fit_settings(nb::module_& m) {
  Words<NoiseCriterion>(m, "NoiseCriterion", "What decides between noise models.")
      .value(NoiseCriterion::bic, "The least BIC, with all detections taken for independent.")
      .value(NoiseCriterion::bic_independent_frames,
             "The least BIC, with correlated detections counted as fewer.")
      .value(NoiseCriterion::cross_validation,
             "The greatest log density of recordings that were held out.");
  using M = NoiseModeSettings;
  Settings<M>(m, "NoiseModeSettings",
              "Which clusters of wrong poses become modes of a noise model.")
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
             "Without modes; models of 1, 2, ... components are fitted.")
      .field("restarts", &S::restarts, "int", "Starts of EM for every number of components.")
      .field("frame", &S::frame, "NoiseFrame | None", "Axes of the covariances; chosen where None.")
      .field("full_covariance", &S::full_covariance, "bool", "Else covariances are diagonal.")
      .field("free_means", &S::free_means, "bool",
             "All components may have offsets; for the object's frame without clutter.")
      .field("clutter", &S::clutter, "bool", "Models have clutter, whose weight is estimated.")
      .field("clutter_volume_m3", &S::clutter_volume_m3, "float", "Its volume [m^3].")
      .field("least_clutter", &S::least_clutter, "float", "Its least weight.")
      .field("modes", &S::modes, "bool", "Modes are looked for; needs clutter.")
      .field("mode", &S::mode, "NoiseModeSettings", "Which clusters become modes.")
      .field("criterion", &S::criterion, "NoiseCriterion", "What decides between models.")
      .field("folds", &S::folds, "int", "Of the cross validation; none where below two.")
      .field("max_rotation_sd_deg", &S::max_rotation_sd_deg, "float", "Bound of a component [deg].")
      .field("max_translation_sd_m", &S::max_translation_sd_m, "float",
             "Bound of a component [m, or fraction of the range].")
      .done();
}

void bind_correlation(nb::module_& m) {
  using D = DependentFrames;
  nb::class_<D>(m, "DependentFrames", "Number of frames that count as one independent frame.")
      .def_ro("about_zero", &D::about_zero,
              "For whole recordings, whose common error counts; at least 1.")
      .def_ro("within", &D::within, "For errors about the mean of each recording; at least 1.");
  using C = NoiseCorrelation;
  nb::class_<C>(m, "NoiseCorrelation", "Correlation in time of the errors of a detector.")
      .def_ro("inliers", &C::inliers, "Number of detections within the gate.")
      .def_ro("inlier", &C::inlier, "Of the whitened residuals of inliers, over all axes.")
      .def_ro("axes", &C::axes, "The same by axis.")
      .def_ro("bias_sd", &C::bias_sd,
              "Shape (6,): standard deviation of the error that a recording has in common [rad, m "
              "or fraction of the range].")
      .def_ro("outlier_share", &C::outlier_share, "Share of detections beyond the gate.")
      .def_ro("outlier_run", &C::outlier_run, "Mean length of a run of outliers [detections].")
      .def_ro("outlier", &C::outlier, "Of the indicator of outliers, about its mean.");
}

void bind_models(nb::module_& m) {
  using M = NoiseMode;
  nb::class_<M>(m, "NoiseMode", "A cluster of wrong poses.")
      .def_ro("offset", &M::offset, "T_object_mode.")
      .def_ro("weight", &M::weight, "Share of the detections.")
      .def_ro("recordings", &M::recordings, "Effective number of recordings that have it.")
      .def_ro("rotation_sd_deg", &M::rotation_sd_deg, "About the axis about which it is widest.")
      .def_ro("accepted", &M::accepted, "Whether it fulfils the settings.");
  using F = NoiseEmFit;
  nb::class_<F>(m, "NoiseEmFit", "A noise model with a given number of components.")
      .def_ro("noise", &F::noise, "The model, without its dependence.")
      .def_ro("log_likelihood", &F::log_likelihood, "Sum over the detections [nats].")
      .def_ro("history", &F::history, "Log-likelihood of the start and after every step.")
      .def_ro("status", &F::status, "How EM ended.")
      .def_ro("parameters", &F::parameters, "Number of free parameters.")
      .def_ro("bic", &F::bic, "parameters log(detections) - 2 log_likelihood.");
  using V = NoiseValidation;
  nb::class_<V>(m, "NoiseValidation",
                "How well a kind of model predicts detections that it was not fitted to.")
      .def_ro("frame", &V::frame, "Axes of the covariances.")
      .def_ro("clutter", &V::clutter, "Whether the models have clutter.")
      .def_ro("components", &V::components, "Number of components.")
      .def_ro("log_density", &V::log_density, "Mean per detection [nats].")
      .def_ro("by_fold", &V::by_fold, "The same by fold.")
      .def_ro("below_best", &V::below_best, "Difference to the best of all kinds [nats].")
      .def_ro("standard_error", &V::standard_error, "Of that difference.");
}

void bind_fit(nb::module_& m) {
  using F = NoiseFit;
  nb::class_<F>(m, "NoiseFit", "A noise model, and how it was found; see `fit_noise`.")
      .def_ro("noise", &F::noise, "The chosen model, with its dependence.")
      .def_ro("frame", &F::frame, "Axes of its covariances.")
      .def_ro("log_likelihood", &F::log_likelihood, "Sum over the detections [nats].")
      .def_ro("parameters", &F::parameters, "Number of free parameters.")
      .def_ro("bic", &F::bic, "parameters log(detections) - 2 log_likelihood.")
      .def_ro("fits", &F::fits,
              "The models in the frame with 1, 2, ... components, then the one with modes.")
      .def_ro("chosen", &F::chosen, "Index of the chosen model in `fits`.")
      .def_ro("dependent_frames", &F::dependent_frames,
              "Number of detections that count as one: median over the coordinates.")
      .def_ro("modes", &F::modes, "Modes that were tried.")
      .def_ro("correlation", &F::correlation, "Correlation of the errors in time.")
      .def_ro("validation", &F::validation, "Empty without cross validation.")
      .def(
          "to_toml",
          [](const F& self, const std::string& name) {
            return format_noise_toml(name, self.noise);
          },
          "name"_a = "detector", "The table `[noise.NAME]` of a sequence file with all digits.")
      .def("__repr__", [](const F& self) {
        return fmt::format("<NoiseFit: {}, BIC {:.1f}>", nb::repr(nb::cast(self.noise)).c_str(),
                           self.bic);
      });
  m.def("fit_noise", [](const PoseArray& truth, const PoseArray& detected,
                        const std::vector<std::size_t>& recording, const NoiseFitSettings& settings,
                        RandomStream& stream) {
    const MaybePoses true_poses = maybe_poses(truth.rows, "truth");
    const MaybePoses detections = maybe_poses(detected.rows, "detected");
    if (true_poses.size() != recording.size() || detections.size() != recording.size()) {
      throw InvalidInput(
          fmt::format("{} true poses, {} detections and {} recordings; expected as many of each",
                      true_poses.size(), detections.size(), recording.size()));
    }
    std::map<std::size_t, std::pair<MaybePoses, MaybePoses>> by_recording;
    for (std::size_t i = 0; i < recording.size(); ++i) {
      by_recording[recording[i]].first.push_back(true_poses[i]);
      by_recording[recording[i]].second.push_back(detections[i]);
    }
    std::vector<NoiseTrack> tracks;
    for (const auto& [index, poses] : by_recording)
      tracks.push_back(noise_track(poses.first, poses.second, index));
    const nb::gil_scoped_release unlocked;
    return fit_noise(tracks, settings, stream);
  });
}

void bind_odometry(nb::module_& m) {
  using S = OdometryNoiseSettings;
  Settings<S>(m, "OdometryNoiseSettings", "Settings of `fit_odometry_noise`.")
      .field("windows_s", &S::windows_s, "list[float]", "Lengths of the windows [s].")
      .field("bootstrap", &S::bootstrap, "int", "Samples of recordings for the standard errors.")
      .field("seed", &S::seed, "int", "Of these samples.")
      .done();
  using W = OdometryWindow;
  nb::class_<W>(m, "OdometryWindow", "The error of the relative pose over windows of one length.")
      .def_ro("seconds", &W::seconds, "Length.")
      .def_ro("independent", &W::independent, "Number of windows that do not overlap.")
      .def_ro("variance", &W::variance, "Shape (6,) [rad^2, m^2], axes of the camera at the end.")
      .def_ro("fitted", &W::fitted, "Shape (6,): the variance by the fitted model.");
  using O = OdometryNoise;
  nb::class_<O>(m, "OdometryNoise", "The noise of odometry, along the axes of the camera.")
      .def_ro("sd_per_sqrt_s", &O::sd_per_sqrt_s,
              "Shape (6,): random walk, per square root of a second [rad, m].")
      .def_ro("jitter_sd", &O::jitter_sd, "Shape (6,): white jitter of the truth [rad, m].")
      .def_ro("sd_per_sqrt_s_error", &O::sd_per_sqrt_s_error,
              "Shape (6,): standard error; NaN for fewer than two recordings.")
      .def_ro("jitter_sd_error", &O::jitter_sd_error, "Shape (6,): standard error.")
      .def_ro("windows", &O::windows, "Windows of all lengths.")
      .def_ro("recordings", &O::recordings, "Number of recordings.")
      .def(
          "to_toml", [](const O& self) { return format_odometry_toml(self); },
          "The table `[motion]` of a sequence file, with comments.");
  m.def("fit_odometry_noise", [](const std::vector<std::tuple<Numbers, Rows, Rows>>& recordings,
                                 const OdometryNoiseSettings& settings) {
    std::vector<OdometryRecording> all;
    for (const auto& [stamps, odometry, truth] : recordings) {
      all.push_back({std::to_string(all.size()),
                     {stamps.data(), stamps.data() + stamps.shape(0)},
                     maybe_poses(odometry, "odometry"),
                     maybe_poses(truth, "camera_truth")});
    }
    const nb::gil_scoped_release unlocked;
    return fit_odometry_noise(all, settings);
  });
}

}  // namespace

void bind_noise_fit(nb::module_& m) {
  bind_noise_fit_settings(m);
  bind_correlation(m);
  bind_models(m);
  bind_fit(m);
  bind_odometry(m);
}

}  // namespace posemix::python
