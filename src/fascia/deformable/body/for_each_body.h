#pragma once

#include <algorithm>
#include <cstddef>

#include <fascia/base/parallel.h>
#include <fascia/deformable/constraint/constraint.h>

namespace fascia {

// visit(BodyId) for all bodies, in parallel: visits must not depend on each other. `bodiesPerTask`
// is enough work to be worth handing to a thread.
template <class Visit>
void forEachBody(std::size_t count, std::size_t bodiesPerTask, Visit&& visit) {
  parallelFor((count + bodiesPerTask - 1) / bodiesPerTask, [&](std::size_t task) {
    const std::size_t last = std::min(count, (task + 1) * bodiesPerTask);
    for (std::size_t b = task * bodiesPerTask; b < last; ++b) visit(BodyId(b));
  });
}

}  // namespace fascia
