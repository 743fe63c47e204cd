#pragma once

#include <fascia/body/behaviour.h>

namespace fascia {

// Steps of the length h_s from now until `end_s` is reached; rounding does not make one more.
int stepsUntil(double end_s, double now_s, double h_s);

// Throws Error for a duration or a velocity that is none.
void checkChase(const char* what, const ChaseOptions& options);

}  // namespace fascia
