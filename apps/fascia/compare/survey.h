#pragma once

#include <functional>

#include "compare/faults.h"
#include "compare/sides.h"

namespace fascia {

// By what moments and places are worst.
enum class Worst { plain, ours, difference };

// Both sides at one moment.
struct Moment {
  std::size_t frame = 0;
  Both<Faults> faults;
  double apart_m = 0;  // how far our points lie from the plain ones, the farthest
  // How much there is to look at, per triangle, by what was asked for; and its sum.
  std::vector<float> weights;
  double badness = 0;

  // A moment of a survey keeps no numbers of single triangles.
  void forgetTriangles();
};

// The frames of a film, or of one out of which the worst is to be chosen, measured.
class Surveyor {
 public:
  Surveyor(Sides& sides, Worst worst) : sides_(sides), finder_(sides.model()), worst_(worst) {}

  Moment look(std::size_t frame);
  // Parallel. progress: the fraction done.
  std::vector<Moment> look(std::span<const std::size_t> frames,
                           const std::function<void(double)>& progress);

 private:
  struct Seen {
    std::size_t frame = 0;
    std::vector<Transform> motion;
    Both<std::vector<Eigen::Vector3f>> points;
  };
  Seen see(std::size_t frame);
  Moment measure(const Seen& seen) const;

  Sides& sides_;
  FaultFinder finder_;
  Worst worst_;
};

// The moment with the most badness, the first of equals.
std::size_t worstOf(std::span<const Moment> moments);

// Of every number the largest.
struct ClipFigures {
  Both<std::size_t> crossings, turned;
  Both<double> stretch{1, 1};
  double apart_m = 0;
};
ClipFigures figuresOf(std::span<const Moment> moments);

}  // namespace fascia
