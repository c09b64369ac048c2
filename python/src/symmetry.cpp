// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/symmetry.hpp"

#include <nanobind/stl/pair.h>

#include "array_like.hpp"
#include "density.hpp"
#include "each_pose.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/slam/symmetric_error.hpp"
#include "record.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

constexpr const char* kGroupDoc =
    R"(The motions g of an object's frame after which it looks the same: X and X g are alike.

Parameters
----------
elements : SE3, shape (k,), optional
    The discrete ones; the identity may be missing.
axes : list of SymmetryAxis, optional
    Lines about which any rotation changes nothing.
tolerance : SymmetryTolerance, optional
    Within which two motions count as one.

Raises
------
ValueError
    Naming two elements whose product is missing, an element that moves an axis, or two axes
    without a common point.

References
----------
Hodan et al., BOP Challenge 2020, section 2.2.

Examples
--------
>>> import numpy as np
>>> from posemix import SE3, SO3, SymmetryGroup
>>> box = SymmetryGroup(SE3(SO3.exp([[0, 0, np.pi]])))
>>> turned = box.closest(SE3(SO3.exp([0, 0, 3.0])), SE3(), np.eye(6))
>>> round(float(turned.rotation.log()[2]), 4)
-0.1416
)";

/// The nearest equivalent poses by SymmetryGroup::closest or ::closest_observed.
template <SE3d (SymmetryGroup::*kClosest)(const SE3d&, const SE3d&, const Matrix6d&) const>
PoseArray closest(const SymmetryGroup& group, const PoseArray& poses, const PoseArray& references,
                  const Matrix6d& information) {
  return each_pose(poses, references, [&](const SE3d& pose, const SE3d& reference) {
    return (group.*kClosest)(pose, reference, information);
  });
}

SymmetryGroup group_of_entry(const nb::dict& entry) {
  nb::dict models;
  models["1"] = entry;
  const nb::object text = nb::module_::import_("json").attr("dumps")(models);
  return parse_bop_model(nb::cast<std::string>(text), "models_info entry", 1).symmetries;
}

SymmetryGroup make_group(const std::optional<PoseArray>& elements,
                         const std::vector<SymmetryAxis>& axes,
                         const SymmetryTolerance& tolerance) {
  return SymmetryGroup(elements ? elements->poses() : std::vector<SE3d>{}, axes, tolerance);
}

void bind_axis(nb::module_& m) {
  Settings<SymmetryAxis>(m, "SymmetryAxis",
                         "The object looks the same turned by any angle about this line.")
      .field("direction", &SymmetryAxis::direction, "numpy.typing.ArrayLike",
             "Shape (3,), object frame, any length but zero.")
      .field("point", &SymmetryAxis::point, "numpy.typing.ArrayLike",
             "Shape (3,), on the axis, object frame [m].")
      .done();
  Settings<SymmetryTolerance>(m, "SymmetryTolerance",
                              "Within which two motions count as the same one.")
      .field("rotation_rad", &SymmetryTolerance::rotation_rad, "float", "Angle between them [rad].")
      .field("translation_m", &SymmetryTolerance::translation_m, "float",
             "Distance of their translations [m].")
      .done();
}

void bind_queries(nb::class_<SymmetryGroup>& group) {
  using S = SymmetryGroup;
  group.def_prop_ro(
      "elements", [](const S& self) { return PoseArray::of(self.elements()); }, nb::rv_policy::move,
      "The discrete motions, shape (k,); the first is the identity.");
  group.def_prop_ro(
      "axes", [](const S& self) { return frozen(self.axes()); },
      nb::for_getter(nb::sig("def axes(self, /) -> collections.abc.Sequence[SymmetryAxis]")),
      "Copies of the axes, which cannot be changed.");
  group.def_prop_ro("is_trivial", &S::is_trivial, "Whether the identity is the only motion.");
  group.def(
      "closest", &closest<&S::closest>, "pose"_a, "reference"_a, "information"_a,
      "The equivalent poses X g nearest to a reference.\n\n"
      "Parameters\n----------\npose : SE3, shape (...)\n    Poses X.\n"
      "reference : SE3, shape (...) or ()\n    One per pose, or one for all.\n"
      "information : array_like, shape (6, 6)\n"
      "    Of z = Log((X g)^-1 reference), along the object's own axes, positive definite. Turns\n"
      "    about axes are found by a local search, which for errors of rotation above about\n"
      "    0.5 rad may end at another minimum.\n");
  group.def(
      "closest_observed", &closest<&S::closest_observed>, "pose"_a, "reference"_a, "information"_a,
      "Of the equivalent poses X g whose error leaves no rotation about the axes, the nearest.\n\n"
      "For how far an error is from nothing: of closest() a wrong pose would be nearer, because "
      "in\n"
      "Log a turn by a large angle turns a translation, too, to where the information is least.\n\n"
      "Parameters\n----------\npose : SE3, shape (...)\n    Poses X.\n"
      "reference : SE3, shape (...) or ()\n    One per pose, or one for all.\n"
      "information : array_like, shape (6, 6)\n"
      "    Of z = Log((X g)^-1 reference), along the object's own axes: the inverse of a "
      "covariance\n"
      "    that has unobserved_covariance().\n");
  group.def(
      "unobserved_covariance",
      [](const S& self) { return matrix_array(self.unobserved_covariance()); },
      "Covariance of the part of a pose that no detection observes, shape (6, 6), along the "
      "object's own axes.");
}

void bind_group(nb::module_& m) {
  using S = SymmetryGroup;
  nb::class_<S> group(m, "SymmetryGroup", kGroupDoc);
  group.def(
      "__init__",
      [](S* self, const std::optional<PoseArray>& elements, const std::vector<SymmetryAxis>& axes,
         const std::optional<SymmetryTolerance>& tolerance) {
        new (self) S(make_group(elements, axes, tolerance.value_or(SymmetryTolerance{})));
      },
      "elements"_a = nb::none(), "axes"_a = nb::tuple(), "tolerance"_a = nb::none());
  group.def_static(
      "turns",
      [](nb::handle axis, int fold) {
        return S::turns(SettingValue<Eigen::Vector3d>::set(axis, "axis"), fold);
      },
      "axis"_a, "fold"_a,
      "Rotations about an axis through the object's origin.\n\n"
      "Parameters\n----------\naxis : array_like, shape (3,)\n"
      "    Direction, object frame.\n"
      "fold : int\n    By multiples of a turn / fold; 0: by any angle.\n");
  group.def_static("from_bop", &group_of_entry, "entry"_a,
                   "The group of one entry of BOP's models_info.json, as json reads it.\n\n"
                   "Discrete times continuous; lengths in millimetres become metres.\n");
  bind_queries(group);
  group.def("__getstate__", [](const S& self) {
    return nb::make_tuple(PoseArray::of(self.elements()), self.axes());
  });
  group.def("__setstate__",
            [](S& self, const std::pair<PoseArray, std::vector<SymmetryAxis>>& state) {
              new (&self) S(S::from_stored(state.first.poses(), state.second));
            });
  group.def(
      "__eq__",
      [](const S& self, nb::handle other) {
        if (!nb::isinstance<S>(other)) return false;
        const S& that = *nb::inst_ptr<S>(other);
        return std::ranges::equal(self.elements(), that.elements(), SettingValue<SE3d>::same) &&
               nb::cast(self.axes()).equal(nb::cast(that.axes()));
      },
      nb::sig("def __eq__(self, other: object, /) -> bool"));
  group.def("__repr__", [](const S& self) {
    return fmt::format("<SymmetryGroup of {} motions and {} axes>", self.elements().size(),
                       self.axes().size());
  });
  group.attr("__hash__") = nb::none();
}

constexpr const char* kErrorDoc =
    R"(The error of an estimate against the nearest of the equivalent true poses.

Parameters
----------
estimate, truth : SE3
    One pose each.
symmetries : SymmetryGroup
    Symmetries of the object.
length_m : float
    Length in rotation^2 + (translation / length_m)^2, which the nearest pose minimises [m]. Turns about axes are found
    by a local search, which for errors of rotation above about 0.5 rad may end at another minimum.
)";

constexpr const char* kSurfaceDoc =
    R"(The maximum symmetry-aware surface distance of the BOP benchmark [m].

Parameters
----------
estimate, truth : SE3
    One pose each.
points : array_like, shape (n, 3)
    Points of the object's surface, in the object's frame [m].
symmetries : SymmetryGroup
    Symmetries of the object.

Raises
------
ValueError
    Without points.

References
----------
Hodan et al., BOP Challenge 2020, eq. 2.
)";

void bind_symmetric_errors(nb::module_& m) {
  using E = SymmetricPoseError;
  Record<E>(m, "SymmetricPoseError", "Difference of two poses of an object with symmetries.")
      .field("rotation_rad", &E::rotation_rad, "float", "Angle between the rotations [rad].")
      .field("translation_m", &E::translation_m, "float", "Distance of the positions [m].")
      .done();
  m.def("symmetric_pose_error", &symmetric_pose_error, "estimate"_a, "truth"_a, "symmetries"_a,
        "length_m"_a = 0.1, kErrorDoc);
  m.def(
      "max_symmetric_surface_distance",
      [](const SE3d& estimate, const SE3d& truth, const ArrayLike& points,
         const SymmetryGroup& group) {
        const ShapedRows given(points, 3, "points");
        std::vector<Eigen::Vector3d> all;
        for (std::size_t i = 0; i < given.rows.shape(0); ++i)
          all.emplace_back(Eigen::Map<const Eigen::Vector3d>(given.rows.data() + 3 * i));
        const nb::gil_scoped_release unlocked;
        return max_symmetric_surface_distance(estimate, truth, all, group);
      },
      "estimate"_a, "truth"_a, "points"_a, "symmetries"_a, kSurfaceDoc);
}

}  // namespace

void bind_symmetry(nb::module_& m) {
  bind_axis(m);
  bind_group(m);
  bind_symmetric_errors(m);
}

}  // namespace posemix::python
