#pragma once

#include <fascia/field/field.h>
#include <fascia/skin/point/face_samples.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// The usual clearance, as a share of the skin's size: what lies between samples comes nearer by
// less.
constexpr double kFaceClearance = 1e-3;
// How far edges of a rest shape, which are at rest then as they are, may be stretched for it.
constexpr double kRestLift = 2;
// And those of a shape that is shown, beyond what its material allows.
constexpr double kShownLift = 1.2;

// Lifts faces off the flesh that comes through them between their points: moves free points out
// until hardly a sample is nearer to a solid than `clearance_m`, or than its fat where that is
// less; but no edge beyond `most_stretch` times its rest length that was not so long before:
// where points are too few for the flesh, faces stay in it rather than become spikes. A function of
// the positions alone, and a continuous one: it is how a skin is shown, and what is simulated knows
// nothing of it. (As a part of the simulation it has no state of rest: which of a face's points
// bears it is left open.)
void liftFaces(const FaceSamples& faces, const DistanceField& flesh, const PointModel& points,
               float clearance_m, double most_stretch, VectorArray& position);

}  // namespace fascia
