#pragma once

#include <string>

#include <fascia/base/tunable.h>
#include <fascia/character/character_def.h>

namespace fascia {

// Warns of every setting that differs from its default and has no effect on this kind of character:
// what only grids read, on a mesh, and so on.
void warnOfIdleSettings(const CharacterDef& def, Diagnostics& diagnostics);

// Why a group of settings has no effect, and what to do.
struct IdleReason {
  const char* why;   // "a grid has no strands …"
  const char* hint;  // "set … or leave it out"
};

// Warns of the rows of a table whose values differ from the default. `keys`: those that matter;
// none: all.
template <class T>
void warnOfIdleRows(const T& def, const std::string& pointer,
                    std::initializer_list<std::string_view> keys, const IdleReason& reason,
                    Diagnostics& diagnostics) {
  const T standard{};
  forEachTunable<T>([&](const auto& row) {
    bool matters = keys.size() == 0;
    for (const std::string_view key : keys) matters = matters || key == row.key;
    if (!matters || def.*row.member == standard.*row.member) return;
    diagnostics.warning(pointer + '/' + std::string(row.key),
                        std::string("has no effect: ") + reason.why, reason.hint);
  });
}

}  // namespace fascia
