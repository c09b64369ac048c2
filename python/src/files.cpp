// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "array_like.hpp"
#include "files.hpp"
#include "posemix/config/symmetries.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
#include "record.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

namespace fs = std::filesystem;

/// A trajectory.
struct StampedPoses {
  std::vector<double> stamps;
  MaybePoses poses;
};

constexpr const char* kReadTumDoc =
    R"(Reads a trajectory in the TUM format: lines ``stamp tx ty tz qx qy qz qw``.

Parameters
----------
path : path
    The file.
allow_misses : bool
    Whether a line of seven zeros is a frame without a pose; otherwise it is an error.
zero_translation_is_miss : bool
    Whether a pose with zero translation is a frame without a pose too.

Raises
------
ValueError
    With file and line.
)";

constexpr const char* kWriteTumDoc =
    R"(Writes a trajectory in the TUM format, with 12 significant digits.

Parameters
----------
path : path
    The file.
stamps : array_like, shape (n,)
    Times, strictly increasing [s].
poses : SE3, shape (n,)
    Poses; NaN for a frame without a pose.
misses_as_zeros : bool
    Whether frames without a pose become lines of zeros; otherwise they are left out.

Raises
------
ValueError
    Naming the row, for stamps that `read_tum` would refuse.
)";

void bind_tum(nb::module_& m) {
  using S = StampedPoses;
  Record<S>(m, "StampedPoses", "Poses with time stamps.")
      .field<NumbersAsArray>("stamps", &S::stamps, kFloatArray,
                             "Shape (n,), strictly increasing [s].")
      .field("poses", &S::poses, "posemix.lie.SE3",
             "Shape (n,): T_a_b of the file's two frames; NaN for a miss, see `is_known`.",
             [](const S& self) {
               return PoseArray::of(rows_of(self.poses), {self.poses.size()}).made;
             })
      .constructible(2)
      .done()
      .def("__len__", [](const S& self) { return self.stamps.size(); });
  m.def(
      "read_tum",
      [](const fs::path& path, bool allow_misses, bool zero_translation_is_miss) {
        S read;
        for (const StampedPose& frame : read_tum(path, {allow_misses, zero_translation_is_miss})) {
          read.stamps.push_back(frame.stamp);
          read.poses.push_back(frame.pose);
        }
        return read;
      },
      "path"_a, "allow_misses"_a = false, "zero_translation_is_miss"_a = false, kReadTumDoc);
  m.def(
      "write_tum",
      [](const fs::path& path, const ArrayLike& stamps, const PoseArray& rows,
         bool misses_as_zeros) {
        const Eigen::VectorXd times = stamps.as<Eigen::VectorXd>("stamps");
        const MaybePoses poses = maybe_poses(rows.rows, "poses");
        if (times.size() != std::ssize(poses)) {
          throw InvalidInput(fmt::format("{} stamps and {} poses; expected as many of both",
                                         times.size(), poses.size()));
        }
        std::vector<StampedPose> frames;
        for (std::size_t i = 0; i < poses.size(); ++i)
          frames.push_back({times[static_cast<Eigen::Index>(i)], poses[i]});
        const auto misses = misses_as_zeros ? TumMisses::write_zeros : TumMisses::leave_out;
        write_output_file(path, format_tum(frames, misses));
      },
      "path"_a, "stamps"_a, "poses"_a, "misses_as_zeros"_a = false, kWriteTumDoc);
}

void bind_bop_models(nb::module_& m) {
  using B = ObjectBox;
  Record<B>(m, "ObjectBox", "An axis-aligned box in the object's frame.")
      .field("lowest_m", &B::lowest_m, kFloatArray, "Shape (3,), the lowest corner [m].")
      .field("size_m", &B::size_m, kFloatArray, "Shape (3,), the edges [m].")
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
    std::array<std::vector<std::int64_t>, 3> ids;
    std::vector<double> scores;
    std::vector<SE3d> poses;
    for (const BopRow& row : read_bop_rows(path)) {
      ids[0].push_back(row.scene);
      ids[1].push_back(row.image);
      ids[2].push_back(row.object);
      scores.push_back(row.score);
      poses.push_back(row.pose);
    }
    return nb::make_tuple(ids, NumbersAsArray::get(scores), PoseArray::of(poses));
  });
  bind_bop_models(m);
  m.def("read_symmetry_file", &read_symmetry_file, "path"_a,
        "Symmetries by object id: a TOML file with tables ``[symmetries.ID]``, or "
        "models_info.json.");
}

PoseFormat format_of(const fs::path& path) {
  if (const auto format = pose_format_of(path.string())) return *format;
  throw InvalidInput(path.string() + ": expected a name in .csv, .npy, .tum or .txt");
}

constexpr const char* kReadSamplesDoc = R"(Reads the poses of a .csv, .npy, .tum or .txt file.

Parameters
----------
path : path
    The file.
residuals : Side, optional
    Side of residuals of estimates ``est_tx`` ... with respect to truths ``gt_tx`` ... of a CSV file, which are read
instead of poses.
weights : str, optional
    Column of the weights of a CSV file; by default ``weight``, if there is such a column.

Raises
------
ValueError
    With file and line.
)";

void bind_pose_files(nb::module_& m) {
  using P = PoseSamples;
  Record<P>(m, "PoseSamples", "Poses with weights.")
      .field("poses", &P::poses, "posemix.lie.SE3", "Samples, shape (n,).")
      .field("weights", &P::weights, "numpy.typing.NDArray[numpy.float64] | None",
             "Shape (n,); None: all count the same.",
             [](const P& self) -> nb::object {
               if (self.weights.empty()) return nb::none();
               return NumbersAsArray::get(self.weights);
             })
      .done();
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
        return parse_pose_samples(read_file(path), path.string(), format_of(path),
                                  {residuals, weights});
      },
      "path"_a, "residuals"_a = nb::none(), "weights"_a = nb::none(), kReadSamplesDoc);
  m.def(
      "write_poses",
      [](const fs::path& path, const PoseArray& poses) {
        write_output_file(path, format_poses(poses.poses(), format_of(path)));
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
  using O = GraspOutcomes;
  const auto poses_of = [](SE3d T::*member) {
    return [member](const O& self) {
      std::vector<SE3d> poses;
      for (const T& trial : self.trials) poses.push_back(trial.*member);
      return PoseArray::of(poses);
    };
  };
  Record<O>(m, "GraspOutcomes", "Grasp trials with the estimates of several estimators.")
      .field("grippers", &O::grippers, "list[str]", "Names.")
      .field("trials", &O::trials, "list[GraspTrial]", "Rows of the tables.")
      .done()
      .def_prop_ro("estimates", poses_of(&T::estimate),
                   "T_camera_object of every trial, shape (n,).")
      .def_prop_ro("truths", poses_of(&T::truth), "True T_camera_object of every trial.");
  m.def("read_grasp_outcomes", &read_grasp_outcomes, "folder"_a,
        "Reads all tables ``DATASET_ESTIMATOR.csv`` of a folder; raises ValueError with file and "
        "line.");
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
  bind_tum(m);
  bind_bop(m);
  bind_observation_files(m);
  bind_pose_files(m);
  bind_outcomes(m);
}

}  // namespace posemix::python
