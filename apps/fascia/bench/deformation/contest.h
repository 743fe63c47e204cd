#pragma once

#include <string>
#include <vector>

#include "bench/deformation/entrant.h"

namespace fascia {

struct ContestOptions {
  std::vector<std::string> motions;            // see findMotions()
  std::vector<std::string> poses;              // groups; empty = all
  std::vector<double> angles_deg = {90, 120};  // of bends
  double seconds = 4;                          // of a motion, at most
  std::string pictures;                        // a folder; empty = none
};

// One rig against all its contenders: tables for a person, and everything as JSON. What cannot be
// shown or drawn is added to the issues and does not keep the rest.
Json runContest(const Entrant& entrant, const ContestOptions& options, const Console& console,
                std::vector<Issue>& issues);

}  // namespace fascia
