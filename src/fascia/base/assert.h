#pragma once

// FASCIA_ASSERT(condition, "what must hold") states what a stage takes for granted. Where it does
// not hold, the program is wrong, not its input: builds without NDEBUG (debug, sanitizers) print
// the place and abort. Release builds do not evaluate the condition, so that it may look at every
// element of an array.

#include <cassert>
#include <cmath>

#ifdef NDEBUG
#define FASCIA_ASSERT(condition, what) static_cast<void>(sizeof(!(condition)))
#else
#define FASCIA_ASSERT(condition, what) assert((condition) && (what))
#endif

namespace fascia {

// For assertions: whether all of a range are finite numbers.
template <class Range>
bool areFinite(const Range& range) {
  for (const auto x : range)
    if (!std::isfinite(x)) return false;
  return true;
}

// For assertions: whether all of a range lie in [0, end).
template <class Range, class End>
bool areBelow(const Range& range, End end) {
  for (const auto x : range)
    if (!(static_cast<unsigned long long>(x) < static_cast<unsigned long long>(end))) return false;
  return true;
}

// For assertions: whether a vector has length 1, to rounding.
template <class Vector>
bool isUnit(const Vector& v, double slack = 1e-3) {
  return std::abs(static_cast<double>(v.squaredNorm()) - 1) <= slack;
}

}  // namespace fascia
