#pragma once

#include <string>

namespace fascia {

// The folder of the example characters: examples/ here or above the program (in a source tree), or
// share/fascia/examples (installed). Throws Error if there is none.
std::string findExamples();

}  // namespace fascia
