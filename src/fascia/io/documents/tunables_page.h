#pragma once

#include <string>

namespace fascia {

// docs/tunables.md: everything a person can set, with unit, range, default and help, made from the
// tables that readers and builders go by.
std::string tunablesPage();

}  // namespace fascia
