#pragma once

#include <compare>
#include <cstdint>

#include <fascia/base/assert.h>

namespace fascia {

// An index that knows what it indexes: swapped ids do not compile.
template <class Tag>
struct Id {
  std::int32_t value = -1;

  constexpr Id() = default;
  constexpr explicit Id(std::int64_t v) : value(static_cast<std::int32_t>(v)) {}
  constexpr bool valid() const { return value >= 0; }
  constexpr std::size_t index() const {
    FASCIA_ASSERT(valid(), "only what exists has a place");
    return static_cast<std::size_t>(value);
  }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using JointId = Id<struct JointTag>;
using SolidId = Id<struct SolidTag>;

}  // namespace fascia
