#pragma once

namespace fascia {

struct RigImportOptions {
  double scale = 1;  // of all lengths; 0.01 for a file in centimetres
};

}  // namespace fascia
