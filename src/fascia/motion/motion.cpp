#include <fascia/motion/motion.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fascia/base/suggest.h>

namespace fascia {
namespace {

// Keys closer than this count as two at once. Much smaller, and slopes overflow; much larger, and
// deliberate jumps between frames are refused.
constexpr double kShortestInterval = 1e-6;  // s
constexpr double kShortestLoop = 1e-3;      // s

void validateKey(const Key& key, const std::string& pointer, Diagnostics& diagnostics) {
  validateTunables(key, pointer, diagnostics);
  // In memory's unit: what a joint's degree of freedom may be is for who binds it to say.
  checkNumber(kKeyValue, key.value, pointer + "/value", diagnostics);
}

void validateOrder(const std::vector<Key>& keys, const std::string& pointer,
                   Diagnostics& diagnostics) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const double interval_s = keys[i].time_s - keys[i - 1].time_s;
    if (std::abs(interval_s) < kShortestInterval) {
      diagnostics.error(pointer + "/" + std::to_string(i),
                        "two keys at " + shortNumber(keys[i].time_s) + " s",
                        "delete one, or move it a little to make a jump");
    } else if (interval_s < 0) {
      diagnostics.error(pointer + "/" + std::to_string(i),
                        "key at " + shortNumber(keys[i].time_s) + " s comes after the key at " +
                            shortNumber(keys[i - 1].time_s) + " s",
                        "sort the keys by time");
    }
  }
}

void validateLoop(const MotionDef& motion, const std::vector<Key>& keys, const std::string& pointer,
                  Diagnostics& diagnostics) {
  const double period_s = playedDuration_s(motion);
  const Key &first = keys.front(), &last = keys.back();
  const std::string lastPointer = pointer + "/" + std::to_string(keys.size() - 1);
  const double span_s = last.time_s - first.time_s;
  const bool same = std::abs(last.value - first.value) <= 1e-6 * (1 + std::abs(first.value));
  if (last.time_s > period_s * (1 + 1e-9)) {
    diagnostics.error(lastPointer, "key at " + shortNumber(last.time_s) +
                                       " s lies beyond the loop of " + shortNumber(period_s) +
                                       " s");
  } else if (period_s > 0 && span_s >= period_s * (1 - 1e-9) && !same) {
    diagnostics.error(lastPointer,
                      "the loop jumps: it ends with " + shortNumber(last.value) +
                          " and starts with " + shortNumber(first.value),
                      "give the last key the first key's value, or leave it out");
  }
}

void validateTrack(const MotionDef& motion, const TrackDef& track, const std::string& pointer,
                   Diagnostics& diagnostics) {
  const bool joint = track.target == TrackDef::Target::joint;
  const bool morph = track.target == TrackDef::Target::morph;
  if (track.name.empty()) {
    const std::string kind = joint ? "joint" : morph ? "morph" : "solid";
    diagnostics.error(pointer + "/" + kind, "a track needs a " + kind + "'s name");
  }
  if (track.channel.empty() && !morph) {
    diagnostics.error(pointer + (joint ? "/dof" : "/parameter"),
                      joint ? "a track needs a degree of freedom: tx, ty, tz, rx, ry or rz"
                            : "a track needs a parameter's name");
  }
  if (track.keys.empty()) {
    diagnostics.error(pointer + "/keys", "a track needs at least one key");
    return;
  }
  for (std::size_t i = 0; i < track.keys.size(); ++i) {
    validateKey(track.keys[i], pointer + "/keys/" + std::to_string(i), diagnostics);
  }
  validateOrder(track.keys, pointer + "/keys", diagnostics);
  if (motion.loop) {
    validateLoop(motion, track.keys, pointer + "/keys", diagnostics);
  } else if (motion.duration_s > 0 && track.keys.back().time_s > motion.duration_s) {
    diagnostics.warning(pointer + "/keys/" + std::to_string(track.keys.size() - 1),
                        "key lies after the end of the motion and is not reached");
  }
}

void validateUniqueTracks(const MotionDef& motion, const std::string& pointer,
                          Diagnostics& diagnostics) {
  std::map<std::tuple<TrackDef::Target, std::string, std::string>, std::size_t> seen;
  for (std::size_t i = 0; i < motion.tracks.size(); ++i) {
    const TrackDef& track = motion.tracks[i];
    const auto [earlier, fresh] = seen.try_emplace({track.target, track.name, track.channel}, i);
    if (fresh) continue;
    diagnostics.error(
        pointer + "/tracks/" + std::to_string(i),
        "a second track for " + quotedName(track.name) + ", " + quotedName(track.channel),
        "the first is track " + std::to_string(earlier->second));
  }
}

}  // namespace

double playedDuration_s(const MotionDef& motion) {
  double last_s = 0;
  if (motion.duration_s > 0) return motion.duration_s;
  for (const TrackDef& track : motion.tracks) {
    if (!track.keys.empty()) last_s = std::max(last_s, track.keys.back().time_s);
  }
  return last_s;
}

void validateMotion(const MotionDef& motion, const std::string& pointer, Diagnostics& diagnostics) {
  if (motion.name.empty()) diagnostics.error(pointer + "/name", "a motion needs a name");
  const std::size_t errorsBefore = diagnostics.errors().size();
  validateTunables(motion, pointer, diagnostics);
  if (diagnostics.errors().size() > errorsBefore) return;  // nothing can be said about loops
  if (motion.tracks.size() > kMostTracks) {
    diagnostics.error(pointer + "/tracks", "found " + std::to_string(motion.tracks.size()) +
                                               " tracks, expected at most " +
                                               std::to_string(kMostTracks));
    return;
  }
  if (motion.loop && !(playedDuration_s(motion) >= kShortestLoop)) {
    diagnostics.error(pointer + "/duration_s", "a loop needs a duration of at least 1 ms",
                      "set duration_s, or give a key after 0 s");
  }
  for (std::size_t i = 0; i < motion.tracks.size(); ++i) {
    validateTrack(motion, motion.tracks[i], pointer + "/tracks/" + std::to_string(i), diagnostics);
  }
  validateUniqueTracks(motion, pointer, diagnostics);
}

}  // namespace fascia
