#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <fascia/character/recording.h>

#include "console.h"

namespace fascia {

std::string endingOf(const std::string& path);  // ".glb", in lower case
bool isGlb(const std::string& path);            // .glb, or .vrm, which is one with extensions

// For CLI11: accepts paths with one of these endings.
std::function<std::string(const std::string&)> endsIn(const std::vector<std::string>& endings);

// Throws Error before any long work if a file could not be written where it is wanted. Empty paths
// are skipped.
void checkFolders(const std::vector<std::string>& paths);

// Throws Error if a file would be written twice, or over one that has been read; and lets reading
// one of them fail from now on.
void checkOverwriting(const std::vector<std::string>& outputs, const std::string& stats);

// A line about each simulation for a person, the whole statistics for a machine: of one as "stats",
// of several as a list of "motions"; `more` joins the machine's answer.
void reportRecordings(std::span<const Recording* const> recordings,
                      const std::vector<std::string>& outputs, const Console& console,
                      const Json::Object& more = {});
// Of one that was not simulated now, but came from the file `cache` if that is named.
void reportRecording(const Recording& recording, const std::vector<std::string>& outputs,
                     const Console& console, const std::string& cache = {});

}  // namespace fascia
