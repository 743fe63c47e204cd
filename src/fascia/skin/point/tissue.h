#pragma once

#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>
#include <fascia/field/field.h>

namespace fascia {

// The inner ends of the tissue strands (Turner & Gobbetti 1998, §4.1.2): material points of
// solids, so that they stay on a solid's surface while it moves and swells. Constant once built.
class TissueAnchors {
 public:
  struct Anchor {
    std::size_t point;  // storage index of the skin point
    SolidId solid;
    Vec3 material;
  };

  TissueAnchors() = default;
  explicit TissueAnchors(std::vector<Anchor> anchors);

  const std::vector<Anchor>& anchors() const { return anchors_; }  // sorted by solid, then point
  // Writes the world position of each anchored point's anchor; other points keep what is there.
  // `scratch` is resized on first use.
  void place(const Field& field, VectorArray& scratch, VectorArray& anchor) const;

 private:
  struct Group {
    SolidId solid;
    std::size_t first, count;
  };
  std::vector<Anchor> anchors_;
  std::vector<Group> groups_;
  VectorArray material_;
};

}  // namespace fascia
