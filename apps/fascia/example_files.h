#pragma once

#include <functional>
#include <string>

namespace fascia {

// The folder of the example characters: examples/ here or above the program (in a source tree), or
// share/fascia/examples (installed). Throws Error if there is none.
std::string findExamples();

// For options that name a file: lets "examples/penguin.fascia.json", as --help writes it, mean the
// example wherever the program is run, if there is no such file here.
std::function<std::string(const std::string&)> exampleFiles();

}  // namespace fascia
