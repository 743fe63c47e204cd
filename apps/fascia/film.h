#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fascia/render/scene.h>

#include "console.h"
#include "simulation_options.h"

namespace fascia {

// How a film is to look.
struct FilmLook {
  std::string camera;  // as on the command line; empty = as the film suggests
  std::string layers = "skin";
  double aspect = 16.0 / 9;
};

// Something recorded that can be drawn at any of its moments, always from the same camera.
class Film {
 public:
  virtual ~Film() = default;
  virtual double start_s() const = 0;
  virtual double end_s() const = 0;
  // The picture of the moment closest to a time. Throws Error outside of the film.
  virtual Scene at(double time_s) = 0;
  virtual std::string stats() const = 0;  // JSON
  virtual void report(const std::vector<std::string>& outputs, const Console& console) const = 0;
};

// A film of a character or a scene, simulated first, or of a cache. With `only_s` no other moment
// needs to be kept.
std::unique_ptr<Film> makeFilm(const std::string& input, SimulationOptions& options,
                               std::optional<double> only_s, const FilmLook& look,
                               const Console& console);

// The two kinds.
std::unique_ptr<Film> makeCharacterFilm(const std::string& input, SimulationOptions& options,
                                        std::optional<double> only_s, const FilmLook& look,
                                        const Console& console);
std::unique_ptr<Film> makeStageFilm(const std::string& input, SimulationOptions& options,
                                    std::optional<double> only_s, const FilmLook& look,
                                    const Console& console);

}  // namespace fascia
