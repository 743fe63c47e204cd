#pragma once

#include <fascia/motion/motion.h>

namespace fascia::test {

inline Key key(double time_s, double value) {
  return {time_s, value, 0, 0, 0};
}

}  // namespace fascia::test
