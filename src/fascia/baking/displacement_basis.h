#pragma once

#include <Eigen/Core>

namespace fascia {

// Displacements of points in frames as sums of a few fields: D ≈ fields · weights.
struct DisplacementBasis {
  Eigen::MatrixXd fields;   // 3 points x K, in the unit of the displacements
  Eigen::MatrixXd weights;  // K x frames
};

// Principal components by the frames' Gram matrix (the "method of snapshots", Sirovich 1987): no
// other K fields leave less. At most `most`; fewer if the RMS over all entries' points falls to
// `tolerance`, or if the displacements have a lower rank.
DisplacementBasis principalFields(const Eigen::MatrixXf& displacements, int most, double tolerance);

// Turns the fields among each other so that every point is moved by few of them (quartimax on the
// lengths per point, Neuhaus & Wrigley 1954): what they span, and so their error, stays.
void localizeFields(DisplacementBasis& basis);

// Scales every field so that its largest weight is 1.
void normalizeWeights(DisplacementBasis& basis);

// Takes displacements shorter than `share` of the largest out of the fields, as weighted by the
// largest weight, and fits what is left to the displacements again: fields against weights,
// alternating (as Neumann et al. 2013 do, but with a fixed set of entries).
void sparsifyFields(const Eigen::MatrixXf& displacements, double share, DisplacementBasis& basis);

}  // namespace fascia
