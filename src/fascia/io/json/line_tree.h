#pragma once

#include <fascia/io/json/json.h>
#include <fascia/io/json/line_index.h>

namespace fascia {

// Part of LineIndex, apart from it so that those who only use it need not know JSON.
struct LineIndex::Tree {
  Json root;
};

}  // namespace fascia
