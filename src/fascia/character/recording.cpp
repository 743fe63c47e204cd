#include <fascia/character/recording.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/character/editing.h>

namespace fascia {

Recording startRecording(const PostureSource& source, double frame_rate_hz) {
  FASCIA_ASSERT(frame_rate_hz > 0, "frames last");
  Recording out;
  out.frame_rate_hz = frame_rate_hz;
  const PostureSource::Info info = source.info();
  out.motion = info.name;
  out.loop = info.loop;
  return out;
}

void keepFrame(const Character& character, const CharacterState& state, bool kept, Recording& out) {
  FASCIA_ASSERT(state.posture.values.size() == character.skeleton().valueCount(),
                "the state is of this character");
  if (character.skin()) {
    skinSurface(*character.skin(), state.flesh, state.skin, out.skin);
    measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin,
                out.stats);
    // A rig's own mesh goes where its joints take it, through flesh as well, and has many faces.
    if (!character.skin()->rigged()) measureFaces(state.flesh, out.skin, out.stats);
  }
  if (!kept) return;
  out.frames.push_back({state.time_s,
                        state.posture.values,
                        out.skin.positions,
                        {},
                        state.sampled.parameters,
                        state.morphs.weights});
  if (const auto& soft = character.softFlesh())
    out.frames.back().soft_shapes = soft->shapes(state.bodies);
}

void finishRecording(const Character& character, const CharacterState& last, Recording& out) {
  if (character.skin() && !out.frames.empty()) {
    out.skin.positions = out.frames.front().skin_m;
    computeNormals(out.skin.positions, out.skin.triangles, out.skin.normals);
  }
  out.state_hash = hashOf(character, last);
}

namespace {

CharacterState firstState(const Character& character, const PostureSource& source,
                          const CharacterState* from) {
  if (!from) return initialState(character, source);
  requireFits(character, *from);
  return *from;
}

}  // namespace

Recording record(const Character& character, const PostureSource& source,
                 const RecordOptions& options) {
  const double frameRate_hz =
      options.frame_rate_hz > 0 ? options.frame_rate_hz : character.def().simulation.frame_rate_hz;
  Recording out = startRecording(source, frameRate_hz);
  CharacterState state = firstState(character, source, options.from);
  const double left_s = std::max(0.0, source.info().duration_s - state.time_s);
  const double duration = options.duration_s > 0 ? options.duration_s : left_s;
  const double dt = 1 / frameRate_hz;
  const auto frames = static_cast<std::int64_t>(std::llround(duration * frameRate_hz));

  const auto keep = [&] {
    keepFrame(character, state, state.time_s + 0.5 * dt >= options.start_s, out);
  };
  keep();
  for (std::int64_t i = 0; i < frames; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    advance(character, source, dt, state, out.stats);
    out.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.simulated_s += dt;
    keep();
    if (options.progress &&
        !options.progress(static_cast<double>(i + 1) / static_cast<double>(frames)))
      throw Error("stopped");
  }
  finishRecording(character, state, out);
  if (options.last) *options.last = std::move(state);
  return out;
}

}  // namespace fascia
