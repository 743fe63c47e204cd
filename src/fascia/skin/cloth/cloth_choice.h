#pragma once

#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// The step of cloth that is not told one, s. Shorter ones ring longer where it snaps taut.
double clothStep_s(std::size_t points);

// Whether a grid hardly stretches, and is left to itself, so that few long steps by limits
// (cloth_stepper.h) show what many short ones would: no strands hold it, its rest shape is relaxed,
// hanging by any edge it would grow by a few per cent only, and the leapfrog's step
// (longestStep_s) is much shorter than its own.
bool suitsCloth(const ElasticGrid& elastic, const PointModel& points, double gravity_m_per_s2,
                double longestStep_s);

}  // namespace fascia
