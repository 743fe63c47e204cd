#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

// module, or folder of a module ("io/json") -> all of them that it may include, itself among them
using Arrows = std::map<std::string, std::set<std::string>>;

// Reads the tables of modules and of their folders in ARCHITECTURE.md, "may use" followed to the
// end.
Arrows readArrows(const std::filesystem::path& architecture);

// What the sources below `root` (one folder per module) do against the rules of ARCHITECTURE.md:
// "skin/skin.cpp:12: includes <fascia/io/cache/cache.h>, …", one entry per offence, sorted.
std::vector<std::string> findViolations(const std::filesystem::path& root, const Arrows& arrows);
