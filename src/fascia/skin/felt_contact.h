#pragma once

#include <span>
#include <vector>

#include <fascia/skin/felt_kernels.h>
#include <fascia/skin/flesh_sense.h>
#include <fascia/skin/skin_contact.h>

namespace fascia {

// Contact of a skin whose points feel only some of the solids, each point its own. Solids are asked
// for the points that may be near them, all of a chunk at once. Which ones may be is known from the
// gap that a pair had when it was last evaluated, less the way that the point has gone in the
// solid's frame since, less what the solid has swollen: it saves work and changes no result.
class FeltContact final : public SkinContact {
 public:
  explicit FeltContact(const FleshSense& sense);  // which must outlive this

  Result project(const Field& field, const PointModel& points, float reach_m, float restitution,
                 VectorArray& position, VectorArray& velocity, PointSurroundings& around) override;
  // Beyond what yields, see findYielding.
  float deepest(const Field& field, const PointModel& points,
                const VectorArray& position) const override;
  // A depth x becomes a push of x up to the yield, of less the deeper it is, and of 0 beyond three
  // yields.
  void projectAnchors(const Field& field, const PointModel& points, VectorArray& anchor) override;
  void findYielding(const Field& field, const PointModel& points,
                    const VectorArray& anchor) override;

 private:
  using Chunk = FleshSense::Chunk;
  using Group = FleshSense::Group;

  // What is known of every pair (see FeltMemory), and the solids when that was last brought up to
  // date.
  struct Memory {
    VectorArray place;
    FloatArray lower, upper;
    std::vector<Field::Outline> outlines;
    std::vector<FeltSolid> solids;

    explicit Memory(const FleshSense& sense);
    void follow(const Field& field);
  };
  class ChunkContact;
  std::span<char> busy(const Chunk& chunk) {
    return std::span(busy_).subspan(chunk.firstGroup, chunk.groups);
  }

  const FleshSense* sense_;
  Memory points_, anchors_;
  FloatArray yield_;             // per pair: how deep the point, or anchor, may be
  FloatArray noYield_;           // where none does
  FloatArray bound_;             // per pair: least gap now
  std::vector<char> busy_;       // per group: whether it has points that are being moved
  std::vector<Result> results_;  // per chunk
};

}  // namespace fascia
