// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/mixture_file.hpp"

#include <filesystem>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "files.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/posterior_file.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

namespace fs = std::filesystem;

void bind_conventions(nb::module_& m) {
  Words<Side>(m, "Side", "Side of the perturbation of concentrated Gaussians.")
      .value(Side::left, "X = Exp(xi) X0, the library's.")
      .value(Side::right, "X = X0 Exp(delta).");
  Words<TangentOrder>(m, "TangentOrder", "Order of a tangent vector's halves.")
      .value(TangentOrder::rotation_translation, "The library's.")
      .value(TangentOrder::translation_rotation, "The other.");
  Words<AngleUnit>(m, "AngleUnit", "Unit of rotations.")
      .value(AngleUnit::rad, "The library's.")
      .value(AngleUnit::deg, "Degrees.");
  Words<LengthUnit>(m, "LengthUnit", "Unit of translations.")
      .value(LengthUnit::m, "The library's.")
      .value(LengthUnit::mm, "Millimetres.");
  using C = MixtureConvention;
  Settings<C>(m, "MixtureConvention",
              "The form in which a mixture file states what the library holds.")
      .field("side", &C::side, "Side", "Side of the perturbation, for concentrated Gaussians only.")
      .field("order", &C::order, "TangentOrder", "Order of the halves of tangent vectors.")
      .field("angle", &C::angle, "AngleUnit", "Unit of rotations, for concentrated Gaussians only.")
      .field("length", &C::length, "LengthUnit", "Unit of translations.")
      .done();
}

Posterior blank_posterior() {
  const std::vector<SE3d> camera(1);
  return Posterior({{0.0, ConcentratedStack(PoseStackd(camera), Matrix6d::Identity())}});
}

/// A mixture file without its convention.
struct NamedMixture {
  std::string from_frame;
  std::string to_frame;
  AnyMixture mixture;
};

constexpr const char* kWriteMixtureDoc = R"(Writes a mixture file.

Parameters
----------
path : path
    The file.
mixture : Mixture
    Mixture over the pose T_from_to.
from_frame, to_frame : str
    Names of the frames, 1 to 100 printable characters without blanks.
convention : MixtureConvention, optional
    Convention of the file; by default that of the library, in which numbers are read back bit by bit.

Raises
------
ValueError
    For a mixture or names that a file cannot represent.
)";

void bind_mixtures(nb::module_& m) {
  bind_conventions(m);
  using F = NamedMixture;
  Record<F>(m, "MixtureFile",
            "The content of a mixture file: a mixture over the pose T_from_to, and the names of "
            "its frames.")
      .made_from([] {
        return F{{}, {}, ConcentratedPoses({{0.0, unit_density()}})};
      })
      .field("from_frame", &F::from_frame, "str", "The frame into which poses map.")
      .field("to_frame", &F::to_frame, "str", "The frame whose points poses map.")
      .field("mixture", &F::mixture,
             "posemix.mixture.Mixture[posemix.density.ConcentratedGaussian[posemix.lie.SE3]] | "
             "posemix.mixture.Mixture[posemix.density.ProjectedGaussian[posemix.lie.SE3]]",
             "The mixture over the pose.")
      .constructible(3)
      .done();
  m.def(
      "read_mixture",
      [](const fs::path& path) {
        MixtureFile file = read_mixture(path);
        warn_of_old_names(file.warnings);
        return F{file.frames.from, file.frames.to, std::move(file.mixture)};
      },
      "path"_a,
      "Reads a mixture file in any convention.\n\nA key under an old name gives a "
      "FutureWarning.\n\nRaises\n------\nValueError\n    Naming the file and the place in it.\n");
  m.def(
      "write_mixture",
      [](const fs::path& path, const AnyMixture& mixture, const std::string& from,
         const std::string& to, const std::optional<MixtureConvention>& convention) {
        write_output_file(
            path, format_mixture({{from, to}, mixture}, convention.value_or(MixtureConvention{})));
      },
      "path"_a, "mixture"_a, "from_frame"_a, "to_frame"_a, "convention"_a = nb::none(),
      kWriteMixtureDoc);
}

void bind_posteriors(nb::module_& m) {
  nb::enum_<PoseKind>(m, "PoseKind", "Meaning of a pose of a joint density.")
      .value("camera", PoseKind::camera, "T_world_camera over the frames.")
      .value("camera_motion", PoseKind::camera_motion, "T_camera_camera over one period.")
      .value("object", PoseKind::object, "T_world_object.");
  Record<NamedPose>(m, "NamedPose", "A pose of a joint density by name.")
      .field("name", &NamedPose::name, "str", "Name of the pose; for an object, its id.")
      .field("kind", &NamedPose::kind, "PoseKind", "Meaning of the pose.")
      .constructible(2)
      .done();
  using P = PosteriorFile;
  Record<P>(m, "PosteriorFile", "posterior.json: a joint mixture over camera and objects.")
      .made_from([] {
        return P{{}, 0.0, {}, blank_posterior()};
      })
      .field("method", &P::method, "str", "Display name of the method.")
      .field("stamp", &P::stamp, "float", "Time of the posterior [s].")
      .field("poses", &P::poses, "collections.abc.Sequence[NamedPose]",
             "Names of the poses, one per pose of every component.")
      .field("mixture", &P::mixture,
             "posemix.mixture.Mixture[posemix.density.ConcentratedGaussian[posemix.lie.SE3]]",
             "Joint mixture over all poses.")
      .constructible(4)
      .done();
  m.def("read_posterior", &read_posterior, "path"_a,
        "Reads a posterior.json; raises ValueError with the file and the place in it.");
  m.def(
      "write_posterior",
      [](const fs::path& path, const P& file) { write_output_file(path, format_posterior(file)); },
      "path"_a, "file"_a, "Writes a posterior.json; numbers are read back bit by bit.");
}

}  // namespace

void bind_mixture_files(nb::module_& m) {
  bind_mixtures(m);
  bind_posteriors(m);
}

}  // namespace posemix::python
