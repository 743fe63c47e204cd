#include <fascia/character/character_def.h>

#include <fascia/math/ode/integrators.h>

namespace fascia {

std::vector<std::string_view> skinIntegrators() {
  std::vector<std::string_view> names = {"auto", "leapfrog", "cloth"};
  for (const IntegratorInfo& info : integrators()) names.push_back(info.name);
  return names;
}

}  // namespace fascia
