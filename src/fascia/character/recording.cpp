#include <fascia/character/recording.h>

#include <chrono>
#include <cmath>

namespace fascia {

Recording record(const Character& character, const RecordOptions& options) {
  const CharacterDef& def = character.def();
  Recording out;
  double duration = options.duration_s;
  if (options.motion >= 0) {
    const BoundClip& clip = character.motion(static_cast<std::size_t>(options.motion));
    out.motion = clip.name;
    out.loop = clip.loop;
    if (duration <= 0) duration = clip.duration_s;
  }
  out.frame_rate_hz =
      options.frame_rate_hz > 0 ? options.frame_rate_hz : def.simulation.frame_rate_hz;
  const double dt = 1 / out.frame_rate_hz;
  const auto frames = static_cast<std::int64_t>(std::llround(duration * out.frame_rate_hz));

  CharacterState state = initialState(character, options.motion);
  const auto keep = [&] {
    if (character.skin()) {
      skinSurface(*character.skin(), state.skin, out.skin);
      measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin,
                  out.stats);
    }
    if (state.time_s + 0.5 * dt >= options.start_s)
      out.frames.push_back({state.time_s, state.posture.values, out.skin.positions,
                            character.softFlesh() ? character.softFlesh()->shapes(state.bodies)
                                                  : std::vector<double>{}});
  };
  keep();
  for (std::int64_t i = 0; i < frames; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    advance(character, options.motion, dt, state, out.stats);
    out.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.simulated_s += dt;
    keep();
    if (options.progress &&
        !options.progress(static_cast<double>(i + 1) / static_cast<double>(frames)))
      throw Error("stopped");
  }
  if (character.skin() && !out.frames.empty()) {
    out.skin.positions = out.frames.front().skin_m;
    computeNormals(out.skin.positions, out.skin.triangles, out.skin.normals);
  }
  out.state_hash = hashOf(character, state);
  return out;
}

}  // namespace fascia
