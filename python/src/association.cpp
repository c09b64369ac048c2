// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/association.hpp"

#include "array_like.hpp"
#include "record.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

constexpr const char* kAssociateDoc =
    R"(The one-to-one assignment of candidates to instances of their class with the least cost.

Parameters
----------
instances : sequence of ConcentratedGaussian
    Predicted T_camera_object of the instances.
candidates : sequence of Candidate
    Candidates of one class in one frame.
noise : NoiseComponent
    Noise of the detector for this class.
symmetries : SymmetryGroup, optional
    Symmetries of the class.
settings : AssociationSettings, optional
    Gate, and criterion for a new instance.

Raises
------
ValueError
    When a probability is not in (0, 1).
)";

constexpr const char* kAssignmentDoc =
    R"(A different column for each row of a cost matrix such that the sum of the entries is least.

Parameters
----------
cost : array_like, shape (rows, columns)
    Costs, finite, with at least as many columns as rows.

Examples
--------
>>> from posemix import least_cost_assignment
>>> least_cost_assignment([[1, 2], [1, 4]])
[1, 0]
)";

}  // namespace

void bind_association(nb::module_& m) {
  using A = Association;
  Record<A>(m, "Association", "Result of the association of one candidate.")
      .field("status", &A::status, "CandidateStatus",
             "Whether it is assigned to an instance, fresh, or rejected.")
      .field("instance", &A::instance, "int", "Index among the instances, if assigned.")
      .field("camera_object", &A::camera_object, "posemix.lie.SE3",
             "The equivalent pose nearest to the instance, if assigned; otherwise the pose as "
             "detected.")
      .field("cost", &A::cost, "float", "Part of the total cost, if assigned.")
      .done();
  m.def(
      "associate",
      [](const std::vector<ConcentratedSE3>& instances, const std::vector<Candidate>& candidates,
         const NoiseComponent& noise, const std::optional<SymmetryGroup>& symmetries,
         const std::optional<AssociationSettings>& settings) {
        return associate(instances, candidates, noise, symmetries.value_or(SymmetryGroup{}),
                         settings.value_or(AssociationSettings{}));
      },
      "instances"_a, "candidates"_a, "noise"_a, "symmetries"_a = nb::none(),
      "settings"_a = nb::none(), kAssociateDoc);
  m.def(
      "least_cost_assignment",
      [](const ArrayLike& cost) { return least_cost_assignment(cost.as<Eigen::MatrixXd>("cost")); },
      "cost"_a, kAssignmentDoc);
}

}  // namespace posemix::python
