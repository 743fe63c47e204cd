#pragma once

#include <Eigen/Core>

namespace fascia {

// Displacements of points in frames as sums of a few fields: D ≈ offset + fields · weights.
struct DisplacementBasis {
  Eigen::VectorXd offset;   // 3 points, in the unit of the displacements; the same in all frames
  Eigen::MatrixXd fields;   // 3 points x K
  Eigen::MatrixXd weights;  // K x frames
};

// The mean of the frames, and principal components around it by the frames' Gram matrix (the
// "method of snapshots", Sirovich 1987): no other K fields leave less. At most `most`; fewer if the
// RMS over all points and frames falls to `tolerance`, or if the displacements have a lower rank.
// Takes the mean out of `displacements`; so do the functions below expect them.
DisplacementBasis principalFields(Eigen::MatrixXf& displacements, int most, double tolerance);

// Turns the fields among each other so that every point is moved by few of them (quartimax on the
// lengths per point, Neuhaus & Wrigley 1954): what they span, and so their error, stays.
void localizeFields(DisplacementBasis& basis);

// Moves the smallest weight of every field to 0, by way of the offset, and the largest to 1.
void normalizeWeights(DisplacementBasis& basis);

// Takes displacements shorter than `share` of the largest out of the offset and of the fields, as
// weighted by the largest weight, and fits what is left to the displacements again: fields against
// weights, alternating (as Neumann et al. 2013 do, but with a fixed set of entries).
void sparsifyFields(const Eigen::MatrixXf& displacements, double share, DisplacementBasis& basis);

}  // namespace fascia
