#include <fascia/skin/flesh_sense.h>

#include <algorithm>
#include <tuple>

namespace fascia {

FleshSense::FleshSense(std::vector<Feeling> feelings, std::size_t solidCount, FloatArray yields_m)
    : yield_m(std::move(yields_m)), solids(solidCount) {
  const auto key = [](const Feeling& f) {
    return std::make_tuple(f.point / kChunk, f.solid.index(), !f.yields, f.point);
  };
  const auto same = [&](const Feeling& a, const Feeling& b) { return key(a) == key(b); };
  std::sort(feelings.begin(), feelings.end(),
            [&](const Feeling& a, const Feeling& b) { return key(a) < key(b); });
  feelings.erase(std::unique(feelings.begin(), feelings.end(), same), feelings.end());
  for (std::size_t first = 0; first < yield_m.size(); first += kChunk)
    chunks.push_back({first, std::min(kChunk, yield_m.size() - first), 0, 0});
  for (auto f = feelings.begin(); f != feelings.end();) {
    Chunk& chunk = chunks[f->point / kChunk];
    if (chunk.groups == 0) chunk.firstGroup = groups.size();
    ++chunk.groups;
    Group& group = groups.emplace_back();
    group.solid = f->solid;
    group.first = static_cast<std::uint32_t>(point.size());
    const auto addRun = [&](bool yields) {
      for (; f != feelings.end() && &chunks[f->point / kChunk] == &chunk &&
             f->solid == group.solid && f->yields == yields;
           ++f)
        point.push_back(static_cast<std::int32_t>(f->point - chunk.firstPoint));
      point.resize((point.size() + kPad - 1) / kPad * kPad, static_cast<std::int32_t>(kChunk));
      return static_cast<std::uint32_t>(point.size());
    };
    group.firstFirm = addRun(true);
    group.end = addRun(false);
  }
}

}  // namespace fascia
