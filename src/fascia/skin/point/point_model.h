#pragma once

#include <fascia/base/aligned.h>

namespace fascia {

// What every skin point has, whatever connects it to its neighbours: one float per point, in the
// storage order of the skin. Written by the builder, read by every stepping scheme.
struct PointModel {
  FloatArray mass;              // kg
  FloatArray drag;              // N s/m, the global damping γ
  FloatArray fat;               // m
  FloatArray tissueStiffness;   // N/m; 0 = no strand
  FloatArray tissueDamping;     // N s/m
  FloatArray tissueRestLength;  // m
  FloatArray stiffnessBound;  // N/m, membrane + bending + tissue: what explicit steps must resolve
  float carry = 0;            // least share of its anchor's changes of velocity a point takes over
  FloatArray slideLimit;      // m; farthest from its anchor at an interval's end; empty: any
  FloatArray free;            // 1, or 0 for points fixed to a joint and for padding
};

// The points' surroundings over one interval of time, linear in time: written once per interval.
struct PointSurroundings {
  VectorArray anchor, anchorVelocity;  // tissue's inner ends at the interval's start
  // A half space per point that the flesh fills: n·r < offset is inside. n = 0: nothing near.
  VectorArray normal, fleshVelocity;
  FloatArray offset;  // at the interval's start; it moves with n·fleshVelocity
  // The flesh's own n, also where other skin has taken the half space. Empty without self-contact.
  VectorArray fleshNormal;

  void resize(std::size_t n) {
    for (VectorArray* a : {&anchor, &anchorVelocity, &normal, &fleshVelocity}) a->resize(n);
    offset.resize(n);
  }
};

// PointModel made ready for one step length of the stabilised leapfrog (see leapfrog.h).
struct StepCoefficients {
  float step_s = 0;
  FloatArray gain;        // velocity per force: h / (M' (1 + z)), z = hγ/(2M')
  FloatArray keep;        // velocity kept: (1 − z)/(1 + z)
  FloatArray weight;      // N per m/s² of gravity: the mass of free points
  FloatArray strandGain;  // share of a strand's closing speed removed: h k_d/(M' + h k_d)
  FloatArray carry;       // max(1 − M/M', PointModel::carry): see there
  float slide = 1;        // k_t: share of tangential velocity kept in contact
  float bounce = 0;       // k_n
};

}  // namespace fascia
