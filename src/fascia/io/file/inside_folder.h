#pragma once

#include <string>

#include <fascia/base/error.h>

namespace fascia {

// The real place of a file that a character's file names: links followed, and inside the real
// folder. Throws Error at `pointer` if the name leads out of that folder (absolute, "..", links) or
// if nothing is there: character files come from strangers and must not read a person's other
// files. `subject` is what messages call it ("the texture").
std::string insideFolder(const std::string& folder, const std::string& name,
                         const std::string& subject, const std::string& pointer);

// An Error about one place.
Error errorAt(const std::string& pointer, const std::string& message, const std::string& hint = {});

}  // namespace fascia
