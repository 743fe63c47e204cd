#pragma once

#include <memory>
#include <span>
#include <string_view>

#include <fascia/math/ode/integrator.h>

namespace fascia {

struct IntegratorInfo {
  std::string_view name;         // as in files and on the command line
  std::string_view description;  // one line for a person who chooses
  std::unique_ptr<Integrator> (*make)();
};

// Every method of the library; to add one, write a file and name it in integrators.cpp.
std::span<const IntegratorInfo> integrators();

// Throws Error, listing the names there are, if there is no such method.
std::unique_ptr<Integrator> makeIntegrator(std::string_view name);

}  // namespace fascia
