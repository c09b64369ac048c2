// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "posemix/config/symmetries.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
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
  Settings<C>(m, "MixtureConvention", "How a mixture file states what the library holds.")
      .field("side", &C::side, "Side", "Of concentrated Gaussians only.")
      .field("order", &C::order, "TangentOrder", "Of tangent vectors.")
      .field("angle", &C::angle, "AngleUnit", "Of concentrated Gaussians only.")
      .field("length", &C::length, "LengthUnit", "Of translations.")
      .done();
}

void bind_mixtures(nb::module_& m) {
  bind_conventions(m);
  m.def("read_mixture", [](const fs::path& path) {
    MixtureFile file = read_mixture(path);
    return nb::make_tuple(file.frames.from, file.frames.to, std::move(file.mixture));
  });
  m.def("write_mixture", [](const fs::path& path, const std::string& from, const std::string& to,
                            const AnyMixture& mixture, const MixtureConvention& convention) {
    write_output_file(path, format_mixture({{from, to}, mixture}, convention));
  });
  nb::enum_<PoseKind>(m, "PoseKind", "What a pose of a joint density is.")
      .value("camera", PoseKind::camera, "T_world_camera.")
      .value("camera_motion", PoseKind::camera_motion, "T_camera_camera over one period.")
      .value("object", PoseKind::object, "T_world_object.");
  Record<NamedPose>(m, "NamedPose", "A pose of a joint density by name.")
      .field("name", &NamedPose::name, "str", "Name; of an object its id.")
      .field("kind", &NamedPose::kind, "PoseKind", "What it is.")
      .done()
      .def(nb::init<std::string, PoseKind>(), "name"_a, "kind"_a);
  m.def("read_posterior", [](const fs::path& path) {
    PosteriorFile file = read_posterior(path);
    return nb::make_tuple(file.method, file.stamp, file.poses, std::move(file.mixture));
  });
  m.def("write_posterior", [](const fs::path& path, const std::string& method, double stamp,
                              const std::vector<NamedPose>& poses, const Posterior& mixture) {
    write_output_file(path, format_posterior({method, stamp, poses, mixture}));
  });
}

void bind_tum(nb::module_& m) {
  m.def("read_tum", [](const fs::path& path, bool allow_misses, bool zero_translation_is_miss) {
    const std::vector<StampedPose> frames =
        read_tum(path, {allow_misses, zero_translation_is_miss});
    NewArray stamps({frames.size()});
    MaybePoses poses;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      stamps.data[i] = frames[i].stamp;
      poses.push_back(frames[i].pose);
    }
    return nb::make_tuple(std::move(stamps.array), rows_of(poses));
  });
  m.def("write_tum",
        [](const fs::path& path, const Numbers& stamps, const Rows& rows, bool misses_as_zeros) {
          const MaybePoses poses = maybe_poses(rows, "poses");
          if (poses.size() != stamps.shape(0)) {
            throw InvalidInput(fmt::format("{} stamps and {} poses; expected as many of both",
                                           stamps.shape(0), poses.size()));
          }
          std::vector<StampedPose> frames;
          for (std::size_t i = 0; i < poses.size(); ++i)
            frames.push_back({stamps.data()[i], poses[i]});
          const auto misses = misses_as_zeros ? TumMisses::write_zeros : TumMisses::leave_out;
          write_output_file(path, format_tum(frames, misses));
        });
}

void bind_bop_models(nb::module_& m) {
  using B = ObjectBox;
  constexpr const char* kArray = "numpy.typing.NDArray[numpy.float64]";
  Record<B>(m, "ObjectBox", "An axis-aligned box in the object's frame.")
      .field("lowest_m", &B::lowest_m, kArray, "Shape (3,), the lowest corner [m].")
      .field("size_m", &B::size_m, kArray, "Shape (3,), the edges [m].")
      .done()
      .def(
          "corners",
          [](const B& self) {
            NewArray out({8, 3});
            double* row = out.data;
            for (const Eigen::Vector3d& corner : self.corners()) {
              std::copy(corner.begin(), corner.end(), row);
              row += 3;
            }
            return std::move(out.array);
          },
          "The corners, shape (8, 3) [m].");
  using M = BopModel;
  Record<M>(m, "BopModel", "One entry of models_info.json.")
      .field("diameter_m", &M::diameter_m, "float", "The largest distance of two vertices [m].")
      .field("symmetries", &M::symmetries, "SymmetryGroup", "Discrete times continuous.")
      .field("box", &M::box, "ObjectBox | None", "The box, where the entry has one.")
      .done();
  m.def("read_bop_models", &read_bop_models, "path"_a,
        "BOP's models_info.json by object id; ValueError names the file and the entry.");
  m.def("read_bop_model", &read_bop_model, "path"_a, "object"_a,
        "One entry of models_info.json; what is wrong with the others does not matter.");
}

void bind_bop(nb::module_& m) {
  m.def("read_bop_rows", [](const fs::path& path) {
    const std::vector<BopRow> rows = read_bop_rows(path);
    std::vector<SE3d> poses;
    for (const BopRow& row : rows) poses.push_back(row.pose);
    const nb::list keys = list_of(rows, [](const BopRow& row) {
      return nb::make_tuple(row.scene, row.image, row.object, row.score);
    });
    return nb::make_tuple(keys, PoseArray::of(poses));
  });
  bind_bop_models(m);
  m.def("read_symmetry_file", &read_symmetry_file, "path"_a,
        "Symmetries by object id: a TOML file with tables ``[symmetries.ID]``, or "
        "models_info.json.");
}

void bind_pose_files(nb::module_& m) {
  m.def(
      "read_object_poses", [](const fs::path& path) { return read_object_poses(path); }, "path"_a,
      "Static poses T_world_object by id: lines ``id tx ty tz qx qy qz qw``.");
  m.def(
      "write_object_poses",
      [](const fs::path& path, const std::map<std::string, SE3d>& poses) {
        write_output_file(path, format_object_poses(poses));
      },
      "path"_a, "poses"_a, "Static poses T_world_object by id, 12 significant digits.");
  m.def(
      "read_pose_samples",
      [](const fs::path& path, const std::optional<Side>& residuals,
         const std::optional<std::string>& weights) {
        const std::optional<PoseFormat> format = pose_format_of(path.string());
        if (!format)
          throw InvalidInput(path.string() + ": expected a name in .csv, .npy, .tum or .txt");
        const PoseSamples samples =
            parse_pose_samples(read_file(path), path.string(), *format, {residuals, weights});
        return nb::make_tuple(PoseArray::of(samples.poses), samples.weights);
      },
      "path"_a, "residuals"_a.none(), "weights"_a.none());
  m.def(
      "write_poses",
      [](const fs::path& path, const PoseArray& poses) {
        const std::optional<PoseFormat> format = pose_format_of(path.string());
        if (!format)
          throw InvalidInput(path.string() + ": expected a name in .csv, .npy, .tum or .txt");
        const std::vector<SE3d> all = poses.poses();
        write_output_file(path, format_poses(all, *format));
      },
      "path"_a, "poses"_a,
      "Poses in the format that the file's name says: .csv, .npy, .tum or .txt.");
}

void bind_outcomes(nb::module_& m) {
  using T = GraspTrial;
  Record<T>(
      m, "GraspTrial",
      "One estimate of an object in one image, and what became of the grasps planned with it.")
      .field("dataset", &T::dataset, "str", "Name of the data set.")
      .field("estimator", &T::estimator, "str", "Name of the estimator.")
      .field("scene", &T::scene, "int", "Id of the scene.")
      .field("image", &T::image, "int", "Id of the image.")
      .field("object", &T::object, "int", "Id of the object.")
      .field("score", &T::score, "float", "The estimator's own confidence.")
      .field("estimate", &T::estimate, "posemix.lie.SE3", "T_camera_object as estimated.")
      .field("truth", &T::truth, "posemix.lie.SE3", "True T_camera_object.")
      .field("outcomes", &T::outcomes, "list[bool | None]",
             "Success of the grasp, one entry per gripper; None where it was not tried.")
      .done();
  m.def("read_grasp_outcomes", [](const fs::path& folder) {
    const GraspOutcomes outcomes = read_grasp_outcomes(folder);
    std::vector<SE3d> estimates;
    std::vector<SE3d> truths;
    for (const GraspTrial& trial : outcomes.trials) {
      estimates.push_back(trial.estimate);
      truths.push_back(trial.truth);
    }
    return nb::make_tuple(outcomes.grippers, outcomes.trials, PoseArray::of(estimates),
                          PoseArray::of(truths));
  });
}

}  // namespace

void bind_files(nb::module_& m) {
  nb::register_exception_translator([](const std::exception_ptr& error, void* /*payload*/) {
    try {
      std::rethrow_exception(error);
    } catch (const OutputError& refused) {
      PyErr_SetString(PyExc_OSError, refused.what());
    }
  });
  bind_mixtures(m);
  bind_tum(m);
  bind_bop(m);
  bind_pose_files(m);
  bind_outcomes(m);
}

}  // namespace posemix::python
