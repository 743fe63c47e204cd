#pragma once

#include <array>
#include <span>
#include <string_view>

#include <fascia/base/aligned.h>
#include <fascia/skin/def/skin_def.h>

namespace fascia {

inline constexpr std::size_t kSkinQuantities = 15;

struct QuantityInfo {
  SkinQuantity quantity;
  std::string_view name;     // as in files
  std::string_view listKey;  // of a list of values per point, as in files
  TunableInfo uniform;       // the tunable that all points have without edits: unit and range
};
std::span<const QuantityInfo> quantityInfos();
const QuantityInfo& info(SkinQuantity quantity);

// All tunable per-point quantities in storage order: what edits, brushes, files and changes of
// resolution work on alike.
class SkinQuantities {
 public:
  FloatArray& operator[](SkinQuantity q) { return arrays_[static_cast<std::size_t>(q)]; }
  const FloatArray& operator[](SkinQuantity q) const {
    return arrays_[static_cast<std::size_t>(q)];
  }

 private:
  std::array<FloatArray, kSkinQuantities> arrays_;
};

// The uniform value that `def` gives a quantity; tissue_rest_length has none (the natural length).
double uniformValue(const SkinDef& def, SkinQuantity quantity);
const SharedList<float>& pointValues(const SkinPointsDef& points, SkinQuantity quantity);
SharedList<float>& pointValues(SkinPointsDef& points, SkinQuantity quantity);

}  // namespace fascia
