#include <fascia/io/glb_export/keep_frames.h>

#include <algorithm>

namespace fascia {

std::vector<std::size_t> keepFrames(std::size_t count,
                                    const std::function<bool(std::size_t, std::size_t)>& blends) {
  std::vector<std::size_t> kept;
  if (count == 0) return kept;
  kept.push_back(0);
  for (std::size_t at = 0; at + 1 < count;) {
    const std::size_t longest = count - 1 - at;
    std::size_t good = 1;
    std::size_t bad = longest + 1;
    while (good < longest && bad > longest) {  // gallop
      const std::size_t next = std::min(2 * good, longest);
      (blends(at, at + next) ? good : bad) = next;
    }
    while (bad <= longest && bad - good > 1) {  // then halve
      const std::size_t middle = (good + bad) / 2;
      (blends(at, at + middle) ? good : bad) = middle;
    }
    at += good;
    kept.push_back(at);
  }
  return kept;
}

}  // namespace fascia
